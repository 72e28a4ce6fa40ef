//! One leg, split into two closed-form chains.

use super::lift::{self, Lean, Lift, Separated};
use crate::chain::condition::Condition;
use crate::chain::limits::Limits;
use crate::chain::partial::{PartialChain, completion};
use crate::chain::screws::{determinant_scale, screw, screws};
use crate::chain::shape::Shape;
use crate::chain::{Branch, Chain, ChainError, ChainJoint, ReachDeficit};
use crate::decomposition::{Freedom, HeightMiss, HeightReason, LegSplit};
use crate::group::{Displacement, JointDisplacement, MotionType, Subspace, SubspaceKind};
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
pub use crate::mechanism::leg::Section;
use crate::task::Task;
use nalgebra::{Unit, Vector3};

/// Why a leg has no closed form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefusedLeg {
    /// The leg's two sections have more freedoms than the subspaces, so that it can move with the platform held.
    #[error("{}", freedoms(*lower, *upper, *dim_lower, *dim_upper, *bridged))]
    Freedoms {
        /// The number of freedoms in its lower section.
        lower: usize,
        /// The number of freedoms in its upper section.
        upper: usize,
        /// The dimension of the lower subspace.
        dim_lower: usize,
        /// The dimension of the upper subspace; zero where all legs move in one subgroup.
        dim_upper: usize,
        /// Whether the two subspaces share a motion.
        bridged: bool,
    },
    /// Not exactly one joint of a Schoenflies section changes the height.
    #[error("{}", .0.of_leg())]
    Height(#[from] HeightMiss),
    /// One of the leg's sections has no closed form.
    #[error("its {section} section ({}) has no closed form: {error}", joints.join(", "))]
    Chain {
        /// The section.
        section: Section,
        /// The names of its joints, base first, and "the imaginary joint" if it belongs to the section.
        joints: Vec<String>,
        /// Why it has no closed form.
        error: ChainError,
    },
}

/// What the numbers of freedoms in a leg are, and how many they may be.
fn freedoms(
    lower: usize,
    upper: usize,
    dim_lower: usize,
    dim_upper: usize,
    bridged: bool,
) -> String {
    let plural = if lower == 1 { "" } else { "s" };
    if dim_upper == 0 {
        return format!(
            "{lower} freedom{plural}, expected {dim_lower} at most, those of its subspace"
        );
    }
    let expected = if bridged {
        format!("at most {dim_lower} and {}, or {} and {dim_upper}", dim_upper - 1, dim_lower - 1)
    } else {
        format!("at most {dim_lower} and {dim_upper}")
    };
    format!(
        "{lower} freedom{plural} in its lower section and {upper} in its upper one, expected {expected}: \
         it can move while the platform is held"
    )
}

/// The joint coordinate that a joint of a chain stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainCoordinate {
    /// The number of the joint coordinate in the mechanism.
    pub number: usize,
    /// Its number among the actuated coordinates; `None` where it is passive.
    pub actuated: Option<usize>,
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
    /// [`lift`](super::lift). `None` where that is the displacement itself.
    pub offset: Option<Displacement>,
}

/// A leg, split into two sections.
#[derive(Clone, Debug)]
pub(crate) struct CompiledLeg {
    pub lower: CompiledSection,
    pub upper: CompiledSection,
    /// The section that the imaginary joint belongs to. It is solved first. Where the subspaces share the
    /// identity alone, there is no imaginary joint, and the upper section is solved first.
    pub split_section: Section,
    /// Whether the subspaces share a motion, along which the leg has an imaginary joint.
    bridged: bool,
    /// The number of its imaginary joint among those that are reported; `None` where it is not reported.
    pub imaginary: Option<usize>,
    /// The region in which the lower section closes, on each branch; `None` where it is not a region of the
    /// plane.
    pub shapes: [Option<Shape>; 2],
    /// Whether the upper section constrains the leg: it is limited or actuated, or may be out of reach though
    /// the lower section closes.
    pub upper_constrains: bool,
    /// Whether the imaginary joint rotates about an axis on which full revolutions are counted.
    pub unwinds: bool,
    /// The joint that carries the height of a Schoenflies section.
    pub lift: Option<Lift>,
    /// What that joint does in the plane, where it leans.
    pub lean: Option<Lean>,
}

