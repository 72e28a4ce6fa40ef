//! `opm design`: problems, their results, and what is wrong with them.

use crate::PLANO;
use crate::run::{Folder, keys, number, opm};

/// A small problem of the shipped manipulator.
const PROBLEM: &str = r#"
format = 1
mechanism = "plano-spherical-5dof"
units = { length = "mm", angle = "deg" }
budget = 60
seed = 2

[grid]
x = [-100, 100, 9]
y = [-100, 100, 9]
xi = [-20, 20, 3]

[[objective]]
measure = "dexterous"

[variables]
h = [80, 160]
a1 = [120, 220]
"leg4.base" = [[-100, 100], [0, 150]]
"#;

/// The problem with some text in place of other text.
fn with(from: &str, to: &str) -> String {
    assert!(PROBLEM.contains(from), "{from}");
    PROBLEM.replace(from, to)
}

/// The report, the mechanism and the evaluations of a run.
fn run(
    folder: &Folder,
    problem: &str,
    name: &str,
    flags: &[&str],
) -> (serde_json::Value, [String; 2]) {
    let problem = folder.write("problem.toml", problem);
    let output = folder.arg(&format!("{name}.toml"));
    let args = ["design", &problem, "-o", &output, "--quiet", "--format", "json"];
    let report = opm(&[&args, flags].concat()).json();
    let files = ["toml", "csv"].map(|ending| folder.read(&format!("{name}.{ending}")));
    (report, files)
}

#[test]
fn a_design_is_better_and_is_what_its_file_says() {
    let folder = Folder::new();
    let (report, [file, csv]) = run(&folder, PROBLEM, "better", &[]);
    let design = &report["designs"][0];
    let found = number(&design["measures"]["dexterous"]);
    let before = number(&report["before"]["dexterous"]);
    assert!(found > before, "{before} {found}");
    assert_eq!(csv.lines().count(), 61);
    assert_eq!(keys(&design["variables"]), ["a1", "h", "leg4.base"]);
    assert!(file.contains("family = \"plano-spherical\""), "{file}");
    // The sweep of the written file finds the same share.
    let grids =
        ["--grid", "x=-100mm:100mm:9", "--grid", "y=-100mm:100mm:9", "--grid", "xi=-20deg:20deg:3"];
    let swept =
        ["workspace", &folder.arg("better.toml"), "--kind", "dexterous", "--format", "json"];
    let swept = opm(&[&swept[..], &grids].concat()).json();
    assert!((number(&swept["fraction"]) - found).abs() < 1e-12, "{swept}");
}

#[test]
fn a_seed_and_not_the_threads_decide() {
    let folder = Folder::new();
    let (_, one) = run(&folder, PROBLEM, "one", &["--threads", "1"]);
    let (_, four) = run(&folder, PROBLEM, "four", &["--threads", "4"]);
    assert_eq!(one, four);
    let (_, other) = run(&folder, PROBLEM, "other", &["--seed", "3"]);
    assert_ne!(one, other);
}

/// The table of a run that was cut short anywhere leads to the result of the whole run.
#[test]
fn a_run_goes_on_where_it_was_cut_short() {
    let folder = Folder::new();
    let (whole, [file, csv]) = run(&folder, PROBLEM, "whole", &[]);
    let lines: Vec<&str> = csv.lines().collect();
    // After 22 rows, in the middle of one.
    let cut = format!("{}\n{}", lines[..23].join("\n"), &lines[23][..20]);
    folder.write("cut.csv", cut);
    let (report, [again, table]) = run(&folder, PROBLEM, "cut", &["--resume"]);
    assert_eq!(number(&report["resumed"]), 22.0);
    assert_eq!((again, table), (file, csv));
    let measures = |report: &serde_json::Value| report["designs"][0]["measures"].clone();
    assert_eq!(measures(&report), measures(&whole));
    // With a larger budget nothing is done twice.
    let (more, [_, table]) = run(&folder, PROBLEM, "cut", &["--resume", "--budget", "75"]);
    assert_eq!(number(&more["resumed"]), 60.0);
    assert_eq!(table.lines().count(), 76);
    // Another seed asks for other designs.
    let args = ["--resume", "--seed", "3", "--budget", "10"];
    let (other, [_, table]) = run(&folder, PROBLEM, "cut", &args);
    assert_eq!(number(&other["resumed"]), 0.0);
    assert_eq!(table.lines().count(), 86);
    // Evaluations of another problem are refused, and stay.
    let problem = folder.write("other.toml", with("[80, 160]", "[80, 170]"));
    let output = folder.arg("cut.toml");
    let other = opm(&["design", &problem, "-o", &output, "--resume"]);
    other.fails_with_one_line(
        2,
        &["--resume: ", "cut.csv: the evaluations in it are of another problem"],
    );
    assert_eq!(folder.read("cut.csv"), table);
    let nothing = folder.arg("nothing.toml");
    let none = opm(&["design", &problem, "-o", &nothing, "--resume"]);
    none.fails_with_one_line(1, &["nothing.csv: No such file"]);
    assert_eq!(none.stderr.matches("No such file").count(), 1, "{}", none.stderr);
}

