//! Whether assemblies share the aspect of home.

use super::levels::Levels;
use super::step::is_clear;
use opm_core::Quantity;
use opm_core::forward::Assembly;
use opm_core::manipulator::Manipulator;
use std::f64::consts::TAU;

/// Whether an assembly is in the aspect that home is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomeAspect {
    /// The platform can go straight from home to it, in reach, within the limits of all joints, and without a singularity.
    Shared,
    /// It is in another working mode, or a measure of parallel singularity has another sign than at home: every way there is
    /// singular.
    Apart,
    /// Neither is known: the straight way is not clear, but another one may be; or home or the assembly is singular or beyond limits.
    Unknown,
}

/// For each assembly, whether it shares the aspect of home: by the straight way and the signs of determinants, without a grid.
///
/// ```
/// use opm_workspace::opm_core::Manipulator;
/// use opm_workspace::{HomeAspect, home_aspects};
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let home = manipulator.home_pose();
/// let mut solution = manipulator.solution();
/// let solution = manipulator.inverse(&home, manipulator.home_mode(), &mut solution)?;
/// let joints = solution.expect("home is in reach").joints();
/// let actuated: Vec<f64> = manipulator.actuated().iter().map(|&c| joints[c]).collect();
/// let mut list = manipulator.forward(&actuated)?.list;
/// manipulator.sort_assemblies(&mut list, &manipulator.platform_pose(&home)?);
/// assert_eq!(home_aspects(&manipulator, &list)[0], HomeAspect::Shared);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn home_aspects(manipulator: &Manipulator, list: &[Assembly]) -> Vec<HomeAspect> {
    let mode = manipulator.home_mode();
    let mut levels = Levels::new(manipulator, mode);
    let home = manipulator.home_pose();
    let mut at_home = Vec::new();
    let regular = levels.at(&home, &mut at_home) && !levels.singular(&at_home);
    let mut of = |assembly: &Assembly| {
        let Some(assembly) = manipulator.assembly_in(assembly, mode) else {
            return HomeAspect::Apart;
        };
        let mut at = Vec::new();
        if !regular || !levels.at(&assembly.pose, &mut at) || levels.singular(&at) {
            return HomeAspect::Unknown;
        }
        let mut signs = at_home[..levels.parallel()].iter().zip(&at);
        if signs.any(|(home, at)| home.signum() != at.signum()) {
            return HomeAspect::Apart;
        }
        let coordinates = manipulator.task_coordinates().iter();
        let goal: Vec<f64> = (coordinates.zip(&home).zip(&assembly.pose))
            .map(|((c, from), to)| match c.quantity {
                Quantity::Angle if !manipulator.counts_turns(c.kind()) => {
                    to - TAU * ((to - from) / TAU).round()
                }
                _ => *to,
            })
            .collect();
        match is_clear(manipulator, mode, &home, &goal) {
            true => HomeAspect::Shared,
            false => HomeAspect::Unknown,
        }
    };
    list.iter().map(&mut of).collect()
}
