//! Rows of poses, cut into pieces in which no step is doubtful.
//!
//! Every pose is measured once. A step between two neighbours of a row is *doubtful* if a level might dip through
//! zero and back in between. Four successive values of the level tell: where it falls before the step and rises
//! after it, both chords are extended into the step, and where they meet is a lower bound of a convex function.

use super::levels::Levels;
use crate::set::GridSet;
use crate::sweep::Run;
use opm_core::manipulator::{Manipulator, Mode};

/// The share of a level that a dip has to leave for a step to be beyond doubt: a level need not be convex.
const LEFT: f64 = 0.5;

/// A run of poses in one row that has no singularity, as far as the measures at its poses tell.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The numbers of its poses in the row.
    pub run: Run,
    /// The signs of the measures, true for positive; `None` for poses that are singular.
    pub signs: Option<Vec<bool>>,
}

/// Cuts rows into pieces.
pub struct Screen<'a> {
    levels: Levels<'a>,
}

impl<'a> Screen<'a> {
    pub fn new(manipulator: &'a Manipulator, mode: Mode) -> Self {
        Self { levels: Levels::new(manipulator, mode) }
    }

    /// The pieces of a row of a set, in order.
    pub fn row(&mut self, set: &GridSet, row: usize) -> Vec<Piece> {
        let first = row as u64 * set.row();
        let mut pieces = Vec::new();
        for run in set.runs(row) {
            self.run(set, first, *run, &mut pieces);
        }
        pieces
    }

    fn run(&mut self, set: &GridSet, first: u64, run: Run, pieces: &mut Vec<Piece>) {
        // The levels of the pose two before, of the one before, of this one and of the next.
        let mut window: [Measured; 4] = Default::default();
        let measure = |levels: &mut Levels<'_>, number: u64, into: &mut Measured| {
            into.reached =
                number < run.to && levels.at(&set.point(first + number), &mut into.levels);
        };
        measure(&mut self.levels, run.from, &mut window[3]);
        for number in run.from..run.to {
            window.rotate_left(1);
            measure(&mut self.levels, number + 1, &mut window[3]);
            let signs = self.signs(&window[2]);
            let goes_on = number > run.from && signs.is_some() && !self.doubtful(&window);
            match pieces.last_mut() {
                Some(last) if goes_on && last.signs == signs => last.run.to = number + 1,
                Some(last) if signs.is_none() && last.signs.is_none() && last.run.to == number => {
                    last.run.to = number + 1;
                }
                _ => pieces.push(Piece { run: Run { from: number, to: number + 1 }, signs }),
            }
        }
    }

    /// The signs of the measures; `None` at a singularity.
    fn signs(&self, at: &Measured) -> Option<Vec<bool>> {
        let levels = at.known().filter(|levels| !self.levels.singular(levels))?;
        Some(levels[..self.levels.signed()].iter().map(|level| *level > 0.0).collect())
    }

    /// Whether the step from the second to the third of four successive poses is doubtful.
    fn doubtful(&self, [before, from, to, after]: &[Measured; 4]) -> bool {
        let (Some(b), Some(c)) = (from.known(), to.known()) else { return true };
        let (before, after) = (before.known(), after.known());
        self.levels.jump(b, c)
            || (0..self.levels.count()).any(|i| {
                let sign = b[i].signum();
                let value = |levels: Option<&[f64]>| levels.map(|levels| sign * levels[i]);
                dips(value(before), [sign * b[i], sign * c[i]], value(after))
            })
    }
}

/// Whether a level may dip below zero between two poses. The values before and after are not known at the ends of
/// a run.
fn dips(before: Option<f64>, [from, to]: [f64; 2], after: Option<f64>) -> bool {
    let left = LEFT * from.min(to);
    // What is left at the end of the step if the level goes on as before it, and the same from behind.
    let [falls, rises] = [before.map(|before| from - before), after.map(|after| after - to)];
    match (falls, rises) {
        (None, None) => true,
        (Some(slope), _) | (None, Some(slope)) if !slope.is_finite() => true,
        (Some(falls), None) => falls < 0.0 && from + falls < left,
        (None, Some(rises)) => rises > 0.0 && to - rises < left,
        (Some(falls), Some(rises)) => {
            if falls >= 0.0 || rises <= 0.0 {
                return false;
            }
            // from + falls s = to - rises (1 - s)
            let meet = ((from - to + rises) / (rises - falls)).clamp(0.0, 1.0);
            (from + falls * meet).max(to - rises * (1.0 - meet)) < left
        }
    }
}

/// The levels of a pose.
#[derive(Default)]
struct Measured {
    reached: bool,
    levels: Vec<f64>,
}

impl Measured {
    fn known(&self) -> Option<&[f64]> {
        self.reached.then_some(&self.levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola that stays above zero is passed; one that goes below between two samples is not.
    #[test]
    fn a_dip_between_two_poses_is_doubtful() {
        let parabola = |depth: f64| {
            let at = |s: f64| (s - 0.5) * (s - 0.5) - depth;
            dips(Some(at(-1.0)), [at(0.0), at(1.0)], Some(at(2.0)))
        };
        assert!(parabola(0.2) && parabola(1e-3));
        assert!(!parabola(-10.0));
        // A line that rises or falls has no dip, at the end of a run either.
        assert!(!dips(Some(1.0), [2.0, 3.0], Some(4.0)) && !dips(None, [3.0, 2.0], Some(1.0)));
        assert!(dips(None, [1.0, 1.0], None) && dips(Some(f64::NAN), [1.0, 1.0], None));
    }
}
