//! Every kind of wrong use: the exit status, and a message that names the flag or the place.

use crate::run::{Folder, command, opm, opm_reading};
use crate::{HELICAL, PLANO};
use std::fs;

#[test]
fn wrong_usage_names_the_flag() {
    let ik = ["ik", PLANO];
    let workspace = ["workspace", PLANO];
    for (command, flags, parts) in [
        (&[][..], &[][..], &["Usage"][..]),
        (&["fly"], &[], &["fly"]),
        (&["decompose"], &[], &["<FILE>"]),
        (&["decompose", PLANO], &["--format", "xml"], &["--format", "text, json"]),
        (&ik, &[], &["--pose", "--poses"]),
        (&ik, &["--pose", "x=0", "--poses", "in.csv"], &["--pose", "--poses"]),
        (&ik, &["--pose", "x=0", "-o", "out.csv"], &["--output"]),
        (&ik, &["--pose", "x"], &["--pose", "expected NAME=VALUE"]),
        (&ik, &["--pose", "x=10furlong"], &["--pose", "unknown unit \"furlong\"", "mm"]),
        (&ik, &["--pose", "x=1,x=2"], &["--pose", "x is given twice"]),
        (&ik, &["--pose", "x=nan"], &["--pose", "not a number"]),
        (&ik, &["--pose", "yaw=1"], &["--pose", "\"yaw\"", "x, y, zeta, xi, psi"]),
        (&ik, &["--pose", "x=1deg"], &["--pose", "x is a length"]),
        (&ik, &["--pose", "xi=1mm"], &["--pose", "xi is an angle"]),
        (&ik, &["--pose", "x=1e200"], &["--pose", "x is 1e200"]),
        (&ik, &["--pose", "x=0", "--mode", "++"], &["--mode", "2 signs for 7", "++ ++ ++ +"]),
        (&ik, &["--pose", "x=0", "--mode", "-x ++ ++ +"], &["--mode", "`x` is not a sign"]),
        (&ik, &["--pose", "x=0", "--mode", "home", "--all-modes"], &["--mode", "--all-modes"]),
        (&ik, &["--pose", "x=0", "--transform", "0,0,0,1,0,0,0"], &["--pose", "--transform"]),
        (&ik, &["--transform", "0,0,0,1,0,0,0", "-o", "out.csv"], &["--output"]),
        (&ik, &["--transform", "0,0,0"], &["--transform", "3 numbers", "X,Y,Z,QW,QX,QY,QZ"]),
        (&ik, &["--transform", "0,0,0,1,1,0,0"], &["--transform", "length 1.4142, expected 1"]),
        (&ik, &["--transform", "0,0,0deg,1,0,0,0"], &["--transform", "Z is a length"]),
        (&ik, &["--poses", "-", "--format", "json"], &["--format json", "--output"]),
        (&workspace, &["--grid", "x=0:1"], &["--grid", "AXIS=MIN:MAX:COUNT"]),
        (&workspace, &["--grid", "x=0:1:two"], &["--grid", "\"two\""]),
        (&workspace, &["--grid", "x=-1:1mm:3"], &["--grid", "one end only"]),
        (&workspace, &["--grid", "yaw=0:1:3"], &["--grid", "axis yaw", "x, y, zeta, xi, psi"]),
        (&workspace, &["--grid", "x=0:1deg:3"], &["--grid", "x is a length"]),
        (&workspace, &["--grid", "x=0", "--grid", "x=1"], &["--grid", "axis x", "twice"]),
        (&workspace, &["--grid", "x=1:0:3"], &["--grid", "axis x", "smaller one first"]),
        (
            &workspace,
            &["--grid", "x=-1e308:1e308:5"],
            &["--grid", "axis x: -1e308 to 1e308, expected numbers up to 1e75"],
        ),
        (&workspace, &["--grid", "x=0:1:0"], &["--grid", "axis x", "at least 1"]),
        (&workspace, &["--grid", "x=0:1:1"], &["--grid", "axis x", "at least 2"]),
        (
            &workspace,
            &["--grid", "x=0:1:18446744073709551615", "--grid", "y=0:1:18446744073709551615"],
            &["--grid", "at most 2^53, some 9e15"],
        ),
        (&workspace, &["--grid", "x=0:1:18446744073709551616"], &["--grid", "number of values"]),
        (&workspace, &["--mode", "sideways"], &["--mode", "not a sign"]),
        (&workspace, &["--threads", "0"], &["--threads", "1..=1024"]),
        (&workspace, &["--max-condition", "0.9"], &["--max-condition", "at least 1"]),
        (&workspace, &["--max-condition", "nan"], &["--max-condition", "at least 1"]),
        (&workspace, &["--max-condition", "inf"], &["--max-condition", "at least 1"]),
        (&workspace, &["--length", "1"], &["--max-condition"]),
        (&workspace, &["--max-condition", "9", "--length", "0"], &["--length", "positive"]),
        (&workspace, &["--max-condition", "9", "--length", "1deg"], &["--length", "an angle"]),
        (&workspace, &["--color", "x"], &["--output"]),
        (&workspace, &["-o", "-"], &["--output", "standard output"]),
    ] {
        opm(&[command, flags].concat()).fails(2, parts);
    }
}

