//! The loop of one section: joints inside one subspace that form a closed chain,
//!
//! ```text
//! exp(a₀q₀) exp(a₁q₁) ... exp(aₙqₙ) = 1
//! ```
//!
//! given in the order of the loop, at home, where all `q` are zero. There is one joint more than the
//! subspace has dimensions, so the loop has one freedom. A cyclic shift of the factors is a
//! conjugation and leaves the product the identity, so any joint can be `a₀`, the driving joint. The
//! others are then an ordinary chain of that subspace with a known target,
//!
//! ```text
//! exp(a₁q₁) ... exp(aₙqₙ) = exp(-a₀q₀)
//! ```
//!
//! and [`Chain`] has its closed form. This covers every loop with a closed form:
//!
//! | subspace | loops | chains |
//! |---|---|---|
//! | planar | four-bar RRRR; slider-crank RRRP and its inversions; double sliders RRPP, RPRP | RRR; PRR, RRP, RPR; RPP, PPR, PRP |
//! | spherical | four-bar RRRR | RRR |
//! | cylindrical | three coaxial joints of different pitch | two coaxial joints |
//! | translational plane | three sliders | two sliders |
//! | translational space | four sliders | three sliders |
//!
//! The loop closes up to inputs at which the chain's two branches meet: the *dead points*, where two
//! links are folded or stretched, or a link is perpendicular to its slider. They are those targets of
//! the chain at which its middle joint is held at a fold ([`Surface`](crate::chain::surface)), and
//! have a closed form along `exp(-a₀q₀)`.
//!
//! * Folded or stretched links count as closing; the two branches meet there.
//! * An angle that is free keeps its home value, zero (a kite whose links lie on each other).
//! * A change point is a dead point that the input passes without leaving the range. A branch keeps
//!   its sign on both sides; the smooth motion changes it.
//! * A pivot between two sliders has *poles* instead: where the sliders become parallel, they run
//!   away to infinity.

use super::drive::Drive;
use crate::chain::limits::Limits;
use crate::chain::planar::PlanarChain;
use crate::chain::screws::screws;
use crate::chain::{Branch, Chain, ChainError, ChainJoint, ReachDeficit};
use crate::group::{JointDisplacement, LocalTwist, Subspace};
use nalgebra::Matrix3;
use std::f64::consts::TAU;

/// A closed loop of joints inside one subspace, at home.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionLoop {
    driven: Vec<DrivenLoop>,
}

/// A loop driven by one of its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivenLoop {
    drive: Drive,
    /// The chain of the other joints, in the order of the loop.
    chain: Chain,
    /// The screws of the chain's joints at home.
    screws: [LocalTwist; 3],
    dead_points: Vec<DeadPoint>,
    home: Branch,
}

/// A displacement of the driving joint at which the loop may stop closing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadPoint {
    /// The displacement, as a direction of unit length or a length.
    pub at: JointDisplacement,
    /// Whether a slider goes to infinity there. Otherwise, the two branches meet.
    pub is_pole: bool,
}

/// The least determinant of a loop's unit screws at which it has rates.
const SINGULAR: f64 = 1e-12;

impl SectionLoop {
    /// The loop of these joints, in its order, as they are at home, in base coordinates. What they deviate from the
    /// subspace by is dropped.
    ///
    /// # Errors
    /// [`ChainError`] if there is not one joint more than the subspace has dimensions, or if some of
    /// them are dependent in every position.
    pub fn new(subspace: &Subspace, joints: &[ChainJoint]) -> Result<Self, ChainError> {
        let driven = |input: usize| {
            let (before, after) = joints.split_at(input);
            let (driving, after) = (&after[0], &after[1..]);
            DrivenLoop::new(subspace, driving, &[after, before].concat())
        };
        Ok(Self { driven: (0..joints.len()).map(driven).collect::<Result<_, _>>()? })
    }

    /// The number of joints.
    pub fn joints(&self) -> usize {
        self.driven.len()
    }

    /// The loop driven by its joint with index `input`, modulo the number of joints.
    pub fn driven_by(&self, input: usize) -> &DrivenLoop {
        &self.driven[input % self.driven.len()]
    }
}

impl DrivenLoop {
    fn new(
        subspace: &Subspace,
        driving: &ChainJoint,
        others: &[ChainJoint],
    ) -> Result<Self, ChainError> {
        let (subspace, drive) = Drive::new(subspace, driving)?;
        let chain = Chain::new(&subspace, others)?;
        let is_pole = matches!(chain, Chain::Planar(PlanarChain::Prp(_)));
        let dead_point = |at| DeadPoint { at, is_pole };
        let folds = chain.folds(&Limits::Free);
        let zeros = folds.iter().flat_map(|(_, surface)| surface.along(&drive.path()).roots());
        let mut driven = Self {
            dead_points: zeros.map(|zero| dead_point(drive.at(zero))).collect(),
            screws: screws(&subspace, others)?,
            home: Branch::Plus,
            drive,
            chain,
        };
        driven.home = driven.branch_at_home();
        Ok(driven)
    }

