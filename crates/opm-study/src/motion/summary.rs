//! The summary of a motion: ranges of all joints, the worst condition number, violations.

use super::driven::Duty;
use super::reacting::Bearing;
use opm_core::manipulator::Manipulator;
use opm_core::trajectory::{Sample, Violation};
use opm_interference::{Contact, Interference, Nearest};

/// Number of violations that are kept. All are counted.
pub const MOST_LISTED: usize = 10_000;

/// The lowest and the highest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range([f64; 2]);

impl Range {
    /// The range of no value.
    const NONE: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    fn add(&mut self, value: f64) {
        self.0 = [self.0[0].min(value), self.0[1].max(value)];
    }

    /// Both ends; `None` if there was no value.
    pub fn get(self) -> Option<[f64; 2]> {
        (self.0[0] <= self.0[1]).then_some(self.0)
    }
}

/// The ranges of a coordinate: position, velocity and acceleration.
pub type CoordinateRanges = [Range; 3];

/// The summary of a motion.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MotionSummary {
    /// Number of samples.
    pub samples: u64,
    /// Number of samples in reach.
    pub reached: u64,
    /// Number of samples in reach and within all limits.
    pub valid: u64,
    /// Ranges of every dependent coordinate.
    pub dependent: Vec<CoordinateRanges>,
    /// Ranges of every joint coordinate.
    pub joints: Vec<CoordinateRanges>,
    /// Ranges of every imaginary joint.
    pub imaginary: Vec<CoordinateRanges>,
    /// The worst condition number, and its time in seconds.
    pub condition: Option<[f64; 2]>,
    /// Violations, where the mechanism cannot follow, in the order of time: [`MOST_LISTED`] at most.
    pub violations: Vec<Violation>,
    /// The number of all violations.
    pub violation_count: u64,
    /// Where two bodies are nearer than the clearance, if that was watched for.
    pub contacts: Option<Contacts>,
    /// What each motor has to do, if that was asked for, in the order of the actuated coordinates; else nothing.
    pub motors: Vec<Duty>,
    /// What each joint has to bear, if that was asked for, leg by leg; else nothing.
    pub bearings: Vec<Bearing>,
}

/// The contacts of a motion.
#[derive(Clone, Debug)]
pub struct Contacts {
    /// The pairs that were tested, with their names.
    pub interference: Interference,
    /// The contacts in the order of time.
    pub contacts: Vec<Contact>,
    /// The nearest pair of the whole motion, and the time, seconds.
    pub nearest: Option<(Nearest, f64)>,
}

impl MotionSummary {
    pub(super) fn new(manipulator: &Manipulator) -> Self {
        Self {
            samples: 0,
            reached: 0,
            valid: 0,
            dependent: vec![[Range::NONE; 3]; manipulator.dependent_coordinates().len()],
            joints: vec![[Range::NONE; 3]; manipulator.coordinates().len()],
            imaginary: vec![[Range::NONE; 3]; manipulator.imaginary().len()],
            condition: None,
            violations: Vec::new(),
            violation_count: 0,
            contacts: None,
            motors: Vec::new(),
            bearings: Vec::new(),
        }
    }

    pub(super) fn add_efforts(
        &mut self,
        sample: &Sample,
        efforts: &[f64],
        manipulator: &Manipulator,
    ) {
        self.motors.resize(efforts.len(), Duty::default());
        let each = self.motors.iter_mut().zip(efforts).zip(manipulator.actuated());
        for ((motor, &effort), &joint) in each {
            motor.add(effort, sample.motion.joint_rates[joint], sample.time);
        }
    }

    pub(super) fn add_reactions(&mut self, sample: &Sample, wrenches: &[f64]) {
        self.bearings.resize(wrenches.len() / 6, Bearing::default());
        let each = self.bearings.iter_mut().zip(wrenches.chunks(6));
        each.for_each(|(bearing, wrench)| bearing.add(wrench, sample.time));
    }

    pub(super) fn add(&mut self, sample: &Sample) {
        self.samples += 1;
        self.reached += u64::from(sample.reached);
        self.valid += u64::from(sample.valid());
        if !sample.reached {
            return;
        }
        let condition = sample.condition;
        if self.condition.is_none_or(|[worst, _]| condition > worst) {
            self.condition = Some([condition, sample.time]);
        }
        let (solution, motion) = (&sample.solution, &sample.motion);
        for (ranges, positions, rates, accelerations) in [
            (
                &mut self.dependent,
                &solution.dependent(),
                &motion.dependent_rates,
                &motion.dependent_accelerations,
            ),
            (
                &mut self.joints,
                &solution.joints(),
                &motion.joint_rates,
                &motion.joint_accelerations,
            ),
            (
                &mut self.imaginary,
                &solution.imaginary(),
                &motion.imaginary_rates,
                &motion.imaginary_accelerations,
            ),
        ] {
            for (i, [position, velocity, acceleration]) in ranges.iter_mut().enumerate() {
                position.add(positions[i]);
                if sample.regular {
                    velocity.add(rates[i]);
                    acceleration.add(accelerations[i]);
                }
            }
        }
    }

    pub(super) fn add_violation(&mut self, violation: Violation) {
        self.violation_count += 1;
        if self.violations.len() < MOST_LISTED {
            self.violations.push(violation);
        }
    }

    pub(super) fn sort(&mut self) {
        self.violations.sort_by(|a, b| a.start.total_cmp(&b.start));
    }
}
