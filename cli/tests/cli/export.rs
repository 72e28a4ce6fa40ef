//! `opm export mjcf`: the model has what the mechanism has, and wrong input is told. What MuJoCo makes of the models is
//! tested in `tests/python`.

use crate::PLANO;
use crate::run::{Folder, keys, opm, opm_reading};
use roxmltree::Document;
use std::fs;

/// The names of all elements of a kind, in the order of the model.
fn names<'a>(model: &'a Document<'_>, kind: &str) -> Vec<&'a str> {
    model
        .descendants()
        .filter(|n| n.has_tag_name(kind))
        .filter_map(|n| n.attribute("name"))
        .collect()
}

#[test]
fn joints_have_the_names_and_values_of_opm() {
    let folder = Folder::new();
    let file = folder.arg("plano.xml");
    let run = opm(&["export", "mjcf", PLANO, "-o", &file]);
    assert_eq!(run.text(), "");
    assert!(run.stderr.contains("plano.xml: 128 keyframes"), "{}", run.stderr);
    assert_eq!(folder.names(), ["plano.xml"]);
    let text = folder.read("plano.xml");
    let model = Document::parse(&text).unwrap();

    let home = opm(&["ik", PLANO, "--pose", "x=0", "--format", "json"]).json();
    let solution = &home["solutions"][0]["joints"];
    let mut expected = keys(solution);
    // The three coordinates of the ball are one joint.
    expected.retain(|name| !name.starts_with("s4."));
    expected.push("s4");
    assert_eq!(names(&model, "joint"), expected);
    for joint in model.descendants().filter(|n| n.has_tag_name("joint")) {
        let name = joint.attribute("name").unwrap();
        let Some(reference) = joint.attribute("ref") else {
            assert_eq!((name, joint.attribute("type")), ("s4", Some("ball")));
            continue;
        };
        let home = solution[name].as_f64().unwrap();
        assert!((reference.parse::<f64>().unwrap() - home).abs() < 1e-12, "{name}");
    }
    assert_eq!(names(&model, "weld"), ["leg2", "leg3", "leg4"]);
    assert_eq!(names(&model, "position"), ["S1", "S2", "S3", "phi14", "phi24"]);
    assert_eq!(names(&model, "body").iter().filter(|&&name| name == "platform").count(), 1);
    let keyframes = names(&model, "key");
    assert_eq!(keyframes.len(), 128);
    assert!(keyframes.contains(&"pp_mp_pm_m"), "{keyframes:?}");
}

/// A file, standard output and `-` hold the same bytes, and so does a model of the mechanism from standard input.
#[test]
fn the_model_goes_to_standard_output_too() {
    let folder = Folder::new();
    let file = folder.arg("a.xml");
    opm(&["export", "mjcf", "five-bar", "-o", &file]).text();
    let written = folder.read("a.xml");
    assert_eq!(opm(&["export", "mjcf", "five-bar"]).text(), written);
    assert_eq!(opm(&["export", "mjcf", "five-bar", "-o", "-", "--format", "json"]).text(), written);
    let mechanism = opm(&["examples", "five-bar"]).stdout;
    assert_eq!(opm_reading(&mechanism, &["export", "mjcf", "-"]).text(), written);
}

#[test]
fn limits_density_and_time_step_are_taken() {
    let arguments = ["--set", "limits.S=0:0.3", "--density", "1000", "--time-step", "0.002"];
    let run = opm(&[&["export", "mjcf", PLANO], &arguments[..]].concat());
    let model = Document::parse(run.text()).unwrap();
    let named = |kind: &str, name: &str| {
        model
            .descendants()
            .find(|n| n.has_tag_name(kind) && n.attribute("name") == Some(name))
            .unwrap()
    };
    assert_eq!(named("joint", "S1").attribute("range"), Some("0 0.3"));
    assert_eq!(named("position", "S1").attribute("ctrlrange"), Some("0 0.3"));
    assert_eq!(named("weld", "leg2").attribute("solref"), Some("0.004 1"));
    let mass = |text: &str| -> f64 {
        let model = Document::parse(text).unwrap();
        let masses = model.descendants().filter_map(|n| n.attribute("mass"));
        masses.map(|mass| mass.parse::<f64>().unwrap()).sum()
    };
    let aluminium = opm(&["export", "mjcf", PLANO, "--set", "limits.S=0:0.3"]).stdout;
    assert!((mass(&aluminium) / mass(run.text()) - 2.7).abs() < 1e-12);
}

