//! Closed cycles of single-loop linkages, driven by one joint.

use crate::error::StudyError;
use opm_core::linkage::{Input, InputRange, Linkage, Position};
use std::f64::consts::PI;

/// One closed cycle of a linkage. An input that can make a full revolution makes one. Otherwise it goes to
/// the end of its range, back in the branch that meets the first one there, and so on until the linkage is
/// home.
pub struct LinkageRound<'a> {
    /// The linkage.
    pub linkage: &'a Linkage,
    /// The joint that moves it.
    pub input: &'a Input<'a>,
    /// Number of positions, two or more. The first and the last are home.
    pub count: u32,
}

/// The totals of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundSummary {
    /// Number of positions.
    pub positions: u64,
    /// Number of positions within all limits.
    pub within_limits: u64,
    /// Whether the input made a full revolution.
    pub is_revolution: bool,
}

impl LinkageRound<'_> {
    /// Calls `take` with every position of the cycle and its number, in order.
    ///
    /// # Errors
    /// An error of `take`, or a position at which the loop does not close.
    pub fn each<E: From<StudyError>>(
        &self,
        mut take: impl FnMut(u32, &Position) -> Result<(), E>,
    ) -> Result<RoundSummary, E> {
        let cycle = self.input.cycle().map_err(StudyError::NoCycle)?;
        let mut position = self.input.home();
        let mut within_limits = 0;
        for number in 0..self.count {
            let phase = f64::from(number) / f64::from(self.count - 1);
            let (value, branch) = cycle.at(phase);
            if !self.input.position_near(value, branch, &mut position) {
                let joint = self.input.coordinate().name.clone();
                let branch = branch.to_string();
                return Err(StudyError::OpenLoop { joint, value, branch }.into());
            }
            within_limits += u64::from(position.within_limits);
            take(number, &position)?;
        }
        let (positions, is_revolution) = (self.count.into(), cycle.is_revolution());
        Ok(RoundSummary { positions, within_limits, is_revolution })
    }
}

/// The range of an input, interval by interval. For a full revolution it is the interval centred at home.
pub fn input_intervals(input: &Input<'_>) -> Vec<[f64; 2]> {
    let home = input.coordinate().home;
    match input.range() {
        InputRange::FullTurn => vec![[home - PI, home + PI]],
        InputRange::Intervals { intervals, .. } => intervals,
    }
}