/// What compiling a leg needs to know of the manipulator.
#[derive(Clone, Copy)]
pub(crate) struct CompileContext<'a> {
    pub task: &'a Task,
    /// For each joint coordinate, its number among the actuated ones; `None` where it is passive.
    pub actuated: &'a [Option<usize>],
    pub limits: &'a [Limits],
    /// The characteristic length of the mechanism, metres.
    pub size: f64,
}

/// One solution of a leg: the displacements of its joints from home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegSolution {
    pub lower: [JointDisplacement; 3],
    pub upper: [JointDisplacement; 3],
    /// The displacement along the intersection motion.
    pub tau: JointDisplacement,
}

impl LegSolution {
    /// The displacements of a section's joints.
    pub fn section(&self, section: Section) -> &[JointDisplacement; 3] {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }

    /// All joints at home.
    pub const HOME: Self = {
        let none = JointDisplacement::Value(0.0);
        Self { lower: [none; 3], upper: [none; 3], tau: none }
    };
}

impl CompiledLeg {
    /// Compiles `leg`, whose first joint coordinate has the number `first` in the mechanism.
    pub fn new(
        leg: &Leg,
        split: &LegSplit,
        first: usize,
        context: CompileContext<'_>,
    ) -> Result<Self, RefusedLeg> {
        let task = context.task;
        let separated = lift::separate(leg, split, first, context)?;
        let split = separated.as_ref().map_or(split, |separated| &separated.rest);
        let (dim_lower, dim_upper) = (task.lower.dimension(), task.upper.dimension());
        let (lower, upper) = (split.lower.len(), split.upper.len());
        let bridged = task.intersection.is_some();
        let preferred = split_section(task, [lower, upper]).ok_or_else(|| {
            // A message counts the lift, too.
            let of_height = |section| {
                usize::from(task.height.as_ref().is_some_and(|height| height.section == section))
            };
            let (low, high) = (of_height(Section::Lower), of_height(Section::Upper));
            RefusedLeg::Freedoms {
                lower: lower + low,
                upper: upper + high,
                dim_lower: dim_lower + low,
                dim_upper: dim_upper + high,
                bridged,
            }
        })?;
        let found = Self::split_in(preferred, leg, split, first, context);
        // A section may contain the intersection motion itself, though it has few joints. Then the imaginary joint
        // belongs to the other one.
        let other = match preferred {
            Section::Lower => Section::Upper,
            Section::Upper => Section::Lower,
        };
        let room = match other {
            Section::Lower => lower < dim_lower,
            Section::Upper => upper < dim_upper,
        };
        let found = match found {
            Err(error) if bridged && room => {
                Self::split_in(other, leg, split, first, context).map_err(|_| error)
            }
            found => found,
        };
        let mut compiled = found?;
        let Some(Separated { lift, mut lean, joint, .. }) = separated else { return Ok(compiled) };
        if let Some(Lean { section, before, .. }) = &mut lean {
            if compiled.section(*section).partial.is_some() {
                // What its locked joints demand would depend on the height.
                let reason = HeightReason::Constraining(leg.joints[joint].name.clone());
                return Err(HeightMiss { leg: leg.name.clone(), reason }.into());
            }
            *before += usize::from(
                compiled.bridge() == Some(Section::Upper) && *section == Section::Upper,
            );
        }
        (compiled.lift, compiled.lean) = (Some(lift), lean);
        Ok(compiled)
    }

