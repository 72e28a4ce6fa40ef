//! Dependent coordinates: those that a mechanism's constraining legs determine.
//!
//! A leg with fewer freedoms than the motion `A · B` constrains the platform: each freedom that it lacks is one
//! equation on the displacement of one of its sections ([`Condition`]). So some of the task coordinates are
//! *independent*, and the others follow from them, one after the other:
//!
//! 1. First the section that is taken modulo the intersection motion (see [`task`](crate::task)). Its
//!    coordinates, and the legs that are split in it, then tell the displacement of the imaginary joints.
//! 2. Then the other section. The constraint of a leg with its imaginary joint in the first one is a condition
//!    on `exp(-I τ) · b`, or on `v · exp(I τ)`, with τ known.
//!
//! In one coordinate, with the others known, a condition is `c₀ + c₁ cos t + c₂ sin t` for an angle, and a
//! polynomial of degree two at most for a length: three of its values determine it. It has two zeros, at which
//! it rises (the plus branch) and falls (minus), or one. A section with one joint that moves has a one-parameter
//! motion: one of its coordinates tells the joint, and the joint the others ([`one_joint`]).
//!
//! Where every leg is solved whole, one is the [`stem`] from which all dependent coordinates follow at once, or they follow from
//! the [`rows`] of several.
//!
//! Further legs may impose constraints that the platform obeys already. They are only checked.

mod complete;
pub(crate) mod constraint;
mod determining;
mod error;
pub(super) mod form;
mod many;
mod mirror;
pub(crate) mod one_joint;
mod place;
mod rail;
mod rows;
mod stem;
pub(crate) mod zeros;

use super::Mode;
use super::leg::{CompiledLeg, Section};
use super::mode::{Choices, ModeLayout};
use crate::decomposition::mobility::assembled;
use crate::decomposition::whole::Constrained;
use crate::group::{JointDisplacement, SubspaceKind};
use crate::mechanism::Mechanism;
use crate::numeric::Quantity;
use crate::task::{CoordinateKind, Task};
use constraint::{Constraint, constraints, follows, order, target_of};
pub use error::ConstraintError;
pub(super) use many::Complete;
use mirror::Mirror;
use one_joint::OneJoint;
use rows::Rows;
use stem::Stem;
use zeros::Function;

/// The coordinate that follows from a condition is the first, in the order of preference, in which the
/// condition has at least this share of its largest slope at home.
const STEEP: f64 = 0.3;

/// A slope below this counts as zero; lengths are over the size.
const LEVEL: f64 = 1e-9;

/// A constraint of a further leg counts as obeyed if it is missed by less than this, in radians or shares of
/// the size.
pub const OBEYED: f64 = 1e-9;

/// The numbers of the coordinates that the file wants as independent ones; `None` if it says nothing.
fn wanted(task: &Task, mechanism: &Mechanism) -> Result<Option<Vec<usize>>, ConstraintError> {
    let names = &mechanism.task.independent;
    let number = |name: &String| {
        task.coordinates.iter().position(|c| c.name == *name).ok_or_else(|| {
            let expected = task.coordinates.iter().map(|c| c.name.to_owned()).collect();
            ConstraintError::Unknown { name: name.clone(), expected }
        })
    };
    let numbers = names.iter().map(number).collect::<Result<Vec<usize>, _>>()?;
    Ok((!names.is_empty()).then_some(numbers))
}

/// The coordinates that follow from the others, and how.
#[derive(Clone, Debug)]
pub(crate) struct Dependent {
    /// The numbers of the independent coordinates among all task coordinates.
    pub independent: Vec<usize>,
    /// The numbers of the dependent ones.
    pub coordinates: Vec<usize>,
    /// How they follow where legs are solved whole; then there are no steps.
    whole: Option<Whole>,
    steps: Vec<Step>,
    /// Constraints that are not used by a step.
    checks: Vec<Constraint>,
    /// The bits of a [`Mode`] on which the dependent coordinates depend.
    bits: Vec<u32>,
    /// The size of the mechanism, metres.
    size: f64,
}

/// How dependent coordinates follow where legs are solved whole.
#[derive(Clone, Debug)]
pub(crate) enum Whole {
    /// From the one leg that the platform moves as.
    Stem(Stem),
    /// From the constraints of several legs.
    Rows(Rows),
    /// From the plane in which the platform is the image of its base.
    Mirror(Mirror),
}

