//! `opm plot`: the pictures agree with the output of the other subcommands.

mod motions;
#[path = "../../../crates/opm-plot/tests/figures/seen.rs"]
#[allow(dead_code, reason = "the tests of the crate that draws use the rest")]
mod seen;

use crate::run::{Folder, Run, number, opm};
use crate::{HELICAL, PLANO};
use opm_mcap::{CloudLayout, Metadata, Slices, Workspace, WorkspaceRecorder};
use roxmltree::Document;
use seen::{across, assert_legible, class, label, named, paths, pieces, up};
use std::fs;

const BENNETT: &str = "bennett-double-spherical-6r";
/// The shipped linkages, which have no platform to position.
const LINKAGES: [&str; 3] = [BENNETT, "bennett-plano-spherical-6r", "sarrus"];
const MOTION: &str = "plano-spherical-sinusoids";

fn plot(folder: &Folder, recording: &str, args: &[&str]) -> (Run, String) {
    let output = folder.arg("picture.svg");
    let run = opm(&[&["plot", recording, "-o", &output], args].concat());
    run.text();
    (run, folder.read("picture.svg"))
}

/// A small workspace of the first manipulator, with its imaginary joints.
fn workspace(folder: &Folder) -> String {
    let output = folder.arg("cloud.mcap");
    let grid = [
        "--grid",
        "x=-200mm:200mm:41",
        "--grid",
        "y=-120mm:140mm:27",
        "--grid",
        "xi=0:90deg:4",
        "--grid",
        "psi=-20deg:20deg:3",
    ];
    let rest = ["--scalars", "theta11,theta12,theta13", "-o", &output, "--quiet"];
    opm(&[&["workspace", PLANO], &grid[..], &rest].concat()).text();
    output
}

fn turn(folder: &Folder) -> String {
    let output = folder.arg("round.mcap");
    opm(&["linkage", BENNETT, "--sweep", "--count", "73", "-o", &output]).text();
    output
}

fn motion(folder: &Folder, args: &[&str]) -> String {
    let output = folder.arg("motion.mcap");
    let fixed = ["trajectory", PLANO, "-o", &output, "--quiet"];
    opm(&[&fixed[..], args].concat()).text();
    output
}

fn titles<'a>(document: &'a Document<'a>) -> Vec<&'a str> {
    class(document.root(), "panel").into_iter().map(label).collect()
}

fn texts<'a>(document: &'a Document<'a>) -> Vec<&'a str> {
    class(document.root(), "text").into_iter().map(label).collect()
}

/// Read by the numbers at the axes, the curves have the values of the CSV, in degrees, over those of the input.
#[test]
fn the_curves_of_a_linkage_are_those_of_its_csv() {
    let folder = Folder::new();
    let (run, svg) = plot(&folder, &turn(&folder), &[]);
    assert!(run.stderr.contains("picture.svg: "), "{}", run.stderr);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["Imaginary joints", "Joints"]);
    assert!(texts(&document).contains(&BENNETT));
    let csv = opm(&["linkage", BENNETT, "--sweep", "--count", "73"]);
    let rows: Vec<Vec<&str>> = csv.text().lines().map(|line| line.split(',').collect()).collect();
    let panels = class(document.root(), "panel");
    let below: Vec<&str> = class(document.root(), "x-axis").into_iter().map(label).collect();
    assert_eq!(below, ["a1 (deg)"]);
    let input = rows[0].iter().position(|name| *name == "a1").unwrap();
    for (column, name) in rows[0].iter().enumerate().take(7) {
        // Over itself it would be a straight line.
        if column == input {
            assert!(class(document.root(), "curve").into_iter().all(|curve| label(curve) != "a1"));
            continue;
        }
        let panel = panels[usize::from(*name != "tau.leg1")];
        let (up, across) = (up(panel), across(panels[1]));
        let curve = named(panel, "curve", name);
        let points = pieces(paths(curve)[0]).concat();
        assert_eq!(points.len(), 73);
        for (i, ([x, y], row)) in points.into_iter().zip(&rows[1..]).enumerate() {
            let value: f64 = row[column].parse().unwrap();
            // A hundredth of a pixel is a tenth of a degree at most here.
            assert!((up(y) - value.to_degrees()).abs() < 0.1, "{name} {i}: {} {value}", up(y));
            let over: f64 = row[input].parse().unwrap();
            assert!((across(x) - over.to_degrees()).abs() < 0.1, "{name} {i}: {}", across(x));
        }
    }
}

