//! The steps of the solution as plain data.

use super::constraint::{Constraint, follows};
use super::one_joint::SectionMotion;
use super::{Closed, Dependent, Whole};
use crate::chain::condition::Condition;
use crate::chain::whole::WholeLeg;
use crate::manipulator::leg::{CompiledLeg, Section};
use crate::numbers::{Plane as _, Real};
use crate::task::Task;
use nalgebra::{Matrix3, Vector3};

/// How coordinates follow from the others, because a leg constrains them.
#[derive(Clone, Debug)]
pub struct StepForm {
    /// The number of the leg.
    pub leg: usize,
    /// The section of it that constrains the platform.
    pub section: Section,
    /// The numbers of the coordinates that follow, among all task coordinates.
    pub coordinates: Vec<usize>,
    /// The bit of its choice in a mode, if it has two solutions.
    pub bit: Option<u32>,
    /// How they follow.
    pub kind: StepKind,
}

/// How coordinates of one section follow.
#[derive(Clone, Debug)]
pub enum StepKind {
    /// They keep their values at home.
    Constant,
    /// One coordinate follows from a condition on the section's displacement.
    Condition {
        /// The condition.
        condition: Condition,
        /// Whether it is a harmonic function of the coordinate; otherwise it is a polynomial of degree two at most.
        harmonic: bool,
        /// The step between the values that determine a polynomial: radians or metres.
        step: f64,
        /// The unit of its values.
        unit: f64,
    },
    /// They follow from the one joint of the section that moves.
    Joint {
        /// What it does.
        motion: SectionMotion,
        /// The numbers of the section's coordinates but that of a height.
        all: Vec<usize>,
    },
}

/// How coordinates follow where legs that are solved whole constrain the platform.
#[derive(Clone, Debug)]
pub enum WholeStep {
    /// From the one leg that the platform moves as.
    Stem(Box<StemForm>),
    /// From the constraints of several legs.
    Rows(RowsForm),
    /// From the plane in which the platform is the image of its base.
    Mirror(MirrorForm),
}

/// The loop of a stem and of the coordinates: `E(q) = T(x y z) · R(angles)`.
#[derive(Clone, Debug)]
pub struct StemForm {
    /// The number of the leg.
    pub leg: usize,
    /// The loop, with the known rotations as given joints. Its target is the displacement with dependent lengths at home; also
    /// with all angles at home, unless these are `turned`.
    pub closure: WholeLeg,
    /// The bits of its choices in a mode.
    pub bits: [Option<u32>; 4],
    /// Whether all angles are known.
    pub turned: bool,
    /// The given rotations, by their numbers among the three factors of the orientation.
    pub given: Vec<usize>,
    /// What is found, with the first freedom of it in the loop.
    pub found: Vec<(StemPart, usize)>,
    /// The dependent coordinates.
    pub coordinates: Vec<usize>,
    /// The number of the first angle among the coordinates, and how many there are.
    pub angles: [usize; 2],
}

/// A part of the displacement that follows from a stem.
#[derive(Clone, Copy, Debug)]
pub enum StemPart {
    /// The length with this number among the coordinates, from home.
    Length(usize),
    /// The factor of the orientation, from home.
    Factor(usize),
    /// The whole orientation, as the rotation back to home.
    Orientation,
}

/// Equations `c · P + ⟨r, R⟩ + c₀ = 0` between the position of the reference point from home, over the size, and the orientation.
#[derive(Clone, Debug)]
pub struct RowsForm {
    /// The number of the first leg that constrains.
    pub leg: usize,
    /// The equations. Those that have no position come first.
    pub rows: Vec<RowForm>,
    /// How many these are.
    pub couples: usize,
    /// The bit of the choice in a mode.
    pub bit: Option<u32>,
    /// Whether the orientation follows from the position: then there are two choices, and nothing below says how.
    pub by_place: bool,
    /// Whether a ball slides on a line: then what it slides is one unknown more, with a choice of its own.
    pub slides: bool,
    /// The dependent positions.
    pub lengths: Vec<usize>,
    /// The factor of the orientation that follows and the coordinate that has it, its value at home, and the unit of the
    /// function whose zero it is.
    pub turn: Option<(usize, usize, f64, f64)>,
    /// The size of the mechanism, metres.
    pub size: f64,
    /// The number of the first angle among the coordinates.
    pub first_angle: usize,
}

/// A platform that is the image of its base in a plane.
#[derive(Clone, Debug)]
pub struct MirrorForm {
    /// The number of the first leg that constrains.
    pub leg: usize,
    /// The number of the roll among the coordinates; the pitch and the yaw follow it.
    pub first_angle: usize,
    /// The height of home's mid-plane above the reference point, metres.
    pub height: f64,
    /// Of two freedoms, the sphere that the mid-plane is tangent to: its centre from the reference point, and its radius.
    pub sphere: Option<(Vector3<f64>, f64)>,
}

