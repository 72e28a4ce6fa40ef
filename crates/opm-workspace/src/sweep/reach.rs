//! Which poses are in reach, each for itself, and many together.

use super::{Modes, Sweep};
use crate::condition::Conditioned;
use opm_core::manipulator::{Batch, Manipulator};
use opm_core::reach::AT_ONCE;

/// Decides which poses are in reach, and within the limit if there is one.
pub struct Reach<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    batch: Batch,
    limited: Option<Conditioned<'a>>,
}

impl<'a> Reach<'a> {
    /// Decides poses of a sweep.
    pub fn new(sweep: &Sweep<'a>) -> Self {
        let Sweep { manipulator, modes, .. } = *sweep;
        let limited = |limit| Conditioned::new(manipulator, limit);
        let limited = sweep.limit.clone().map(limited);
        Self { manipulator, modes, batch: manipulator.batch(), limited }
    }

    /// Decides some poses, and gives the ranges of imaginary joints in those that are reached, if these are `wanted`.
    pub fn decide(
        &mut self,
        poses: &[f64],
        reached: &mut [bool],
        wanted: bool,
        mut used: impl FnMut(usize, [f64; 2]),
    ) {
        let width = self.manipulator.task_coordinates().len();
        let poses = poses.chunks(AT_ONCE * width);
        for (poses, reached) in poses.zip(reached.chunks_mut(AT_ONCE)) {
            let mut take = |imaginary: usize, range: [f64; 2]| {
                if wanted {
                    used(imaginary, range);
                }
            };
            let Some(conditioned) = &mut self.limited else {
                let (mode, batch) = (self.modes.one(), &mut self.batch);
                self.manipulator.reach().decide_many(poses, mode, batch, reached, &mut take);
                continue;
            };
            let mut conditions = [0.0; AT_ONCE];
            let conditions = &mut conditions[..reached.len()];
            let used: Option<&mut dyn FnMut(usize, [f64; 2])> =
                if wanted { Some(&mut take) } else { None };
            conditioned.decide(poses, self.modes, conditions, used);
            let admitted = conditions.iter().map(|condition| !condition.is_nan());
            reached.iter_mut().zip(admitted).for_each(|(to, admitted)| *to = admitted);
        }
    }
}