/// The table has a row for each time step, and the columns of the model.
#[test]
fn a_motion_is_written_beside_the_model() {
    let folder = Folder::new();
    let file = folder.arg("plano.xml");
    let motion = ["--trajectory", "plano-spherical-sinusoids", "--time-step", "0.01"];
    let run = opm(&[&["export", "mjcf", PLANO, "-o", &file], &motion[..]].concat());
    assert_eq!(run.text(), "");
    assert_eq!(folder.names(), ["plano.csv", "plano.xml"]);
    let (text, table) = (folder.read("plano.xml"), folder.read("plano.csv"));
    let model = Document::parse(&text).unwrap();
    assert_eq!(names(&model, "key").last(), Some(&"motion"));
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    assert_eq!(header[..2], ["time", "qpos.S1"]);
    assert!(header.contains(&"qpos.s4.w") && header.ends_with(&["ctrl.phi14", "ctrl.phi24"]));
    let rows = table.lines().skip(1);
    assert!(rows.clone().all(|row| row.split(',').count() == header.len()));
    assert_eq!(rows.count(), 1001, "ten seconds at 100 Hz");
    assert!(run.stderr.contains("129 keyframes, 1,001 time steps"), "{}", run.stderr);

    let export = |args: &[&str]| opm(&[&["export", "mjcf", PLANO, "--trajectory"], args].concat());
    export(&["plano-spherical-sinusoids"]).fails_with_one_line(2, &["--trajectory", "--output"]);
    export(&["none.toml", "-o", &file]).fails_with_one_line(1, &["none.toml"]);
    let far = folder.write("far.csv", "t,x\n0,0\n1,5\n");
    export(&[&far, "-o", &file, "--quiet"])
        .fails_with_one_line(1, &["far.csv: at t = ", "is out of reach"]);
    let past = folder.write("past.csv", "t,x\n0,0\n2,0.14\n");
    export(&[&past, "-o", &file]).fails_with_one_line(
        1,
        &["past.csv: leg3: S3 past its highest value by 0.00787", "t = 2 s"],
    );
    let own = folder.write("own.csv", "t,x\n0,0\n1,0.01\n");
    export(&[&own, "-o", &folder.arg("own.xml")]).fails_with_one_line(2, &["also the input"]);
    export(&[&own, "-o", &file, "--time-step", "1e-9"])
        .fails_with_one_line(1, &["1000000001 time steps", "expected at most 1000000"]);
}

#[test]
fn a_tree_has_its_closures_beside_it() {
    let folder = Folder::new();
    let file = folder.arg("plano.urdf");
    let run = opm(&["export", "urdf", PLANO, "-o", &file]);
    assert!(run.stderr.contains("3 closures"), "{}", run.stderr);
    assert_eq!(folder.names(), ["plano.urdf", "plano.yaml"]);
    let (text, closures) = (folder.read("plano.urdf"), folder.read("plano.yaml"));
    assert_eq!(opm(&["export", "urdf", PLANO]).text(), text);
    assert!(closures.starts_with(
        "closed_loop: [['platform', 'leg2.platform'], ['platform', 'leg3.platform'], ['platform', 'leg4.platform']]\n\
         type: ['6d', '6d', '6d']\nname_mot: ['S1', 'S2', 'S3', 'phi14', 'phi24']\n"
    ));
    let model = Document::parse(&text).unwrap();
    let (links, joints) = (names(&model, "link"), names(&model, "joint"));
    // A tree: each link but the base has one joint to its parent.
    assert_eq!(links.len(), joints.len() + 1);
    for name in ["S1", "phi14", "s4.1", "s4.2", "s4.3"] {
        assert!(joints.contains(&name), "{name}: {joints:?}");
    }
    let tree = |args: &[&str]| opm(&[&["export", "urdf", PLANO], args].concat());
    // It is written again, but a file of that name that was there before is somebody else's.
    tree(&["-o", &file]).text();
    folder.write("own.yaml", "mine");
    let parts = ["--output: ", "own.yaml, which goes beside it, is there already"];
    tree(&["-o", &folder.arg("own.urdf")]).fails_with_one_line(2, &parts);
    assert_eq!(folder.names(), ["own.yaml", "plano.urdf", "plano.yaml"]);
    assert_eq!(folder.read("own.yaml"), "mine");
    tree(&["-o", &folder.arg("a.xml")]).fails_with_one_line(2, &["--output", "ends in .urdf"]);
    tree(&["--density", "0"]).fails_with_one_line(2, &["--density", "expected a number from"]);
}