/// A tile has as many cells as a sweep of that slice alone counts poses.
#[test]
fn slices_have_the_cells_that_a_sweep_counts() {
    let folder = Folder::new();
    let file = workspace(&folder);
    let (_, svg) = plot(&folder, &file, &["--slice", "psi=20deg"]);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panels = class(document.root(), "panel");
    let expected = ["xi = 0 deg", "xi = 30 deg", "xi = 60 deg", "xi = 90 deg"];
    assert_eq!(titles(&document)[..4], expected);
    let (left, below) = (up(panels[0]), across(panels[2]));
    let scale = (below(1.0) - below(0.0)) * (left(0.0) - left(1.0));
    for (panel, xi) in panels.iter().zip([0, 30, 60, 90]) {
        let boxes = pieces(paths(class(*panel, "points")[0])[0]);
        let area: f64 = boxes.iter().map(|b| (b[2][0] - b[0][0]) * (b[2][1] - b[0][1])).sum();
        let xi = format!("xi={xi}deg");
        let args = [
            "workspace",
            PLANO,
            "--grid",
            "x=-200mm:200mm:41",
            "--grid",
            "y=-120mm:140mm:27",
            "--grid",
            &xi,
            "--grid",
            "psi=20deg",
            "--format",
            "json",
        ];
        let counted = number(&opm(&args).json()["reachable"]);
        let cells = area * scale / 100.0;
        assert!((cells - counted).abs() < 0.01 * counted, "{xi}: {cells} {counted}");
    }
    let joints = &panels[4..];
    let axes: Vec<&str> = joints.iter().flat_map(|p| class(*p, "x-axis")).map(label).collect();
    assert_eq!(axes, ["theta11 (deg)", "theta11 (deg)", "theta12 (deg)"]);
}

#[test]
fn slices_are_chosen_by_name_and_value() {
    let folder = Folder::new();
    let file = workspace(&folder);
    let (_, svg) = plot(&folder, &file, &["--slice", "xi=31deg,xi=1rad", "--panels", "slices"]);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["xi = 30 deg", "xi = 60 deg"]);
    assert!(texts(&document).contains(&"Reachable at psi = 0 deg"));
    let args = ["--values", "xi,psi,theta13", "--slice", "x=0,y=10mm"];
    let (_, svg) = plot(&folder, &file, &args);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["psi over xi", "poses over theta13"]);
    let (_, svg) = plot(&folder, &file, &["--panels", "imaginary", "--values", "theta12,theta11"]);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["theta11 over theta12"]);
}

#[test]
fn what_is_not_stored_can_be_recorded() {
    let folder = Folder::new();
    let file = folder.arg("bare.mcap");
    let grid = ["--grid", "x=-20mm:20mm:5", "--grid", "y=-20mm:20mm:5", "--grid", "xi=0:0.2:3"];
    opm(&[&["workspace", PLANO, "-o", &file, "-q"], &grid[..]].concat()).text();
    let (run, _) = plot(&folder, &file, &[]);
    assert!(run.stderr.contains("--scalars theta11,theta12,theta13"), "{}", run.stderr);
    let output = folder.arg("none.svg");
    opm(&["plot", &file, "-o", &output, "--panels", "imaginary"])
        .fails_with_one_line(2, &["--panels: ", "bare.mcap", "--scalars theta11,theta12,theta13"]);
    let (run, svg) = plot(&folder, &file, &["--quiet"]);
    assert_eq!(run.stderr, "");
    assert_legible(&svg);
    // In one subspace there are no imaginary joints to record.
    let args = ["workspace", "planar-3rpr", "-o", &file, "-q", "--grid", "x=0:20mm:9"];
    opm(&args).text();
    assert!(!plot(&folder, &file, &[]).0.stderr.contains("imaginary"));
}

