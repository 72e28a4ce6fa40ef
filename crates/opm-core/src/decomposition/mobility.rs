//! Mobility at the assembled home pose: how many freedoms the legs leave together, whether the
//! actuators hold them all, and whether home is a singular pose.
//!
//! All is read from the loop closure: joint rates `q̇` and a platform twist `t` are a first-order
//! motion exactly if `J_k q̇_k = t` for every leg `k`.

mod linkage;
mod singular;

pub(crate) use linkage::{Linkage, loop_closure};
pub use singular::HomeSingularity;

use crate::group::subspace::{Basis, Frame, SubspaceClass, TOLERANCE, fit};
use crate::mechanism::Mechanism;
use crate::numeric::svd::{Svd, singular_values};
use nalgebra::{DMatrix, Vector6};
use thiserror::Error;

/// Most single freedoms of all joints together: the time grows with the fourth power of their
/// number, and these take about a second.
pub const MAX_FREEDOMS: usize = 96;

/// A mechanism that has no mobility to speak of: something is missing or is not a number.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MobilityError {
    /// A loop takes two legs.
    #[error("mechanism {mechanism:?}: number of legs is {legs}, at least 2 are needed")]
    TooFewLegs {
        /// Name of the mechanism.
        mechanism: String,
        /// Legs that it has.
        legs: usize,
    },
    /// A leg that connects nothing.
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
    /// More joints than this module is made for.
    #[error("the joints have {freedoms} freedoms together; at most {MAX_FREEDOMS} are supported")]
    TooLarge {
        /// Freedoms of all joints.
        freedoms: usize,
    },
}

/// What the joints of a mechanism allow at its home pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// Dimension of the span of all joint screws.
    pub lambda: usize,
    /// `N`: freedoms of all joints less the rank of the loop closure.
    pub mobility: usize,
    /// Of those, the ones that do not move the platform (a strut that spins between two spherical
    /// joints).
    pub idle: usize,
    /// Freedoms of the actuated joints.
    pub actuators: usize,
    /// How many of the mechanism's freedoms they control: `mobility` less what is left when they
    /// are locked.
    pub controlled: usize,
    /// Actuated joints that could be locked out one at a time without losing control; none unless
    /// `actuators > controlled`.
    pub redundant: Vec<String>,
    /// Motions of the platform that are left when all actuators are locked: independent twists,
    /// each as the motion that it generates.
    pub loose: Vec<SubspaceClass>,
    /// In what respects home is more degenerate than assembled poses nearby; empty if it is regular.
    pub singular: Vec<HomeSingularity>,
}

/// Counts freedoms, actuators and singularities at home.
///
/// # Errors
/// [`MobilityError`] if the mechanism has fewer than two legs, a leg without joints, a number that
/// is not finite, or more than [`MAX_FREEDOMS`].
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

/// Actuated joints whose rates follow from those of the other actuated joints.
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

/// Rank of rows taken from orthonormal columns, whose natural size is one.
fn absolute_rank(matrix: DMatrix<f64>) -> usize {
    singular_values(matrix).iter().filter(|&&value| value > TOLERANCE).count()
}

/// Motions of the platform with every actuator locked.
fn loose(linkage: &Linkage) -> Vec<SubspaceClass> {
    let passive = linkage.passive(&linkage.units(&linkage.home()));
    let kernel = Svd::new(loop_closure(&passive)).kernel(TOLERANCE);
    let platform = kernel.rows(kernel.nrows() - 6, 6).into_owned();
    let twists = span(&platform);
    let motion = |twist: &Vector6<f64>| Some(fit(&[*twist])?.class.restored(&linkage.frame));
    twists.vectors().iter().filter_map(motion).collect()
}

/// Span of the columns of a 6 × n block of orthonormal columns: those that are all but zero (idle
/// motions) do not count, whatever the size of the others.
fn span(block: &DMatrix<f64>) -> Basis {
    let svd = Svd::new(block.clone());
    let columns: Vec<Vector6<f64>> = (0..svd.values.len())
        .filter(|&i| svd.values[i] > TOLERANCE)
        .map(|i| Vector6::from_iterator(svd.image.column(i).iter().copied()) / svd.values[i])
        .collect();
    Basis::span(&columns)
}

/// The normalised frame of a mechanism: from all its joint axes, and their points as given.
pub fn frame(mechanism: &Mechanism) -> Frame {
    let axes: Vec<_> = mechanism
        .joints()
        .flat_map(|joint| joint.screws().into_iter().map(|screw| (screw, joint.point)))
        .collect();
    Frame::of(&axes)
}

#[cfg(test)]
mod tests;
