//! The dependent coordinates of a block of poses: what [`Dependent::complete_from_home`] does for one pose, as loops over
//! the block.

use super::constraint::{Constraint, follows};
use super::one_joint::{OneJoint, SectionMotion};
use super::zeros::Function;
use super::{Closed, Dependent, OBEYED};
use crate::chain::ReachDeficit;
use crate::chain::condition::Condition;
use crate::chain::equation::AttemptedZero;
use crate::group::{CylindricalDisplacement, Displacement, PlanarDisplacement, SubspaceKind};
use crate::manipulator::batch::lanes::{Column, LANES, Lane, Lanes};
use crate::manipulator::batch::section::{self, Side, Step};
use crate::manipulator::batch::{Block, SolveSection};
use crate::manipulator::{CompiledLeg, Manipulator, Mode, Section};
use crate::numeric::Quantity;
use nalgebra::{Complex, Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

/// Completes the poses of a block in a mode. Poses that have no dependent coordinates are marked as out of reach.
pub(in crate::manipulator) struct Complete<'a> {
    pub manipulator: &'a Manipulator,
    pub dependent: &'a Dependent,
    pub mode: Mode,
    pub arch: Arch,
}

impl Complete<'_> {
    pub fn run(&self, block: &mut Block) {
        let Self { manipulator, dependent, mode, .. } = *self;
        for &coordinate in &dependent.coordinates {
            block.pose[coordinate].fill(manipulator.home[coordinate]);
        }
        block.begin(manipulator);
        let mut values = [Lanes::all(0.0); 3];
        for step in &dependent.steps {
            let sign = step.sign(mode);
            match &step.solution {
                Closed::Constant { .. } => {}
                Closed::Condition { constraint, coordinate, function } => {
                    self.find_tau_before(block, constraint.leg, constraint.section);
                    for (place, values) in function.places().into_iter().zip(&mut values) {
                        block.pose[*coordinate].fill(place);
                        self.demand(block, constraint, values);
                    }
                    let (values, coordinate) = (&values, *coordinate);
                    self.part(block, SharedWork::Zeros { function, values, sign, coordinate });
                }
                Closed::Joint(joint) => {
                    self.find_tau_before(block, joint.leg, joint.section);
                    self.part(block, SharedWork::Joint(joint, sign));
                }
            }
        }
        for check in &dependent.checks {
            self.find_tau_before(block, check.leg, check.section);
            let [missed, ..] = &mut values;
            self.demand(block, check, missed);
            for (lane, &missed) in missed.iter().enumerate() {
                let deficit = check.condition.deficit(missed);
                let unit = if deficit.quantity == Quantity::Length { dependent.size } else { 1.0 };
                let obeyed = u64::from(deficit.excess <= OBEYED * unit);
                block.status.note_lane(lane, obeyed, obeyed ^ 1);
            }
        }
    }

    /// Finds the displacements τ of a leg along the intersection motion, where they follow from the section other than this
    /// one; zeros otherwise.
    fn find_tau_before(&self, block: &mut Block, number: usize, section: Section) {
        let Self { manipulator, mode, arch, .. } = *self;
        let leg = &manipulator.legs[number];
        let joint = leg.imaginary_joint().filter(|_| follows(&manipulator.task, leg, section));
        let Some(joint) = joint else {
            block.tau.clear();
            return;
        };
        let bridge = leg.split_section;
        block.displace_only(manipulator, bridge, arch);
        let Block { v, b, lower: found, status, .. } = &mut *block;
        let target = if bridge == Section::Lower { &*v } else { &*b };
        let branches = &[manipulator.branches(mode, number).of(bridge); LANES];
        let bridge = leg.section(bridge);
        SolveSection { section: bridge, branches, target, found, lanes: LANES }.run(arch);
        status.note(found);
        self.part(block, SharedWork::Tau(leg, joint));
    }

    /// Computes the values of a constraint's condition at the present poses.
    fn demand(&self, block: &mut Block, constraint: &Constraint, values: &mut Column) {
        block.displace_only(self.manipulator, constraint.section, self.arch);
        self.part(block, SharedWork::Demand(constraint, values));
    }

    fn part(&self, block: &mut Block, part: SharedWork<'_>) {
        self.arch.dispatch(OnBlock { complete: self, block, part });
    }
}

/// A part of the work. Several steps need the same part, of which there is one copy for each set of instructions.
enum SharedWork<'a> {
    /// See [`Block::take_tau`].
    Tau(&'a CompiledLeg, usize),
    /// See [`Block::demand`].
    Demand(&'a Constraint, &'a mut Column),
    /// See [`Block::take_zeros`].
    Zeros { function: &'a Function, values: &'a [Column; 3], sign: f64, coordinate: usize },
    /// See [`Block::take_joint`].
    Joint(&'a OneJoint, f64),
}

/// A part, with the instructions of the processor at hand.
struct OnBlock<'a, 'p> {
    complete: &'a Complete<'a>,
    block: &'a mut Block,
    part: SharedWork<'p>,
}

impl WithSimd for OnBlock<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { complete: &Complete { manipulator, .. }, block, part } = self;
        match part {
            SharedWork::Tau(leg, joint) => block.take_tau(leg, joint),
            SharedWork::Demand(constraint, values) => block.demand(manipulator, constraint, values),
            SharedWork::Zeros { function, values, sign, coordinate } => {
                let home = manipulator.home[coordinate];
                block.take_zeros(function, values, sign, home, coordinate);
            }
            SharedWork::Joint(joint, sign) => block.take_joint(manipulator, joint, sign),
        }
    }
}

