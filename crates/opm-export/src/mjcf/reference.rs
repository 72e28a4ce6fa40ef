//! A motion in the coordinates of a model: a row for each time step of a simulation.
//!
//! A servo's spring pulls towards its control, and its damper holds against every rate. So a servo whose control is the
//! value itself lags behind. Here a control leads the value by what the damper takes, rate times damping over stiffness:
//! the damper then acts on the difference of rates alone.

use super::joints::{Column, columns, joint_values};
use super::servo::LEAD;
use crate::keyframe::{Keyframe, Keyframes};
use crate::xml::number;
use opm_core::Manipulator;
use opm_core::trajectory::{
    Change, Gauge, Trajectory, TrajectoryError, Violation, ViolationReport,
};
use std::fmt::Write;

/// The largest number of rows: more than a quarter of an hour at a time step of a millisecond.
const MOST_ROWS: u64 = 1_000_000;

/// A motion of a mechanism in the coordinates of its model.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfReference {
    columns: Vec<String>,
    rows: Vec<f64>,
    start: Vec<f64>,
}

/// Why a motion is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// The motion cannot be followed at all.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The mechanism cannot follow the motion at some time.
    #[error("at t = {time} s: {leg} {what}, expected a motion that the mechanism can follow")]
    Unfollowed {
        /// The time, seconds.
        time: f64,
        /// The leg that does not follow.
        leg: String,
        /// What is the matter with it.
        what: &'static str,
    },
    /// A joint passes a limit, where MuJoCo would hold it.
    #[error("{violation}, expected a motion within all limits")]
    PastLimit {
        /// The joint, the limit, by how much it is passed, and when.
        violation: String,
    },
    /// The motion has too many time steps.
    #[error(
        "{rows} time steps, expected at most {MOST_ROWS}: a shorter motion, or a longer time step"
    )]
    Long {
        /// The number of time steps.
        rows: u64,
    },
}

impl MjcfReference {
    /// Follows a trajectory, which is sampled at the time steps of the simulation.
    ///
    /// # Errors
    /// The mechanism cannot follow it, or it is too long.
    pub fn new(
        manipulator: &Manipulator,
        mut trajectory: Trajectory<'_>,
    ) -> Result<Self, ReferenceError> {
        if trajectory.samples() > MOST_ROWS {
            return Err(ReferenceError::Long { rows: trajectory.samples() });
        }
        let mechanism = manipulator.mechanism();
        let (mut rows, mut start, mut ended) = (Vec::new(), None, Vec::new());
        while trajectory.advance()? {
            let sample = trajectory.sample();
            let stuck = |leg: usize, what| ReferenceError::Unfollowed {
                time: sample.time,
                leg: mechanism.legs[leg].name.clone(),
                what,
            };
            if !sample.reached {
                let leg = sample.solution.unreachable().first().map_or(0, |missed| missed.leg);
                return Err(stuck(leg, "is out of reach"));
            }
            if let Some(singular) = sample.motion.singular.first() {
                return Err(stuck(singular.leg, "is singular: its joints have no rates"));
            }
            let joints = sample.solution.joints();
            let rates = &sample.motion.joint_rates;
            let led: Vec<f64> = joints.iter().zip(rates).map(|(q, rate)| q + LEAD * rate).collect();
            rows.push(sample.time);
            rows.extend(joint_values(mechanism, joints).positions);
            rows.extend(joint_values(mechanism, &led).controls);
            start.get_or_insert_with(|| joints.to_vec());
            ended.extend(trajectory.changes().iter().filter_map(|change| match change {
                Change::Ends(violation) => Some(*violation),
                Change::Begins(_) => None,
            }));
        }
        let past = |violation: &&Violation| matches!(violation.gauge, Gauge::Limit { .. });
        if let Some(violation) = ended.iter().chain(trajectory.open()).find(past) {
            let violation = ViolationReport::new(violation, manipulator).si();
            return Err(ReferenceError::PastLimit { violation });
        }
        let columns = columns(mechanism).map(|column| match column {
            Column::Position(name) => format!("qpos.{name}"),
            Column::Control(name) => format!("ctrl.{name}"),
        });
        let columns = ["time".to_owned()].into_iter().chain(columns).collect();
        Ok(Self { columns, rows, start: start.unwrap_or_default() })
    }

    /// The names of the columns: `time`, `qpos.NAME` for each number of MuJoCo's `qpos`, and `ctrl.NAME` for each of its
    /// `ctrl`, in their order.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The numbers, row by row: seconds, metres, radians, and parts of quaternions.
    pub fn values(&self) -> &[f64] {
        &self.rows
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.rows.len() / self.columns.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The table as CSV.
    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",");
        text.push('\n');
        for row in self.rows.chunks_exact(self.columns.len()) {
            for (i, &value) in row.iter().enumerate() {
                let _ = write!(text, "{}{}", if i == 0 { "" } else { "," }, number(value));
            }
            text.push('\n');
        }
        text
    }
}

impl Keyframes<'_> {
    /// The same postures with that at the start of a motion, `motion`.
    #[must_use]
    pub fn with_start(mut self, reference: &MjcfReference) -> Self {
        self.push(Keyframe {
            name: "motion".to_owned(),
            joints: reference.start.clone(),
            within_limits: true,
            loose: false,
        });
        self
    }
}
