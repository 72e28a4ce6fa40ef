//! One leg, split into two closed-form chains.

use super::cones::ConeLimit;
use super::lift::{self, Lean, Lift, Separated};
use super::refused::RefusedLeg;
use super::section::{ChainCoordinate, CompiledSection, Slider, chain_joints, coordinate_number};
use super::whole::Whole;
use crate::chain::partial::{PartialChain, completion};
use crate::chain::screws::{determinant_scale, screw, screws};
use crate::chain::shape::Shape;
use crate::chain::shell::Shell;
use crate::chain::{Branch, Chain, ChainJoint, ReachDeficit};
use crate::decomposition::{Decomposition, Freedom, HeightMiss, HeightReason, LegSplit};
use crate::group::{Displacement, JointDisplacement, MotionType, Subspace, SubspaceKind};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
pub use crate::mechanism::leg::Section;
use crate::task::Task;
use nalgebra::{Unit, Vector3};

/// A leg, split into two sections.
#[derive(Clone, Debug)]
pub(crate) struct CompiledLeg {
    pub lower: CompiledSection,
    pub upper: CompiledSection,
    /// The section that the imaginary joint belongs to. It is solved first. Where the subspaces share the
    /// identity alone, there is no imaginary joint, and the upper section is solved first.
    pub split_section: Section,
    /// Whether the subspaces share a motion, along which the leg has an imaginary joint.
    pub(super) bridged: bool,
    /// The number of its imaginary joint among those that are reported; `None` where it is not reported.
    pub imaginary: Option<usize>,
    /// The region in which the lower section closes, on each branch; `None` where it is not a region of the
    /// plane.
    pub shapes: [Option<Shape>; 2],
    /// Where it has none of these: see [`CompiledSection::bounds`].
    pub bounds: [Option<Shape>; 2],
    /// In a sphere: see [`CompiledSection::shells`].
    pub shells: [Option<Shell>; 2],
    /// Whether the upper section constrains the leg: it is limited or actuated, or may be out of reach though
    /// the lower section closes.
    pub upper_constrains: bool,
    /// Whether the imaginary joint rotates about an axis on which full revolutions are counted.
    pub unwinds: bool,
    /// The joint that carries the height of a Schoenflies section.
    pub lift: Option<Lift>,
    /// What that joint does in the plane, where it leans.
    pub lean: Option<Lean>,
    /// How it is solved whole; `None` where it is solved by its sections.
    pub whole: Option<Box<Whole>>,
    /// The cones of its joints.
    pub cones: Vec<ConeLimit>,
}

