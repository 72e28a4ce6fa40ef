//! `opm trajectory --efforts`: what motors have to do.

use crate::run::{Folder, opm};

/// Two sliders lift a platform of 3 kg; the second one is passive.
const LIFT: &str = r#"
format = 1
name = "lift"
units = { length = "mm", angle = "deg" }
[parameters]
gear = { value = 0.2 }
[platform]
point = [0, 0, 0]
[bodies]
masses = { platform = 3 }
[[leg]]
name = "a"
joints = [{ name = "S", type = "prismatic", axis = [0, 0, 1], point = [1, 0, 0], actuated = true, rotor_inertia = 1e-4, gear = "gear", coulomb_friction = 11 }]
[[leg]]
name = "b"
joints = [{ name = "P", type = "prismatic", axis = [0, 0, 1], point = [-1, 0, 0], viscous_friction = 0.7 }]
"#;

/// From rest to rest by 100 mm: a cubic, of which all derivatives are known.
const MOTION: &str = "format = 1\nname = \"up\"\nunits = { length = \"mm\", angle = \"deg\" }\nrate = 100\nends = \"rest\"\n[points]\nt = [0, 1]\nz = [0, 100]\n";

#[test]
fn a_lift_needs_newtons_second_law() {
    let folder = Folder::new();
    let (lift, motion) = (folder.write("lift.toml", LIFT), folder.write("up.toml", MOTION));
    let table = folder.arg("up.csv");
    let json = opm(&[
        "trajectory",
        &lift,
        "--motion",
        &motion,
        "--rates",
        "--efforts",
        "-o",
        &table,
        "--format",
        "json",
    ])
    .json();
    let text = folder.read("up.csv");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|known| *known == name).unwrap();
    let (rate, effort) = (column("d.S"), column("effort.S"));
    let (mut peak, mut at_peak, mut squares, mut count) = (0.0_f64, f64::NAN, 0.0, 0.0);
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let t = cells[0];
        let (v, a) = (0.1 * (6.0 * t - 6.0 * t * t), 0.1 * (6.0 - 12.0 * t));
        assert!((cells[rate] - v).abs() < 1e-12);
        // A rotor of 1e-4 kg m² at 200 rad/m is as heavy as 4 kg.
        let against = if v > 0.0 { 11.0 } else { 0.0 };
        let expected = 3.0 * (9.81 + a) + 4.0 * a + against + 0.7 * v;
        let rounding = if v.abs() < 1e-12 { 11.0 } else { 0.0 };
        assert!(
            (cells[effort] - expected).abs() < 1e-9 + rounding,
            "{t}: {} {expected}",
            cells[effort]
        );
        if cells[effort].abs() > peak {
            (peak, at_peak) = (cells[effort].abs(), cells[rate]);
        }
        squares += cells[effort] * cells[effort];
        count += 1.0;
    }
    let motor = &json["efforts"]["S"];
    assert!((motor["peak"].as_f64().unwrap() - peak).abs() < 1e-9);
    assert!((motor["rate"].as_f64().unwrap() - at_peak).abs() < 1e-12);
    assert!((motor["rms"].as_f64().unwrap() - (squares / count).sqrt()).abs() < 1e-9);
    assert!(motor["power"][1].as_f64().unwrap() > 0.0);
    assert_eq!(json["efforts"].as_object().unwrap().len(), 1);
    let text = opm(&["trajectory", &lift, "--motion", &motion, "--efforts"]).stdout;
    assert!(text.contains("motor") && text.contains("rms"), "{text}");
    // Without gravity and without friction the sum of what accelerates and what brakes is nothing.
    let free = folder.write(
        "free.toml",
        LIFT.replace("coulomb_friction = 11", "home = 0")
            .replace("viscous_friction = 0.7", "home = 0"),
    );
    let free = opm(&[
        "trajectory",
        &free,
        "--motion",
        &motion,
        "--efforts",
        "--gravity",
        "0,0,0",
        "--format",
        "json",
    ])
    .json();
    let power = &free["efforts"]["S"]["power"];
    let [takes, gives] = [0, 1].map(|i| power[i].as_f64().unwrap());
    assert!((takes + gives).abs() < 1e-9 * gives, "{takes} {gives}");
}