/// The largest disc inside is in the recording, and its picture has it with its numbers.
#[test]
fn the_largest_disc_inside_is_drawn() {
    let folder = Folder::new();
    let file = folder.arg("disc.mcap");
    let grid = ["--grid", "x=-200mm:200mm:81", "--grid", "y=-150mm:200mm:71"];
    let asked = ["--inscribed", "disc", "--centre", "x=0,y=0", "--format", "json"];
    let run = opm(&[&["workspace", PLANO, "-o", &file, "-q"], &grid[..], &asked].concat());
    let radius = 1000.0 * number(&run.json()["inscribed"]["radius"]);
    let (_, svg) = plot(&folder, &file, &["--panels", "slices"]);
    let document = Document::parse(&svg).unwrap();
    let panel = class(document.root(), "panel")[0];
    let (across, up) = (across(panel), up(panel));
    let lines = paths(class(panel, "points")[0]);
    let circle = pieces(lines[lines.len() - 1]).concat();
    assert!(circle.len() >= 180);
    for [x, y] in circle {
        assert!((across(x).hypot(up(y)) - radius).abs() < 0.1, "{} {}", across(x), up(y));
    }
    let said = texts(&document).into_iter().find_map(|text| {
        let (_, numbers) = text.split_once("largest disc inside: radius ")?;
        numbers.split_once(" mm, centre x = 0 mm, y = 0 mm.")?.0.parse::<f64>().ok()
    });
    assert!((said.unwrap() - radius).abs() < 0.06, "{said:?} {radius}");
}

/// A plane mechanism shows its plane at held angles, a wrist directions and tilts in polar form; slices that are equal are drawn
/// once.
#[test]
fn slices_are_those_that_papers_print() {
    let folder = Folder::new();
    let draw = |mechanism: &str, grid: &[&str]| {
        let file = folder.arg(&format!("{mechanism}.mcap"));
        let grid: Vec<&str> = grid.iter().flat_map(|axis| ["--grid", axis]).collect();
        opm(&[&["workspace", mechanism, "-o", &file, "--quiet"], &grid[..]].concat()).text();
        plot(&folder, &file, &[]).1
    };
    let axes = |svg: &str| {
        let document = Document::parse(svg).unwrap();
        let name = |kind| class(document.root(), kind).first().map(|axis| label(*axis).to_owned());
        let titles: Vec<String> = titles(&document).into_iter().map(str::to_owned).collect();
        (name("x-axis"), name("y-axis"), titles)
    };
    let millimetres = ["x=-200mm:200mm:21", "y=-200mm:200mm:21", "theta=-60deg:60deg:3"];
    let (x, y, found) = axes(&draw("planar-3rrr", &millimetres));
    assert_eq!((x.as_deref(), y.as_deref()), (Some("x (mm)"), Some("y (mm)")));
    assert_eq!(found, ["theta = −60 deg", "theta = 0 deg", "theta = 60 deg"]);

    // Agile Eye reaches every orientation, in every slice the same.
    let all = ["zeta=-180deg:180deg:37", "xi=0:180deg:19", "psi=-120deg:120deg:5"];
    let svg = draw("agile-eye", &all);
    let (x, y, found) = axes(&svg);
    assert_eq!((x.as_deref(), y), (Some("zeta (deg) around, xi (deg) outwards"), None));
    assert_eq!(found, ["psi = −120 … 120 deg"]);
    assert!(svg.contains("Slices that are equal are drawn once."));
    assert_legible(&svg);
}

