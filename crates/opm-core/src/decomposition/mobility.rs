//! Mobility at the assembled home pose: the number of freedoms of the mechanism, whether the
//! actuators control all of them, and whether home is a singular pose.
//!
//! Everything follows from the loop closure: joint rates `q̇` and a platform twist `t` are a
//! first-order motion exactly if `J_k q̇_k = t` for every leg `k`.

mod linkage;
mod singular;

pub(crate) use linkage::{Linkage, loop_closure};
pub use singular::HomeSingularity;

use crate::group::subspace::{Basis, Frame, SubspaceClass, TOLERANCE, fit};
use crate::mechanism::Mechanism;
use crate::numeric::svd::{Svd, singular_values};
use nalgebra::{DMatrix, Vector6};
use thiserror::Error;

/// Largest supported number of freedoms of all joints together. The time grows with the fourth
/// power of this number; the largest takes about a second.
pub const MAX_FREEDOMS: usize = 96;

/// Why the mobility of a mechanism cannot be computed: something is missing or is not a number.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MobilityError {
    /// The mechanism has fewer than two legs, so it has no loop.
    #[error("mechanism {mechanism:?}: number of legs is {legs}, at least 2 are needed")]
    TooFewLegs {
        /// Name of the mechanism.
        mechanism: String,
        /// The number of legs.
        legs: usize,
    },
    /// A leg has no joints.
    #[error("leg {leg:?} has no joints")]
    EmptyLeg {
        /// Name of the leg.
        leg: String,
    },
    /// An axis, point or pitch is NaN or infinite, or too large to be squared.
    #[error("leg {leg:?}, joint {joint:?}: axis, point and pitch must be finite numbers")]
    NotFinite {
        /// Name of the leg.
        leg: String,
        /// Name of the joint.
        joint: String,
    },
    /// The joints have more freedoms than are supported.
    #[error("the joints have {freedoms} freedoms together; at most {MAX_FREEDOMS} are supported")]
    TooLarge {
        /// The number of freedoms of all joints.
        freedoms: usize,
    },
}

/// What the joints of a mechanism allow at its home pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// Dimension of the span of all joint screws, `lambda`.
    pub lambda: usize,
    /// Mobility `N`: the freedoms of all joints minus the rank of the loop closure.
    pub mobility: usize,
    /// Those of the `mobility` freedoms that do not move the platform, such as a strut that spins
    /// between two spherical joints.
    pub idle: usize,
    /// The number of freedoms of the actuated joints.
    pub actuators: usize,
    /// How many of the mechanism's freedoms the actuators control: `mobility` minus the freedoms
    /// left when the actuators are locked.
    pub controlled: usize,
    /// Names of the actuated joints that are redundant: each of them, alone, could be made passive
    /// without losing control. Empty unless `actuators > controlled`.
    pub redundant: Vec<String>,
    /// The motions of the platform that are left when all actuators are locked: independent twists,
    /// each given as the motion that it generates.
    pub loose: Vec<SubspaceClass>,
    /// Every respect in which home is more degenerate than assembled poses nearby; empty if home is
    /// regular.
    pub singular: Vec<HomeSingularity>,
}

/// Counts freedoms and actuators at home, and finds its singularities.
///
/// # Errors
/// [`MobilityError`] if the mechanism has fewer than two legs, a leg without joints, a number that
/// is not finite, or more than [`MAX_FREEDOMS`] freedoms.
pub fn mobility(mechanism: &Mechanism) -> Result<Mobility, MobilityError> {
    let linkage = Linkage::new(mechanism)?;
    let home = linkage.home();
    let ranks = linkage.ranks(&home, TOLERANCE);
    let freedoms = linkage.actuated.len();

    let kernel = Svd::new(loop_closure(&linkage.units(&home))).kernel(TOLERANCE);
    let platform = kernel.rows(freedoms, 6).into_owned();
    let actuators = linkage.actuated.iter().filter(|actuated| **actuated).count();

    Ok(Mobility {
        lambda: ranks.lambda,
        mobility: ranks.mobility,
        idle: ranks.mobility - span(&platform).dimension(),
        actuators,
        controlled: ranks.mobility.saturating_sub(ranks.locked),
        redundant: redundant(mechanism, &linkage, &kernel),
        loose: loose(&linkage),
        singular: singular::singularities(&linkage, &ranks, mechanism),
    })
}

/// The actuated joints whose rates follow from those of the other actuated joints.
fn redundant(mechanism: &Mechanism, linkage: &Linkage, kernel: &DMatrix<f64>) -> Vec<String> {
    let mut row = 0;
    let mut driven: Vec<(&str, Vec<usize>)> = vec![];
    for joint in mechanism.joints() {
        let rows = (row..row + joint.freedoms()).collect();
        row += joint.freedoms();
        if joint.actuated {
            driven.push((&joint.name, rows));
        }
    }
    let rank = |rows: &[usize]| absolute_rank(kernel.select_rows(rows));
    let all: Vec<usize> = (0..row).filter(|&i| linkage.actuated[i]).collect();
    let controlled = rank(&all);
    let spare = |own: &[usize]| {
        let rest: Vec<usize> = all.iter().copied().filter(|i| !own.contains(i)).collect();
        rank(&rest) == controlled
    };
    driven.into_iter().filter(|(_, rows)| spare(rows)).map(|(name, _)| name.to_owned()).collect()
}

/// The rank of rows taken from orthonormal columns. The natural size of these rows is one, so the
/// tolerance is absolute.
fn absolute_rank(matrix: DMatrix<f64>) -> usize {
    singular_values(matrix).iter().filter(|&&value| value > TOLERANCE).count()
}

/// The motions of the platform with every actuator locked.
fn loose(linkage: &Linkage) -> Vec<SubspaceClass> {
    let passive = linkage.passive(&linkage.units(&linkage.home()));
    let kernel = Svd::new(loop_closure(&passive)).kernel(TOLERANCE);
    let platform = kernel.rows(kernel.nrows() - 6, 6).into_owned();
    let twists = span(&platform);
    let motion = |twist: &Vector6<f64>| Some(fit(&[*twist])?.class.restored(&linkage.frame));
    twists.vectors().iter().filter_map(motion).collect()
}

/// The span of the columns of a 6 × n block of orthonormal columns. Columns that are nearly zero
/// (idle motions) do not count, whatever the size of the others.
fn span(block: &DMatrix<f64>) -> Basis {
    let svd = Svd::new(block.clone());
    let columns: Vec<Vector6<f64>> = (0..svd.values.len())
        .filter(|&i| svd.values[i] > TOLERANCE)
        .map(|i| Vector6::from_iterator(svd.image.column(i).iter().copied()) / svd.values[i])
        .collect();
    Basis::span(&columns)
}

/// The normalised frame of a mechanism, from all its joint axes and their points as given.
pub fn frame(mechanism: &Mechanism) -> Frame {
    let axes: Vec<_> = mechanism
        .joints()
        .flat_map(|joint| joint.screws().into_iter().map(|screw| (screw, joint.point)))
        .collect();
    Frame::of(&axes)
}

#[cfg(test)]
mod tests;
