//! `opm linkage`: positions and sweeps of Bennett's double spherical 6R, of Sarrus' linkage and of sliders.

use crate::run::{Folder, Run, keys, number, opm};
use crate::{HELICAL, PLANO};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const BENNETT: &str = "bennett-double-spherical-6r";
/// The file's axes are unit vectors to fifteen digits.
const ROUNDING: f64 = 1e-9;

fn linkage(args: &[&str]) -> Run {
    opm(&[&["linkage", BENNETT], args].concat())
}

fn solved(input: &str) -> Value {
    linkage(&["--input", input, "--format", "json"]).json()
}

/// The rows of a sweep, one number per column, without the branch.
fn rows(csv: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    csv.lines().skip(1).map(row).collect()
}

#[test]
fn every_branch_is_told() {
    let found = solved("a1=30deg");
    let expected = ["name", "input", "range", "full_turn", "home_branch", "solutions"];
    assert_eq!(keys(&found), expected);
    assert_eq!(keys(&found["input"]), ["joint", "value"]);
    assert_eq!(found["input"]["joint"], "a1");
    assert!((number(&found["input"]["value"]) - PI / 6.0).abs() < 1e-15);
    assert_eq!((&found["range"], &found["full_turn"]), (&json!([[-PI, PI]]), &json!(true)));
    let solutions = found["solutions"].as_array().unwrap();
    let branches: Vec<_> = solutions.iter().map(|s| s["branch"].as_str().unwrap()).collect();
    assert_eq!(branches, ["+ +", "+ -", "- +", "- -"]);
    for solution in solutions {
        assert_eq!(keys(solution), ["branch", "within_limits", "joints", "imaginary"]);
        assert_eq!(keys(&solution["joints"]), ["a1", "b3", "a2", "a3", "b1", "b2"]);
        assert_eq!(keys(&solution["imaginary"]), ["tau.leg1"]);
    }
}

/// Without --input, the actuated joint is at home, and one branch is home.
#[test]
fn home_is_one_of_the_branches() {
    let found = linkage(&["--format", "json"]).json();
    assert_eq!(found["input"], json!({ "joint": "a1", "value": 0.0 }));
    let solutions = found["solutions"].as_array().unwrap();
    let home = solutions.iter().find(|s| s["branch"] == found["home_branch"]).unwrap();
    for value in home["joints"].as_object().unwrap().values() {
        assert!(number(value).abs() < ROUNDING, "{home}");
    }
    assert!(linkage(&[]).text().contains("home is in - +"));
}

/// The spherical law of cosines gives the same diagonal from either side of each four-bar, with the arcs that the
/// file states. At home the angle at the imaginary joint is 100 degrees in one four-bar and 80 in the other.
#[test]
fn a_turn_keeps_the_arcs_that_the_file_states() {
    let run = linkage(&["--sweep", "--count", "73"]);
    let text = run.text();
    assert!(text.starts_with("a1,b3,a2,a3,b1,b2,tau.leg1,branch,within_limits\n"));
    let rows = rows(text);
    assert_eq!(rows.len(), 73);
    // Arcs on both sides of the imaginary joint, its angle at home, and arcs beside the opposite joint.
    for (arcs, home, beside, opposite) in
        [([30.0, 75.0], 100.0, [70.0, 60.0], 2), ([35.0, 70.0], 80.0, [65.0, 80.0], 5)]
    {
        let law = |arcs: [f64; 2], angle: f64| {
            let [(s1, c1), (s2, c2)] = arcs.map(|arc| arc.to_radians().sin_cos());
            c1 * c2 + s1 * s2 * angle.cos()
        };
        let angle = |arcs: [f64; 2], diagonal: f64| {
            let [(s1, c1), (s2, c2)] = arcs.map(|arc| arc.to_radians().sin_cos());
            ((diagonal - c1 * c2) / (s1 * s2)).acos()
        };
        let home = home * PI / 180.0;
        let across = angle(beside, law(arcs, home));
        // The axes define the senses of the two angles: one choice of signs fits all positions.
        let worst = |signs: [f64; 2]| {
            let off = |row: &Vec<f64>| {
                let near = law(arcs, home + signs[0] * row[6]);
                (near - law(beside, across + signs[1] * row[opposite])).abs()
            };
            rows.iter().map(off).fold(0.0, f64::max)
        };
        let fits = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(worst);
        assert_eq!(fits.iter().filter(|&&off| off < ROUNDING).count(), 1, "{fits:?}");
    }
    let (first, last) = (&rows[0], &rows[72]);
    assert!((last[0] - first[0] - TAU).abs() < ROUNDING);
    for (a, b) in first[..7].iter().zip(&last[..7]) {
        assert!(((a - b) / TAU - ((a - b) / TAU).round()).abs() < ROUNDING, "{first:?} {last:?}");
    }
}

