//! The recording of a closed cycle of a linkage.

use super::scene::{Scene, imaginary_coordinates, joint_coordinates};
use super::{Attachment, record};
use crate::error::StudyError;
use crate::linkage::{LinkageRound, RoundSummary, input_intervals};
use opm_core::linkage::Position;
use opm_core::skeleton::{self as core, ImaginaryJoints};
use opm_mcap::trajectory::{Posture, Sample};
use opm_mcap::{RecordError, Trajectory, TrajectoryRecorder};
use serde_json::json;
use std::path::Path;

/// Duration of a recorded cycle, in nanoseconds.
const ROUND: u64 = 10_000_000_000;

/// Records a closed cycle of a linkage, ten seconds long.
///
/// # Errors
/// The file cannot be written, or the loop does not close at a position.
pub fn record_linkage(
    round: &LinkageRound<'_>,
    mechanism_file: Attachment<'_>,
    path: &Path,
) -> Result<RoundSummary, StudyError> {
    let LinkageRound { linkage, input, count } = *round;
    let failed = |error: RecordError| StudyError::record(path.display(), error);
    let steps = u64::from(count - 1);
    let mechanism = linkage.mechanism();
    let cuts = linkage
        .decomposition()
        .map(|decomposition| ImaginaryJoints { decomposition, imaginary: linkage.imaginary() });
    let mut scene = Scene::new(mechanism, cuts);
    let trajectory = Trajectory {
        pose: Vec::new(),
        dependent: Vec::new(),
        joints: joint_coordinates(mechanism),
        imaginary: imaginary_coordinates(linkage.imaginary()),
        rates: false,
        measures: Vec::new(),
        indices: Vec::new(),
        bodies: scene.bodies(),
        files: vec![(mechanism_file.name, mechanism_file.text.as_bytes())],
        run: record([
            ("command", "linkage".to_owned()),
            ("mechanism", mechanism.name.clone()),
            ("input", input.coordinate().name.clone()),
            ("range", json!(input_intervals(input)).to_string()),
            ("branch", input.home_branch().to_string()),
            ("positions", count.to_string()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ]),
    };
    let mut recorder = TrajectoryRecorder::create(path, &trajectory).map_err(failed)?;
    let summary = round.each(|number: u32, position: &Position| -> Result<(), StudyError> {
        let time = u64::from(number) * ROUND / steps;
        let (joints, imaginary) = (&position.joints, position.imaginary.as_slice());
        let frames = if recorder.shows(time) {
            let leg = &mechanism.legs[0];
            let own = &joints[..leg.coordinates().count()];
            let platform = leg.displacement(own).expect("a position has a value for every joint");
            scene.frames(&core::Configuration { joints, imaginary, platform })
        } else {
            &[]
        };
        let posture = Posture { joints, imaginary, frames, ..Posture::default() };
        let sample =
            Sample { valid: position.within_limits, posture: Some(posture), ..Sample::default() };
        recorder.push(time, &sample).map_err(failed)
    })?;
    let result = record([
        ("positions", summary.positions.to_string()),
        ("within_limits", summary.within_limits.to_string()),
        ("turns", summary.is_revolution.to_string()),
    ]);
    recorder.finish(&result).map_err(failed)?;
    Ok(summary)
}
