//! `opm inspect`: complete recordings, truncated ones, and other files.

use crate::PLANO;
use crate::run::{Folder, keys, number, opm};
use std::fs;

fn record(folder: &Folder) -> String {
    let output = folder.arg("cloud.mcap");
    let grid = ["--grid", "x=-20mm:20mm:41", "--grid", "y=-20mm:20mm:41"];
    let rest = ["--grid", "xi=0:0.2:5", "--scalars", "theta11,S1", "-o", &output, "--quiet"];
    opm(&[&["workspace", PLANO], &grid[..], &rest].concat()).text();
    output
}

#[test]
fn a_recording_says_what_it_holds() {
    let folder = Folder::new();
    let file = record(&folder);
    let found = opm(&["inspect", &file, "--format", "json"]).json();
    let expected = ["file", "complete", "topics", "time", "extents", "metadata", "attachments"];
    assert_eq!(keys(&found), expected);
    assert_eq!(found["complete"], true);
    let topics = found["topics"].as_array().unwrap();
    let names: Vec<&str> = topics.iter().map(|t| t["name"].as_str().unwrap()).collect();
    let parts = ["axes", "cloud", "label", "slice", "slices"];
    assert_eq!(names, parts.map(|part| format!("/workspace/{part}")));
    let messages: Vec<f64> = topics.iter().map(|topic| number(&topic["messages"])).collect();
    assert_eq!(messages, [1.0, 1.0, 5.0, 5.0, 5.0]);
    for topic in [&topics[0], &topics[2], &topics[3]] {
        assert_eq!(topic["points"], serde_json::Value::Null);
    }
    for topic in [&topics[1], &topics[4]] {
        assert_eq!(keys(topic), ["name", "schema", "messages", "points"]);
        assert_eq!(topic["schema"], "foxglove.PointCloud");
        assert_eq!(number(&topic["points"]), 41.0 * 41.0 * 5.0, "all of this grid is in reach");
    }
    assert_eq!(keys(&found["extents"]), ["x", "y", "z", "theta11", "S1"]);
    let x = found["extents"]["x"].as_array().unwrap();
    assert!((number(&x[0]) + 0.02).abs() < 1e-7 && (number(&x[1]) - 0.02).abs() < 1e-7);
    assert_eq!(found["metadata"]["run"]["grid.x"], "-0.02:0.02:41");
    assert_eq!(found["metadata"]["run"]["mode"], "++ ++ ++ +");
    assert_eq!(found["metadata"]["run"]["program"], concat!("opm ", env!("CARGO_PKG_VERSION")));
    assert_eq!(found["metadata"]["result"]["complete"], "true");
    assert_eq!(found["metadata"]["clouds"]["color"], "xi");
    let attached = &found["attachments"][0];
    assert_eq!(attached["name"], format!("{PLANO}.toml"));
    assert_eq!(number(&attached["size"]), opm(&["examples", PLANO]).stdout.len() as f64);

    let text = opm(&["inspect", &file]);
    for part in ["complete", "/workspace/slices", "8,405", "theta11", "-0.02:0.02:41"] {
        assert!(text.text().contains(part), "no {part:?} in\n{}", text.stdout);
    }
}

#[test]
fn a_cut_recording_is_read_as_far_as_it_is_whole() {
    let folder = Folder::new();
    let whole = fs::read(record(&folder)).unwrap();
    let cut = folder.write("cut.mcap", &whole[..whole.len() / 2]);
    let run = opm(&["inspect", &cut, "--format", "json"]);
    assert_eq!(run.json()["complete"], false);
    assert!(run.stderr.contains("cut short"), "{}", run.stderr);
    assert!(opm(&["inspect", &cut]).text().contains("cut short"));
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = Folder::new();
    let text = folder.write("text.mcap", "this is not a recording");
    opm(&["inspect", &text]).fails_with_one_line(1, &["text.mcap: not an MCAP file"]);
    let empty = folder.write("empty.mcap", "");
    opm(&["inspect", &empty]).fails_with_one_line(1, &["empty.mcap"]);
    let missing = folder.arg("missing.mcap");
    opm(&["inspect", &missing]).fails_with_one_line(1, &["missing.mcap: No such file"]);
    opm(&["inspect", &folder.arg("")]).fails_with_one_line(1, &["directory"]);
    let mut damaged = fs::read(record(&folder)).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle..middle + 64].fill(0x55);
    let damaged = folder.write("damaged.mcap", damaged);
    opm(&["inspect", &damaged]).fails_with_one_line(1, &["damaged.mcap"]);
}