/// Below this, a symmetric platform counts as upside down.
pub const UPRIGHT: f64 = 1e-6;

/// What follows from the orientation of a mid-plane.
#[derive(Clone, Copy, Debug)]
pub struct Mirrored<T: Real> {
    /// The direction of the yaw, of no particular length.
    pub yaw: T::Plane,
    /// The position of the reference point from home, metres.
    pub moved: [T; 3],
    /// Zero where the platform is upside down, and nothing follows.
    pub upright: T,
}

impl MirrorForm {
    /// What follows from the roll, the pitch, and the height of the reference point above home.
    pub fn follow<T: Real>(&self, [roll, pitch]: [T; 2], height: T) -> Mirrored<T> {
        let (roll, pitch) = (roll.unit(), pitch.unit());
        let ([c, s], [k, t]) = ([roll.re(), roll.im()], [pitch.re(), pitch.im()]);
        let upright = k * c + 1.0;
        let normal = [t, -(s * k), upright];
        let twice = 2.0 * self.height;
        // How far the reference point is moved along the normal.
        let along = match self.sphere {
            None => (height - twice).over(upright),
            Some((centre, radius)) => {
                let towards = normal[0] * centre.x + normal[1] * centre.y + normal[2] * centre.z;
                let root = (upright * 2.0).root();
                towards.over(upright) + T::constant(2.0 * radius).over(root) - twice
            }
        };
        let moved = [normal[0] * along, normal[1] * along, normal[2] * along + twice];
        Mirrored { yaw: T::Plane::new(k + c, t * s), moved, upright }
    }
}

/// One of the equations.
#[derive(Clone, Debug)]
pub struct RowForm {
    /// Whether the direction turns with the platform.
    pub carried: bool,
    /// The direction is this one of the base across that which turns with the platform.
    pub across: Option<Vector3<f64>>,
    /// The direction `c`.
    pub direction: Vector3<f64>,
    /// The factors `r` of the orientation in base directions, from home.
    pub turn: Matrix3<f64>,
    /// The constant.
    pub constant: f64,
}

/// A constraint that is only checked.
#[derive(Clone, Copy, Debug)]
pub struct CheckForm {
    /// The number of the leg.
    pub leg: usize,
    /// The section of it that constrains the platform.
    pub section: Section,
    /// Whether the displacement of the leg's imaginary joint matters, which the other section tells.
    pub follows: bool,
    /// The condition on the section's displacement.
    pub condition: Condition,
}

impl Dependent {
    /// How coordinates follow where legs are solved whole.
    pub(in crate::manipulator) fn whole_step(&self) -> Option<WholeStep> {
        Some(match self.whole.as_ref()? {
            Whole::Stem(stem) => WholeStep::Stem(Box::new(stem.form())),
            Whole::Rows(rows) => WholeStep::Rows(rows.form()),
            Whole::Mirror(mirror) => WholeStep::Mirror(mirror.form.clone()),
        })
    }

    /// The steps.
    pub(in crate::manipulator) fn step_forms(&self) -> Vec<StepForm> {
        let form = |step: &super::Step| StepForm {
            leg: step.solution.leg(),
            section: step.solution.section(),
            coordinates: step.solution.coordinates(),
            bit: step.bit,
            kind: Self::kind(&step.solution),
        };
        self.steps.iter().map(form).collect()
    }

    fn kind(solution: &Closed) -> StepKind {
        match solution {
            Closed::Constant { .. } => StepKind::Constant,
            Closed::Condition { constraint, function, .. } => StepKind::Condition {
                condition: constraint.condition,
                harmonic: function.harmonic,
                step: function.step,
                unit: function.unit,
            },
            Closed::Joint(joint) => {
                StepKind::Joint { motion: joint.motion, all: joint.all.clone() }
            }
        }
    }

    /// The constraints that are only checked.
    pub(in crate::manipulator) fn check_forms(
        &self,
        task: &Task,
        legs: &[CompiledLeg],
    ) -> Vec<CheckForm> {
        let form = |&Constraint { leg, section, condition }: &Constraint| {
            let follows = follows(task, &legs[leg], section);
            CheckForm { leg, section, follows, condition }
        };
        self.checks.iter().map(form).collect()
    }

    /// The bits of a mode on which the dependent coordinates depend.
    pub(in crate::manipulator) fn bits(&self) -> &[u32] {
        &self.bits
    }
}