impl Whole {
    /// The first leg that constrains.
    fn leg(&self) -> usize {
        match self {
            Self::Stem(stem) => stem.leg,
            Self::Rows(rows) => rows.leg(),
            Self::Mirror(mirror) => mirror.form.leg,
        }
    }

    fn choices(&self) -> usize {
        match self {
            Self::Stem(stem) => stem.choices(),
            Self::Rows(rows) => rows.choices(),
            Self::Mirror(_) => 0,
        }
    }

    /// The bits of its choices.
    fn bits(&self) -> [Option<u32>; 4] {
        match self {
            Self::Stem(stem) => stem.bits,
            Self::Rows(rows) => [rows.bits[0], rows.bits[1], None, None],
            Self::Mirror(_) => [None; 4],
        }
    }
}

/// One step of the solution.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub solution: Closed,
    /// The bit of its choice in a [`Mode`], if it has two solutions.
    bit: Option<u32>,
}

/// How dependent coordinates of one section follow from the others.
#[derive(Clone, Debug)]
pub(crate) enum Closed {
    /// They keep their values at home: the leg's section can only move along the intersection motion.
    Constant { leg: usize, section: Section, coordinates: Vec<usize> },
    /// One coordinate follows from a condition.
    Condition { constraint: Constraint, coordinate: usize, function: Function },
    /// They follow from the one joint that moves.
    Joint(OneJoint),
}

impl Dependent {
    /// The dependent coordinates of a mechanism with these legs and this mobility, or `None` if all coordinates are
    /// independent. Lengths are compared with `size`, metres.
    ///
    /// # Errors
    /// The first leg whose constraint has no closed form.
    pub fn new(
        task: &Task,
        legs: &[CompiledLeg],
        names: &[&str],
        mobility: usize,
        size: f64,
    ) -> Result<Option<Self>, ConstraintError> {
        let mut steps: Vec<Closed> = Vec::new();
        let mut checks = Vec::new();
        for section in order(task) {
            let mut constraining: Vec<usize> = (0..legs.len())
                .filter(|&leg| legs[leg].section(section).partial.is_some())
                .collect();
            // The leg with the most constraints; the others can only repeat them.
            let locked = |leg: &usize| constraints(legs, *leg, section).count();
            constraining.sort_by_key(|leg| std::cmp::Reverse(locked(leg)));
            let Some((&leg, further)) = constraining.split_first() else { continue };
            let step = closed(task, legs, leg, section, size)
                .ok_or_else(|| ConstraintError::Singular { leg: names[leg].to_owned(), section })?;
            steps.push(step);
            checks.extend(further.iter().flat_map(|&leg| constraints(legs, leg, section)));
        }
        if steps.is_empty() {
            return Ok(None);
        }
        let mut coordinates: Vec<usize> = steps.iter().flat_map(Closed::coordinates).collect();
        coordinates.sort_unstable();
        let all = 0..task.coordinates.len();
        let independent = all.filter(|i| !coordinates.contains(i)).collect();
        let steps =
            steps.into_iter().map(|solution| Step { solution, bit: None }).collect::<Vec<_>>();
        let count = task.coordinates.len();
        let determined = count - coordinates.len();
        if determined != mobility {
            let constrains = |leg: &usize| {
                [&legs[*leg].lower, &legs[*leg].upper].iter().any(|s| s.partial.is_some())
            };
            let legs = (0..legs.len()).filter(constrains).map(|leg| names[leg].to_owned());
            let legs = legs.collect();
            return Err(ConstraintError::Several { legs, mobility, determined });
        }
        let (whole, bits) = (None, Vec::new());
        Ok(Some(Self { independent, coordinates, whole, steps, checks, bits, size }))
    }