/// The value of the colour is stored with other values, and colours the slices.
#[test]
fn a_recorded_colour_is_drawn_with_other_values() {
    let folder = Folder::new();
    let file = folder.arg("colour.mcap");
    let grid = ["--grid", "x=-20mm:20mm:5", "--grid", "y=-20mm:20mm:5", "--grid", "xi=0:0.2:3"];
    let values = ["--scalars", "theta11", "--color", "inverse_condition"];
    opm(&[&["workspace", PLANO, "-o", &file, "-q"], &grid[..], &values].concat()).text();
    let (_, svg) = plot(&folder, &file, &["--values", "inverse_condition"]);
    let document = Document::parse(&svg).unwrap();
    assert!(texts(&document).contains(&"Values in reachable poses: inverse_condition"));
    let bars: Vec<&str> = class(document.root(), "bar").into_iter().map(label).collect();
    assert!(bars.contains(&"inverse_condition"), "{bars:?}");
    let (_, svg) = plot(&folder, &file, &["--values", "theta11"]);
    let document = Document::parse(&svg).unwrap();
    assert!(texts(&document).contains(&"Joint values in reachable poses: theta11"));
}

/// The range of an axis with a third of its values.
fn coarser((name, axis): (&String, &serde_json::Value)) -> String {
    let (min, max) = (&axis["min"], &axis["max"]);
    format!("{name}={min}:{max}:{}", axis["count"].as_u64().unwrap().div_ceil(3).max(2))
}

#[test]
fn every_shipped_mechanism_can_be_drawn() {
    let folder = Folder::new();
    let list = opm(&["examples", "--format", "json"]).json();
    let file = folder.arg("cloud.mcap");
    for example in list["examples"].as_array().unwrap() {
        let name = example["name"].as_str().unwrap();
        if LINKAGES.contains(&name) {
            continue;
        }
        // The four million poses of the five-bar's own grid are solved one by one.
        let given = ["--grid", "x=-0.27:0.27:201", "--grid", "y=0.05:0.42:201"];
        let given = if name == "five-bar" { &given[..] } else { &[] };
        let run = [&["workspace", name, "-q"], given].concat();
        let swept = opm(&[&run, &["--format", "json"][..]].concat()).json();
        let coarse: Vec<String> = swept["grid"].as_object().unwrap().iter().map(coarser).collect();
        let mut tips = vec!["workspace", name, "-q", "-o", &file, "--axes", "tip"];
        tips.extend(coarse.iter().flat_map(|axis| ["--grid", axis]));
        opm(&tips).text();
        let (_, svg) = plot(&folder, &file, &["-q"]);
        assert_legible(&svg);
        let ranges = swept["imaginary_range"].as_object().unwrap();
        let joints: Vec<&str> = ranges.keys().map(String::as_str).collect();
        let scalars = joints.join(",");
        // A mechanism of one subspace has no imaginary joints.
        let flags: &[&str] = match joints.first() {
            Some(first) => &["--scalars", &scalars, "--color", first],
            None => &["--color", "inverse_condition"],
        };
        opm(&[&run, &["-o", &file][..], flags].concat()).text();
        let (_, svg) = plot(&folder, &file, &[]);
        assert_legible(&svg);
        let document = Document::parse(&svg).unwrap();
        assert!(texts(&document).contains(&&*format!("{name}: workspace")));
        assert!(svg.len() < 4_000_000, "{name}: {} bytes", svg.len());
    }
}

/// What is printed is what is written.
#[test]
fn a_picture_is_printed() {
    let folder = Folder::new();
    let file = folder.arg("a.svg");
    opm(&["plot", PLANO, "-o", &file]).text();
    let written = folder.read("a.svg");
    for name in ["-", "/dev/stdout"] {
        let printed = opm(&["plot", PLANO, "-o", name]);
        assert_eq!(printed.text(), written, "{name}");
        assert_eq!(printed.stderr, "", "{name}");
    }
    let run = opm(&["plot", PLANO, "-o", "-", "--format", "json"]);
    run.fails_with_one_line(2, &["--format json", "standard output"]);
    // Pages have a size, and no pixels.
    let pdf = opm(&["plot", PLANO, "-o", &folder.arg("a.pdf")]);
    assert!(pdf.text().is_empty() && pdf.stderr.trim_end().ends_with(" mm"), "{}", pdf.stderr);
}