#[test]
fn a_range_ends_where_its_branches_meet() {
    let found = solved("a2");
    assert_eq!(found["full_turn"], false);
    let ranges = found["range"].as_array().unwrap();
    assert_eq!(ranges.len(), 2);
    for range in ranges {
        let [low, high] = [0, 1].map(|i| number(&range[i]));
        let count = |value: f64| {
            let input = format!("a2={value}");
            solved(&input)["solutions"].as_array().unwrap().len()
        };
        assert_eq!([count(low - 1e-6), count(high + 1e-6)], [0, 0]);
        assert_eq!([count(low + 1e-6), count(high - 1e-6), count(0.5 * (low + high))], [4; 3]);
    }
    let text = linkage(&["--input", "a2=60deg"]);
    assert!(text.text().contains("range of a2: -214.0466 .. -140.9589, -43.3695 .. 29.7182 deg"));
    assert!(text.text().contains("out of range"));
}

/// The input goes out and back: the rows stay inside the range, and end at home.
#[test]
fn a_sweep_of_a_limited_input_goes_there_and_back() {
    let run = linkage(&["--input", "a2", "--sweep", "--count", "201"]);
    let rows = rows(run.text());
    let a2: Vec<f64> = rows.iter().map(|row| row[2]).collect();
    let (low, high) = a2.iter().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
    let ranges = solved("a2")["range"].clone();
    for (reached, end) in [(low, 0), (high, 1)] {
        let end = number(&ranges[1][end]);
        assert!(reached.abs() <= end.abs() + ROUNDING, "{reached} {end}");
        assert!(reached.abs() > end.abs() - 1e-3, "{reached} {end}");
    }
    assert!(a2[1] > a2[0], "it grows at first");
    assert!(a2[200].abs() < ROUNDING);
    for pair in rows.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]).take(7) {
            assert!((a - b).abs() < 0.2, "{pair:?}");
        }
    }
}

#[test]
fn a_sweep_goes_to_a_file() {
    let folder = Folder::new();
    let printed = linkage(&["--sweep", "--count", "5"]);
    let csv = folder.arg("round.csv");
    let run = linkage(&["--sweep", "--count", "5", "-o", &csv]);
    assert_eq!(run.text(), "");
    assert!(run.stderr.contains("5 positions, one revolution of a1"), "{}", run.stderr);
    assert_eq!(folder.read("round.csv"), printed.text());

    let mcap = folder.arg("round.mcap");
    let run = linkage(&["--sweep", "--count", "5", "-o", &mcap, "--format", "json", "--quiet"]);
    assert_eq!(run.stderr, "");
    let found = run.json();
    assert_eq!((&found["positions"], &found["turns"]), (&json!(5), &json!(true)));
    let inside = opm(&["inspect", &mcap, "--format", "json"]).json();
    assert_eq!(inside["complete"], true);
    let topics: Vec<_> = inside["topics"].as_array().unwrap().iter().map(|t| &t["name"]).collect();
    for topic in
        ["/imaginary_joints", "/joints", "/joint_states", "/scene", "/tf", "/scene/bodies/base"]
    {
        assert!(topics.iter().any(|name| *name == topic), "{topic}: {topics:?}");
    }
    assert_eq!(inside["metadata"]["run"]["input"], "a1");
    assert_eq!(inside["attachments"][0]["name"], format!("{BENNETT}.toml"));
    assert_eq!(folder.names(), ["round.csv", "round.mcap"]);
}