impl Block {
    /// Takes the displacements τ of a leg along the intersection motion from joint number `joint` of its section with the
    /// imaginary joint, whose solution is in `lower`, whichever section it is.
    #[inline(always)]
    fn take_tau(&mut self, leg: &CompiledLeg, joint: usize) {
        let Self { lower: found, tau, .. } = self;
        section::unwind(leg.unwinds, &found.displacements[joint], tau, LANES);
        if leg.split_section == Section::Lower {
            section::invert(tau, LANES);
        }
    }

    /// Computes the values of a constraint's condition at the displacements of its section.
    #[inline(always)]
    fn demand(&mut self, manipulator: &Manipulator, constraint: &Constraint, values: &mut Column) {
        let Constraint { leg, section, condition } = constraint;
        let task = &manipulator.task;
        let Self { v, b, shifted, tau, .. } = self;
        let (own, kind) = match section {
            Section::Lower => (&*v, task.lower.kind),
            Section::Upper => (&*b, task.upper.kind),
        };
        let mut targets = own;
        if follows(task, &manipulator.legs[*leg], *section) {
            match section {
                Section::Lower => {
                    let step = Step { motion: task.lower_intersection, side: Side::After };
                    section::shift(step, own, tau, shifted, LANES);
                }
                Section::Upper => {
                    let step = Step { motion: task.upper_intersection, side: Side::Before };
                    section::invert(tau, LANES);
                    section::shift(step, own, tau, shifted, LANES);
                    section::invert(tau, LANES);
                }
            }
            targets = shifted;
        }
        // With a constant kind of displacement and of condition, the loop has no branches.
        macro_rules! each {
            ($condition:expr, $variant:ident, $displacement:ty) => {{
                let condition = $condition;
                for lane in 0..LANES {
                    let target = <$displacement>::load(targets, lane);
                    values[lane] = condition.value(&Displacement::$variant(target));
                }
            }};
        }
        match *condition {
            Condition::Circle { point, centre, radius } => {
                each!(Condition::Circle { point, centre, radius }, Planar, PlanarDisplacement);
            }
            Condition::Line { point, normal, offset } => {
                each!(Condition::Line { point, normal, offset }, Planar, PlanarDisplacement);
            }
            Condition::CarriedLine { point, normal, offset } => {
                each!(Condition::CarriedLine { point, normal, offset }, Planar, PlanarDisplacement);
            }
            Condition::Heading { rotation } => {
                each!(Condition::Heading { rotation }, Planar, PlanarDisplacement);
            }
            Condition::Cone { fixed, carried, cosine } => {
                each!(Condition::Cone { fixed, carried, cosine }, Spherical, Matrix3<f64>);
            }
            Condition::Flat { normal, value } => {
                let condition = Condition::Flat { normal, value };
                match kind {
                    SubspaceKind::Cylindrical => {
                        each!(condition, Cylindrical, CylindricalDisplacement);
                    }
                    SubspaceKind::TranslationalPlane => {
                        each!(condition, Translational, Complex<f64>);
                    }
                    SubspaceKind::Identity
                    | SubspaceKind::Planar
                    | SubspaceKind::Spherical
                    | SubspaceKind::TranslationalSpace => each!(condition, Spatial, Vector3<f64>),
                }
            }
        }
    }

    /// Takes the zeros of functions of a coordinate for its values: see [`Function::zero`].
    #[inline(always)]
    fn take_zeros(
        &mut self,
        function: &Function,
        [first, second, third]: &[Column; 3],
        sign: f64,
        held: f64,
        coordinate: usize,
    ) {
        let Self { pose, status, .. } = self;
        let to = &mut pose[coordinate];
        macro_rules! each {
            ($harmonic:expr) => {{
                let function = Function { harmonic: $harmonic, ..*function };
                for lane in 0..LANES {
                    let values = [first[lane], second[lane], third[lane]];
                    let AttemptedZero { at, holds, beyond } =
                        function.attempt_zero(values, sign, held);
                    to[lane] = at;
                    status.note_lane(lane, u64::from(holds), u64::from(beyond));
                }
            }};
        }
        if function.harmonic {
            each!(true);
        } else {
            each!(false);
        }
    }

    /// Takes the coordinates of a section with one joint.
    #[inline(always)]
    fn take_joint(&mut self, manipulator: &Manipulator, joint: &OneJoint, sign: f64) {
        let Self { pose, tau, status, .. } = self;
        let task = &manipulator.task;
        // Where τ does not matter, a slider moves along the same line at all poses.
        let follows = follows(task, &manipulator.legs[joint.leg], joint.section);
        let line = match joint.motion {
            SectionMotion::Slide(s, given) if !follows => {
                Some(joint.line(manipulator, s, given, tau.get(0)))
            }
            _ => None,
        };
        macro_rules! each {
            ($lane:ident, $at:ident => $solved:expr) => {
                for $lane in 0..LANES {
                    let mut $at = [0.0; 3];
                    for (at, &coordinate) in $at.iter_mut().zip(&joint.all) {
                        *at = pose[coordinate][$lane];
                    }
                    let found: Result<[f64; 3], ReachDeficit> = $solved;
                    let solved = u64::from(found.is_ok());
                    status.note_lane($lane, solved, solved ^ 1);
                    for (value, &coordinate) in found.unwrap_or($at).into_iter().zip(&joint.all) {
                        pose[coordinate][$lane] = value;
                    }
                }
            };
        }
        match line {
            Some(line) => {
                let kind = match joint.section {
                    Section::Lower => task.lower.kind,
                    Section::Upper => task.upper.kind,
                };
                each!(lane, at => line.through(at).map(|found| joint.taken(kind, at, found)));
            }
            None => each!(lane, at => joint.solve(manipulator, tau.get(lane), sign, at)),
        }
    }
}
