//! Which of many poses are in reach within all limits, in one working mode or in any.

use super::Reach;
use crate::manipulator::Mode;
use crate::manipulator::batch::Batch;
use crate::manipulator::batch::decide::{Decided, OfBranch};
use crate::manipulator::batch::lanes::Lanes;

impl Reach<'_> {
    /// Whether many poses are decided together, which is several times as fast: chains are the same at all poses. Where they
    /// are not, [`Reach::decide_many`] decides one pose after the other.
    pub fn decides_many(self) -> bool {
        self.manipulator.decides_reach()
    }

    /// Finds which of some poses, row after row, are in reach within all limits, in one working mode or (`None`) in any:
    /// `reached` gets one answer for each. `used` is called with the number of an imaginary joint and the least and the
    /// largest of its values in solutions of reached poses.
    ///
    /// # Panics
    /// If there are more answers than [`AT_ONCE`](super::AT_ONCE), or fewer poses than answers.
    pub fn decide_many(
        self,
        poses: &[f64],
        mode: Option<Mode>,
        batch: &mut Batch,
        reached: &mut [bool],
        used: &mut dyn FnMut(usize, [f64; 2]),
    ) {
        let manipulator = self.manipulator;
        let (width, rows) = (manipulator.task_coordinates().len(), reached.len());
        let Batch { arch, block, solution, all, .. } = batch;
        let together = manipulator.decides_reach();
        let mut alone = Lanes::all(u64::from(!together));
        reached.fill(false);
        if together {
            block.take(manipulator, poses);
        }
        for choices in manipulator.completions(mode).take_while(|_| together) {
            manipulator.complete_block(choices.chosen, *arch, block);
            block.displace(manipulator, *arch);
            block.decide(manipulator, choices, *arch);
            let Decided { missed, open, imaginary } = &block.decided;
            for (lane, reached) in reached.iter_mut().enumerate() {
                *reached |= missed[lane] | open[lane] == 0;
                alone[lane] |= open[lane] & !missed[lane];
            }
            for OfBranch { number, reaches, values } in imaginary {
                let mut range = [f64::INFINITY, f64::NEG_INFINITY];
                for lane in 0..rows {
                    let counts = reaches[lane] != 0 && missed[lane] | open[lane] == 0;
                    let value = values[lane];
                    range[0] = if counts { range[0].min(value) } else { range[0] };
                    range[1] = if counts { range[1].max(value) } else { range[1] };
                }
                if range[0] <= range[1] {
                    used(*number, range);
                }
            }
        }
        if manipulator.shares_limits() {
            // What is known does not count these.
            for (lane, &reached) in reached.iter().enumerate() {
                alone[lane] |= u64::from(reached);
            }
        }
        for lane in (0..rows).filter(|&lane| alone[lane] & 1 == 1) {
            let pose = &poses[lane * width..][..width];
            if manipulator.is_whole() && manipulator.differences().is_empty() {
                reached[lane] = manipulator.whole_reaches(pose, mode);
                continue;
            }
            let mut each = |number: usize, value: f64| used(number, [value; 2]);
            reached[lane] = match mode {
                Some(mode) => {
                    match manipulator.inverse(pose, mode, solution).expect("a finite pose") {
                        Some(solution) if solution.within_limits() => {
                            let values = solution.imaginary().iter().enumerate();
                            values.for_each(|(number, &value)| each(number, value));
                            true
                        }
                        _ => false,
                    }
                }
                None => {
                    let found = manipulator.inverse_all(pose, all).expect("a finite pose");
                    found.is_some_and(|all| all.within_limits_in_any(manipulator, each))
                }
            };
        }
    }
}