#[test]
fn a_png_has_twice_the_pixels_and_the_same_bytes_each_time() {
    let folder = Folder::new();
    let file = turn(&folder);
    let [first, second] = ["a.png", "b.png"].map(|name| {
        let output = folder.arg(name);
        let args = ["plot", &file, "-o", &output, "--size", "900x400", "--format", "json", "-q"];
        let found = opm(&args).json();
        assert_eq!((number(&found["width"]), number(&found["height"])), (1800.0, 800.0));
        assert_eq!(found["complete"], true);
        fs::read(output).unwrap()
    });
    assert_eq!(first, second);
    // PNG: after eight bytes, the chunk IHDR begins with width and height.
    assert_eq!(first[..8], *b"\x89PNG\r\n\x1a\n");
    let side = |at: usize| u32::from_be_bytes(first[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (1800, 800));
    let (_, svg) = plot(&folder, &file, &["--size", "900x400"]);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(document.root_element().attribute("width"), Some("900"));
    assert_eq!(svg, plot(&folder, &file, &["--size", "900x400"]).1);
    assert_eq!(folder.names(), ["a.png", "b.png", "picture.svg", "round.mcap"]);
}

#[test]
fn an_unfinished_recording_is_drawn_as_far_as_it_goes() {
    let folder = Folder::new();
    let whole = fs::read(motion(&folder, &["--motion", MOTION])).unwrap();
    let cut = folder.write("motion.mcap.partial", &whole[..whole.len() / 2]);
    let (run, svg) = plot(&folder, &cut, &[]);
    assert!(run.stderr.contains("unfinished"), "{}", run.stderr);
    let document = Document::parse(&svg).unwrap();
    assert!(texts(&document).iter().any(|text| text.contains("unfinished")));
    let points = pieces(paths(named(document.root(), "curve", "x"))[0]).concat();
    assert!(points.len() > 100 && points.len() < 900, "{}", points.len());
    let whole = fs::read(workspace(&folder)).unwrap();
    let cut = folder.write("cloud.mcap.partial", &whole[..whole.len() * 2 / 3]);
    let (run, _) = plot(&folder, &cut, &[]);
    assert!(run.stderr.contains("unfinished"), "{}", run.stderr);
}

#[test]
fn what_is_no_recording_is_refused_and_leaves_nothing() {
    let folder = Folder::new();
    let output = folder.arg("picture.svg");
    let text = folder.write("text.mcap", "this is not a recording");
    opm(&["plot", &text, "-o", &output]).fails_with_one_line(1, &["text.mcap: not an MCAP file"]);
    let missing = folder.arg("missing.mcap");
    opm(&["plot", &missing, "-o", &output]).fails_with_one_line(1, &["missing.mcap: No such file"]);
    opm(&["plot", &folder.arg(""), "-o", &output]).fails_with_one_line(1, &["directory"]);
    let text = folder.write("text.txt", "this is neither");
    opm(&["plot", &text, "-o", &output]).fails(1, &["text.txt:1:"]);
    fs::remove_file(text).unwrap();
    let nowhere = folder.arg("far.mcap");
    let grid = ["--grid", "x=5:6:3", "--grid", "y=0:1:3"];
    opm(&[&["workspace", PLANO, "-o", &nowhere, "-q"], &grid[..]].concat()).text();
    opm(&["plot", &nowhere, "-o", &output])
        .fails_with_one_line(1, &["far.mcap", "no pose of the grid is in reach"]);
    assert_eq!(folder.names(), ["far.mcap", "text.mcap"]);
}

#[test]
fn wrong_usage_names_the_flag() {
    let folder = Folder::new();
    let (cloud, turn) = (workspace(&folder), turn(&folder));
    let svg = folder.arg("p.svg");
    for (file, args, parts) in [
        (&cloud, &["-o", "p.jpg"][..], &["--output", "p.jpg", ".svg, .png or .pdf"][..]),
        (&cloud, &["-o", &svg, "--values", "theta14"], &["--values", "\"theta14\"", "theta13"]),
        (&cloud, &["-o", &svg, "--values", "x"], &["--values", "two of x, y"]),
        (&cloud, &["-o", &svg, "--values", "x,x"], &["--values", "x is given twice"]),
        (&cloud, &["-o", &svg, "--panels", "pose"], &["--panels", "pose", "workspace"]),
        (&cloud, &["-o", &svg, "--slice", "x=0"], &["--slice", "x is an axis"]),
        (&cloud, &["-o", &svg, "--slice", "q=0"], &["--slice", "\"q\"", "xi"]),
        (&cloud, &["-o", &svg, "--slice", "xi=3"], &["--slice", "xi = 171.9 deg", "grid"]),
        (&cloud, &["-o", &svg, "--slice", "xi=3mm"], &["--slice", "xi is an angle"]),
        (&cloud, &["-o", &svg, "--slice", "xi=0,xi=1,psi=0,psi=0.3"], &["--slice", "xi and psi"]),
        (&cloud, &["-o", &svg, "--size", "200x100"], &["--size", "200x100", "need at least"]),
        (&turn, &["-o", &svg, "--values", "c1"], &["--values", "\"c1\"", "a1, b3, a2"]),
        (&turn, &["-o", &svg, "--panels", "slices"], &["--panels", "slices", "motion"]),
        (&turn, &["-o", &svg, "--slice", "xi=0"], &["--slice", "not a workspace"]),
    ] {
        opm(&[&["plot", file], args].concat()).fails_with_one_line(2, parts);
    }
    opm(&["plot", &turn, "-o", &svg, "--size", "9"]).fails(2, &["--size", "900x600"]);
    opm(&["plot", &turn, "-o", &svg, "--size", "9000x10"]).fails(2, &["--size", "4000"]);
    opm(&["plot", &turn]).fails(2, &["--output"]);
    opm(&["plot", &turn, "-o", &svg, "--panels", "condition"])
        .fails_with_one_line(2, &["--panels: condition: ", "round.mcap", "`opm trajectory -o`"]);
    assert_eq!(folder.names(), ["cloud.mcap", "round.mcap"]);
}

#[test]
fn an_output_that_cannot_be_written_is_told_at_once() {
    let folder = Folder::new();
    let file = turn(&folder);
    let nowhere = folder.arg("missing/p.svg");
    opm(&["plot", &file, "-o", &nowhere]).fails_with_one_line(1, &["missing", "No such file"]);
    fs::create_dir(folder.path("p.svg")).unwrap();
    opm(&["plot", &file, "-o", &folder.arg("p.svg")])
        .fails_with_one_line(1, &["not a regular file"]);
    let renamed = folder.arg("turn.svg");
    fs::rename(&file, &renamed).unwrap();
    opm(&["plot", &renamed, "-o", &renamed])
        .fails_with_one_line(2, &["--output", "also the input"]);
    assert_eq!(folder.names(), ["p.svg", "turn.svg"]);
}

/// The centres of all shapes of the solids in a view, as its axes tell them.
fn centres(document: &Document<'_>, view: &str) -> Vec<[f64; 2]> {
    let panel = named(document.root_element(), "panel", view);
    let (x, y) = (across(panel), up(panel));
    let solids = class(panel, "solids")[0];
    let middle = |path| {
        let points: Vec<[f64; 2]> = pieces(path).into_iter().flatten().collect();
        let range = |i: usize| {
            let values = || points.iter().map(|point| point[i]);
            0.5 * (values().fold(f64::INFINITY, f64::min) + values().fold(f64::MIN, f64::max))
        };
        [x(range(0)), y(range(1))]
    };
    paths(solids).into_iter().map(middle).collect()
}

/// The joints of the planar 3-RRR, from above: bases A, and the platform's C, which move with it.
#[test]
fn a_mechanism_is_drawn_where_its_joints_are() {
    let folder = Folder::new();
    let (a, c) = (331.0 / 2.0, 75.06);
    let at = |radius: f64, degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [radius * cos, radius * sin]
    };
    let radius = a / 30_f64.to_radians().cos();
    for (pose, moved, turned) in
        [("", [0.0, 0.0], 0.0), ("x=10mm,y=-5mm,theta=20deg", [10.0, -5.0], 20.0)]
    {
        let (_, svg) = plot(&folder, "planar-3rrr", &["--pose", pose]);
        let document = Document::parse(&svg).unwrap();
        assert_legible(&svg);
        let found = centres(&document, "from above");
        let drawn = |point: [f64; 2]| {
            found.iter().any(|at| (at[0] - point[0]).hypot(at[1] - point[1]) < 0.1)
        };
        for corner in [-150.0, -30.0, 90.0] {
            assert!(drawn(at(radius, corner)), "{pose}: base at {corner}");
            let [x, y] = at(c, corner + turned);
            assert!(drawn([x + moved[0], y + moved[1]]), "{pose}: platform at {corner}");
        }
        let views: Vec<&str> =
            class(document.root_element(), "panel").into_iter().map(label).collect();
        assert_eq!(views, ["from above", "from the front", "from the right", "in perspective"]);
        for name in ["A1", "B2", "C3"] {
            named(named(document.root_element(), "panel", "from above"), "text", name);
        }
    }
}

