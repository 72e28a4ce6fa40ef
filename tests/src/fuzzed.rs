//! What is fuzzed: arbitrary bytes as mechanism files, motion files, recordings and joint lists. Nothing may panic or
//! hang, and what is accepted has to hold. `fuzz/` has a target of `cargo fuzz` for each; a test replays the stored
//! corpora and changes of them. What is fuzzed of the command line is beside that test.

mod bytes;
mod joints;

pub use bytes::Bytes;

use joints::joints;
use opm_check::{Comparison, Options, closures, rows};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file;
use opm_core::motion::table::TableOptions;
use opm_core::motion::{file as motion_file, table};
use opm_core::table::ColumnNames;
use opm_mcap::{ReadError, read};
use std::io::Write as _;
use std::sync::LazyLock;

/// The manipulator that motions are read for.
static PLANO: LazyLock<Manipulator> =
    LazyLock::new(|| Manipulator::example("plano-spherical-5dof").unwrap());

/// The largest closure error at poses that may be next to a singularity, where half of the digits are lost.
const CLOSED: f64 = 1e-6;

/// A mechanism file: read, decomposed, compiled, and its text read again.
pub fn mechanism(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(read) = file::read(text) else { return };
    let again = file::read(&read.text()).expect("a file that opm writes");
    assert_eq!(again.mechanism.legs.len(), read.mechanism.legs.len());
    if let Ok(manipulator) = Manipulator::new(read.mechanism) {
        // The extremes of doubles are accepted by the reader; sizes beyond those of machines lose digits.
        let size = manipulator.characteristic_length();
        let home = manipulator.home_pose();
        let mut solution = manipulator.solution();
        if (1e-3..1e3).contains(&size) && home.iter().all(|value| value.abs() < 1e3) {
            let _ = manipulator.inverse(&home, manipulator.home_mode(), &mut solution);
        }
    }
}

/// A motion file, or a table of poses if the first byte is odd.
pub fn motion(data: &[u8]) {
    let Some((first, rest)) = data.split_first() else { return };
    let Ok(text) = std::str::from_utf8(rest) else { return };
    let found = match first % 2 {
        0 => motion_file::read(text, &PLANO),
        first => {
            let columns: Option<ColumnNames> =
                "t=time,x=pos_x,y".parse().ok().filter(|_| first % 4 == 3);
            let options = TableOptions {
                columns: columns.as_ref(),
                relative_time: first % 8 > 4,
                ..Default::default()
            };
            table::read(text, "table", &PLANO, &options).map(|read| read.motion)
        }
    };
    match found {
        Ok(motion) => assert!(motion.duration.is_finite() && motion.duration >= 0.0),
        Err(errors) => assert!(!errors.problems.is_empty()),
    }
}

/// A recording: read to its end, with every cloud and every table decoded; and recovered.
pub fn recording(data: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(data).unwrap();
    let mut values = Vec::new();
    let _ = read::<ReadError>(file.path(), |message| {
        message.cloud()?;
        message.values(&mut values)?;
        message.runs()?;
        Ok(())
    });
    let target = file.path().with_extension("recovered");
    if opm_mcap::recover(file.path(), &target).is_ok() {
        let _ = read::<ReadError>(&target, |_| Ok(()));
        std::fs::remove_file(&target).unwrap();
    }
}

/// A list of joints, made from bytes so that it often decomposes: closures and rows have to hold.
pub fn joint_list(data: &[u8]) {
    let text = joints(&mut Bytes(data));
    let read = file::read(&text).unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    let Ok(manipulator) = Manipulator::new(read.mechanism) else { return };
    let options = Options { samples: 3, seed: data.iter().map(|&byte| u64::from(byte)).sum() };
    let holds = |found: Comparison| {
        let off = found.worst.is_some_and(|worst| worst > CLOSED);
        // A mechanism that nearly decomposes may close to a multiple of its deviation only.
        let excused = found.tolerance.is_some_and(|tolerance| tolerance > CLOSED);
        let wrong = found.problem.is_some() && (found.worst.is_none() || off);
        assert!(!wrong || excused, "{found:?}\n{text}");
    };
    holds(closures(&manipulator, &options, &mut || true).unwrap());
    if manipulator.choices() < 12 {
        holds(rows(&manipulator, &options, &mut || true).unwrap());
    }
    let mut at = manipulator.solution();
    let home = manipulator.home_pose();
    if manipulator.forward_closed_form().is_ok()
        && manipulator.inverse(&home, manipulator.home_mode(), &mut at).unwrap().is_some()
    {
        let actuated: Vec<f64> = manipulator.actuated().iter().map(|&i| at.joints()[i]).collect();
        let _ = manipulator.forward(&actuated).unwrap();
    }
}