/// An option that other commands have is not to be passed as a value; they are named.
#[test]
fn an_option_of_other_commands_is_told() {
    let wrong = opm(&["velocity", PLANO, "--pose", "x=1mm", "--all-modes"]);
    wrong.fails(2, &["tip: --all-modes is an option of opm ik, opm workspace"]);
    for option in ["--all-modes", "--all-mods", "--nothing-like-it", "-z"] {
        let wrong = opm(&["velocity", PLANO, "--pose", "x=1mm", option]);
        assert!(!wrong.stderr.contains("as a value"), "{}", wrong.stderr);
    }
}

#[test]
fn wrong_wishes_for_a_recording_cost_no_time_and_leave_no_file() {
    let folder = Folder::new();
    let output = folder.arg("out.mcap");
    let slices = ["--grid", "x=0:1:2", "--grid", "y=0:1:2", "--grid", "psi=0:1:1000001"];
    for (flags, parts) in [
        (&["--color", "mood"][..], &["--color", "\"mood\"", "psi, theta11", "S1", "phi24"][..]),
        // Passive joints are not among the values.
        (&["--color", "phi11"], &["--color", "\"phi11\""]),
        (&["--axes", "x,y"], &["--axes", "three", "tip"]),
        (&["--axes", "x,y,x"], &["--axes", "different"]),
        (&["--axes", "x,y,yaw"], &["--axes", "\"yaw\""]),
        (&["--scalars", "S1,S9"], &["--scalars", "\"S9\""]),
        (&["--scalars", "S1,S1"], &["--scalars", "S1 is given twice"]),
        (&["--scalars", "x"], &["--scalars", "field x"]),
        (&slices, &["--grid", "1,000,001 slices", "psi", "at most 1,000,000"]),
    ] {
        let args = [&["workspace", PLANO, "-o", &output], flags].concat();
        opm(&args).fails_with_one_line(2, parts);
        assert_eq!(folder.names(), [""; 0]);
    }
}

#[test]
fn a_mechanism_that_cannot_be_had() {
    let folder = Folder::new();
    let missing = folder.arg("missing.toml");
    opm(&["decompose", &missing]).fails_with_one_line(1, &["missing.toml: No such file"]);
    let unknown = opm(&["decompose", "plano-sperical-5dof"]);
    unknown.fails_with_one_line(
        1,
        &["plano-sperical", "no such example", "did you mean `plano-spherical-5dof`"],
    );
    opm(&["decompose", &folder.arg("")]).fails_with_one_line(1, &["directory"]);
    let latin = folder.write("latin.toml", b"format = 1\nname = \"caf\xe9\"\n");
    opm(&["decompose", &latin]).fails_with_one_line(1, &["latin.toml:2: not UTF-8"]);
    let empty = folder.write("empty.toml", "");
    opm(&["ik", &empty, "--pose", ""]).fails(1, &["empty.toml:1:1: `format`"]);
    opm(&["workspace", "bennett-double-spherical-6r"]).fails_with_one_line(
        1,
        &["bennett-double-spherical-6r:38:1: legs leg1, leg2", "closed-form"],
    );
    opm(&["examples", "none"]).fails_with_one_line(2, &["\"none\"", PLANO]);
}