#[test]
fn wrong_masses_are_told_where_they_stand() {
    let folder = Folder::new();
    let text = opm(&["examples", PLANO]).stdout;
    for (bodies, problem) in [
        ("density = 0", "`density` is 0 kg/m^3, expected 0.001 to 1000000.0 kg/m^3"),
        ("density = \"iron\"", "`density`: `iron` is not a parameter; expected a number"),
        ("masses = { platform = -1 }", "`platform` is -1 kg, expected 1e-9 to 1000000.0 kg"),
        ("masses = { S11 = 1 }", "no body is called \"S11\""),
        ("masses = { s4 = 1 }", "the joint s4 carries the platform, expected `platform`"),
        ("mass = 1", "unknown key `mass`, did you mean `masses`"),
        ("inertias = { S1 = [1, 1, 3] }", "`S1` is the inertia of no body"),
        ("payload = { centre = [0, 0, 1] }", "`mass` is missing, expected the payload's mass"),
    ] {
        let file = folder.write("wrong.toml", format!("{text}\n[bodies]\n{bodies}\n"));
        opm(&["export", "mjcf", &file]).fails_with_one_line(1, &["wrong.toml:", problem]);
    }
}

/// In the other mode of leg 1 its elbow B1 is at 88 degrees.
#[test]
fn modes_past_limits_are_named() {
    let run = opm(&["export", "mjcf", "planar-3rrr", "--set", "B1.limits=-80deg:80deg"]);
    let model = Document::parse(run.text()).unwrap();
    let keyframes = names(&model, "key");
    assert_eq!(keyframes.len(), 8);
    for name in keyframes {
        assert_eq!(name.ends_with("_out_of_limits"), name.starts_with('m'), "{name}");
    }
}

/// Two arms that close a loop in no subspaces of their own: there is a model, with home as its only keyframe.
#[test]
fn a_mechanism_without_closed_forms_is_written_too() {
    let joint = |name: &str, axis: &str, point: &str| {
        format!("  {{ name = \"{name}\", type = \"revolute\", axis = {axis}, point = {point} }},\n")
    };
    let leg = |name: &str, joints: &[String]| {
        format!("[[leg]]\nname = \"{name}\"\njoints = [\n{}]\n", joints.concat())
    };
    let heading = "format = 1\nname = \"a <general> loop\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
                   [platform]\npoint = [0, 0, 100]\n";
    let one = [
        joint("a", "[1, 2, 3]", "[0, 0, 0]"),
        joint("b", "[3, -1, 1]", "[10, 50, 0]"),
        joint("c", "[1, 1, -2]", "[0, 20, 70]"),
        joint("d", "[0, 1, 4]", "[20, 0, 90]"),
    ];
    let two = [
        joint("e", "[2, 1, 0]", "[100, 0, 0]"),
        joint("f", "[1, -3, 1]", "[110, 10, 30]"),
        joint("g", "[5, 1, 2]", "[70, 30, 60]"),
    ];
    let file = format!("{heading}{}{}", leg("one", &one), leg("two", &two));
    let run = opm_reading(&file, &["export", "mjcf", "-"]);
    let model = Document::parse(run.text()).unwrap();
    assert_eq!(model.root_element().attribute("model"), Some("a <general> loop"));
    assert_eq!(names(&model, "joint"), ["a", "b", "c", "d", "e", "f", "g"]);
    assert_eq!(names(&model, "key"), ["home"]);
    assert!(run.stderr.contains("home is the only keyframe"), "{}", run.stderr);
}

