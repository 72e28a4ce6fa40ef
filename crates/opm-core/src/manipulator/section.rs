//! One section of a leg: its chain, and what its joints are in the mechanism.

use crate::chain::condition::Condition;
use crate::chain::limits::Limits;
use crate::chain::partial::PartialChain;
use crate::chain::shape::Shape;
use crate::chain::shell::Shell;
use crate::chain::{Branch, Chain, ChainJoint, ReachDeficit};
use crate::decomposition::Freedom;
use crate::group::{Displacement, JointDisplacement};
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
use nalgebra::{Complex, Unit, Vector3};

/// The joint coordinate that a joint of a chain stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainCoordinate {
    /// The number of the joint coordinate in the mechanism.
    pub number: usize,
    /// Its number among the actuated coordinates; `None` where it is passive.
    pub actuated: Option<usize>,
    /// Its value at home, radians or metres.
    pub home: f64,
    pub limits: Limits,
    /// Whether its joint has a cone.
    pub cone: bool,
}

/// One section of a leg: its chain, and the chain's joint coordinates.
#[derive(Clone, Debug)]
pub(crate) struct CompiledSection {
    pub chain: Chain,
    /// The screws of the chain's joints at home: see `chain::screws`.
    pub screws: [Vector3<f64>; 3],
    /// The unit of the determinant of the screws: see `chain::screws::determinant_scale`.
    pub scale: f64,
    /// The joint coordinates of the chain's joints, base first; `None` for the imaginary joint, and for
    /// elements beyond the chain's freedoms.
    pub coordinates: [Option<ChainCoordinate>; 3],
    /// Whether any of its coordinates has limits.
    pub limited: bool,
    /// Whether any of its joints is held when the inputs are locked: it is actuated, or locked always.
    pub driven: bool,
    /// The joints that move, where these are fewer than the subspace has dimensions; then the chain is completed
    /// by locked joints.
    pub partial: Option<PartialChain>,
    /// What the section's displacement is multiplied by, on its right, to be what the chain has to reach: see
    /// [`lift`](super::lift). `None` where that is the displacement itself, and the chain has no
    /// [`slider`](Self::slider).
    pub offset: Option<Displacement>,
    /// The imaginary joint, where the chain has a part of it alone: see [`lift`](super::lift).
    pub slider: Option<Slider>,
}

/// A slider of a chain in the plane that is the part in the plane of an inclined imaginary joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slider {
    /// Its number in the chain.
    pub joint: usize,
    /// Its displacement for a unit of the imaginary joint's.
    pub rate: f64,
}

impl CompiledSection {
    /// The joints' displacements that move the outer link by `target`: see [`Chain::inverse`]. A section that
    /// constrains the platform has one solution, if `target` satisfies its constraints.
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
    #[inline(always)]
    pub fn inverse(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let mut found = [JointDisplacement::Value(0.0); 3];
        self.solve(target, branch, &mut found)?;
        Ok(found)
    }

    /// Writes what [`CompiledSection::inverse`] returns; nothing where the target is out of reach.
    #[inline(always)]
    pub fn solve(
        &self,
        target: &Displacement,
        branch: Branch,
        out: &mut [JointDisplacement; 3],
    ) -> Result<(), ReachDeficit> {
        match (&self.partial, &self.offset) {
            (None, None) => return self.chain.solve(target, branch, out),
            _ => *out = self.inverse_otherwise(target, branch)?,
        }
        Ok(())
    }

    /// The same for a section that constrains the platform or has an offset. It is not inlined: every caller of
    /// [`Self::solve`] would have a second copy of all chains.
    #[inline(never)]
    fn inverse_otherwise(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let found = match &self.partial {
            Some(partial) => partial.inverse(target),
            None => self.chain.inverse(&self.of_chain(target), branch)?,
        };
        Ok(self.with_imaginary(found))
    }

    /// The displacements of the section's joints from those of its chain's: of an inclined imaginary joint, the chain has
    /// a part.
    #[inline]
    fn with_imaginary(&self, mut found: [JointDisplacement; 3]) -> [JointDisplacement; 3] {
        if let Some(Slider { joint, rate }) = self.slider {
            found[joint] = JointDisplacement::Value(found[joint].value() / rate);
        }
        found
    }

    /// The displacement of a joint of the chain from that of the section's joint.
    fn in_chain(&self, joint: usize, displacement: JointDisplacement) -> JointDisplacement {
        match self.slider {
            Some(slider) if slider.joint == joint => {
                JointDisplacement::Value(displacement.value() * slider.rate)
            }
            _ => displacement,
        }
    }

    /// The branch with a known displacement of the first joint: see [`Chain::branch_with`].
    #[inline(always)]
    pub fn branch_with(
        &self,
        target: &Displacement,
        first: Complex<f64>,
        within: f64,
    ) -> Option<Branch> {
        match (&self.partial, &self.offset) {
            (None, None) => self.chain.branch_with(target, first, within),
            _ => None,
        }
    }

