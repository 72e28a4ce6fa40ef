//! Closed forms of legs as a whole: joint by joint, by invariants.
//!
//! A leg closes a loop: the displacements of its joints, from base to platform, make that of the platform. Of the joints that
//! are not found yet, one splits the others into two arcs. Where each arc leaves an object alone (a point, a direction, a
//! plane), the two objects have an invariant that is the same at all poses or known: a distance, a height, an angle. That is
//! an equation in the one joint alone ([`kernel`](super::kernel)). It is found, and the rest of the loop is shorter by it.
//!
//! [`WholeLeg::new`] looks for an order in which this goes on to the end. The order is tested at sampled motions of the
//! platform; it holds for all motions of the set that they are from. [`WholeLeg::solve`] then only computes: what is rare is
//! found afterwards.
//!
//! * A spherical joint that is left alone is read off. Where two are left, the first one swings by the smallest angle and does
//!   not spin.
//! * The sign of a choice is that of the slope of its equation, as the joint turns or slides on: for a slider of the square
//!   of a distance; for a revolute joint of the height or the cosine of an angle, or against that of the square of a distance.
//!   It is constant along a path, until the branches meet.
//! * An angle that is free is that of home.

mod element;
mod equation;
mod nodes;
mod objects;
mod order;
mod program;
mod reach;
mod roots;
mod run;
mod samples;
mod solve;
mod step;
mod write;

pub use equation::{Invariant, Roots};
pub use reach::{LegReach, PackReach};
pub(crate) use roots::{General, scale};
pub use run::WholeRun;

use super::{Branch, ReachDeficit};
use crate::numbers::JointDisplacement;
use element::{Element, Kind};
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use nodes::Nodes;
use objects::Leg;
use order::Search;
use program::{JOINTS, Program, SIGNS};
use samples::Sample;
use solve::{MOST_GIVEN, Solved, VALUES};
use step::Candidate;

/// The most freedoms that a leg can have.
pub const MOST_FREEDOMS: usize = 7;
/// A leg has at most so many parallelograms.
pub const MOST_PARALLELOGRAMS: usize = 2;

/// The most choices of a leg.
const MOST_CHOICES: usize = 2;

/// The most choices of a leg of which joints are given.
const MOST_GIVEN_CHOICES: usize = 3;

/// A loop that is open by no more than this is closed: radians, and lengths as a share of the size. A closed form leaves about
/// 1e-14, and within 1e-7 of a pose at which two branches meet up to 1e-10. A mechanism's file gives directions to some ten
/// digits.
pub const CLOSURE: f64 = 1e-9;

/// Not more motions than this are sampled.
const MOST_SAMPLES: usize = 12;
/// An order is given up where it finds fewer of the samples than this share.
const MOST_LOST: f64 = 0.1;
/// A sampled joint is found where the order gives it to within this, radians or sizes.
const SAME: f64 = 1e-5;

/// A joint of a leg at home, in base coordinates. A universal joint and a cylindrical one are two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegJoint {
    /// A revolute or helical joint.
    Screw {
        /// The direction of its axis.
        axis: Unit<Vector3<f64>>,
        /// A point of its axis, metres.
        point: Point3<f64>,
        /// Its advance, metres per radian; zero for a revolute joint.
        pitch: f64,
    },
    /// A prismatic joint.
    Slide {
        /// The direction.
        axis: Unit<Vector3<f64>>,
    },
    /// A spherical joint.
    Ball {
        /// The centre, metres.
        point: Point3<f64>,
    },
    /// A parallelogram: a bar turns, and what it carries does not. Its two freedoms are the hinges at the ends of the bar, the
    /// second of which turns back what the first one turns.
    Parallelogram {
        /// The direction of the axes of its hinges.
        axis: Unit<Vector3<f64>>,
        /// A point of the first one's, metres.
        point: Point3<f64>,
        /// The bar, from one hinge to the other, metres.
        arm: Vector3<f64>,
    },
}

impl LegJoint {
    /// The number of its freedoms.
    pub fn freedoms(&self) -> usize {
        match self {
            Self::Screw { .. } | Self::Slide { .. } => 1,
            Self::Parallelogram { .. } => 2,
            Self::Ball { .. } => 3,
        }
    }