#[test]
fn wrong_input_is_told_and_leaves_no_file() {
    let folder = Folder::new();
    let good = folder.arg("a.xml");
    let export = |args: &[&str]| opm(&[&["export", "mjcf"], args].concat());
    export(&["none.toml", "-o", &good]).fails_with_one_line(1, &["none.toml: No such file"]);
    export(&["plano-sperical-5dof", "-o", &good]).fails_with_one_line(1, &["plano-spherical-5dof"]);
    for name in ["a.mjcf", "a", "a.xml.gz"] {
        let output = folder.arg(name);
        export(&[PLANO, "-o", &output])
            .fails_with_one_line(2, &["--output", "expected a name that ends in .xml"]);
    }
    let nowhere = folder.arg("no/where.xml");
    export(&[PLANO, "-o", &nowhere])
        .fails_with_one_line(1, &["where.xml", "cannot create", "No such file"]);
    for flag in ["--density", "--time-step"] {
        for value in ["0", "-1", "inf", "nan"] {
            export(&[PLANO, "-o", &good, flag, value])
                .fails_with_one_line(2, &[flag, "expected a number from"]);
        }
    }
    export(&[PLANO, "--density", "2700kg"]).fails(2, &["--density", "a number of kg/m^3, without"]);
    export(&[PLANO, "--time-step", "1ms"])
        .fails(2, &["--time-step", "a number of seconds, without"]);
    opm(&["export"]).fails(2, &["mjcf"]);
    assert!(folder.names().is_empty(), "{:?}", folder.names());

    let text = opm(&["examples", PLANO]).stdout;
    let own = folder.write("own.xml", &text);
    export(&[&own, "-o", &own]).fails_with_one_line(2, &["--output", "also the input"]);
    assert_eq!(fs::read_to_string(folder.path("own.xml")).unwrap(), text);
}

/// Friction and rotors stand at their joints, in both formats as far as they have a place for them.
#[test]
fn drives_are_part_of_models() {
    let folder = Folder::new();
    let text = opm(&["examples", "five-bar"]).stdout;
    let drive = "rotor_inertia = 2e-5, gear = 50, viscous_friction = 0.25, coulomb_friction = 0.5";
    let text = text.replace("actuated = true", &format!("actuated = true, {drive}"));
    let with_payload = format!("{text}\n[bodies]\npayload = {{ mass = 4, inertia = [1, 1, 1] }}\n");
    let (plain, laden) =
        (folder.write("plain.toml", &text), folder.write("laden.toml", &with_payload));
    let model = |file: &str, format: &str| {
        let run = opm(&["export", format, file]);
        run.text().to_owned()
    };
    let mass = |file: &str| -> f64 {
        let text = model(file, "mjcf");
        let model = Document::parse(&text).unwrap();
        let all = model.descendants().filter(|n| n.has_tag_name("inertial"));
        all.map(|n| n.attribute("mass").unwrap().parse::<f64>().unwrap()).sum()
    };
    assert!((mass(&laden) - mass(&plain) - 4.0).abs() < 1e-9);

    let text = model(&plain, "mjcf");
    let model_of_mujoco = Document::parse(&text).unwrap();
    let driven = model_of_mujoco.descendants().filter(|n| n.attribute("armature").is_some());
    let driven: Vec<_> = driven.collect();
    assert_eq!(driven.len(), 2, "{text}");
    for joint in driven {
        let number = |key: &str| joint.attribute(key).unwrap().parse::<f64>().unwrap();
        assert!((number("armature") - 0.05).abs() < 1e-15);
        assert_eq!((number("damping"), number("frictionloss")), (0.25, 0.5));
    }
    let text = model(&plain, "urdf");
    let tree = Document::parse(&text).unwrap();
    let dynamics = tree.descendants().filter(|n| n.has_tag_name("dynamics"));
    let all: Vec<_> = dynamics.map(|n| (n.attribute("damping"), n.attribute("friction"))).collect();
    assert_eq!(all, [(Some("0.25"), Some("0.5")); 2]);
}