    /// The same for a given section that the imaginary joint belongs to.
    fn split_in(
        split_section: Section,
        leg: &Leg,
        split: &LegSplit,
        first: usize,
        CompileContext { task, actuated, limits, size }: CompileContext<'_>,
    ) -> Result<Self, RefusedLeg> {
        let bridged = task.intersection.is_some();
        let imaginary_joint = task.intersection.as_ref().map(|axis| match axis.point {
            Some(point) => ChainJoint::Screw { axis: axis.direction, point, pitch: 0.0 },
            None => ChainJoint::Slide { axis: axis.direction },
        });
        let compile = |section: Section, subspace: &Subspace, freedoms: &[Freedom]| {
            let mut joints = chain_joints(leg, freedoms);
            let mut coordinates = [None; 3];
            let first_is_imaginary =
                bridged && section == Section::Upper && section == split_section;
            let shift = usize::from(first_is_imaginary);
            for (slot, freedom) in coordinates[shift..].iter_mut().zip(freedoms) {
                let number = first + coordinate_number(leg, *freedom);
                *slot = Some(ChainCoordinate { number, actuated: actuated[number] });
            }
            let refused = |error| {
                let mut joints: Vec<String> =
                    freedoms.iter().map(|f| leg.joints[f.joint].name.clone()).collect();
                joints.dedup();
                if bridged && section == split_section {
                    joints.push("the imaginary joint".into());
                }
                RefusedLeg::Chain { section, joints, error }
            };
            let bridge = imaginary_joint.filter(|_| section == split_section);
            let bridge_at = if section == Section::Upper { 0 } else { joints.len() };
            joints.splice(bridge_at..bridge_at, bridge);
            // A section with too few freedoms is completed by locked joints, on the side of its other end.
            let mut partial = None;
            let mut locked = [false; 3];
            if freedoms.len() + usize::from(bridge.is_some()) < subspace.dimension() {
                let free: Result<Vec<_>, _> =
                    joints.iter().map(|joint| screw(subspace, joint)).collect();
                let added = completion(subspace, &free.map_err(refused)?, size);
                let at = freedoms.len() + shift;
                locked[at..at + added.len()].fill(true);
                joints.splice(at..at, added);
                partial = Some(locked);
            }
            let chain = Chain::new(subspace, &joints).map_err(refused)?;
            let screws = screws(subspace, &joints).map_err(refused)?;
            let partial = partial.map(|locked| PartialChain::new(subspace.kind, screws, locked));
            let own = || coordinates.iter().flatten();
            Ok::<_, RefusedLeg>(CompiledSection {
                chain,
                screws,
                scale: determinant_scale(subspace.kind, &screws, size),
                coordinates,
                limited: own().any(|c| limits[c.number].any()),
                driven: partial.is_some() || own().any(|c| c.actuated.is_some()),
                partial,
                offset: None,
            })
        };
        let lower = compile(Section::Lower, &task.lower, &split.lower)?;
        let upper = compile(Section::Upper, &task.upper, &split.upper)?;
        let of_joint = lower.coordinates.map(|c| c.map_or(&Limits::Free, |c| &limits[c.number]));
        let shapes = Branch::BOTH.map(|branch| lower.chain.shape(branch, of_joint));
        // An upper section that does not give τ may be out of reach; a spherical joint never is.
        let gives_tau = bridged && split_section == Section::Upper;
        let may_fail = !gives_tau && !matches!(upper.chain, Chain::Ball(_) | Chain::Rigid);
        Ok(Self {
            upper_constrains: upper.limited || upper.driven || may_fail,
            lower,
            upper,
            split_section,
            bridged,
            shapes,
            imaginary: None,
            lift: None,
            lean: None,
            unwinds: task.shared() == Some(MotionType::Rotation)
                && [&task.lower, &task.upper].iter().any(|s| s.kind == SubspaceKind::Cylindrical),
        })
    }

    /// Whether an actuated joint carries the height.
    pub fn drives_height(&self) -> bool {
        self.lift.is_some_and(|lift| lift.coordinate.actuated.is_some())
    }

    /// The sections in the order in which they are solved.
    pub fn order(&self) -> [Section; 2] {
        match self.split_section {
            Section::Upper => [Section::Upper, Section::Lower],
            Section::Lower => [Section::Lower, Section::Upper],
        }
    }