/// Home of the reference point is computed, and is zero but for rounding.
#[test]
fn a_coordinate_that_is_only_rounding_is_zero() {
    let folder = Folder::new();
    let (_, svg) = plot(&folder, "schoenflies-lift-4dof", &[]);
    let document = Document::parse(&svg).unwrap();
    let home = texts(&document).into_iter().find(|text| text.starts_with("at home: "));
    assert_eq!(home, Some("at home: x = 0 mm, y = 480 mm, phi = 0 deg, z = −150 mm"));
}

#[test]
fn mechanisms_of_every_kind_are_drawn() {
    let folder = Folder::new();
    let outside = folder.write(
        "outside.toml",
        opm(&["examples", "planar-3rrr"])
            .text()
            .replace("axis = [0, 0, 1], point = [0, 75.06", "axis = [0, 1, 1], point = [0, 75.06"),
    );
    for mechanism in [PLANO, HELICAL, BENNETT, "orbita", "cartesian-wrist-6dof", &outside] {
        for ending in ["svg", "png", "pdf"] {
            let output = folder.arg(&format!("picture.{ending}"));
            opm(&["plot", mechanism, "-o", &output, "--quiet"]).text();
            let start: &[u8] = match ending {
                "svg" => b"<svg",
                "png" => b"\x89PNG",
                _ => b"%PDF-1.",
            };
            assert!(fs::read(&output).unwrap().starts_with(start), "{mechanism}: {ending}");
        }
    }
}