/// What compiling a leg needs to know of the manipulator.
#[derive(Clone, Copy)]
pub(crate) struct CompileContext<'a> {
    pub mechanism: &'a Mechanism,
    pub task: &'a Task,
    pub decomposition: &'a Decomposition,
    /// Every joint coordinate of the mechanism.
    pub coordinates: &'a [ChainCoordinate],
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
        let CompileContext { mechanism, decomposition, size, .. } = context;
        if let Some(whole) = decomposition.whole_leg(mechanism, leg, split, size) {
            return Ok(Self::whole(leg, whole?.into_owned(), first, context));
        }
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
            let name = || leg.joints[joint].name.clone();
            let refused = |reason| RefusedLeg::from(HeightMiss { leg: leg.name.clone(), reason });
            if compiled.section(*section).partial.is_some() {
                // What its locked joints demand would depend on the height.
                return Err(refused(HeightReason::Constraining(name())));
            }
            if compiled.section(*section).slider.is_some() {
                // What it does in the plane would depend on the imaginary joint, and that on the plane.
                return Err(refused(HeightReason::Inclined(name())));
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
        CompileContext { task, coordinates: all, size, .. }: CompileContext<'_>,
    ) -> Result<Self, RefusedLeg> {
        let bridged = task.intersection.is_some();
        // Of an inclined one, the chain of a Schoenflies section has the part in the plane.
        let in_plane = |axis: Unit<Vector3<f64>>| match &task.height {
            Some(height) if height.section == split_section && height.slope != 0.0 => {
                let part = axis.into_inner() - height.up * height.up.dot(&axis);
                let (axis, rate) = Unit::new_and_get(part);
                (axis, Some(rate))
            }
            Some(_) | None => (axis, None),
        };
        let imaginary = task.intersection.as_ref().map(|axis| match axis.point {
            Some(point) => (ChainJoint::Screw { axis: axis.direction, point, pitch: 0.0 }, None),
            None => {
                let (axis, rate) = in_plane(axis.direction);
                (ChainJoint::Slide { axis }, rate)
            }
        });
        let compile = |section: Section, subspace: &Subspace, freedoms: &[Freedom]| {
            let mut joints = chain_joints(leg, freedoms);
            let mut coordinates = [None; 3];
            let first_is_imaginary =
                bridged && section == Section::Upper && section == split_section;
            let shift = usize::from(first_is_imaginary);
            for (slot, freedom) in coordinates[shift..].iter_mut().zip(freedoms) {
                let number = first + coordinate_number(leg, *freedom);
                *slot = Some(all[number]);
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
            let (bridge, rate) = imaginary.filter(|_| section == split_section).unzip();
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
            let mut screws = screws(subspace, &joints).map_err(refused)?;
            let partial = partial.map(|locked| PartialChain::new(subspace.kind, screws, locked));
            let mut scale = determinant_scale(subspace.kind, &screws, size);
            let slider = rate.flatten().map(|rate| {
                let joint = if section == Section::Upper { 0 } else { joints.len() - 1 };
                // The screw is for a unit of the imaginary joint's displacement.
                screws[joint] *= rate;
                scale *= rate;
                Slider { joint, rate }
            });
            let own = || coordinates.iter().flatten();
            Ok::<_, RefusedLeg>(CompiledSection {
                chain,
                screws,
                scale,
                coordinates,
                limited: own().any(|c| c.limits.any() || c.cone),
                driven: partial.is_some() || own().any(|c| c.actuated.is_some()),
                partial,
                // See `CompiledSection::slider`.
                offset: slider.map(|_| subspace.kind.identity()),
                slider,
            })
        };
        let lower = compile(Section::Lower, &task.lower, &split.lower)?;
        let upper = compile(Section::Upper, &task.upper, &split.upper)?;
        let (shapes, bounds) = (lower.shapes(), lower.bounds());
        let shells = if task.rows_are_paths() { lower.shells() } else { [None; 2] };
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
            bounds,
            shells,
            imaginary: None,
            lift: None,
            lean: None,
            whole: None,
            cones: Vec::new(),
            unwinds: task.shared() == Some(MotionType::Rotation)
                && [&task.lower, &task.upper].iter().any(|s| s.kind == SubspaceKind::Cylindrical),
        })
    }

    /// Whether an actuated joint carries the height.
    pub fn drives_height(&self) -> bool {
        self.lift.is_some_and(|lift| lift.coordinate.actuated.is_some())
    }

    /// Whether an input depends on the imaginary joint of a leg that is split in its lower section: a joint that is held
    /// in the upper section, or an actuated lift, where the imaginary joint has a part in the height.
    pub fn passes_on(&self) -> bool {
        self.upper.driven || self.drives_height() && self.lift.is_some_and(|lift| lift.slope != 0.0)
    }

    /// A section that does not close, as it is reported; `None` where the leg is solved whole.
    pub fn named(&self, section: Section) -> Option<Section> {
        self.whole.is_none().then_some(section)
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

    /// Writes the lower joints' displacements and that along the intersection motion, within π where revolutions are
    /// counted, at a height above home, metres. This suffices for a leg that its upper section does not constrain.
    #[inline(always)]
    pub fn solve_actuated(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        out: &mut LegSolution,
    ) -> Result<(), ReachDeficit> {
        if self.is_apart() {
            let solved = self.solve_apart(task, [v, b], rise, branches, 0.0, out);
            return solved.map_err(|(_, deficit)| deficit);
        }
        match self.split_section {
            Section::Upper => {
                out.tau = self.unwound(self.first_step(b, branches.upper)?, 0.0);
                let target = task.lower_intersection.after(v, out.tau);
                self.lower.solve(&target, branches.lower, &mut out.lower)
            }
            Section::Lower => {
                self.lower.solve(v, branches.lower, &mut out.lower)?;
                out.tau = self.step(&out.lower).inverse();
                Ok(())
            }
        }
    }

    /// Solves the closure for `v · b`, at a height above home, metres. Where revolutions are counted, the displacement
    /// along the intersection motion is taken nearest to `near`.
    #[inline(always)]
    pub fn solve(
        &self,
        task: &Task,
        pose: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
    ) -> Result<LegSolution, (Section, ReachDeficit)> {
        let mut found = LegSolution::HOME;
        self.solve_in(task, pose, rise, branches, near, &mut found)?;
        Ok(found)
    }

    /// Writes what [`CompiledLeg::solve`] returns. Where the pose is out of reach, `out` has no meaning.
    #[inline(always)]
    pub fn solve_in(
        &self,
        task: &Task,
        pose: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
        out: &mut LegSolution,
    ) -> Result<(), (Section, ReachDeficit)> {
        self.solve_first(pose, branches, near, out)?;
        self.solve_second(task, pose, rise, branches, near, out)
    }

    /// Solves the section that is solved first, and the imaginary joint that follows from it.
    #[inline(always)]
    pub fn solve_first(
        &self,
        [v, b]: [&Displacement; 2],
        branches: LegBranches,
        near: f64,
        out: &mut LegSolution,
    ) -> Result<(), (Section, ReachDeficit)> {
        if self.is_apart() {
            // Neither section is solved by itself.
            return Ok(());
        }
        match self.split_section {
            Section::Upper => {
                let solved = self.upper.solve(b, branches.upper, &mut out.upper);
                solved.map_err(|deficit| (Section::Upper, deficit))?;
                out.tau = self.unwound(self.step(&out.upper), near);
            }
            Section::Lower => {
                let solved = self.lower.solve(v, branches.lower, &mut out.lower);
                solved.map_err(|deficit| (Section::Lower, deficit))?;
                // L · exp(I c) = v, with c the imaginary joint's displacement: τ = -c and U = exp(I c) · b.
                out.tau = self.unwound(self.step(&out.lower), -near).inverse();
            }
        }
        Ok(())
    }

    /// Solves the other section for what [`CompiledLeg::solve_first`] found.
    #[inline(always)]
    pub fn solve_second(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
        out: &mut LegSolution,
    ) -> Result<(), (Section, ReachDeficit)> {
        if self.is_apart() {
            return self.solve_apart(task, [v, b], rise, branches, near, out);
        }
        match self.split_section {
            Section::Upper => {
                let target = task.lower_intersection.after(v, out.tau);
                let solved = self.lower.solve(&target, branches.lower, &mut out.lower);
                solved.map_err(|deficit| (Section::Lower, deficit))
            }
            Section::Lower => {
                let target = task.upper_intersection.before(b, out.tau.inverse());
                let solved = self.upper.solve(&target, branches.upper, &mut out.upper);
                solved.map_err(|deficit| (Section::Upper, deficit))
            }
        }
    }

    /// The same for work that is done seldom. It is not inlined, so that there is one copy of all chains for it.
    #[inline(never)]
    pub fn solve_seldom(
        &self,
        task: &Task,
        pose: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
    ) -> Result<LegSolution, (Section, ReachDeficit)> {
        self.solve(task, pose, rise, branches, near)
    }

    /// Whether it is not solved one section after the other.
    #[inline(always)]
    fn is_apart(&self) -> bool {
        self.lean.is_some() || self.whole.is_some()
    }

    /// The same for a leg that is not solved one section after the other.
    #[inline(never)]
    fn solve_apart(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
        out: &mut LegSolution,
    ) -> Result<(), (Section, ReachDeficit)> {
        match &self.whole {
            Some(whole) => whole.solve(&task.raised(rise, task.isometry(v, b)), branches, out),
            None => {
                *out = self.solve_raised(task, [v, b], rise, branches, near)?;
                Ok(())
            }
        }
    }

    /// The same for a leg whose lift leans.
    #[cold]
    fn solve_raised(
        &self,
        task: &Task,
        [v, b]: [&Displacement; 2],
        rise: f64,
        branches: LegBranches,
        near: f64,
    ) -> Result<LegSolution, (Section, ReachDeficit)> {
        let rise = match task.slope() != 0.0 {
            true => task.rise_of_leg(rise, self.first_tau([v, b], branches)?),
            false => rise,
        };
        self.at(rise)?.solve_seldom(task, [v, b], rise, branches, near)
    }

    /// The displacement along the intersection motion, a translation, from the section that is solved first. It does not
    /// contain a lift that leans, where it tells the leg's height.
    fn first_tau(
        &self,
        [v, b]: [&Displacement; 2],
        branches: LegBranches,
    ) -> Result<JointDisplacement, (Section, ReachDeficit)> {
        match self.split_section {
            Section::Upper => self.first_step(b, branches.upper),
            Section::Lower => {
                self.lower.inverse(v, branches.lower).map(|q| self.step(&q).inverse())
            }
        }
        .map_err(|deficit| (self.split_section, deficit))
    }

    /// The region in which the lower section closes, if it is a region of the plane.
    pub fn shape(&self, branch: Branch) -> Option<&Shape> {
        of_branch(&self.shapes, branch)
    }

    /// The targets at which the lower section closes, whatever its limits of the first and the last joint, if it moves in a
    /// sphere and these are a shell.
    pub fn shell(&self, branch: Branch) -> Option<&Shell> {
        of_branch(&self.shells, branch)
    }

    /// The region outside of which the lower section does not close, if there is one in the plane.
    pub fn shape_or_bounds(&self, branch: Branch) -> Option<&Shape> {
        self.shape(branch).or(of_branch(&self.bounds, branch))
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

fn of_branch<T>([plus, minus]: &[Option<T>; 2], branch: Branch) -> Option<&T> {
    match branch {
        Branch::Plus => plus.as_ref(),
        Branch::Minus => minus.as_ref(),
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

/// The branch of each section's chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LegBranches {
    pub lower: Branch,
    pub upper: Branch,
}

impl LegBranches {
    /// The branch of a section's chain.
    #[inline(always)]
    pub fn of(self, section: Section) -> Branch {
        match section {
            Section::Lower => self.lower,
            Section::Upper => self.upper,
        }
    }
}