    /// The section that the imaginary joint belongs to; `None` where the subspaces share the identity alone.
    #[inline]
    pub fn bridge(&self) -> Option<Section> {
        self.bridged.then_some(self.split_section)
    }

    /// The number of the imaginary joint in the chain of the section that it belongs to.
    #[inline(always)]
    pub fn imaginary_joint(&self) -> Option<usize> {
        self.bridge().map(|section| match section {
            Section::Upper => 0,
            Section::Lower => self.lower.chain.freedoms() - 1,
        })
    }

    /// The displacement of the imaginary joint among those of the chain that it belongs to; zero without one.
    #[inline(always)]
    pub fn step(&self, displacements: &[JointDisplacement; 3]) -> JointDisplacement {
        self.imaginary_joint().map_or(JointDisplacement::Value(0.0), |joint| displacements[joint])
    }

    /// The displacement of the imaginary joint of a leg that is split in its upper section; cheaper than
    /// solving that section.
    #[inline(always)]
    pub fn first_step(
        &self,
        b: &Displacement,
        branch: Branch,
    ) -> Result<JointDisplacement, ReachDeficit> {
        let first = self.upper.first(b, branch)?;
        Ok(if self.bridged { first } else { JointDisplacement::Value(0.0) })
    }

    pub fn section(&self, section: Section) -> &CompiledSection {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }

    /// The lower joints' displacements and that along the intersection motion, within π where revolutions are
    /// counted, at a height above home, metres. This suffices for a leg that its upper section does not constrain.
    #[inline(always)]
    pub fn solve_actuated(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
    ) -> Result<([JointDisplacement; 3], JointDisplacement), ReachDeficit> {
        if self.lean.is_some() {
            let solution = self.solve_raised(task, [v, b], rise, branches, 0.0);
            return solution.map(|found| (found.lower, found.tau)).map_err(|(_, missed)| missed);
        }
        match self.split_section {
            Section::Upper => {
                let tau = self.unwound(self.first_step(b, branches.upper)?, 0.0);
                let lower = self.solve_lower(task, v, tau, branches.lower)?;
                Ok((lower, tau))
            }
            Section::Lower => {
                let lower = self.lower.inverse(v, branches.lower)?;
                Ok((lower, self.step(&lower).inverse()))
            }
        }
    }

    /// Solves the closure for `v · b`, at a height above home, metres. Where revolutions are counted, the displacement
    /// along the intersection motion is taken nearest to `near`.
    #[inline(always)]
    pub fn solve(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
    ) -> Result<LegSolution, (Section, ReachDeficit)> {
        if self.lean.is_some() {
            return self.solve_raised(task, [v, b], rise, branches, near);
        }
        let of = |section: Section| move |deficit: ReachDeficit| (section, deficit);
        match self.split_section {
            Section::Upper => {
                let upper = self.upper.inverse(b, branches.upper).map_err(of(Section::Upper))?;
                let tau = self.unwound(self.step(&upper), near);
                let lower =
                    self.solve_lower(task, v, tau, branches.lower).map_err(of(Section::Lower))?;
                Ok(LegSolution { lower, upper, tau })
            }
            Section::Lower => {
                let lower = self.lower.inverse(v, branches.lower).map_err(of(Section::Lower))?;
                // L · exp(I c) = v, with c the imaginary joint's displacement: τ = -c and U = exp(I c) · b.
                let step = self.unwound(self.step(&lower), -near);
                let target = task.upper_intersection.before(b, step);
                let upper =
                    self.upper.inverse(&target, branches.upper).map_err(of(Section::Upper))?;
                Ok(LegSolution { lower, upper, tau: step.inverse() })
            }
        }
    }

    /// The same for a leg whose lift leans.
    #[cold]
    #[inline(never)]
    fn solve_raised(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
    ) -> Result<LegSolution, (Section, ReachDeficit)> {
        self.at(rise)?.solve(task, [v, b], rise, branches, near)
    }

