//! `opm check` and `opm recover`.

use crate::PLANO;
use crate::run::{Folder, keys, number, opm};
use std::fs;

#[test]
fn a_certificate_says_what_was_held() {
    let found = opm(&["check", PLANO, "--samples", "5", "--format", "json"]).json();
    assert_eq!(
        keys(&found),
        ["name", "version", "samples", "seed", "holds", "misfit", "comparisons"]
    );
    assert_eq!(found["holds"], true);
    let comparisons = found["comparisons"].as_array().unwrap();
    let names: Vec<&str> = comparisons.iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["closure", "branches", "derivatives", "rows", "forward"]);
    for one in comparisons {
        assert!(one["holds"] == true && number(&one["compared"]) > 0.0, "{one}");
    }
    let again = opm(&["check", PLANO, "--samples", "5", "--format", "json"]).json();
    assert_eq!(found, again);
    let text = opm(&["check", PLANO, "--samples", "5", "--seed", "2"]);
    for part in ["everything compared holds", "seed 2", "closure", "undecomposed legs"] {
        assert!(text.text().contains(part), "no {part:?} in\n{}", text.stdout);
    }
    opm(&["check", PLANO, "--samples", "0"]).fails(2, &["--samples"]);
    opm(&["check", "none.toml"]).fails(1, &["none.toml"]);
}

#[test]
fn a_recording_that_was_cut_short_is_recovered() {
    let folder = Folder::new();
    let whole = folder.arg("cloud.mcap");
    let grid = ["--grid", "x=-20mm:20mm:41", "--grid", "y=-20mm:20mm:41", "--grid", "xi=0:0.2:5"];
    opm(&[&["workspace", PLANO], &grid[..], &["-o", &whole, "--quiet"]].concat()).text();
    let bytes = fs::read(&whole).unwrap();
    let cut = folder.write("cut.mcap.partial", &bytes[..bytes.len() * 2 / 3]);
    let found = opm(&["recover", &cut, "--format", "json"]).json();
    let recovered = folder.arg("cut.recovered.mcap");
    assert_eq!(found["output"], recovered);
    let inspect = |path: &str| opm(&["inspect", path, "--format", "json"]).json();
    let [before, after] = [&cut, &recovered].map(|path| inspect(path));
    for part in ["topics", "time", "extents", "attachments", "complete"] {
        assert_eq!(before[part], after[part]);
    }
    assert_eq!(after["complete"], false);
    assert_eq!(after["metadata"]["recovered"]["from"], "cut.mcap.partial");
    // It is drawn like any other.
    let picture = folder.arg("cut.svg");
    opm(&["plot", &recovered, "-o", &picture]).text();

    opm(&["recover", &whole]).fails(1, &["cloud.mcap", "whole: there is nothing to recover"]);
    opm(&["recover", &cut, "-o", &cut]).fails(2, &["--output", "is the file to recover"]);
    let text = folder.write("text.mcap.partial", b"x,y\n");
    opm(&["recover", &text]).fails(1, &["text.mcap.partial: not an MCAP file"]);
    assert!(!fs::exists(folder.arg("text.recovered.mcap")).unwrap());
    assert!(!fs::exists(folder.arg("text.recovered.mcap.partial")).unwrap());
}

/// The parts of a sweep count; half a part must not.
#[test]
fn a_recovered_shard_is_not_merged() {
    let folder = Folder::new();
    let part = folder.arg("part-1.mcap");
    let grid = ["--grid", "x=-20mm:20mm:41", "--grid", "y=-20mm:20mm:41", "--grid", "xi=0:0.2:5"];
    opm(&[&["workspace", PLANO], &grid[..], &["--shard", "1/1", "-o", &part, "--quiet"]].concat())
        .text();
    let bytes = fs::read(&part).unwrap();
    for share in 1..16 {
        let cut = folder.write("cut.mcap.partial", &bytes[..bytes.len() * share / 16]);
        let recovered = folder.arg("cut.recovered.mcap");
        if opm(&["recover", &cut]).code == Some(0) {
            let whole =
                opm(&["inspect", &recovered, "--format", "json"]).json()["complete"].clone();
            let merged = opm(&["merge", &recovered]);
            assert_eq!(merged.code == Some(0), whole == true, "{share}: {}", merged.stderr);
        }
    }
}
