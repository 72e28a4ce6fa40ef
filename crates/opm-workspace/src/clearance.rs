//! A limit on the distance of bodies: poses at which two of them are too near do not count.

use crate::grid::{Grid, Sections};
use crate::sweep::Modes;
use opm_core::manipulator::Mode;
use opm_interference::Interference;

/// The least distance of all pairs of bodies at which a pose counts.
#[derive(Clone, Copy, Debug)]
pub struct ClearanceLimit<'a> {
    /// The pairs of bodies.
    pub interference: &'a Interference,
    /// The least distance, metres.
    pub least: f64,
}

/// Why a sweep has no clearance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClearanceError {
    /// The grid is of one section alone: only the whole mechanism has bodies at known places.
    #[error("a section alone has no clearance")]
    Section,
    /// The sweep is of all working modes.
    #[error("a clearance is that of one working mode, not of any")]
    Modes,
    /// The distance is not a number of at least zero.
    #[error("clearance {0} m, expected a length of 0 or more")]
    Length(f64),
}

impl ClearanceLimit<'_> {
    /// The working mode in which the poses of a grid have a clearance.
    pub(crate) fn check(&self, grid: &Grid, modes: Modes) -> Result<Mode, ClearanceError> {
        if grid.sections() != Sections::Whole {
            return Err(ClearanceError::Section);
        }
        if !(self.least >= 0.0 && self.least.is_finite()) {
            return Err(ClearanceError::Length(self.least));
        }
        modes.one().ok_or(ClearanceError::Modes)
    }
}