/// The file says where the plates of Sarrus' linkage are level and in line: there the angle of the lower
/// plate is arccos 0.8, and the platform is at sqrt(200^2 - 20^2) mm.
#[test]
fn sarrus_platform_goes_up_and_down() {
    let sarrus =
        |input: &str| opm(&["linkage", "sarrus", "--input", input, "--format", "json"]).json();
    let found = sarrus("a1");
    let [low, high] = [0, 1].map(|i| number(&found["range"][0][i]));
    assert!((low - 0.8_f64.acos()).abs() < ROUNDING, "{low}");
    assert!((high - (TAU - 0.8_f64.acos())).abs() < ROUNDING, "{high}");
    assert_eq!((&found["full_turn"], found["range"].as_array().unwrap().len()), (&json!(false), 1));
    // The heights of the platform above home, on both sides of the base.
    let home = number(&sarrus("a1=60deg")["input"]["value"]);
    assert!((home - PI / 3.0).abs() < ROUNDING);
    for angle in [40.0_f64, 60.0, 90.0, 150.0, 200.0] {
        let found = sarrus(&format!("a1={angle}deg"));
        let (sin, cos) = angle.to_radians().sin_cos();
        let rise = (0.01 - (0.02 + 0.1 * cos).powi(2)).sqrt();
        let height = |sign: f64| 0.1 * sin + sign * rise - 0.158_016_824_663_872;
        let solutions = found["solutions"].as_array().unwrap();
        for sign in [-1.0, 1.0] {
            let same =
                |s: &&Value| (number(&s["imaginary"]["tau.leg1"]) - height(sign)).abs() < ROUNDING;
            // The plates of the other leg bend outwards or inwards.
            assert_eq!(solutions.iter().filter(same).count(), 2, "{angle} {found}");
        }
    }
    let run = opm(&["linkage", "sarrus"]);
    let told = "tau.leg1 is the motion of the platform: translation along (0, 0, 1)";
    assert!(run.text().contains(told), "{}", run.text());
    assert!(run.text().contains("range of a1: 36.8699 .. 323.1301 deg"), "{}", run.text());
    let back = opm(&["linkage", "sarrus", "--sweep", "--count", "101"]);
    let rows = rows(back.text());
    let tops = rows.iter().map(|row| row[6]).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(rows.len(), 101);
    assert!(tops > 0.04 && tops < 0.198_997_487_5 - 0.158_016_824_6, "{tops}");
    assert!((rows[0][6] - rows[100][6]).abs() < ROUNDING);
}

/// Lengths are lengths, and a joint that runs away to infinity has no cycle.
#[test]
fn a_slider_has_its_own_unit_and_may_have_no_end() {
    let folder = Folder::new();
    let file = folder.arg("slides.toml");
    let slide = |name: &str, axis: &str, more: &str| {
        format!("{{ name = \"{name}\", type = \"prismatic\", axis = {axis}{more} }}")
    };
    let text = format!(
        "format = 1\nname = \"slides\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
         [platform]\npoint = [0, 0, 0]\n\
         [[leg]]\nname = \"leg1\"\njoints = [{}, {}]\n[[leg]]\nname = \"leg2\"\njoints = [{}, {}]\n",
        slide("a", "[1, 0, 1]", ", actuated = true"),
        slide("b", "[1, 0, -1]", ""),
        slide("c", "[0, 1, 1]", ""),
        slide("d", "[0, 1, -1]", "")
    );
    std::fs::write(&file, text).unwrap();
    let run = opm(&["linkage", &file, "--input", "a=10mm"]);
    assert!(run.text().contains("range of a: no end"), "{}", run.text());
    let found = opm(&["linkage", &file, "--input", "a=10mm", "--format", "json"]).json();
    assert_eq!(found["range"], json!([[null, null]]));
    assert_eq!(found["solutions"].as_array().unwrap().len(), 1);
    // The two sliders of a leg move alike, so that the platform goes straight up.
    for name in ["b", "c", "d"] {
        assert!((number(&found["solutions"][0]["joints"][name]).abs() - 0.01).abs() < 1e-12);
    }
    opm(&["linkage", &file, "--input", "a=10deg"]).fails_with_one_line(2, &["a is a length"]);
    opm(&["linkage", &file, "--sweep"]).fails_with_one_line(1, &["moved by a", "infinity"]);
}