#[test]
fn a_picture_of_a_mechanism_needs_a_pose_in_reach_and_its_own_flags() {
    let folder = Folder::new();
    let output = folder.arg("p.svg");
    let draw = |args: &[&str]| opm(&[&["plot", PLANO, "-o", &output], args].concat());
    draw(&["--pose", "y=-5"]).fails(1, &[PLANO, "out of reach", "leg4"]);
    draw(&["--pose", "yaw=1"]).fails_with_one_line(2, &["--pose", "yaw"]);
    draw(&["--slice", "xi=0"]).fails_with_one_line(2, &["--slice", "is a mechanism"]);
    draw(&["--size", "100x100"]).fails_with_one_line(2, &["--size", "4 panels need"]);
    let turn = turn(&folder);
    opm(&["plot", &turn, "-o", &output, "--pose", "x=0"])
        .fails_with_one_line(2, &["--pose", "is a recording"]);
    opm(&["plot", BENNETT, "-o", &output, "--pose", "x=0"]).fails(1, &[BENNETT]);
    assert_eq!(folder.names(), ["round.mcap"]);
}

#[test]
fn points_of_an_unknown_mechanism_are_drawn_as_they_are() {
    let folder = Folder::new();
    let file = folder.arg("odd.mcap");
    let workspace = Workspace {
        layout: CloudLayout {
            axes: ["a", "b", "c"].map(String::from),
            scalars: vec!["s".into()],
            color: "s".into(),
            color_range: [0.0, 1.0],
            frame_id: "f".into(),
            scale: [1.0; 3],
            units: ["m", "m", "rad"],
        },
        mechanism_name: "nonsense.toml",
        mechanism: b"nonsense",
        run: Metadata::new(),
        points: 50,
        slices: Slices { axes: vec![], point_area: 1.0 },
    };
    let rows: Vec<f64> = (0..50).flat_map(|i| [i, i * i, 7, i % 5].map(f64::from)).collect();
    let mut recorder = WorkspaceRecorder::create(file.as_ref(), &workspace).unwrap();
    recorder.overview(&rows).unwrap();
    recorder.push(0, &rows).unwrap();
    recorder.finish(&Metadata::new()).unwrap();
    let (run, svg) = plot(&folder, &file, &[]);
    assert!(run.stderr.contains("no values of imaginary joints"), "{}", run.stderr);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panel = class(document.root(), "panel")[0];
    let (across, up) = (across(panel), up(panel));
    let dots = pieces(paths(class(panel, "points")[0])[0]);
    assert_eq!(dots.len(), 50);
    for (i, dot) in dots.iter().enumerate() {
        let middle = |k: usize| dot.iter().map(|p| p[k]).sum::<f64>() / dot.len() as f64;
        let (a, b) = (i as f64, (i * i) as f64);
        assert!((across(middle(0)) - a).abs() < 0.01, "{i}");
        assert!((up(middle(1)) - b).abs() < 1.0, "{i}");
    }
    let (_, svg) = plot(&folder, &file, &["--values", "a,c,s"]);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(titles(&document), ["c over a", "poses over s"]);
}