    /// The dependent coordinates of a mechanism whose legs are solved whole.
    ///
    /// # Errors
    /// If no coordinates determine the platform's motion in closed form.
    pub fn of_whole(
        task: &Task,
        mechanism: &Mechanism,
        by: Constrained,
        size: f64,
    ) -> Result<Self, ConstraintError> {
        let wanted = wanted(task, mechanism)?;
        let (mut independent, whole) = match by {
            Constrained::Stem(leg) => {
                let name = || mechanism.legs[leg].name.clone();
                let found = Stem::new(task, mechanism, leg, size);
                let (independent, stem) = found.map_err(|reason| match reason {
                    Some(reason) => ConstraintError::Stem { leg: name(), reason },
                    None => ConstraintError::Poles { leg: name() },
                })?;
                (independent, Whole::Stem(stem))
            }
            Constrained::Legs { freedoms } => {
                let motions = assembled(mechanism);
                let wanted = (freedoms, wanted.as_deref());
                let found = Rows::new(task, mechanism, wanted, &motions, size);
                let (independent, rows) = found.map_err(ConstraintError::Rows)?;
                (independent, Whole::Rows(rows))
            }
            Constrained::Mirror { freedoms } => {
                let motions = assembled(mechanism);
                let lacks = |leg: &usize| mechanism.legs[*leg].screws().len() < 6;
                let legs = (0..mechanism.legs.len()).filter(lacks).collect();
                let legs = (legs, freedoms);
                let found = Mirror::new(task, mechanism.platform, legs, &motions, size);
                let (independent, mirror) = found.ok_or(ConstraintError::Mirror)?;
                (independent, Whole::Mirror(mirror))
            }
        };
        independent.sort_unstable();
        let all = 0..task.coordinates.len();
        let coordinates = all.filter(|i| !independent.contains(i)).collect();
        let (steps, checks, bits) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { independent, coordinates, whole: Some(whole), steps, checks, bits, size })
    }

    /// Checks that the independent coordinates are those that the file wants.
    ///
    /// # Errors
    /// They are others.
    pub fn check_wanted(
        dependent: Option<&Self>,
        task: &Task,
        mechanism: &Mechanism,
    ) -> Result<(), ConstraintError> {
        let Some(wanted) = wanted(task, mechanism)? else { return Ok(()) };
        let all: Vec<usize> = (0..task.coordinates.len()).collect();
        let found = dependent.map_or(&all, |dependent| &dependent.independent);
        let same = found.len() == wanted.len() && wanted.iter().all(|i| found.contains(i));
        let name = |&i: &usize| task.coordinates[i].name.to_owned();
        match same {
            true => Ok(()),
            false => Err(ConstraintError::Independent {
                given: mechanism.task.independent.clone(),
                expected: found.iter().map(name).collect(),
            }),
        }
    }

    /// The steps, in their order.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// For each two-valued choice of the steps, the leg that it belongs to.
    pub fn choosing_legs(&self) -> impl Iterator<Item = usize> + '_ {
        let whole = self.whole.iter();
        let of_whole = whole.flat_map(|whole| std::iter::repeat_n(whole.leg(), whole.choices()));
        let choosing = self.steps.iter().filter(|step| step.solution.has_choice());
        choosing.map(|step| step.solution.leg()).chain(of_whole)
    }

    /// Takes the bits of the choices from a layout that was made for them.
    pub(super) fn set_bits(&mut self, task: &Task, layout: &ModeLayout, legs: &[CompiledLeg]) {
        let mut given = vec![0; legs.len()];
        for step in &mut self.steps {
            if step.solution.has_choice() {
                let leg = step.solution.leg();
                step.bit = layout.pose_bits(leg).nth(given[leg]);
                given[leg] += 1;
            }
        }
        match &mut self.whole {
            Some(Whole::Stem(stem)) => {
                let given = layout.pose_bits(stem.leg);
                stem.bits.iter_mut().zip(given).for_each(|(to, bit)| *to = Some(bit));
            }
            Some(Whole::Rows(rows)) => {
                let given = layout.pose_bits(rows.leg());
                rows.bits.iter_mut().zip(given).for_each(|(to, bit)| *to = Some(bit));
                if let Some(leg) = rows.rail_leg() {
                    let of = |section| layout.section_bit(leg, section);
                    rows.rail_bits = [of(Section::Lower), of(Section::Upper)];
                }
            }
            Some(Whole::Mirror(_)) | None => {}
        }
        let mut bits: Vec<u32> = self.own_bits().collect();
        if let Some(Whole::Rows(rows)) = &self.whole {
            bits.extend(rows.rail_bits.into_iter().flatten());
        }
        let used = self.steps.iter().map(|step| (step.solution.leg(), step.solution.section()));
        let checked = self.checks.iter().map(|check| (check.leg, check.section));
        for (leg, section) in used.chain(checked) {
            if follows(task, &legs[leg], section) {
                bits.extend(layout.section_bit(leg, legs[leg].split_section));
            }
        }
        bits.sort_unstable();
        bits.dedup();
        self.bits = bits;
    }

    /// The bits of the choices with which the dependent coordinates follow.
    fn own_bits(&self) -> impl Iterator<Item = u32> {
        let of_whole = self.whole.iter().flat_map(Whole::bits);
        self.steps.iter().map(|step| step.bit).chain(of_whole).flatten()
    }

    /// The number of combinations of choices on which the dependent coordinates depend.
    pub fn combinations(&self) -> usize {
        1 << self.bits.len()
    }

    /// The mode with one of these combinations, and plus for all other choices.
    pub fn mode(&self, combination: usize) -> Mode {
        let bits = self.bits.iter().enumerate();
        Mode(bits.fold(0, |mode, (i, bit)| mode | (combination as u64 >> i & 1) << bit))
    }

    /// The number of the combination that a mode has.
    pub fn combination(&self, mode: Mode) -> usize {
        let bits = self.bits.iter().enumerate();
        bits.fold(0, |number, (i, bit)| number | ((mode.0 >> bit & 1) as usize) << i)
    }

    /// All choices on which the dependent coordinates depend, in one of these combinations.
    pub fn choices(&self, combination: usize) -> Choices {
        Choices { given: self.mode(self.combinations() - 1), chosen: self.mode(combination) }
    }

    /// The modes with every combination of the steps' own choices, and plus for all others.
    pub fn step_modes(&self) -> impl Iterator<Item = Mode> + '_ {
        let bits: Vec<u32> = self.own_bits().collect();
        (0..1u64 << bits.len()).map(move |combination| {
            let bits = bits.iter().enumerate();
            Mode(bits.fold(0, |mode, (i, bit)| mode | (combination >> i & 1) << bit))
        })
    }

    /// The constraints that only repeat others, as the legs and sections that they belong to.
    pub fn checked(&self) -> impl Iterator<Item = (usize, Option<Section>)> + '_ {
        self.checks.iter().map(|check| (check.leg, Some(check.section)))
    }

    /// How they follow where legs are solved whole.
    pub fn whole(&self) -> Option<&Whole> {
        self.whole.as_ref()
    }

    /// The legs and sections whose constraints determine the dependent coordinates.
    /// A leg that is solved whole constrains as a whole.
    pub fn constraining(&self) -> impl Iterator<Item = (usize, Option<Section>)> + '_ {
        let legs: Vec<usize> = match &self.whole {
            Some(Whole::Stem(stem)) => vec![stem.leg],
            Some(Whole::Rows(rows)) => rows.legs().collect(),
            Some(Whole::Mirror(mirror)) => mirror.legs.clone(),
            None => Vec::new(),
        };
        let of_whole = legs.into_iter().map(|leg| (leg, None));
        let of_step = |step: &Step| (step.solution.leg(), Some(step.solution.section()));
        self.steps.iter().map(of_step).chain(of_whole)
    }

    /// The leg, the section and the numbers of the locked joints of each step, which are as many as it has
    /// dependent coordinates.
    pub fn locked<'a>(
        &'a self,
        legs: &'a [CompiledLeg],
    ) -> impl Iterator<Item = (usize, Section, usize)> + 'a {
        let sections = self.constraining().filter_map(|(leg, section)| Some((leg, section?)));
        sections.flat_map(|(leg, section)| {
            let partial = legs[leg].section(section).partial;
            let joints = partial.into_iter().flat_map(|partial| partial.locked_joints());
            joints.map(move |joint| (leg, section, joint))
        })
    }
}