/// The evaluations of an earlier run are hours of work: they are only replaced by --force.
#[test]
fn evaluations_that_are_there_are_kept() {
    let folder = Folder::new();
    let short = with("budget = 60", "budget = 4");
    let (_, [_, csv]) = run(&folder, &short, "short", &[]);
    let (problem, output) = (folder.arg("problem.toml"), folder.arg("short.toml"));
    let again = ["design", &problem, "-o", &output, "--seed", "3"];
    let parts = ["--output: ", "short.csv is there already", "--resume", "--force"];
    opm(&again).fails_with_one_line(2, &parts);
    assert_eq!(folder.read("short.csv"), csv);
    opm(&[&again[..], &["--force", "--quiet"]].concat()).text();
    assert_ne!(folder.read("short.csv"), csv);
}

/// A problem with two objectives, and so with a front.
fn of_a_front(budget: &str) -> String {
    let second = "[[objective]]\nmeasure = \"size\"\n\n[variables]";
    with("budget = 60", budget).replace("[variables]", second)
}

/// A design of a front would get the name of the mechanism that it begins with.
#[test]
fn a_front_does_not_replace_its_mechanism() {
    let folder = Folder::new();
    let own = folder.write("front-01.toml", opm(&["convert", PLANO]).text());
    let two = of_a_front("budget = 4").replace("\"plano-spherical-5dof\"", "\"front-01.toml\"");
    let problem = folder.write("problem.toml", two);
    let before = folder.read("front-01.toml");
    let parts = ["--output: ", "front-01.toml is also the input"];
    opm(&["design", &problem, "-o", &folder.arg("front.toml")]).fails_with_one_line(2, &parts);
    assert_eq!(std::fs::read_to_string(own).expect("it is there"), before);
    assert_eq!(folder.names(), ["front-01.toml", "problem.toml"]);
}

#[test]
fn two_objectives_have_a_front() {
    let folder = Folder::new();
    let two = of_a_front("budget = 160");
    let problem = folder.write("problem.toml", two);
    let (output, picture) = (folder.arg("front.toml"), folder.arg("front.svg"));
    let args = ["design", &problem, "-o", &output, "--designs", "2", "--picture", &picture];
    let report = opm(&[&args[..], &["--format", "json", "--quiet"]].concat()).json();
    let designs = report["designs"].as_array().expect("a list");
    assert!(designs.len() >= 2, "{report}");
    let of = |design: &serde_json::Value, name: &str| number(&design["measures"][name]);
    for pair in designs.windows(2) {
        assert!(of(&pair[0], "dexterous") > of(&pair[1], "dexterous"), "{report}");
        assert!(of(&pair[0], "size") > of(&pair[1], "size"), "{report}");
    }
    let named: Vec<_> = designs.iter().filter_map(|design| design["file"].as_str()).collect();
    assert_eq!(named.len(), 2);
    for name in named {
        opm(&["decompose", name]).text();
    }
    assert!(folder.read("front.svg").contains("size"));
}

#[test]
fn sections_are_designed_one_after_the_other() {
    let folder = Folder::new();
    let split = with("budget = 60", "budget = 80\nsplit = true").replace(
        "[variables]",
        "[[constraint]]\nmeasure = \"range.theta11\"\nmost = 60\n\n[upper]\nbeta = [50, 80]\nalpha1 = [60, 90]\n\n[lower]",
    );
    let (report, _) = run(&folder, &split, "split", &[]);
    assert_eq!(number(&report["evaluations"]["upper"]), 27.0, "{report}");
    assert_eq!(number(&report["evaluations"]["lower_or_whole"]), 53.0);
    let range = &report["imaginary_range"]["theta11"];
    let width = number(&range[1]) - number(&range[0]);
    assert!(0.0 < width && width < 60_f64.to_radians(), "{report}");
    // The whole mechanism needs no wider range than its upper section alone.
    let measures = &report["designs"][0]["measures"];
    assert!(number(&measures["range.theta11"]) <= width + 1e-12, "{report}");
    let (undivided, _) = run(&folder, &split, "undivided", &["--undivided"]);
    assert_eq!(number(&undivided["evaluations"]["upper"]), 0.0);
    assert_eq!(keys(&undivided["imaginary_range"]), [""; 0]);
}

/// Constraints are kept, and a text says so where they cannot be.
#[test]
fn constraints_are_kept_or_told() {
    let folder = Folder::new();
    // A pose out of reach has an index of zero, so the grid is small.
    let small = PROBLEM.replace("[-100, 100, 9]", "[-20, 20, 3]");
    let constrained = |least: &str| {
        let constraint =
            format!("[[constraint]]\nmeasure = \"lti\"\nleast = {least}\n\n[variables]");
        small.replace("[variables]", &constraint)
    };
    let (report, _) = run(&folder, &constrained("0.05"), "kept", &[]);
    let design = &report["designs"][0];
    assert!(design["feasible"].as_bool() == Some(true), "{report}");
    assert!(number(&design["measures"]["lti"]) >= 0.05, "{report}");
    let problem = folder.write("impossible.toml", constrained("0.999"));
    let found = opm(&["design", &problem]);
    assert!(found.text().contains("breaks constraints"), "{}", found.stdout);
    assert!(found.stderr.contains("no design keeps all constraints"), "{}", found.stderr);
}