/// Between slices that hold points, those that hold nothing are left out, unless --slice asks for them.
#[test]
fn slices_that_hold_nothing_are_left_out() {
    let folder = Folder::new();
    let file = folder.arg("gap.mcap");
    let grid = [("grid.a", "0:4:5"), ("grid.b", "0:4:5"), ("grid.c", "0:6:7")];
    let workspace = Workspace {
        layout: CloudLayout {
            axes: ["a", "b", "c"].map(String::from),
            scalars: vec![],
            color: "c".into(),
            color_range: [0.0, 1.0],
            frame_id: "f".into(),
            scale: [1.0; 3],
            units: ["m", "m", "rad"],
        },
        mechanism_name: "nonsense.toml",
        mechanism: b"nonsense",
        run: grid.map(|(name, range)| (name.to_owned(), range.to_owned())).into(),
        points: 15,
        slices: Slices { axes: vec![], point_area: 1.0 },
    };
    let rows: Vec<f64> =
        (0..15).flat_map(|i| [i % 5, i % 3, [1, 2, 5][i / 5]].map(|v| v as f64)).collect();
    let mut recorder = WorkspaceRecorder::create(file.as_ref(), &workspace).unwrap();
    recorder.overview(&rows).unwrap();
    recorder.push(0, &rows).unwrap();
    recorder.finish(&Metadata::new()).unwrap();
    let drawn = |args: &[&str]| {
        let (_, svg) = plot(&folder, &file, args);
        let document = Document::parse(&svg).unwrap();
        let titles = titles(&document).into_iter().map(str::to_owned).collect::<Vec<_>>();
        (titles, svg.contains("Left out: 2 slices that hold nothing."))
    };
    let named = |values: &[i32]| values.iter().map(|c| format!("c = {c} ")).collect::<Vec<_>>();
    assert_eq!(drawn(&[]), (named(&[1, 2, 5]), true));
    assert_eq!(drawn(&["--slice", "c=2,c=3"]), (named(&[2, 3]), false));
}