    /// Its displacement by the values of its freedoms, radians and metres; a ball's are its rotation vector. The first one
    /// of a parallelogram tells the second.
    pub fn exp(&self, values: &[f64]) -> Isometry3<f64> {
        let (elements, _) = Element::of(&[*self], &[]);
        elements.iter().fold(Isometry3::identity(), |_, element| element.exp(values))
    }
}

/// A step of an order: for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StepName {
    /// The number of the joint.
    pub joint: usize,
    /// How it is found: `linear`, `quadratic`, `direct`, `pair`, `double`, `twofold`, `ball` or `swing`.
    pub root: &'static str,
    /// By which invariant: `distance`, `height`, `angle`, `point`, `line` or `direction`; `None` for a spherical joint.
    pub invariant: Option<&'static str>,
}

/// Which orders are wanted.
#[derive(Clone, Copy)]
struct Orders<'a> {
    /// The joints that come first where that is possible.
    actuated: &'a [bool],
    most_choices: usize,
    /// An order to try first; none if empty.
    known: &'a [StepName],
}

/// Why a leg has no closed form here. Joints are named by their numbers from the base, from zero.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoOrder {
    /// The joints cannot be found one by one.
    #[error(
        "joints {} can only be found together: no two of the arcs between them leave objects alone whose invariant has one \
         of them alone. Axes of neighbours among them that meet in a point or are parallel would separate them",
        List(.joints)
    )]
    Coupled {
        /// The joints that are left.
        joints: Vec<usize>,
    },
    /// Each order has more choices than are named.
    #[error(
        "an order would have more than {most} choices with two solutions each, and joints {} would still be left",
        List(.joints)
    )]
    Choices {
        /// The most choices.
        most: usize,
        /// The joints that are left after them.
        joints: Vec<usize>,
    },
    /// More freedoms than the leg can fix.
    #[error("{found} freedoms, expected at most {MOST_FREEDOMS} with at most two spherical joints")]
    Freedoms {
        /// The number of freedoms.
        found: usize,
    },
    /// More parallelograms than are supported.
    #[error("{found} parallelograms, expected at most {MOST_PARALLELOGRAMS}")]
    Parallelograms {
        /// The number of them.
        found: usize,
    },
    /// No sampled motion but home is in reach.
    #[error("the leg reaches none of the {given} sampled motions of the platform")]
    Unreached {
        /// The number of motions.
        given: usize,
    },
    /// An order was found, but it does not lead back to the samples.
    #[error("the joints can be found one by one, but that misses configurations of the leg")]
    Untrue,
}

/// Numbers with commas between them.
struct List<'a>(&'a [usize]);

impl std::fmt::Display for List<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, number) in self.0.iter().enumerate() {
            let before = match i {
                0 => "",
                _ if i + 1 == self.0.len() => " and ",
                _ => ", ",
            };
            write!(f, "{before}{number}")?;
        }
        Ok(())
    }
}

/// The closed form of a leg.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLeg {
    elements: Vec<Element>,
    program: Program,
    names: Vec<StepName>,
    choosing: Vec<usize>,
    freedoms: usize,
    centre: Vector3<f64>,
    size: f64,
    /// Whether the loop closes wherever all roots are real.
    real_closes: bool,
}

impl WholeLeg {
    /// The closed form of a leg. `actuated` says which joints have motors: these are found first where that is possible.
    /// `motions` are displacements of the platform from home, at random, from the set that it moves in: the closed form is
    /// valid for targets of that set. `size` is a length of the leg, metres, with which others are compared. Where the leg
    /// is congruent to one of `solved`, which have the same motors, its order is taken.
    ///
    /// # Errors
    /// Where there is no order.
    pub fn new(
        joints: &[LegJoint],
        actuated: &[bool],
        motions: &[Isometry3<f64>],
        size: f64,
        solved: &[&Self],
    ) -> Result<Self, NoOrder> {
        let (elements, freedoms) = Element::of(joints, &[]);
        let congruent = |one: &&&Self| element::congruent(&one.elements, &elements, size);
        let known = solved.iter().find(congruent).map_or(&[][..], |one| &one.names);
        let orders = Orders { actuated, most_choices: MOST_CHOICES, known };
        let mut leg = Self::ordered(&elements, freedoms, orders, size, |elements, centre| {
            let reached =
                motions.iter().filter_map(|motion| Sample::at(elements, motion, centre, size));
            let reached: Vec<Sample> = reached.take(MOST_SAMPLES).collect();
            match reached.is_empty() && freedoms > 0 {
                true => Err(NoOrder::Unreached { given: motions.len() }),
                false => Ok(reached),
            }
        })?;
        leg.real_closes = leg.closes_where_real(motions);
        Ok(leg)
    }