#[test]
fn every_problem_of_a_file_has_its_line() {
    let folder = Folder::new();
    let text = opm(&["examples", PLANO]).text().replace("b1 = 100", "b1 = -100");
    let text = text.replace("h = 120  ", "hh = 120 ");
    let file = folder.write("bad.toml", &text);
    let run = opm(&["ik", &file, "--pose", "x=0"]);
    run.fails(1, &["b1"]);
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert!(lines.len() >= 4, "three legs and the arm: {}", run.stderr);
    let prefix = format!("opm: error: {file}:");
    for line in &lines {
        let place = line.strip_prefix(&prefix).unwrap_or_else(|| panic!("{line}"));
        let mut numbers = place.splitn(3, ':').take(2);
        assert!(numbers.all(|n| n.parse::<usize>().is_ok_and(|n| n > 0)), "{line}");
    }
    let arm = text.lines().position(|line| line.starts_with("b1")).unwrap() + 1;
    assert!(lines.iter().any(|line| line.starts_with(&format!("{prefix}{arm}:"))));
}

/// The shipped list of joints, with one wrong leg at a time. The message names the leg, its place in the file
/// and the cause.
#[test]
fn legs_that_cannot_be_solved_are_named() {
    let folder = Folder::new();
    let shipped = opm(&["examples", "plano-spherical-5dof-joints"]).text().to_owned();
    let line = |name: &str| {
        let mark = format!("name = \"{name}\"");
        shipped.lines().find(|line| line.contains(&mark)).unwrap().to_owned()
    };
    let (planar, spherical, slider) = (line("phi21"), line("theta21"), line("S1"));
    // The values at home are removed, since they would not fit another type.
    let typed = |line: &str, kind: &str, more: &str| {
        let (head, _) = line.split_once(", home").unwrap();
        let from = if line.contains("revolute") { "revolute" } else { "prismatic" };
        format!("{}{more} }},", head.replace(from, kind).replace(", actuated = true", ""))
    };
    let another = |line: &str, from: &str, to: &str| {
        let copy = line.replace("name = \"", "name = \"extra ").replacen(from, to, 1);
        format!("{line}\n{}", copy.replacen(" },", ", actuated = true },", 1))
    };
    let leg = "leg1: ";
    for (from, to, parts) in [
        (
            &planar,
            another(&planar, "point = [", "point = [1"),
            &[leg, "4 freedoms in its lower"][..],
        ),
        (&spherical, another(&spherical, "axis = [0", "axis = [1"), &[leg, "3 in its upper"]),
        (
            &spherical,
            typed(&spherical, "revolute", "")
                .replace("axis = [0.1", "axis = [0, 0, 1], axis2 = [0.1"),
            &["unknown key `axis2`"],
        ),
        (
            &planar,
            typed(&planar, "helical", ", pitch = 20"),
            &["joint phi21 of leg leg1 alone changes the height of the lower section", "planar"],
        ),
        (
            &planar,
            typed(&planar, "cylindrical", ""),
            &["joint phi21 of leg leg1 alone changes the height of the lower section", "planar"],
        ),
        (
            &spherical,
            typed(&spherical, "prismatic", ""),
            &["joint theta21 of leg leg1 alone changes the height of the lower section", "planar"],
        ),
        (
            &planar,
            typed(&planar, "universal", ", axis2 = [0, 1, 0]"),
            &[
                "no partial subspaces",
                "only joint phi21 of leg leg1 does not fit such a split: its axis passes the centre",
            ],
        ),
        (
            &slider,
            typed(&slider, "cylindrical", ", actuated = true"),
            &[
                "no partial subspaces",
                "only joint S1 of leg leg1 does not fit such a split: its axis is",
            ],
        ),
        (&planar, planar.replace("phi21", "psi"), &["\"psi\" is the name of a task coordinate"]),
        (&planar, planar.replace("phi21", "tau.leg2"), &["that leg's imaginary joint"]),
    ] {
        assert!(shipped.contains(&**from));
        let file = folder.write("bad.toml", shipped.replacen(&**from, &to, 1));
        let run = opm(&["ik", &file, "--pose", ""]);
        run.fails(1, parts);
        // The error is in the first leg, which is the file's first.
        let place = run.stderr.split_once("bad.toml:").unwrap().1;
        let number: usize = place.split(':').next().unwrap().parse().unwrap();
        assert!((14..24).contains(&number), "{}", run.stderr);
    }
    // There are more freedoms than actuated joints: the message names the free motion.
    let extra = planar.replace("phi21", "extra").replace("point = [", "point = [1");
    let loose = shipped.replacen(&*planar, &format!("{planar}\n{extra}"), 1);
    let file = folder.write("loose.toml", loose);
    opm(&["ik", &file, "--pose", ""]).fails_with_one_line(1, &["5 of the 6 freedoms", "free: rot"]);
    let run = opm(&["ik", HELICAL, "--pose", "", "--mode", "+"]);
    run.fails_with_one_line(
        2,
        &["--mode", "1 sign for 0 choices", "no choices, and one working mode"],
    );
}