#[test]
fn the_picture_of_a_design_is_that_of_its_mechanism() {
    let folder = Folder::new();
    let problem = folder.write("problem.toml", with("budget = 60", "budget = 10"));
    for (name, first) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF")] {
        let picture = folder.arg(name);
        opm(&["design", &problem, "--picture", &picture, "--quiet"]).text();
        assert!(std::fs::read(&picture).expect("a picture").starts_with(first), "{name}");
    }
}

#[test]
fn what_is_wrong_with_a_problem_is_told_with_its_place() {
    let folder = Folder::new();
    for (problem, parts) in [
        (String::new(), &["problem.toml:1:1: missing field"][..]),
        ("format = ".to_owned(), &["problem.toml:1:"]),
        (with("format = 1", "format = 2"), &["problem.toml:2:10: `format` is 2, expected 1"]),
        (with("seed = 2", "sead = 2"), &[":6:1: unknown field `sead`"]),
        (
            with("5dof", "6dof"),
            &["`mechanism`: plano-spherical-6dof: no such file", "did you mean"],
        ),
        (with("\"mm\"", "\"mn\""), &[":4:20: `length` is \"mn\", did you mean `m`?"]),
        (with("budget = 60", "budget = 1"), &[":5:", "`budget` is less than 2 designs"]),
        (with("budget = 60", "budget = -3"), &[":5:10: -3, expected a whole number of 0 or more"]),
        (with("budget = 60", "budget = 1e9"), &[":5:10: 1000000000.0, expected a whole number"]),
        (with("x = [-100, 100, 9]", "x = [-100, 100]"), &[":9:", "expected a value, or [lowest"]),
        (
            with("x = [-100, 100, 9]", "x = [100, -100, 9]"),
            &[":9:1: grid axis x", "smaller one first"],
        ),
        (with("xi = [-20", "roll = [-20"), &[":11:1: grid axis roll", "x, y, zeta, xi, psi"]),
        (
            with("\"dexterous\"", "\"dextrous\""),
            &[":14:11: `dextrous` is not a measure; did you mean `dexterous`?"],
        ),
        (with("\"dexterous\"", "\"range.theta\""), &["`range.theta` is not a measure"]),
        (
            with("\"dexterous\"", "\"ball\""),
            &["`ball`: expected a grid whose places vary in 3 coordinates"],
        ),
        (with("\"dexterous\"", "\"effort\""), &["`effort`: effort: nothing acts on the mechanism"]),
        (with("h = [80", "hh = [80"), &[":17:1:", "hh"]),
        (with("h = [80, 160]", "h = [160, 80]"), &[":17:1: `h`: 160 is above 80, expected"]),
        (with("h = [80, 160]", "h = [80, 80]"), &[":17:1: `h`: both bounds are 80, expected two"]),
        (
            with("h = [80, 160]", "h = [nan, 160]"),
            &[":17:1: `h`: a bound is nan, expected a number"],
        ),
        (with("h = [80, 160]", "h = [80, inf]"), &[":17:1: `h`"]),
        (with("h = [80, 160]", "h = [[0, 1], [2, 3]]"), &[":17:1:", "`h`"]),
        (
            with("[variables]", "[[constraint]]\nmeasure = \"lti\"\n\n[variables]"),
            &["`lti`: expected `least`, `most`"],
        ),
        (with("seed = 2", "split = true"), &["with `split`, expected [upper] and [lower]"]),
        (with("[variables]\nh", "[variables]\nh = [1, 2]\n[upper]\nh"), &["`h` varies already"]),
    ] {
        let file = folder.write("problem.toml", problem);
        opm(&["design", &file]).fails(1, parts);
    }
    let file = folder.write("problem.toml", PROBLEM);
    let text = folder.arg("better.txt");
    for (flags, parts) in [
        (&["--budget", "1"][..], &["--budget"][..]),
        (&["--undivided"], &["--undivided", "not divided"]),
        (&["--resume"], &["--output"]),
        (&["--designs", "3"], &["--output"]),
        (&["--picture", "a.gif"], &["--picture: a.gif: expected a name that ends in .svg"]),
        (&["-o", "-"], &["--output", "standard output"]),
        (&["-o", &text], &["--output", "better.txt: expected a name that ends in .toml"]),
        (&["-o", &file], &["--output", "problem.toml is also the input"]),
        (&["--threads", "0"], &["--threads"]),
    ] {
        opm(&[&["design", &file], flags].concat()).fails(2, parts);
    }
    let nowhere = folder.arg("no/such/folder.toml");
    opm(&["design", &file, "-o", &nowhere])
        .fails_with_one_line(1, &["folder.toml", "No such file"]);
    opm(&["design", &folder.arg("none.toml")]).fails_with_one_line(1, &["none.toml: No such file"]);
    opm(&["design", PLANO]).fails_with_one_line(1, &["No such file"]);
    assert_eq!(folder.names(), ["problem.toml"]);
}
