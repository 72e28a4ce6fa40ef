//! `opm new`, and files that name their dimensions, in the commands that change numbers.

use crate::run::{Folder, opm};
use serde_json::Value;

/// The length of the rod of each leg, metres, from the joints that `decompose` prints.
fn rods(json: &Value) -> Vec<f64> {
    let point = |name: &str| -> Vec<f64> {
        let joints = json["joints"].as_array().unwrap();
        let joint = joints.iter().find(|joint| joint["name"] == name).unwrap();
        joint["point"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect()
    };
    let distance = |leg: usize| {
        let (b, c) = (point(&format!("B{leg}")), point(&format!("C{leg}")));
        b.iter().zip(&c).map(|(b, c)| (b - c).powi(2)).sum::<f64>().sqrt()
    };
    (1..=3).map(distance).collect()
}

/// A Delta by its drawing is changed, swept and optimised by the names on the drawing.
#[test]
fn a_robot_is_written_by_its_dimensions() {
    let folder = Folder::new();
    let mine = folder.arg("mine.toml");
    opm(&["new", "delta", "--set", "rb=120mm,rp=40mm,crank=150mm,rod=350mm", "-o", &mine]).text();
    let text = folder.read("mine.toml");
    for line in ["rb = { value = 120,", "rod = { value = 350,", "# Delta: three cranks"] {
        assert!(text.contains(line), "{text}");
    }
    let decompose =
        |more: &[&str]| opm(&[&["decompose", &mine, "--format", "json"], more].concat()).json();
    for (json, rod) in
        [(decompose(&[]), 0.35), (decompose(&["--set", "rod=380mm,crank=0.16"]), 0.38)]
    {
        for found in rods(&json) {
            assert!((found - rod).abs() < 1e-12, "{found}");
        }
        let rod_of_file =
            json["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "rod");
        assert_eq!(rod_of_file.unwrap()["value"], rod);
        assert_eq!(json["patterns"][0]["legs"], serde_json::json!(["leg1", "leg2", "leg3"]));
    }
    let shown = opm(&["decompose", &mine]).stdout;
    assert!(shown.contains("leg1, leg2, leg3 are alike: 120 deg apart about (0, 0, 1)"), "{shown}");
    assert!(shown.contains("crank") && shown.contains("150 mm"), "{shown}");

    let table = opm(&[
        "workspace",
        &mine,
        "--grid",
        "x=-100mm:100mm:5",
        "--grid",
        "y=0",
        "--vary",
        "crank=100mm:200mm:3",
        "--format",
        "json",
    ])
    .json();
    let runs = table["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 3);
    assert_eq!(
        (&runs[0]["value"], &table["units"]),
        (&serde_json::json!(0.1), &serde_json::json!("m"))
    );

    // A change keeps the rest of the text.
    let changed = opm(&["convert", &mine, "--set", "crank=160mm"]).stdout;
    assert_eq!(changed, text.replace("crank = { value = 150,", "crank = { value = 160,"));
    // A list of joints is that of the file.
    let list = folder.write("list.toml", opm(&["convert", &mine, "--joints"]).stdout);
    assert!(!folder.read("list.toml").contains("parameters"));
    for found in rods(&opm(&["decompose", &list, "--format", "json"]).json()) {
        assert!((found - 0.35).abs() < 1e-12);
    }
}

#[test]
fn an_optimiser_takes_parameters() {
    let folder = Folder::new();
    let mine = folder.arg("mine.toml");
    opm(&["new", "five-bar", "-o", &mine]).text();
    folder.write(
        "problem.toml",
        "format = 1\nmechanism = \"mine.toml\"\nunits = { length = \"mm\", angle = \"deg\" }\nbudget = 60\n\n\
         [grid]\nx = [-200, 200, 21]\ny = [50, 400, 21]\n\n[variables]\nupper = [120, 180]\nfore = [250, 350]\n\n\
         [[objective]]\nmeasure = \"grid\"\n",
    );
    let problem = folder.arg("problem.toml");
    let better = folder.arg("better.toml");
    opm(&["design", &problem, "-o", &better]).text();
    let text = folder.read("better.toml");
    assert!(text.contains("# Five-bar") && text.contains("span = { value = 320,"), "{text}");
    assert!(!text.contains("upper = { value = 138,"), "{text}");
    opm(&["decompose", &better]).text();
}

#[test]
fn every_architecture_is_listed_and_written() {
    let folder = Folder::new();
    let json = opm(&["new", "--format", "json"]).json();
    let all = json["architectures"].as_array().unwrap();
    assert!(all.len() >= 30);
    let text = opm(&["new"]).stdout;
    for one in all {
        let name = one["name"].as_str().unwrap();
        assert!(text.contains(&format!("\n{name}: ")) || text.starts_with(&format!("{name}: ")));
        let file = folder.arg(&format!("{name}.toml"));
        let written = opm(&["new", name, "-o", &file]);
        assert!(written.stderr.is_empty(), "{name}: {}", written.stderr);
        assert_eq!(folder.read(&format!("{name}.toml")), one["text"].as_str().unwrap());
        opm(&["decompose", &file]).text();
    }
    // The drawings are of Braille.
    assert!(text.lines().any(|line| line.chars().any(|c| ('\u{2801}'..='\u{28ff}').contains(&c))));
}

#[test]
fn wrong_dimensions_are_told_and_leave_no_file() {
    let folder = Folder::new();
    let mine = folder.arg("mine.toml");
    let new = |arguments: &[&str]| opm(&[&["new"], arguments].concat());
    new(&["delat"]).fails_with_one_line(2, &["no architecture \"delat\"", "did you mean `delta`?"]);
    new(&["delta", "--set", "rodd=1", "-o", &mine])
        .fails_with_one_line(2, &["--set", "`rodd`", "did you mean `rod`?"]);
    new(&["delta", "--set", "rod=300mm", "-o", &mine])
        .fails_with_one_line(2, &["--set", "along: B is 644 mm from the line", "344 mm off"]);
    new(&["delta", "--set", "rod=20deg", "-o", &mine]).fails_with_one_line(2, &["rod is a length"]);
    new(&["delta", "--set", "crank=-20mm", "-o", &mine])
        .fails_with_one_line(2, &["`crank` is -20 mm, expected at least 0 mm"]);
    new(&["delta", "--set", "A=1", "-o", &mine]).fails_with_one_line(2, &["`A` is a point"]);
    new(&["delta", "-o", "mine.csv"]).fails_with_one_line(2, &["--output", "toml"]);
    new(&["--set", "rod=1"]).fails_with_one_line(2, &["NAME is missing"]);
    assert!(folder.names().is_empty());
    new(&["delta", "-o", &mine]).text();
    new(&["delta", "--set", "rod=1.3", "-o", &mine]).fails_with_one_line(2, &["exists", "--force"]);
    new(&["delta", "--set", "rod=1.3", "-o", &mine, "--force"]).text();
    assert!(folder.read("mine.toml").contains("rod = { value = 1300,"));
    opm(&["measure", &mine, "--vary", "rodd=1:2:3"]).fails_with_one_line(2, &["--vary", "`rodd`"]);
    // A problem of a file stands at its place in the expression.
    let wrong =
        folder.write("wrong.toml", folder.read("mine.toml").replace("rb + crank", "rb + crnk"));
    opm(&["decompose", &wrong]).fails_with_one_line(
        1,
        &["wrong.toml:", "`crnk` is not a parameter; did you mean `crank`?"],
    );
}