#[test]
fn inputs_are_not_written_over() {
    let folder = Folder::new();
    let text = opm(&["examples", PLANO]).stdout;
    let file = folder.write("mine.toml", &text);
    let csv = folder.write("in.csv", "x\n0\n");
    let same = &["--output", "also the input"];
    opm(&["workspace", &file, "-o", &file]).fails_with_one_line(2, same);
    opm(&["ik", &file, "--poses", &csv, "-o", &csv]).fails_with_one_line(2, same);
    opm(&["ik", &file, "--poses", &csv, "-o", &file]).fails_with_one_line(2, same);
    let dotted = folder.arg("./in.csv");
    opm(&["ik", &file, "--poses", &csv, "-o", &dotted]).fails_with_one_line(2, same);
    assert_eq!((folder.read("mine.toml"), folder.read("in.csv")), (text, "x\n0\n".to_owned()));
    assert_eq!(folder.names(), ["in.csv", "mine.toml"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = Folder::new();
    let csv = folder.write("in.csv", "x\n0\n");
    fs::create_dir(folder.path("taken.mcap")).unwrap();
    for (output, parts) in [
        (folder.arg("no/where.mcap"), &["where.mcap", "cannot create", "No such file"][..]),
        (folder.arg("taken.mcap"), &["taken.mcap", "not a regular file"]),
    ] {
        opm(&["workspace", PLANO, "-o", &output]).fails_with_one_line(1, parts);
    }
    let table = folder.arg("no/where.csv");
    opm(&["ik", PLANO, "--poses", &csv, "-o", &table])
        .fails_with_one_line(1, &["where.csv", "cannot create", "No such file"]);
    opm(&["ik", PLANO, "--poses", &folder.arg("none.csv")])
        .fails_with_one_line(1, &["none.csv: No such file"]);
}

/// Writing to `/dev/full` fails as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_a_failure() {
    let folder = Folder::new();
    let csv = folder.write("in.csv", "x\n0\n");
    for args in [
        &["decompose", PLANO][..],
        &["ik", PLANO, "--pose", "x=0", "--format", "json"],
        &["ik", PLANO, "--poses", &csv],
        &["examples", PLANO],
        &["completions", "bash"],
        &["help", "format"],
        &["ik", "--help"],
        &["--version"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command(args).stdout(full).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{args:?}: {stderr}");
        assert!(
            stderr.starts_with("opm: error: standard output: No space left"),
            "{args:?}: {stderr}"
        );
    }
}

/// Content that is written as MCAP only is refused under other names, and no file is left.
#[test]
fn what_is_written_as_mcap_is_not_called_otherwise() {
    let folder = Folder::new();
    for name in ["a.npy", "a.ply", "a"] {
        let output = folder.arg(name);
        for (args, what) in [
            (&["workspace", PLANO, "--grid", "x=0:1:3", "--shard", "1/2"][..], "a shard"),
            (&["workspace", PLANO, "--kind", "upper"], "--kind upper"),
        ] {
            opm(&[args, &["-o", &output]].concat())
                .fails_with_one_line(2, &["--output", what, "expected a name that ends in .mcap"]);
        }
    }
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

/// A message names a place once.
#[test]
fn messages_name_the_file_once() {
    let folder = Folder::new();
    fs::create_dir(folder.path("taken.npy")).unwrap();
    let run = opm(&["workspace", PLANO, "-o", &folder.arg("taken.npy")]);
    run.fails_with_one_line(1, &["not a regular file"]);
    assert_eq!(run.stderr.matches("taken.npy").count(), 1, "{}", run.stderr);
    opm(&["workspace", PLANO, "--grid", "x=1:0:3"])
        .fails_with_one_line(2, &["expected the smaller one first"]);
}

/// The five-bar's angle follows from its place, wherever a coordinate of the pose is expected.
#[test]
fn a_coordinate_that_follows_from_others_is_told() {
    let folder = Folder::new();
    let out = folder.arg("a.mcap");
    let follows = "theta follows from x, y; give these instead";
    for (flag, args) in [
        ("--grid", &["workspace", "--grid", "theta=-10deg:10deg:5"][..]),
        ("--axes", &["workspace", "-o", &out, "--axes", "theta,x,y"]),
        ("--scalars", &["workspace", "-o", &out, "--scalars", "theta"]),
        ("--color", &["workspace", "-o", &out, "--color", "theta"]),
        ("--near", &["fk", "--joints", "S1=100deg,S2=80deg", "--near", "theta=1"]),
        ("--rates", &["velocity", "--rates", "theta=1"]),
    ] {
        let args = [&[args[0], "five-bar"], &args[1..]].concat();
        opm(&args).fails_with_one_line(2, &[flag, follows]);
    }
    let table = folder.write("motion.csv", "t,x,theta\n0,0,0\n1,0,0\n2,0,0\n");
    let head = "format = 1\nname = \"m\"\nunits = { length = \"mm\", angle = \"deg\" }\nduration = 1\nrate = 100\n";
    let file = folder.write("motion.toml", format!("{head}[coordinates]\ntheta = 3\n"));
    for (motion, place) in [(table, "motion.csv:1:5"), (file, "motion.toml:7:9")] {
        let run = opm(&["trajectory", "five-bar", "--motion", &motion]);
        run.fails_with_one_line(1, &[place, "theta", "follows from x, y; give these instead"]);
    }
}

/// A mechanism without an upper section has no coordinates of it to list.
#[test]
fn no_list_of_names_is_empty() {
    let grid = |file, kind| opm(&["workspace", file, "--kind", kind, "--grid", "q=0:0.1:2"]);
    for (file, kind, words) in [
        ("planar-3rrr", "upper", ["--kind", "no upper section"]),
        ("agile-eye", "imaginary", ["--kind", "no imaginary joints"]),
        ("planar-3rrr", "lower", ["--grid", "expected one of x, y, theta"]),
        (PLANO, "upper", ["--grid", "expected one of zeta, xi, psi"]),
        (PLANO, "lower", ["--grid", "expected one of x, y, theta11"]),
        ("five-bar", "upper", ["--kind", "no upper section"]),
        ("five-bar", "grid", ["--grid", "expected one of x, y"]),
    ] {
        grid(file, kind).fails_with_one_line(2, &words);
    }
}

/// 10 m is 30 times as large as the mechanism, and 15 rad is more than two turns.
#[test]
fn numbers_without_a_unit_that_look_misread_are_noted() {
    let odd =
        |args: &[&str]| opm(args).stderr.lines().filter(|l| l.contains("has no unit")).count();
    for args in [
        &["ik", PLANO, "--pose", "x=10,xi=15"][..],
        &["velocity", PLANO, "--pose", "x=10,xi=15"],
        &["fk", PLANO, "--joints", "S1=170,S2=165mm,S3=160mm,phi14=-150,phi24=130deg"],
        &["workspace", PLANO, "--grid", "x=-100:100:3", "--grid", "xi=-30:30:3"],
        &[
            "measure", PLANO, "--over", "x=0:10", "--over", "y=0", "--over", "zeta=90", "--over",
            "xi=0", "--over", "psi=0",
        ],
        &["ik", PLANO, "--set", "leg1.h=140", "--set", "limits.S=-200:200", "--pose", "x=0"],
        &["workspace", PLANO, "--clearance", "3", "--grid", "x=-100:.1:11"],
        &["calibrate", PLANO, "--plan", "2", "--candidates", "2", "--sigma", "20,20"],
    ] {
        assert_eq!(odd(args), 2, "{args:?}");
        assert_eq!(odd(&[args, &["--quiet"]].concat()), 0, "{args:?}");
    }
    assert_eq!(odd(&["ik", PLANO, "--pose", "x=10mm,y=0.01,xi=15deg,psi=0.2"]), 0);
    // Rates and accelerations are no places.
    let limits = ["--set", "leg4.max_rate.phi1=30", "--set", "leg1.max_acceleration.S=20"];
    assert_eq!(odd(&[&["ik", PLANO, "--pose", "x=0"], &limits[..]].concat()), 0);
    let run = opm(&["ik", PLANO, "--pose", "xi=15"]);
    let expected = "opm: note: --pose: xi=15 has no unit and was read as 15 rad, 859 degrees; if it is in \
                    deg, write xi=15deg\n";
    assert_eq!(run.stderr, expected);
}

/// The headings of columns may name units; without them, numbers that look misread are noted once.
#[test]
fn headings_of_columns_name_units() {
    let folder = Folder::new();
    let solved = |text: &str| {
        let file = folder.write("poses.csv", text);
        let run = opm(&["ik", PLANO, "--poses", &file]);
        (run.text().to_owned(), run.stderr.clone())
    };
    let (si, quiet) = solved("x,xi,t\n0.01,0.5235987755982988,0\n");
    assert_eq!(quiet, "");
    let (own, quiet) = solved("x [mm],xi [deg],t [s]\n10,30,0\n");
    assert_eq!((own, quiet.as_str()), (si, ""));
    let (_, noted) = solved("x,xi\n10,30\n20,40\n");
    let lines: Vec<&str> = noted.lines().collect();
    assert_eq!(lines.len(), 2, "{noted}");
    assert!(lines[0].contains("poses.csv:2: x has no unit and was read as 10 m"), "{noted}");
    assert!(lines[1].ends_with("head the column xi [deg]"), "{noted}");
    for (heading, words) in [
        ("x [deg]", "x is a length, expected m, cm, mm, um, in, not \"deg\""),
        ("xi [grad]", "xi is an angle, expected rad, mrad, urad, deg, not \"grad\""),
        ("t [ms]", "expected t or t [s]"),
    ] {
        let file = folder.write("wrong.csv", format!("{heading}\n1\n"));
        opm(&["ik", PLANO, "--poses", &file]).fails_with_one_line(1, &["wrong.csv:1: ", words]);
    }
    // So may those of a motion.
    let followed = |text: &str| {
        let file = folder.write("motion.csv", text);
        opm(&["trajectory", PLANO, "--motion", &file, "--rate", "10", "-o", "-"]).text().to_owned()
    };
    let si = followed("t,x,xi\n0,0,0\n1,0.01,0.5235987755982988\n");
    assert_eq!(followed("t [s],x [mm],xi [deg]\n0,0,0\n1,10,30\n"), si);
    // What a motion writes in the units of the file is read back.
    let table = folder.arg("joints.csv");
    let motion = ["trajectory", PLANO, "--motion", "plano-spherical-sinusoids", "--rate", "10"];
    opm(&[&motion[..], &["--units", "file", "--rates", "-o", &table]].concat()).text();
    let poses = opm(&["ik", PLANO, "--poses", &table]);
    assert_eq!((poses.text().lines().count(), poses.stderr.as_str()), (102, ""));
    let back = opm(&["fk", PLANO, "--poses", &table]);
    assert_eq!((back.text().lines().count(), back.stderr.as_str()), (102, ""));
}

#[test]
fn a_mechanism_can_come_from_standard_input() {
    let text = opm(&["examples", PLANO]).text().to_owned();
    let read = opm_reading(&text, &["decompose", "-"]);
    // The commands that come next need a file.
    let by_name = opm(&["decompose", PLANO]);
    assert_eq!(by_name.text().split("\nnext:\n").next(), Some(read.text()));
    opm_reading("format = 2", &["decompose", "-"]).fails(1, &["standard input:1:10"]);
    opm_reading(&text, &["ik", "-", "--poses", "-"])
        .fails_with_one_line(2, &["--poses", "standard input is the mechanism already"]);
}