    /// The region in which the lower section closes, if it is a region of the plane.
    pub fn shape(&self, branch: Branch) -> Option<&Shape> {
        let [plus, minus] = &self.shapes;
        match branch {
            Branch::Plus => plus.as_ref(),
            Branch::Minus => minus.as_ref(),
        }
    }

    /// Whether the imaginary joint rotates about an axis on which full revolutions are counted.
    pub fn unwinds(&self) -> bool {
        self.unwinds
    }

    /// The displacement along the intersection motion, as the angle nearest to `near` where revolutions are
    /// counted.
    #[inline(always)]
    pub fn unwound(&self, tau: JointDisplacement, near: f64) -> JointDisplacement {
        if self.unwinds { JointDisplacement::Value(tau.nearest(near)) } else { tau }
    }

    /// Solves `L = v · exp(I τ)` for the lower joints.
    #[inline(always)]
    pub fn solve_lower(
        &self,
        task: &Task,
        v: &Displacement,
        tau: JointDisplacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        self.lower.inverse(&task.lower_intersection.after(v, tau), branch)
    }
}

/// The section that the imaginary joint of a leg with these numbers of freedoms belongs to; `None` if the leg has
/// too many freedoms.
///
/// A leg with one freedom less than both subspaces together lacks it in one of its sections. One with fewer
/// freedoms constrains the platform. Then the section that is taken modulo the intersection motion (see
/// [`task`](crate::task)) has the imaginary joint, if there is room for it: its coordinates alone then tell the
/// displacement of the imaginary joint, and the constraints of the other section follow.
fn split_section(task: &Task, [lower, upper]: [usize; 2]) -> Option<Section> {
    let (dim_lower, dim_upper) = (task.lower.dimension(), task.upper.dimension());
    if lower > dim_lower || upper > dim_upper {
        return None;
    }
    match task.shared() {
        None => Some(Section::Upper),
        Some(_) if lower == dim_lower && upper == dim_upper => None,
        Some(MotionType::Rotation) if lower < dim_lower => Some(Section::Lower),
        Some(MotionType::Rotation) => Some(Section::Upper),
        Some(MotionType::Translation) if upper < dim_upper => Some(Section::Upper),
        Some(MotionType::Translation) => Some(Section::Lower),
    }
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
        match (&self.partial, &self.offset) {
            (None, None) => self.chain.inverse(target, branch),
            (None, Some(offset)) => self.chain.inverse(&target.after(offset), branch),
            (Some(partial), _) => Ok(partial.inverse(target)),
        }
    }

    /// The first joint's displacement alone: see [`Chain::first`].
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
    #[inline(always)]
    fn first(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<JointDisplacement, ReachDeficit> {
        match (&self.partial, &self.offset) {
            (None, None) => self.chain.first(target, branch),
            (None, Some(offset)) => self.chain.first(&target.after(offset), branch),
            (Some(partial), _) => Ok(partial.inverse(target)[0]),
        }
    }

    /// The condition on the section's displacement that one of its joints imposes, held at a displacement: see
    /// [`Condition::new`].
    pub fn condition(&self, joint: usize, displacement: JointDisplacement) -> Option<Condition> {
        let condition = Condition::new(&self.chain, joint, displacement)?;
        Some(match &self.offset {
            None => condition,
            Some(offset) => condition.before(offset),
        })
    }

    /// Whether a target has two solutions.
    pub fn has_choice(&self) -> bool {
        self.partial.is_none() && self.chain.has_choice()
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
    pub fn admits(&self, limits: &[Limits], displacements: &[JointDisplacement; 3]) -> bool {
        !self.limited
            || self.coordinates.iter().zip(displacements).all(|(coordinate, &displacement)| {
                match coordinate {
                    Some(coordinate) => limits[coordinate.number].admits(displacement),
                    None => true,
                }
            })
    }
}

/// The branch of each section's chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LegBranches {
    pub lower: Branch,
    pub upper: Branch,
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