/// The three arms of a Delta bear its platform: its weight, and what accelerates it.
#[test]
fn joints_bear_what_moves_the_platform() {
    let folder = Folder::new();
    let delta = opm(&["examples", "delta"]).stdout;
    let delta =
        folder.write("delta.toml", format!("{delta}\n[bodies]\nmasses = {{ platform = 3 }}\n"));
    let motion = MOTION.replace("z = [0, 100]", "x = [0, 60]");
    let motion = folder.write("along.toml", motion.replace("t = [0, 1]", "t = [0, 0.2]"));
    let table = folder.arg("along.csv");
    let soft = ["--link-stiffness", "1e6,1e4", "--joint-stiffness", "A1=1e4,A2=2e4,A3=3e4"];
    let of = ["trajectory", &delta, "--motion", &motion, "--reactions"];
    let more = ["-o", &table, "--accelerations", "--format", "json"];
    let json = opm(&[&of[..], &soft, &more].concat()).json();
    let text = folder.read("along.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|known| *known == name).expect(name);
    let mut largest = 0.0_f64;
    for row in &rows[1..] {
        let number = |name: &str| row[column(name)].parse::<f64>().unwrap();
        let sum = |part: &str| -> f64 {
            (1..=3).map(|leg| number(&format!("reaction.C{leg}.{part}"))).sum()
        };
        // What passes on to the arms is the weight, downwards, and against the acceleration.
        for (part, expected) in [
            ("FX", -3.0 * number("dd.x")),
            ("FY", -3.0 * number("dd.y")),
            ("FZ", -3.0 * (9.81 + number("dd.z"))),
        ] {
            assert!((sum(part) - expected).abs() < 1e-6, "{part}: {} {expected}", sum(part));
        }
        let force = ["FX", "FY", "FZ"].map(|part| number(&format!("reaction.A1.{part}")));
        largest = largest.max(force.iter().map(|part| part * part).sum::<f64>().sqrt());
    }
    let found = json["reactions"]["A1"]["force"]["largest"].as_f64().unwrap();
    assert!((found - largest).abs() < 1e-9 && largest > 10.0, "{found} {largest}");
    assert_eq!(json["reactions"].as_object().unwrap().len(), 9);
    let text = opm(&[&of[..], &soft].concat()).stdout;
    assert!(text.contains("moment [N m]"), "{text}");
    opm(&of).fails_with_one_line(2, &["--reactions", "give --link-stiffness"]);
    let recording = folder.arg("up.mcap");
    opm(&[&of[..], &soft, &["-o", &recording]].concat())
        .fails_with_one_line(2, &["--reactions", "a recording has none"]);
}

#[test]
fn wrong_drives_and_flags_are_told() {
    let folder = Folder::new();
    let motion = folder.write("up.toml", MOTION);
    let wrong =
        folder.write("wrong.toml", LIFT.replace("coulomb_friction = 11", "coulomb_friction = -1"));
    opm(&["trajectory", &wrong, "--motion", &motion, "--efforts"])
        .fails_with_one_line(1, &["wrong.toml:13:", "`coulomb_friction` is -1, expected 0 to"]);
    let lift = folder.write("lift.toml", LIFT);
    opm(&["trajectory", &lift, "--motion", &motion, "--gravity", "0,0,-9", "-q"])
        .fails_with_one_line(2, &["--gravity", "--efforts"]);
    assert_eq!(folder.names(), ["lift.toml", "up.toml", "wrong.toml"]);
}

/// The lift with a largest effort moves 7 kg against 29.43 N of weight and 11 N of dry friction.
#[test]
fn the_fastest_timing_keeps_the_largest_effort() {
    let folder = Folder::new();
    let motion = folder.write("up.toml", MOTION);
    let lift = |effort: &str| {
        let text =
            LIFT.replace("gear = \"gear\"", &format!("gear = \"gear\", max_effort = {effort}"));
        folder.write(&format!("lift{effort}.toml"), text)
    };
    let run = |effort: &str, more: &[&str]| {
        let of = ["trajectory", &lift(effort), "--motion", &motion, "--time-optimal"];
        opm(&[&of[..], more].concat())
    };
    let json = run("80", &["--efforts", "--format", "json"]).json();
    let peak = json["efforts"]["S"]["peak"].as_f64().unwrap();
    assert!(peak <= 80.0 * (1.0 + 1e-9) && peak > 79.0, "{peak}");
    // Speeding up and slowing down; viscous friction is some half a newton.
    let each = [80.0 - 40.43, 80.0 + 40.43].map(|force: f64| 7.0 / force);
    let expected = (0.2 * (each[0] + each[1])).sqrt();
    let duration = json["duration"].as_f64().unwrap();
    assert!((duration / expected - 1.0).abs() < 0.02, "{duration} {expected}");
    let heavy = run("40", &[]);
    assert_eq!(heavy.code, Some(1));
    let said =
        "S needs 40.4300 N against weight, load and dry friction, more than its max_effort of 40 N";
    assert!(heavy.stderr.contains(said), "{}", heavy.stderr);
    assert_eq!(run("40", &["--gravity", "0,0,0"]).code, Some(0));
    let unused = opm(&["trajectory", &lift("80"), "--motion", &motion, "--gravity", "0,0,0"]);
    assert_eq!(unused.code, Some(2));
    assert!(unused.stderr.contains("nothing uses it"), "{}", unused.stderr);
}

/// Three upright sliders bear a third of the weight each, where the mechanism is symmetric; the motors of a Delta turn.
#[test]
fn what_holds_a_mechanism_is_an_index() {
    let json =
        opm(&["analyze", "linear-delta", "--gravity", "0,0,-9.81", "--format", "json"]).json();
    let mass = json["gravity"]["mass"].as_f64().unwrap();
    let force = json["indices"]["holding_force"].as_f64().unwrap();
    assert!((force - mass * 9.81 / 3.0).abs() < 1e-9 * force, "{force} {mass}");
    // It needs no flag, and a payload counts.
    let loaded = ["analyze", "linear-delta", "--set", "payload.mass=3", "--format", "json"];
    let found = opm(&loaded).json()["indices"]["holding_force"].as_f64().unwrap();
    assert!((found - force - 9.81).abs() < 1e-9, "{found} {force}");
    assert!(json["indices"].get("holding_torque").is_none());
    let folder = Folder::new();
    let out = folder.arg("out.mcap");
    let grid = ["--grid", "x=0:0:1", "--grid", "y=0:0:1", "--grid", "z=-10mm:10mm:3"];
    let sweep = |name: &str| {
        opm(&[&["workspace", "linear-delta", "--color", name, "-o", &out], &grid[..]].concat())
    };
    sweep("holding_force").text();
    sweep("holding_torque").fails(2, &["holding_torque: no actuated joint turns"]);
}

/// Rotors, gears, friction, masses and a payload are set by their names as the file would give them, in lists of joints and in families.
#[test]
fn drives_and_masses_are_set_by_name() {
    let folder = Folder::new();
    let (lift, motion) = (folder.write("lift.toml", LIFT), folder.write("up.toml", MOTION));
    let typed = LIFT
        .replace("platform = 3 }", "platform = 4 }\npayload = { mass = 0.5 }")
        .replace("rotor_inertia = 1e-4", "rotor_inertia = 2e-4")
        .replace("coulomb_friction = 11", "coulomb_friction = 5")
        .replace("viscous_friction = 0.7", "viscous_friction = 1.4");
    let typed = folder.write("typed.toml", &typed);
    let efforts = |file: &str, set: &[&str]| {
        let asked = ["trajectory", file, "--motion", &motion, "--efforts", "--format", "json"];
        opm(&[&asked[..], set].concat()).json()["efforts"].clone()
    };
    let set = "S.rotor_inertia=2e-4,S.coulomb_friction=5,P.viscous_friction=1.4,masses.platform=4,payload.mass=0.5";
    assert!(!efforts(&lift, &[]).is_null());
    assert_eq!(efforts(&lift, &["--set", set]), efforts(&typed, &[]));
    assert_ne!(efforts(&lift, &["--set", set]), efforts(&lift, &[]));
    let set_to = |what: &str| opm(&["analyze", &lift, "--set", what]);
    set_to("S.rotor_inertia=-1").fails(2, &["`S.rotor_inertia` is -1, expected 0 to"]);
    set_to("S.gear=2mm").fails(2, &["S.gear has a unit"]);
    set_to("masses.plaftorm=1").fails(2, &["did you mean `masses.platform`?"]);
    set_to("payload.mass=0").fails(2, &["`payload.mass` is 0 kg"]);

    let set = [
        "--set",
        "rotor_inertia.S=1e-5,gear.S=1500,leg1.coulomb_friction.phi1=0.25,masses.platform=2",
    ];
    let family = folder.arg("family.toml");
    opm(&[&["convert", "plano-spherical-5dof", "-q", "-o", &family], &set[..]].concat()).text();
    let text = folder.read("family.toml");
    // Its unit of length is a millimetre.
    assert!(
        text.contains("gear = { S = 1.5 }") && text.contains("rotor_inertia = { S = 1e-5 }"),
        "{text}"
    );
    let sinusoids = |file: &str, set: &[&str]| {
        let motion = ["--motion", "plano-spherical-sinusoids", "--efforts", "--format", "json"];
        opm(&[&["trajectory", file], &motion[..], set].concat()).json()["efforts"].clone()
    };
    let of_family = sinusoids("plano-spherical-5dof", &set);
    assert_eq!(sinusoids(&family, &[]), of_family);
    assert_ne!(sinusoids("plano-spherical-5dof", &[]), of_family);
}
