//! Aspects: the table and JSON of `opm workspace --kind aspects`, pictures, `opm path` and `opm fk --aspects`.

use crate::run::opm;
use serde_json::Value;
use tempfile::TempDir;

const GRID: [&str; 6] =
    ["--grid", "x=-36mm:36mm:21", "--grid", "y=-36mm:36mm:21", "--grid", "theta=-180deg:180deg:21"];

fn with_grid<'a>(args: &[&'a str]) -> Vec<&'a str> {
    args.iter().copied().chain(GRID).collect()
}

#[test]
fn aspects_are_listed_with_their_signs_and_their_extents() {
    let args = with_grid(&["workspace", "planar-3rpr", "--kind", "aspects"]);
    let text = opm(&args).text().to_owned();
    assert!(text.contains("planar-3rpr, aspects, mode") && text.contains("aspect  sign"), "{text}");
    let json = opm(&[&args[..], &["--format", "json"]].concat()).json();
    let aspects = &json["aspects"];
    let list = aspects["list"].as_array().unwrap();
    assert_eq!(aspects["number"], list.len());
    let poses = |one: &Value| one["poses"].as_u64().unwrap();
    let all: u64 = list.iter().map(poses).sum();
    assert_eq!(all + aspects["singular"].as_u64().unwrap(), json["reachable"].as_u64().unwrap());
    assert!(list.windows(2).all(|two| poses(&two[0]) >= poses(&two[1])));
    assert_ne!(list[0]["sign"], list[1]["sign"]);
    let specks = list.iter().filter(|one| poses(one) <= 2).count();
    assert_eq!(aspects["specks"], specks);
    assert_eq!(text.contains(&format!("and {specks} specks of one or two poses")), specks > 0);
    let measure = |one: &Value| one["measure"]["value"].as_f64().unwrap();
    let shares: f64 = list.iter().map(measure).sum();
    let share = shares / json["measure"]["value"].as_f64().unwrap();
    assert!((share - all as f64 / json["reachable"].as_f64().unwrap()).abs() < 1e-12);
    let [low, high] = [0, 1].map(|i| list[0]["extent"]["x"][i].as_f64().unwrap());
    assert!(-0.036 <= low && low < high && high <= 0.036);
    assert_eq!(json["singularities"]["slices"].as_array().unwrap().len(), 21);
    assert_eq!(json["components"]["number"], list.len());
}

#[test]
fn aspects_are_of_one_working_mode_and_of_a_mechanism_that_is_held() {
    let any = with_grid(&["workspace", "planar-3rpr", "--kind", "aspects", "--mode", "any"]);
    opm(&any).fails(2, &["--mode", "--kind aspects", "other aspects in each mode"]);
    let all = ["workspace", "planar-3rrr", "--kind", "aspects", "--all-modes"];
    opm(&all).fails(2, &["--all-modes", "--grid"]);
    let grid = ["--grid", "x=-0.1:0.1:9", "--grid", "y=-0.1:0.1:9", "--format", "json"];
    let runs = opm(&[&all[..], &grid].concat()).json();
    let runs = runs["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 8);
    assert!(runs.iter().all(|run| run["aspects"].as_u64().unwrap() > 0), "{runs:?}");
}

#[test]
fn a_picture_of_aspects_has_their_colours_and_the_singularities() {
    let folder = TempDir::new().unwrap();
    let [recording, picture] = ["aspects.mcap", "aspects.svg"].map(|name| folder.path().join(name));
    let [recording, picture] = [&recording, &picture].map(|path| path.to_str().unwrap());
    let args = ["workspace", "planar-3rpr", "--kind", "aspects", "-o", recording];
    opm(&with_grid(&args)).text();
    opm(&["plot", recording, "-o", picture]).text();
    let svg = std::fs::read_to_string(picture).unwrap();
    for part in ["aspect 1", "aspect 2", "The red lines are parallel singularities"] {
        assert!(svg.contains(part), "no {part}");
    }
}

#[test]
fn three_and_three_assemblies_of_a_planar_3rpr_share_an_aspect() {
    let args = ["fk", "planar-3rpr", "--joints", "S1=14.98mm,S2=15.38mm,S3=12mm", "--aspects"];
    let text = opm(&with_grid(&args)).text().to_owned();
    assert!(
        text.contains("1, 3 and 6 share aspect") && text.contains("2, 4 and 5 share"),
        "{text}"
    );
    let json = opm(&with_grid(&[&args[..], &["--format", "json"]].concat())).json();
    let assemblies = json["assemblies"].as_array().unwrap();
    let labels: Vec<u64> = assemblies.iter().map(|one| one["aspect"].as_u64().unwrap()).collect();
    assert_eq!(labels[0], labels[2]);
    assert_eq!(labels[0], labels[5]);
    assert_ne!(labels[0], labels[1]);
    let plain = opm(&[&args[..4], &["--format", "json"]].concat()).json();
    assert!(plain["assemblies"][0].get("aspect").is_none());
    opm(&["fk", "planar-3rpr", "--joints", "S1=1", "--grid", "x=0:1:3"]).fails(2, &["--aspects"]);
}

#[test]
fn a_path_is_a_motion_that_the_mechanism_follows() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("path.csv");
    let file = file.to_str().unwrap();
    let to = "x=-13.4mm,y=-6.6mm,theta=-23.8deg";
    let args = ["path", "planar-3rpr", "--from", "x=14.9201332mm", "--to", to];
    opm(&with_grid(&[&args[..], &["-o", file, "--duration", "4"]].concat())).text();
    let followed = ["trajectory", "planar-3rpr", "--motion", file, "--strict", "--format", "json"];
    let followed = opm(&followed).json();
    assert_eq!(followed["duration"], 4.0);
    assert_eq!(followed["violations"].as_array().unwrap().len(), 0);
    let json = opm(&with_grid(&[&args[..], &["--format", "json"]].concat())).json();
    assert_eq!((&json["joined"], &json["aspects"]["from"]), (&true.into(), &json["aspects"]["to"]));
    let last = json["poses"]["x"].as_array().unwrap().last().unwrap().as_f64().unwrap();
    assert!((last + 0.0134).abs() < 1e-12);
    let printed = opm(&with_grid(&[&args[..], &["-o", "-"]].concat())).text().to_owned();
    assert!(printed.starts_with("t,x,y,theta\n0.0,"), "{printed}");
}

#[test]
fn poses_of_two_aspects_are_not_joined() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("path.csv");
    let args = [
        "path",
        "planar-3rpr",
        "--from",
        "x=14.9201332mm",
        "--to",
        "x=14.674mm,y=-3.013mm,theta=64.79deg",
    ];
    let json = opm(&with_grid(&[&args[..], &["--format", "json"]].concat())).json();
    assert_eq!(json["joined"], false);
    assert!(json["reason"].as_str().unwrap().contains("different aspects"), "{json}");
    assert_ne!(json["aspects"]["from"], json["aspects"]["to"]);
    let written = opm(&with_grid(&[&args[..], &["-o", file.to_str().unwrap()]].concat()));
    written.fails(1, &["no path", "different aspects"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let far = ["path", "planar-3rpr", "--from", "x=1m", "--to", "x=14mm"];
    opm(&with_grid(&far))
        .fails(2, &["--from", "S1 = 1000 mm is beyond its limits, 5.000 .. 35.000 mm"]);
    let ending = [&args[..], &["-o", "path.toml"]].concat();
    opm(&with_grid(&ending)).fails(2, &["--output", ".csv"]);
    opm(&with_grid(&[&args[..], &["--duration", "0"]].concat()))
        .fails(2, &["--duration", "seconds"]);
}