#[test]
fn wrong_usage_names_the_flag() {
    for (args, parts) in [
        (&["--input", "j1"][..], &["--input", "\"j1\"", "a1, b3, a2, a3, b1, b2"][..]),
        (&["--input", "a1=3mm"], &["--input", "a1 is an angle"]),
        (&["--input", "a1=30deg", "--sweep"], &["--input", "a sweep starts at home"]),
        (&["--sweep", "-o", "turn.txt"], &["--output", "turn.txt", ".csv or .mcap"]),
        (&["--sweep", "--format", "json"], &["--format json", "--output"]),
    ] {
        linkage(args).fails_with_one_line(2, parts);
    }
    linkage(&["--input", "a1=much"]).fails(2, &["--input", "not a number"]);
    linkage(&["--sweep", "--count", "1"]).fails(2, &["--count"]);
    linkage(&["--count", "5"]).fails(2, &["--sweep"]);
}

#[test]
fn what_is_no_linkage_is_told_so_and_a_linkage_its_command() {
    for (name, legs) in [(PLANO, "4 legs"), (HELICAL, "3 legs")] {
        opm(&["linkage", name])
            .fails_with_one_line(1, &[name, legs, "expected two, which form one loop"]);
    }
    opm(&["linkage", "five-bar"])
        .fails_with_one_line(1, &["it has 2 freedoms at home, expected one"]);
    let hint = format!("use `opm linkage {BENNETT}`");
    opm(&["ik", BENNETT, "--pose", ""]).fails_with_one_line(1, &["closed-form", &hint]);
    opm(&["workspace", BENNETT]).fails_with_one_line(1, &["closed-form", &hint]);
    let run = opm(&["decompose", BENNETT]);
    assert!(run.stderr.contains(&hint), "{}", run.stderr);
}

const FOUR_BAR: &str = r#"
format = 1
name = "four-bar"
units = { length = "mm", angle = "deg" }
[platform]
point = [50, 80, 0]
[[leg]]
name = "crank"
joints = [
  { name = "a", type = "revolute", axis = [0, 0, 1], point = [0, 0, 0], actuated = true },
  { name = "b", type = "revolute", axis = [0, 0, 1], point = [0, 40, 0] },
]
[[leg]]
name = "rocker"
joints = [
  { name = "d", type = "revolute", axis = [0, 0, 1], point = [100, 0, 0] },
  { name = "c", type = "revolute", axis = [0, 0, 1], point = [100, 80, 0] },
]
"#;

/// A loop without sections: branches are numbers, there is no imaginary joint, and a point of the coupler is where the links have
/// it.
#[test]
fn a_loop_without_sections_is_traced() {
    let folder = Folder::new();
    let path = folder.write("four-bar.toml", FOUR_BAR);
    let run = |args: &[&str]| opm(&[&["linkage", &*path], args].concat());
    let found = run(&["--input", "a=20deg", "--coupler", "0,40mm,0", "--format", "json"]).json();
    assert_eq!((&found["home_branch"], &found["full_turn"]), (&json!("1"), &json!(true)));
    let solutions = found["solutions"].as_array().unwrap();
    assert_eq!(solutions.len(), 2);
    let (sin, cos) = (PI / 9.0).sin_cos();
    for solution in solutions {
        assert_eq!(keys(solution), ["branch", "within_limits", "joints", "imaginary", "coupler"]);
        assert_eq!(solution["imaginary"], json!({}));
        // The pin b is a point of the crank, too.
        let at: Vec<f64> = solution["coupler"].as_array().unwrap().iter().map(number).collect();
        let expected = [-0.04 * sin, 0.04 * cos, 0.0];
        assert!(at.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{at:?}");
    }
    let run_text = run(&["--input", "a=20deg"]);
    let text = run_text.text();
    assert!(text.contains("2 assemblies, complex ones included"), "{text}");
    let swept = run(&["--sweep", "--count", "91", "--coupler", "50mm,80mm,0"]);
    let curve = swept.text();
    let header = "a,b,d,c,branch,within_limits,coupler.x,coupler.y,coupler.z";
    assert!(curve.starts_with(header), "{curve}");
    let rows = rows(curve);
    for row in &rows {
        // Its distance from the pin b stays.
        let pin = [-0.04 * row[0].sin(), 0.04 * row[0].cos()];
        let away = (row[6] - pin[0]).hypot(row[7] - pin[1]);
        assert!((away - 0.05_f64.hypot(0.04)).abs() < 1e-12);
    }
    assert_eq!(rows.len(), 91);
    let parts = ["--input", "\"nothing\" is no joint, expected one of a, b, d, c"];
    run(&["--input", "nothing"]).fails_with_one_line(2, &parts);
}
