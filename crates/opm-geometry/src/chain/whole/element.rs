//! The joints of a leg, as elements that move vectors over any numbers.

use super::{LegJoint, MOST_FREEDOMS};
use crate::chain::kernel::Axis;
use crate::numbers::{Plane, Real, Space};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// What a joint does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A rotation.
    Turn,
    /// A rotation that advances by so many metres per radian.
    Helix(f64),
    /// A translation.
    Slide,
    /// Any rotation about a point.
    Ball,
    /// A translation on a circle: this vector from the centre to what moves turns, and nothing else does.
    Circle(Vector3<f64>),
}

/// A joint at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Element {
    pub kind: Kind,
    /// A point of the axis, or the centre; of no meaning for a slider.
    pub point: Vector3<f64>,
    /// The unit direction; of no meaning for a ball.
    pub direction: Vector3<f64>,
    /// The first of its freedoms among those of the leg; that of a joint whose displacement is given comes after all
    /// freedoms.
    pub slot: usize,
}

/// What a joint other than a ball is displaced by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved<T: Real> {
    /// Its rotation, or that of its arm, as a unit vector.
    pub unit: T::Plane,
    /// Its translation along its direction.
    pub shift: T,
}

impl<T: Real> Moved<T> {
    /// No displacement.
    #[inline(always)]
    pub fn home() -> Self {
        let zero = T::constant(0.0);
        Self { unit: T::Plane::new(T::constant(1.0), zero), shift: zero }
    }
}

/// Whether a vector is a point, or a direction, which translations leave alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Vector {
    Point,
    Direction,
}

/// A vector of the mechanism as one of the numbers.
#[inline(always)]
pub(super) fn constant<T: Real>(v: &Vector3<f64>) -> T::Space {
    T::Space::new(T::constant(v.x), T::constant(v.y), T::constant(v.z))
}

/// Whether two legs have the same shape, but for a reflection, to within a millionth of `size`.
pub(super) fn congruent(one: &[Element], other: &[Element], size: f64) -> bool {
    const SAME: f64 = 1e-6;
    let same_kind = |(a, b): (&Element, &Element)| match (a.kind, b.kind) {
        (Kind::Helix(a), Kind::Helix(b)) => (a - b).abs() <= SAME * size,
        // How an arm lies to the axes of other joints is not compared.
        (Kind::Circle(_), Kind::Circle(_)) => false,
        (a, b) => a == b,
    };
    let shape = |a: &Element, b: &Element| {
        let placed = a.kind != Kind::Slide && b.kind != Kind::Slide;
        let between = if placed { (b.point - a.point) / size } else { Vector3::zeros() };
        let along = [a.direction.dot(&between), b.direction.dot(&between)];
        [a.direction.dot(&b.direction), between.norm(), along[0], along[1]]
    };
    let same_shape = |i: usize, j: usize| {
        let [one, other] = [shape(&one[i], &one[j]), shape(&other[i], &other[j])];
        one.iter().zip(other).all(|(a, b)| (a - b).abs() <= SAME)
    };
    one.len() == other.len()
        && one.iter().zip(other).all(same_kind)
        && (0..one.len()).all(|j| (0..j).all(|i| same_shape(i, j)))
}

impl Element {
    /// The elements of joints, and the number of their freedoms. The displacements of some, which are no balls, are given.
    pub fn of(joints: &[LegJoint], given: &[bool]) -> (Vec<Self>, usize) {
        let (mut freedom, mut known) = (0, MOST_FREEDOMS);
        let elements = joints.iter().enumerate().map(|(number, joint)| {
            let slot = if given.get(number) == Some(&true) { &mut known } else { &mut freedom };
            let zero = Vector3::zeros();
            let (kind, point, direction, freedoms) = match *joint {
                LegJoint::Screw { axis, point, pitch } => {
                    let kind = if pitch == 0.0 { Kind::Turn } else { Kind::Helix(pitch) };
                    (kind, point.coords, axis.into_inner(), 1)
                }
                LegJoint::Slide { axis } => (Kind::Slide, zero, axis.into_inner(), 1),
                LegJoint::Ball { point } => (Kind::Ball, point.coords, zero, 3),
                LegJoint::Parallelogram { axis, point, arm } => {
                    (Kind::Circle(arm), point.coords, axis.into_inner(), 2)
                }
            };
            let element = Self { kind, point, direction, slot: *slot };
            *slot += freedoms;
            element
        });
        let elements = elements.collect();
        (elements, freedom)
    }

    /// Whether its displacement is given.
    #[inline(always)]
    pub fn is_given(&self) -> bool {
        self.slot >= MOST_FREEDOMS
    }