/// How the constraints of a leg's section determine coordinates; `None` if they determine none at home.
fn closed(
    task: &Task,
    legs: &[CompiledLeg],
    leg: usize,
    section: Section,
    size: f64,
) -> Option<Closed> {
    let (compiled, subspace) = match section {
        Section::Lower => (&legs[leg].lower, &task.lower),
        Section::Upper => (&legs[leg].upper, &task.upper),
    };
    let partial = compiled.partial?;
    let coordinates: Vec<usize> = task.in_plane(section, task.range(section)).collect();
    let bridge = legs[leg].imaginary_joint().filter(|_| legs[leg].split_section == section);
    let modulo = task.shared().is_some() && order(task)[0] == section;
    let (first, second) = partial.free();
    match (partial.locked_joints().count(), second) {
        _ if modulo && second.is_none() && first == bridge => {
            Some(Closed::Constant { leg, section, coordinates })
        }
        // The imaginary joint rotates about the third direction, as the first factor of an orientation does, and does not
        // change the others.
        (1, Some(second))
            if subspace.kind == SubspaceKind::Spherical && bridge.is_some() && !modulo =>
        {
            let screw = compiled.screws[second];
            Some(Closed::Joint(OneJoint::last_angle(task, leg, section, screw)))
        }
        (1, _) => {
            let constraint = constraints(legs, leg, section).next()?;
            // At home τ is zero.
            let tau = JointDisplacement::Value(0.0);
            let home = task.home();
            let slope = |&coordinate: &usize| {
                let unit = match task.coordinates[coordinate].quantity {
                    Quantity::Angle => 1.0,
                    Quantity::Length => size,
                };
                let target = |pose: &[f64]| target_of(task, &legs[leg], section, tau, pose);
                let mut pose = home.clone();
                let function = constraint.function(task, coordinate, size);
                let values = constraint.values(function.places(), coordinate, &mut pose, target);
                (function.slope(values) * unit).abs() / constraint.unit(size)
            };
            // In the azimuth, a condition is no harmonic function.
            let mut preferred = coordinates;
            preferred.retain(|&i| task.coordinates[i].kind() != CoordinateKind::Azimuth);
            preferred
                .sort_by_key(|&i| (preference(task.coordinates[i].kind()), std::cmp::Reverse(i)));
            let steepest = preferred.iter().map(slope).fold(0.0, f64::max);
            if steepest < LEVEL {
                return None;
            }
            let coordinate = preferred.into_iter().find(|i| slope(i) >= STEEP * steepest)?;
            let function = constraint.function(task, coordinate, size);
            Some(Closed::Condition { constraint, coordinate, function })
        }
        _ => OneJoint::new(task, leg, section, first.map(|joint| compiled.screws[joint]))
            .map(Closed::Joint),
    }
}

