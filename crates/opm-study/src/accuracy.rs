//! Accuracy over the poses of a grid.

use crate::error::StudyError;
use opm_accuracy::{
    Allocation, Assembler, Both, Budget, Model, Response, Samples, Worst, draw, sample_assembled,
};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::velocity::VelocityError;
use opm_workspace::{Cancelled, Grid, Progress, in_order};

/// Poses that a thread works on between two visits: a response takes far longer than to hand it over.
const PIECE: u64 = 32;

/// The most mechanisms that are drawn at a pose: each takes some hundred bytes.
pub const MOST_SAMPLES: u64 = 1_000_000;

/// What is asked of the accuracy over a grid.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyRequest<'a> {
    /// The errors.
    pub model: &'a Model<'a>,
    /// The size of each error, radians and metres, in the order of the model's sources.
    pub sizes: &'a [f64],
    /// The working mode.
    pub mode: Mode,
    /// The clearance of joints that tolerances are asked for.
    pub clearance: Option<Both>,
}

/// The accuracy over the poses of a grid that are in reach and within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyField {
    /// How many poses the grid has.
    pub poses: u64,
    /// The largest errors, and where they are. It counts the poses that are in reach and within limits.
    pub worst: Worst,
    /// The tolerances that keep within the clearance at all of them.
    pub allocation: Option<Allocation>,
}

/// The errors at one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyRow {
    /// The pose, radians and metres.
    pub pose: Vec<f64>,
    /// Its dependent coordinates.
    pub dependent: Vec<f64>,
    /// What the errors do together.
    pub budget: Budget,
}

impl<'a> AccuracyRequest<'a> {
    fn manipulator(&self) -> &'a Manipulator {
        self.model.manipulator()
    }

    /// A field without poses.
    fn empty(&self) -> AccuracyField {
        let coordinates = self.manipulator().task_coordinates().len();
        let joints = self.manipulator().mechanism().joints().count();
        let sources = self.model.sources().len();
        let allocation = self.clearance.map(|c| Allocation::new(c, self.model.length(), sources));
        AccuracyField { poses: 0, worst: Worst::new(coordinates, joints), allocation }
    }

    /// The largest errors over a grid. Each pose is given to `visit`, in the order of the grid. The work is done on the
    /// current thread pool, and does not depend on the number of threads.
    ///
    /// # Errors
    /// [`StudyError::Cancelled`], or the first error of `visit`.
    pub fn over<E: From<StudyError> + From<Cancelled> + Send>(
        &self,
        grid: &Grid,
        progress: &Progress,
        mut visit: impl FnMut(&AccuracyRow) -> Result<(), E> + Send,
    ) -> Result<AccuracyField, E> {
        let mut whole = self.empty();
        let pieces = (0..grid.poses().div_ceil(PIECE)).map(Ok);
        in_order(
            pieces,
            || (self.manipulator().solution(), self.manipulator().home_pose()),
            |(at, pose), piece| {
                let mut field = self.empty();
                let mut rows = Vec::new();
                let numbers = piece * PIECE..((piece + 1) * PIECE).min(grid.poses());
                for number in numbers {
                    progress.advance(1)?;
                    grid.pose_into(number, pose);
                    field.poses += 1;
                    if let Some((response, row)) = self.row(pose, at) {
                        field.worst.add(&row.budget, pose);
                        if let Some(allocation) = &mut field.allocation {
                            allocation.add(&response, self.model.sources());
                        }
                        rows.push(row);
                    }
                }
                Ok((field, rows))
            },
            |(field, rows)| {
                whole.poses += field.poses;
                whole.worst.merge(&field.worst);
                if let (Some(own), Some(other)) = (&mut whole.allocation, &field.allocation) {
                    own.merge(other);
                }
                rows.iter().try_for_each(&mut visit)
            },
        )?;
        Ok(whole)
    }

    /// The errors at a pose, if it is in reach and within limits.
    fn row(&self, pose: &[f64], at: &mut Solution) -> Option<(Response, AccuracyRow)> {
        let found = self.manipulator().inverse(pose, self.mode, at).ok().flatten()?;
        if !found.within_limits() {
            return None;
        }
        let response: Result<_, VelocityError> = self.model.at(found);
        let response = response.ok()?;
        let budget = Budget::new(&response, self.sizes);
        let dependent = found.dependent().to_vec();
        Some((response, AccuracyRow { pose: pose.to_vec(), dependent, budget }))
    }
}

/// Mechanisms with errors that are drawn at random, assembled at one pose.
#[derive(Clone, Copy, Debug)]
pub struct Drawing<'a> {
    /// What assembles them.
    pub assembler: &'a Assembler<'a>,
    /// The size of each error, radians and metres.
    pub sizes: &'a [f64],
    /// How many mechanisms are drawn.
    pub count: u64,
    /// The same seed draws the same mechanisms.
    pub seed: u64,
}

impl Drawing<'_> {
    /// Assembles them, on the current thread pool; the result does not depend on the number of threads. Each takes some hundred
    /// bytes of memory.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn samples(&self, progress: &Progress) -> Result<Samples, Cancelled> {
        let mut all = Vec::new();
        in_order(
            (0..self.count.div_ceil(PIECE)).map(Ok),
            || (),
            |(), piece| {
                let numbers = piece * PIECE..((piece + 1) * PIECE).min(self.count);
                let one = |number| {
                    progress.advance(1)?;
                    let errors = draw(self.sizes, self.seed, number);
                    Ok(sample_assembled(self.assembler, &errors))
                };
                numbers.map(one).collect::<Result<Vec<_>, Cancelled>>()
            },
            |samples: Vec<_>| {
                all.extend(samples);
                Ok::<(), Cancelled>(())
            },
        )?;
        Ok(Samples::of(all))
    }
}
