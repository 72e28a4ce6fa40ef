//! Every command, on mechanisms of every pair and family at every special home: nothing panics, and messages end.

use super::shapes::{SHAPES, redrawn, regular};
use opm_cli::fuzzed::silently;
use opm_core::decomposition::mobility::mobility;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::{self, AngleUnit, Digits, FileUnits, LengthUnit};
use opm_core::{Quantity, TaskCoordinate};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

const UNITS: FileUnits = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };

/// A message that is whole: no slot of it is empty, and it does not stop in the middle.
fn ends(message: &str, of: &str) {
    let text = message.trim_end();
    let stops = [":", ";", ",", "(", " and", " or", " is", " of", " by"];
    assert!(
        !text.is_empty() && !stops.iter().any(|stop| text.ends_with(stop)),
        "{of}: {message:?}"
    );
    for hole in ["()", ": ;", "; ;", ": ,", "(; ", "NaN", "  m", "tolerance 0"] {
        assert!(!text.contains(hole), "{of}: {hole:?} in {message:?}");
    }
}

/// Of the commands that take longer, so many are run for each mechanism, in turn.
const IN_TURN: usize = 2;

/// What command lines are made of: two poses, a grid around the first one, and the actuated joints at home.
struct Values {
    pose: String,
    other: String,
    grid: String,
    joints: String,
}

/// The command lines for a mechanism file, those that take longer last.
fn lines(values: &Values) -> [Vec<String>; 2] {
    let Values { pose, other, grid, joints } = values;
    let quick = [
        "decompose home.toml".to_owned(),
        format!("ik home.toml --pose {pose}"),
        "velocity home.toml".to_owned(),
    ];
    let longer = [
        "decompose home.toml --format json".to_owned(),
        format!("ik home.toml --pose {other} --all-modes --format json"),
        format!("fk home.toml --joints {joints} --near {other}"),
        format!("velocity home.toml --pose {other}"),
        "analyze home.toml".to_owned(),
        "convert home.toml -o converted.toml".to_owned(),
        "ik home.toml --poses poses.csv -o ik.csv".to_owned(),
        format!("fk home.toml --joints {joints}"),
        format!("analyze home.toml --pose {other}"),
        "accuracy home.toml --axes 10um,10urad".to_owned(),
        "check home.toml --samples 2".to_owned(),
        "plot home.toml -o plot.svg".to_owned(),
        "explore home.toml -o page.html".to_owned(),
        "export mjcf home.toml -o model.xml".to_owned(),
        "export urdf home.toml -o model.urdf".to_owned(),
        "generate c home.toml -o c".to_owned(),
        "generate rust home.toml -o rust".to_owned(),
        "generate python home.toml -o python".to_owned(),
        "generate matlab home.toml -o matlab".to_owned(),
        "generate st home.toml -o st".to_owned(),
        format!("path home.toml --from {pose} --to {other}"),
        "trajectory home.toml --motion motion.csv -o motion.mcap".to_owned(),
        "calibrate home.toml --plan 5 --candidates 20 -o plan.csv".to_owned(),
        format!("workspace home.toml {grid}"),
        format!("workspace home.toml {grid} --conditioning"),
    ];
    [quick.into(), longer.into()]
}

#[test]
fn nothing_panics_and_messages_end() {
    let folder = tempfile::tempdir().unwrap();
    let mut outcomes: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    let (mut singular, mut turn) = (0, 0);
    for (name, mechanism, decomposition) in regular(1) {
        for shape in SHAPES {
            let drawn = redrawn(&mechanism, &decomposition, shape);
            let what = format!("{name}, {shape:?}");
            let path = folder.path().join("home.toml");
            fs::write(&path, file::write(&drawn, UNITS, Digits::All)).unwrap();
            let report = mobility(&drawn).unwrap();
            singular += usize::from(report.parallel_home().is_some());
            report.parallel_home().iter().for_each(|told| ends(told, &what));
            let values = match Manipulator::new(drawn) {
                Ok(manipulator) => values(&manipulator, folder.path()),
                Err(error) => {
                    ends(&error.to_string(), &what);
                    let [pose, other, joints] = ["x=0", "x=1", "a1=0"].map(str::to_owned);
                    Values { pose, other, joints, grid: "--grid x=0".to_owned() }
                }
            };
            let [mut all, longer] = lines(&values);
            let picked = (0..IN_TURN).map(|i| longer[(turn + i) % longer.len()].clone());
            all.extend(picked);
            turn += IN_TURN;
            run(folder.path(), &all, &what, &mut outcomes);
        }
    }
    println!("{singular} parallel singular homes; done, refused: {outcomes:?}");
    assert!(singular > 10 && outcomes.values().all(|[done, _]| *done > 0));
}

/// What command lines are made of, with tables of the two poses in a folder.
fn values(manipulator: &Manipulator, folder: &Path) -> Values {
    let size = manipulator.characteristic_length();
    let coordinates = manipulator.task_coordinates();
    let by = |share: f64| {
        let step = |quantity| if quantity == Quantity::Angle { share } else { share * size };
        let home = manipulator.home_pose().into_iter().zip(coordinates);
        home.map(|(home, c)| home + step(c.quantity)).collect::<Vec<f64>>()
    };
    let unit = |quantity| if quantity == Quantity::Angle { "rad" } else { "m" };
    let named = |pose: &[f64]| {
        let one =
            |(c, value): (&TaskCoordinate, &f64)| format!("{}={value}{}", c.name, unit(c.quantity));
        coordinates.iter().zip(pose).map(one).collect::<Vec<_>>().join(",")
    };
    let [pose, other, below] = [0.0, 0.02, -0.02].map(by);
    let axes = coordinates.iter().enumerate().map(|(i, c)| {
        let unit = unit(c.quantity);
        format!("--grid {}={}{unit}:{}{unit}:2", c.name, below[i], other[i])
    });
    let names: Vec<&str> = coordinates.iter().map(|c| c.name).collect();
    let row = |pose: &[f64]| pose.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let (names, first, last) = (names.join(","), row(&pose), row(&other));
    fs::write(folder.join("poses.csv"), format!("{names}\n{first}\n{last}\n")).unwrap();
    fs::write(folder.join("motion.csv"), format!("t,{names}\n0,{first}\n1,{last}\n")).unwrap();
    let actuated = manipulator.actuated().iter().map(|&i| &manipulator.coordinates()[i]);
    let joints = actuated.map(|c| format!("{}={}{}", c.name, c.home, unit(c.quantity)));
    Values {
        pose: named(&pose),
        other: named(&other),
        grid: axes.collect::<Vec<_>>().join(" "),
        joints: joints.collect::<Vec<_>>().join(","),
    }
}

fn run(folder: &Path, lines: &[String], what: &str, outcomes: &mut BTreeMap<String, [usize; 2]>) {
    for line in lines {
        let (mut words, mut takes_file) = (vec![OsString::from("opm")], false);
        for word in line.split(' ') {
            let is_file = takes_file || word.ends_with(".toml") || word.ends_with(".csv");
            words.push(if is_file { folder.join(word).into() } else { word.into() });
            takes_file = word == "-o";
        }
        let (command, _) = line.split_once(' ').expect("a file");
        let counts = outcomes.entry(command.to_owned()).or_default();
        match silently(words) {
            Ok(()) => counts[0] += 1,
            Err(message) => {
                counts[1] += 1;
                ends(&message, &format!("{what}: {line}"));
            }
        }
    }
}