    /// The closed form of a leg of which some joints, three at most and no balls, are `given`: [`WholeLeg::solve_given`] takes
    /// their displacements. It is valid for targets and displacements like those of `configurations`: for each of these, at
    /// random, the values of all freedoms in the order of the joints, a ball's as a rotation vector.
    ///
    /// # Errors
    /// Where there is no order.
    pub fn with_given(
        joints: &[LegJoint],
        given: &[bool],
        configurations: &[Vec<f64>],
        size: f64,
    ) -> Result<Self, NoOrder> {
        let (elements, freedoms) = Element::of(joints, given);
        let orders = Orders { actuated: &[], most_choices: MOST_GIVEN_CHOICES, known: &[] };
        Self::ordered(&elements, freedoms, orders, size, |elements, _| {
            let of_values = |values: &Vec<f64>| {
                let (mut all, mut next) = (vec![0.0; VALUES], values.iter());
                for element in elements {
                    let own = &mut all[element.slot..element.slot + element.freedoms()];
                    own.iter_mut().zip(&mut next).for_each(|(to, value)| *to = *value);
                }
                Sample::with(elements, all)
            };
            Ok(configurations.iter().take(MOST_SAMPLES).map(of_values).collect())
        })
    }

    fn ordered(
        elements: &[Element],
        freedoms: usize,
        orders: Orders<'_>,
        size: f64,
        sampled: impl FnOnce(&[Element], &Vector3<f64>) -> Result<Vec<Sample>, NoOrder>,
    ) -> Result<Self, NoOrder> {
        let balls = elements.iter().filter(|one| one.kind == Kind::Ball).count();
        let given = elements.iter().filter(|one| one.is_given()).count();
        let full = given > MOST_GIVEN || elements.len() > JOINTS;
        if freedoms > MOST_FREEDOMS || balls > 2 || full {
            return Err(NoOrder::Freedoms { found: freedoms });
        }
        let found = elements.iter().filter(|one| matches!(one.kind, Kind::Circle(_))).count();
        if found > MOST_PARALLELOGRAMS {
            return Err(NoOrder::Parallelograms { found });
        }
        let placed: Vec<Vector3<f64>> =
            elements.iter().filter(|one| one.has_place()).map(|one| one.point).collect();
        let count = placed.len().max(1);
        let centre = placed.iter().sum::<Vector3<f64>>() * (1.0 / count as f64);
        let mut samples = vec![Sample::home(elements)];
        samples.extend(sampled(elements, &centre)?);
        let leg = Leg { elements, samples: &samples, centre, size };
        let mut nodes = Nodes::new(elements, &samples, size);
        let mut search = Search::new(leg, &mut nodes, orders.actuated, orders.most_choices);
        let mut test = |nodes: &mut Nodes<'_>, steps: &[Candidate]| {
            let program = write::write(leg, nodes, steps)?;
            let whole = Self::of(elements, freedoms, steps, program, centre, size);
            whole.finds(&samples).then_some(whole)
        };
        let known = match orders.known {
            [] => None,
            known => search.known(known, &mut test),
        };
        if let Some(found) = known.or_else(|| search.run(&mut test)) {
            return Ok(found);
        }
        if search.untrue() {
            return Err(NoOrder::Untrue);
        }
        let stuck = search.stuck;
        let open = |&joint: &usize| stuck & (1 << joint) != 0 && !elements[joint].is_given();
        let left = (0..elements.len()).filter(open).collect();
        Err(if search.full {
            NoOrder::Choices { most: orders.most_choices, joints: left }
        } else {
            NoOrder::Coupled { joints: left }
        })
    }

    fn of(
        elements: &[Element],
        freedoms: usize,
        steps: &[Candidate],
        program: Program,
        centre: Vector3<f64>,
        size: f64,
    ) -> Self {
        let mut names: Vec<StepName> =
            steps.iter().map(|step| step.kernel.named(step.joint)).collect();
        let balls: Vec<usize> =
            (0..elements.len()).filter(|&i| elements[i].kind == Kind::Ball).collect();
        for (i, &joint) in balls.iter().enumerate() {
            let root = if balls.len() == 2 && i == 0 { "swing" } else { "ball" };
            names.push(StepName { joint, root, invariant: None });
        }
        let mut choosing: Vec<usize> =
            steps.iter().filter(|step| step.kernel.chooses()).map(|step| step.joint).collect();
        choosing.sort_unstable();
        let real_closes = false;
        let elements = elements.to_vec();
        Self { elements, program, names, choosing, freedoms, centre, size, real_closes }
    }

    /// Whether home is found on some branch, and the samples are.
    fn finds(&self, samples: &[Sample]) -> bool {
        let found = |sample: &Sample| {
            let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
            let given = self.elements.iter().filter(|element| element.is_given());
            let given: Vec<f64> = given.map(|element| sample.values[element.slot]).collect();
            self.branches().any(|branches| {
                self.solve_given(&sample.target, &given, branches, &mut out).is_ok()
                    && self.elements.iter().filter(|element| !element.is_given()).all(|element| {
                        let (value, found) = (sample.values[element.slot], out[element.slot]);
                        match element.kind {
                            Kind::Slide => (found.value() - value).abs() <= SAME * self.size,
                            Kind::Turn | Kind::Helix(_) | Kind::Circle(_) => {
                                (found.nearest(value) - value).abs() <= SAME
                            }
                            Kind::Ball => true,
                        }
                    })
            })
        };
        let lost = samples.iter().skip(1).filter(|sample| !found(sample)).count();
        samples.first().is_some_and(found) && lost as f64 <= MOST_LOST * (samples.len() - 1) as f64
    }

    /// All branches: one for each combination of the signs of its choices.
    fn branches(&self) -> impl Iterator<Item = [Branch; SIGNS]> + use<> {
        (0..1_usize << self.choices())
            .map(|number| std::array::from_fn(|choice| Branch::BOTH[number >> choice & 1]))
    }

    /// The number of choices with two solutions: at most two, or three where joints are given.
    pub fn choices(&self) -> usize {
        self.choosing.len()
    }

    /// The joint of each choice, in the order from the base.
    pub fn choosing_joints(&self) -> &[usize] {
        &self.choosing
    }

    /// The number of freedoms.
    pub fn freedoms(&self) -> usize {
        self.freedoms
    }

    /// Whether this is the closed form of a leg with these joints.
    pub fn is_of(&self, joints: &[LegJoint]) -> bool {
        Element::of(joints, &[]).0 == self.elements
    }

    /// Where a strut could spin between two spherical joints: the number of the first one's first freedom, and the direction of the
    /// strut at home, along which its rotation vector has no component. `None` where nothing is idle.
    pub fn idle(&self) -> Option<(usize, Vector3<f64>)> {
        let mut balls = self.elements.iter().filter(|element| element.kind == Kind::Ball);
        let (first, second) = (balls.next()?, balls.next()?);
        Some((first.slot, (second.point - first.point).normalize()))
    }

    /// How the joints are found, in the order in which they are.
    pub fn steps(&self) -> impl Iterator<Item = StepName> {
        self.names.iter().copied()
    }

    /// Writes the freedoms' displacements from base to platform that move the platform by `target`; nothing where it is out of
    /// reach. A spherical joint has three, which are its rotation vector in base coordinates, at most π long. Those that the
    /// leg does not have are zero. The branches are those of the choices; more are of no meaning.
    ///
    /// # Errors
    /// By how much the target is out of reach, or out of the set that the leg moves in.
    #[inline]
    pub fn solve(
        &self,
        target: &Isometry3<f64>,
        [first, second]: [Branch; 2],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        self.solve_given(target, &[], [first, second, Branch::Plus, Branch::Plus], out)
    }

    /// The same for a leg of which joints are given, with their displacements in the order of the joints.
    ///
    /// # Errors
    /// As [`WholeLeg::solve`].
    #[inline(always)]
    pub fn solve_given(
        &self,
        target: &Isometry3<f64>,
        given: &[f64],
        branches: [Branch; 4],
        out: &mut [JointDisplacement; MOST_FREEDOMS],
    ) -> Result<(), ReachDeficit> {
        let Self { elements, program, centre, size, .. } = self;
        Solved { elements, program, centre, size: *size, given }.joints(target, branches, out)
    }
}

#[cfg(test)]
mod tests;