    /// The first joint's displacement alone: see [`Chain::first`].
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
    #[inline(always)]
    pub fn first(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<JointDisplacement, ReachDeficit> {
        match (&self.partial, &self.offset) {
            (None, None) => self.chain.first(target, branch),
            _ => Ok(self.inverse_otherwise(target, branch)?[0]),
        }
    }

    /// What the chain has to reach for a displacement of the section.
    pub fn of_chain(&self, target: &Displacement) -> Displacement {
        self.offset.as_ref().map_or(*target, |offset| target.after(offset))
    }

    /// The condition on the section's displacement that one of its joints imposes, held at a displacement: see
    /// [`Condition::new`].
    pub fn condition(&self, joint: usize, displacement: JointDisplacement) -> Option<Condition> {
        let condition = Condition::new(&self.chain, joint, self.in_chain(joint, displacement))?;
        Some(match &self.offset {
            None => condition,
            Some(offset) => condition.before(offset),
        })
    }

    /// The region in which the section closes, on each branch; `None` where it is not a region of the plane.
    pub fn shapes(&self) -> [Option<Shape>; 2] {
        let limits = |c: &'_ Option<ChainCoordinate>| c.map_or(Limits::Free, |c| c.limits);
        let of_joint = self.coordinates.each_ref().map(limits);
        let of_joint = of_joint.each_ref();
        Branch::BOTH.map(|branch| self.chain.shape(branch, of_joint))
    }

    /// The region in which the section closes whatever its limits on angles, on each branch, where these make the region in
    /// which it closes more than [`CompiledSection::shapes`] can tell.
    pub fn bounds(&self) -> [Option<Shape>; 2] {
        let of_joint = [0, 1, 2].map(|joint| match &self.coordinates[joint] {
            Some(c) if !self.chain.is_rotation(joint) => &c.limits,
            Some(_) | None => &Limits::Free,
        });
        Branch::BOTH.map(|branch| self.chain.shape(branch, of_joint))
    }

    /// The targets of a sphere at which the section closes, whatever its limits of the first and the last joint, on each
    /// branch.
    pub fn shells(&self) -> [Option<Shell>; 2] {
        let Chain::Spherical(chain) = &self.chain else { return [None; 2] };
        let middle = self.coordinates[1].as_ref().map_or(&Limits::Free, |middle| &middle.limits);
        Branch::BOTH.map(|branch| chain.shell(branch, middle))
    }

    /// Whether its joints are those of a spherical joint.
    pub fn is_ball(&self) -> bool {
        self.chain.is_ball()
    }

    /// Whether a target has two solutions.
    pub fn has_choice(&self) -> bool {
        self.partial.is_none() && self.chain.has_choice()
    }

    /// The branches on which a target may have a solution.
    pub fn branches(&self) -> &'static [Branch] {
        if self.has_choice() { &Branch::BOTH } else { &Branch::BOTH[..1] }
    }

    /// Whether a joint of the chain is held when the inputs are locked: it is actuated, or locked always.
    #[inline]
    pub fn is_held(&self, joint: usize) -> bool {
        self.coordinates[joint].is_some_and(|joint| joint.actuated.is_some())
            || self.is_locked(joint)
    }

    /// Whether a joint of the chain never moves: it completes a section with too few freedoms.
    pub fn is_locked(&self, joint: usize) -> bool {
        self.partial.is_some_and(|partial| partial.locked()[joint])
    }

    /// Whether the displacements of this section's chain are within the limits.
    #[inline]
    pub fn admits(&self, displacements: &[JointDisplacement; 3]) -> bool {
        !self.limited
            || self.coordinates.iter().zip(displacements).all(|(coordinate, &displacement)| {
                coordinate.as_ref().is_none_or(|joint| joint.limits.admits(displacement))
            })
    }
}

/// The freedoms of a section as chain joints; the three freedoms of a spherical joint are one chain joint.
pub(crate) fn chain_joints(leg: &Leg, freedoms: &[Freedom]) -> Vec<ChainJoint> {
    let mut joints = Vec::with_capacity(3);
    for freedom in freedoms {
        let joint = &leg.joints[freedom.joint];
        let screw =
            |axis: Unit<Vector3<f64>>, pitch| ChainJoint::Screw { axis, point: joint.point, pitch };
        joints.push(match joint.kind {
            JointKind::Spherical if freedom.index > 0 => continue,
            JointKind::Spherical => ChainJoint::Ball,
            JointKind::Prismatic => ChainJoint::Slide { axis: joint.axis },
            JointKind::Cylindrical if freedom.index == 1 => ChainJoint::Slide { axis: joint.axis },
            JointKind::Universal { second } if freedom.index == 1 => screw(second, 0.0),
            JointKind::Helical { pitch } => screw(joint.axis, pitch),
            JointKind::Revolute | JointKind::Cylindrical | JointKind::Universal { .. } => {
                screw(joint.axis, 0.0)
            }
        });
    }
    joints
}

/// The number of a freedom among the leg's coordinates.
pub(crate) fn coordinate_number(leg: &Leg, freedom: Freedom) -> usize {
    let before: usize =
        leg.joints[..freedom.joint].iter().map(crate::mechanism::joint::Joint::freedoms).sum();
    before + freedom.index
}