    /// The displacement of a joint, which is no ball, by a value.
    pub fn moved_by<T: Real>(&self, value: T) -> Moved<T> {
        match self.kind {
            Kind::Turn | Kind::Circle(_) => Moved { unit: value.unit(), ..Moved::home() },
            Kind::Helix(pitch) => Moved { unit: value.unit(), shift: value * pitch },
            Kind::Slide => Moved { shift: value, ..Moved::home() },
            Kind::Ball => Moved::home(),
        }
    }

    /// Whether it matters where its axis or centre is.
    pub fn has_place(&self) -> bool {
        match self.kind {
            Kind::Turn | Kind::Helix(_) | Kind::Ball => true,
            Kind::Slide | Kind::Circle(_) => false,
        }
    }

    /// Whether it turns what it carries.
    pub fn turns(&self) -> bool {
        match self.kind {
            Kind::Turn | Kind::Helix(_) | Kind::Ball => true,
            Kind::Slide | Kind::Circle(_) => false,
        }
    }

    /// The arm of a circle and the point to which it moves the arm's end where it moves a point to another one: an equation in
    /// these is one in the joint. Both points themselves for other joints.
    #[inline(always)]
    pub fn armed<T: Real>(&self, moved: T::Space, fixed: T::Space) -> (T::Space, T::Space) {
        match self.kind {
            Kind::Circle(arm) => {
                let arm = constant::<T>(&arm);
                (arm, fixed.plus(T::constant(-1.0), moved).plus(T::constant(1.0), arm))
            }
            Kind::Turn | Kind::Helix(_) | Kind::Slide | Kind::Ball => (moved, fixed),
        }
    }

    /// The axis. That of a circle is through the origin, from where its arm is.
    #[inline(always)]
    pub fn axis<T: Real>(&self) -> Axis<T> {
        let point = match self.kind {
            Kind::Circle(_) => Vector3::zeros(),
            Kind::Turn | Kind::Helix(_) | Kind::Slide | Kind::Ball => self.point,
        };
        Axis { point: constant::<T>(&point), direction: constant::<T>(&self.direction) }
    }

    /// The number of freedoms.
    pub fn freedoms(&self) -> usize {
        match self.kind {
            Kind::Turn | Kind::Helix(_) | Kind::Slide => 1,
            Kind::Circle(_) => 2,
            Kind::Ball => 3,
        }
    }

    /// A vector moved by the joint, or moved back. A ball, of which nothing is known before the end, moves nothing.
    #[inline(always)]
    pub fn carry<T: Real>(&self, by: Moved<T>, back: bool, of: Vector, v: T::Space) -> T::Space {
        let unit = if back { by.unit.conj() } else { by.unit };
        let along = |v: T::Space| {
            let shift = if back { -by.shift } else { by.shift };
            v.plus(shift, constant::<T>(&self.direction))
        };
        T::compute(|| match (self.kind, of) {
            (Kind::Turn, Vector::Point) => self.axis::<T>().moved(v, unit),
            (Kind::Turn | Kind::Helix(_), Vector::Direction) => self.axis::<T>().turned(v, unit),
            (Kind::Helix(_), Vector::Point) => along(self.axis::<T>().moved(v, unit)),
            (Kind::Slide, Vector::Point) => along(v),
            (Kind::Circle(arm), Vector::Point) => {
                let arm = constant::<T>(&arm);
                let moved = self.axis::<T>().turned(arm, by.unit).plus(T::constant(-1.0), arm);
                v.plus(T::constant(if back { -1.0 } else { 1.0 }), moved)
            }
            (Kind::Slide | Kind::Circle(_), Vector::Direction) | (Kind::Ball, _) => v,
        })
    }

    /// The displacement by the values of its freedoms.
    pub fn exp(&self, values: &[f64]) -> Isometry3<f64> {
        let about = |rotation: UnitQuaternion<f64>, shift: Vector3<f64>| {
            let translation = self.point - rotation * self.point + shift;
            Isometry3::from_parts(Translation3::from(translation), rotation)
        };
        let turn =
            |q: f64| UnitQuaternion::from_axis_angle(&Unit::new_unchecked(self.direction), q);
        match (self.kind, values) {
            (Kind::Turn, &[q, ..]) => about(turn(q), Vector3::zeros()),
            (Kind::Helix(pitch), &[q, ..]) => about(turn(q), self.direction * (pitch * q)),
            (Kind::Slide, &[q, ..]) => Translation3::from(self.direction * q).into(),
            (Kind::Circle(arm), &[q, ..]) => Translation3::from(turn(q) * arm - arm).into(),
            (Kind::Ball, &[x, y, z, ..]) => {
                about(UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z)), Vector3::zeros())
            }
            (Kind::Turn | Kind::Helix(_) | Kind::Slide | Kind::Ball | Kind::Circle(_), _) => {
                Isometry3::identity()
            }
        }
    }
}