    /// The branch in which no joint is displaced with the driving joint at home.
    fn branch_at_home(&self) -> Branch {
        let displaced = |branch| {
            let displacements = self.solve(JointDisplacement::Value(0.0), branch);
            displacements.map_or(f64::INFINITY, |displacements| {
                displacements.iter().map(|d| d.value().abs()).fold(0.0, f64::max)
            })
        };
        if self.has_choice() && displaced(Branch::Minus) < displaced(Branch::Plus) {
            Branch::Minus
        } else {
            Branch::Plus
        }
    }

    /// Whether the loop has two branches; otherwise `+` is the only one.
    pub fn has_choice(&self) -> bool {
        self.chain.has_choice()
    }

    /// The branches of the loop.
    pub fn branches(&self) -> &'static [Branch] {
        if self.has_choice() { &Branch::BOTH } else { &Branch::BOTH[..1] }
    }

    /// Whether the loop is on an axis on which full revolutions are counted.
    #[inline]
    pub fn counts_revolutions(&self) -> bool {
        matches!(self.chain, Chain::Cylindrical(_))
    }

    /// The displacements of the joints that follow the driving joint in the loop; those beyond the
    /// number of the loop's joints are zero. A direction must have unit length.
    ///
    /// # Errors
    /// The reach deficit if the loop does not close at this input.
    #[inline]
    pub fn solve(
        &self,
        input: JointDisplacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        self.chain.inverse(&self.drive.target(input), branch)
    }

    /// The displacement of the joint with this index after the driving joint, as a number: radians or
    /// metres. On an axis, full revolutions are counted. `None` if the loop does not close.
    pub fn counted(&self, input: JointDisplacement, branch: Branch, index: usize) -> Option<f64> {
        let target = self.drive.target(input);
        match &self.chain {
            Chain::Cylindrical(chain) => Some(chain.coordinates(target.cylindrical())[index]),
            Chain::Rigid
            | Chain::Part(_)
            | Chain::Planar(_)
            | Chain::Spherical(_)
            | Chain::Ball(_)
            | Chain::Translational(_)
            | Chain::Spatial(_) => {
                self.chain.inverse(&target, branch).ok().map(|found| found[index].value())
            }
        }
    }

    /// Whether the loop closes at this input.
    #[inline]
    pub fn closes(&self, input: JointDisplacement) -> bool {
        self.chain.first(&self.drive.target(input), Branch::Plus).is_ok()
    }

    /// The branch in which the loop is assembled at home.
    pub fn home(&self) -> Branch {
        self.home
    }

    /// The inputs, at most four, between which the loop changes between closing and not closing,
    /// and those at which it only folds.
    pub fn dead_points(&self) -> &[DeadPoint] {
        &self.dead_points
    }

    /// The rates of the joints that follow the driving joint, for a unit rate of that joint, at a
    /// position given by [`DrivenLoop::solve`]. `None` at a dead point, where they are infinite or
    /// free.
    pub fn rates(&self, displacements: &[JointDisplacement; 3]) -> Option<[f64; 3]> {
        let kind = self.drive.target(JointDisplacement::Value(0.0)).kind();
        let freedoms = self.chain.freedoms();
        let mut moved = Matrix3::identity();
        let mut so_far = kind.identity();
        for (i, (screw, step)) in self.screws.iter().zip(displacements).enumerate().take(freedoms) {
            moved.set_column(i, &so_far.adjoint(screw));
            so_far = so_far.after(&kind.exponential(&(screw * step.value())));
        }
        let scale: f64 = (0..3).map(|i| moved.column(i).norm()).product();
        let determinant = moved.determinant().abs();
        if determinant.is_nan() || determinant <= SINGULAR * scale {
            return None;
        }
        // The loop's twist is zero: a₀ + Σ aᵢ qᵢ' = 0, with each aᵢ where it is now.
        let rates = moved.lu().solve(&-self.drive.twist())?;
        Some(std::array::from_fn(|i| if i < freedoms { rates[i] } else { 0.0 }))
    }

    /// The period of the joint with this index after the driving joint: after so much, in radians or
    /// metres, the loop is as before. That of an angle is 2π. On an axis it is what the joint moves by
    /// while the driving joint, if it is a revolute, makes one revolution. Other joints have none.
    pub(super) fn period(&self, index: usize) -> Option<f64> {
        match &self.chain {
            Chain::Planar(chain) => chain.is_rotation(index).then_some(TAU),
            Chain::Spherical(_) | Chain::Ball(_) => Some(TAU),
            Chain::Cylindrical(_) if self.drive.is_rotation() => {
                let revolution = JointDisplacement::Value(TAU);
                self.counted(revolution, Branch::Plus, index).map(f64::abs)
            }
            Chain::Rigid
            | Chain::Part(_)
            | Chain::Cylindrical(_)
            | Chain::Translational(_)
            | Chain::Spatial(_) => None,
        }
    }
}

#[cfg(test)]
mod spherical_tests;
