//! Mobility at the assembled home pose: the number of freedoms of the mechanism, whether the
//! actuators control all of them, and whether home is a singular pose.
//!
//! Everything follows from the loop closure: joint rates `q̇` and a platform twist `t` are a
//! first-order motion exactly if `J_k q̇_k = t` for every leg `k`.

mod linkage;
mod singular;

pub use singular::HomeSingularity;
pub(crate) use singular::{assembled, share};

use super::motions;
use crate::group::subspace::{Basis, Frame, SubspaceClass, TOLERANCE, fit};
use crate::mechanism::Mechanism;
use crate::mechanism::file::FileUnits;
use crate::numeric::svd::{Svd, singular_values};
use linkage::Linkage;
use nalgebra::{DMatrix, Vector6};
use singular::Nearby;
use thiserror::Error;

/// Largest supported number of freedoms of all joints together. Each leg is looked at by itself: the time grows about as
/// this number does.
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
    /// Those of the `mobility` freedoms that do not move the platform at poses near home, such as a strut that spins
    /// between two spherical joints.
    pub idle: usize,
    /// The number of freedoms of the actuated joints.
    pub actuators: usize,
    /// How many of the mechanism's freedoms the actuators control at assembled poses near home: `mobility` minus the
    /// freedoms left when the actuators are locked. At home itself they control fewer where it is a
    /// [parallel singularity](HomeSingularity::Parallel).
    pub controlled: usize,
    /// Names of the actuated joints that are redundant: each of them, alone, could be made passive
    /// without losing control at poses near home. Empty unless `actuators > controlled`.
    pub redundant: Vec<String>,
    /// The motions of the platform that are left when all actuators are locked, at home as at poses nearby: independent
    /// twists, each given as the motion that it generates. Those that are left at home alone are in `singular`.
    pub loose: Vec<SubspaceClass>,
    /// Every respect in which home is more degenerate than assembled poses nearby; empty if home is
    /// regular.
    pub singular: Vec<HomeSingularity>,
    /// The coordinates of an assembled pose near home, joint by joint: radians, and lengths in that of the
    /// [`frame`]. `None` if there is none.
    pub(crate) nearby: Option<Vec<f64>>,
    /// The units of the mechanism's file, for messages.
    pub(crate) units: FileUnits,
}

impl Mobility {
    /// What people have to know about a home that is a parallel singularity, in one sentence; `None` if it is none, if it
    /// is singular in another respect, too, or if the actuators control as little at poses nearby.
    pub fn parallel_home(&self) -> Option<String> {
        let [HomeSingularity::Parallel { loose, .. }] = &self.singular[..] else { return None };
        if !self.loose.is_empty() {
            return None;
        }
        let moves = match loose.is_empty() {
            true => "a joint that does not move the platform".to_owned(),
            false => format!("the platform ({})", motions(loose, self.units)),
        };
        Some(format!(
            "the home pose is a parallel singularity: there, but not at poses nearby, the locked actuators do not hold \
             {moves}; rates, forces and errors cannot be told at home itself, and iterations \
             of forward kinematics have to start elsewhere"
        ))
    }
}

/// Counts freedoms and actuators at home, and finds its singularities.
///
/// # Errors
/// [`MobilityError`] if the mechanism has fewer than two legs, a leg without joints, a number that
/// is not finite, or more than [`MAX_FREEDOMS`] freedoms.
pub fn mobility(mechanism: &Mechanism) -> Result<Mobility, MobilityError> {
    let linkage = Linkage::new(mechanism)?;
    let home = linkage.first_order(&linkage.home());
    let nearby = Nearby::new(&linkage, &home);
    let ranks = nearby.at_home(&home);
    let (motions, mobility) = (&ranks.motions, ranks.mobility());

    let at_home = nearby.controlled(&linkage.controls(motions));
    let loose = loose_twists(&linkage, motions, at_home);
    let motion = |twist: &Vector6<f64>| Some(fit(&[*twist])?.class.restored(&linkage.frame));
    let mut loose: Vec<SubspaceClass> = loose.vectors().iter().filter_map(motion).collect();

    let names = mechanism.legs.iter().map(|leg| &*leg.name);
    let mut singular = singular::singularities(&nearby, &ranks, names);
    let mut controlled = at_home;
    if let Some(generic) = &nearby.generic {
        controlled = at_home.max(generic.controlled);
        let [home, nearby] =
            [mobility - at_home, generic.mobility.saturating_sub(generic.controlled)];
        if home > nearby {
            singular.push(HomeSingularity::Parallel { home, nearby, loose: loose.clone() });
        }
        if generic.loose == 0 {
            loose.clear();
        }
    }
    Ok(Mobility {
        lambda: ranks.lambda,
        mobility,
        idle: nearby.generic.as_ref().map_or(mobility - platform(motions), |generic| generic.idle),
        actuators: linkage.actuated_rows().count(),
        controlled,
        redundant: redundant(mechanism, &linkage, &nearby, controlled),
        loose,
        singular,
        nearby: nearby.coordinates,
        units: mechanism.units,
    })
}

/// The actuated joints whose rates follow from those of the other actuated joints at poses near home.
fn redundant(
    mechanism: &Mechanism,
    linkage: &Linkage,
    nearby: &Nearby,
    controlled: usize,
) -> Vec<String> {
    let mut row = 0;
    let mut redundant = vec![];
    if linkage.actuated_rows().count() <= controlled {
        return redundant;
    }
    for joint in mechanism.joints() {
        let rows: Vec<usize> = (row..row + joint.freedoms()).collect();
        row += joint.freedoms();
        if joint.actuated && nearby.spares(linkage, &rows) {
            redundant.push(joint.name.clone());
        }
    }
    redundant
}

/// The singular values of rows taken from orthonormal columns, largest first. Their natural size is one.
fn absolute_values(rows: DMatrix<f64>) -> Vec<f64> {
    let mut values = singular_values(rows);
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// The twists of the platform among motions, given as orthonormal columns, of which the actuators control this many.
fn loose_twists(linkage: &Linkage, motions: &DMatrix<f64>, controlled: usize) -> Basis {
    if controlled == motions.ncols() {
        return Basis::span(&[]);
    }
    let rows: Vec<usize> = linkage.actuated_rows().collect();
    let right = match rows.is_empty() {
        true => DMatrix::identity(motions.ncols(), motions.ncols()),
        false => Svd::new(motions.select_rows(&rows)).right,
    };
    let free = motions * right.columns(controlled, right.ncols() - controlled);
    span(&free.rows(free.nrows() - 6, 6).into_owned())
}

/// How many independent twists of the platform motions have that are orthonormal columns. Idle motions, whose twists are
/// nearly zero, do not count.
fn platform(motions: &DMatrix<f64>) -> usize {
    let values = singular_values(motions.rows(motions.nrows() - 6, 6).into_owned());
    values.iter().filter(|&&value| value > TOLERANCE).count()
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