/// The order in which coordinates are made dependent: angles before lengths.
fn preference(kind: CoordinateKind) -> u8 {
    match kind {
        CoordinateKind::Zeta
        | CoordinateKind::Theta
        | CoordinateKind::Phi
        | CoordinateKind::Azimuth
        | CoordinateKind::Yaw => 0,
        CoordinateKind::Psi
        | CoordinateKind::Nu
        | CoordinateKind::Torsion
        | CoordinateKind::Roll => 1,
        CoordinateKind::Xi | CoordinateKind::Mu | CoordinateKind::Tilt | CoordinateKind::Pitch => 2,
        CoordinateKind::X
        | CoordinateKind::Y
        | CoordinateKind::Z
        | CoordinateKind::H
        | CoordinateKind::W => 3,
    }
}

impl Step {
    /// The sign of its choice in a mode.
    pub fn sign(&self, mode: Mode) -> f64 {
        if self.bit.is_some_and(|bit| mode.0 >> bit & 1 == 1) { -1.0 } else { 1.0 }
    }
}

impl Closed {
    fn leg(&self) -> usize {
        match self {
            Self::Constant { leg, .. } => *leg,
            Self::Condition { constraint, .. } => constraint.leg,
            Self::Joint(joint) => joint.leg,
        }
    }

    fn section(&self) -> Section {
        match self {
            Self::Constant { section, .. } => *section,
            Self::Condition { constraint, .. } => constraint.section,
            Self::Joint(joint) => joint.section,
        }
    }

    /// The coordinates that it determines.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Constant { coordinates, .. } => coordinates.clone(),
            Self::Condition { coordinate, .. } => vec![*coordinate],
            Self::Joint(joint) => joint.coordinates.clone(),
        }
    }

    fn has_choice(&self) -> bool {
        match self {
            Self::Constant { .. } => false,
            Self::Condition { constraint, function, .. } => constraint.has_choice(function),
            Self::Joint(joint) => joint.has_choice(),
        }
    }
}
