//! The equation that a joint of a chain, held at a known displacement, imposes on the chain's displacement.
//!
//! A chain `E₀ E₁ E₂` of which one joint is held can be written as `D · X(p) · Y(q) · E` with the two
//! others, `X` and `Y`, free. Where the second is held, the third is transformed by it:
//! `E₀ E₁ E₂ = E₀ (E₁ E₂ E₁⁻¹) E₁`. Two free joints leave one equation on the displacement, one of those
//! below.

use crate::chain::planar::PlanarJoint;
use crate::chain::{Chain, ReachDeficit};
use crate::group::{
    Displacement, JointDisplacement, LocalTwist, PlanarDisplacement, SubspaceKind, mismatch,
    rotation_about,
};
use crate::numbers::{Over, Plane, PlaneOver, Real, RotationOver, Space, SpaceOver};
use nalgebra::{Complex, Vector3};

/// Conditions that miss each other by less than this, as a fraction of the size, count as compatible:
/// rounding at the boundary of reach must not decide.
pub const VERGE: f64 = 1e-13;

/// The rotation by a right angle, counter-clockwise.
pub const QUARTER: Complex<f64> = Complex::new(0.0, 1.0);

/// One equation on a displacement `g`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition<C: Real = f64> {
    /// A point of the body is at a given distance from a point of the base: `|g point − centre| = radius`.
    Circle {
        /// The point, body coordinates, metres.
        point: C::Plane,
        /// The centre, base coordinates, metres.
        centre: C::Plane,
        /// The distance, metres.
        radius: C,
    },
    /// A point of the body is on a line of the base: `normal · g point = offset`.
    Line {
        /// The point, body coordinates, metres.
        point: C::Plane,
        /// The line's unit normal, base coordinates.
        normal: C::Plane,
        /// The line's distance from the origin along the normal, metres.
        offset: C,
    },
    /// A point of the base is on a line of the body: `normal · g⁻¹ point = offset`.
    CarriedLine {
        /// The point, base coordinates, metres.
        point: C::Plane,
        /// The line's unit normal, body coordinates.
        normal: C::Plane,
        /// The line's distance from the origin along the normal, metres.
        offset: C,
    },
    /// The rotation of `g` is known.
    Heading {
        /// The unit vector in the direction of the angle.
        rotation: C::Plane,
    },
    /// A direction of the body makes a given angle with a direction of the base:
    /// `fixed · g carried = cosine`.
    Cone {
        /// The unit direction, base coordinates.
        fixed: C::Space,
        /// The unit direction, body coordinates.
        carried: C::Space,
        /// The cosine of the angle between them.
        cosine: C,
    },
    /// A linear equation on a displacement of a commutative subspace: `normal · g = value`.
    Flat {
        /// The coefficients, for the coordinates of the displacement's logarithm.
        normal: C::Space,
        /// The value, in the units of `normal · g`.
        value: C,
    },
}

/// The coordinates of the displacement that one unit of each joint makes, for a chain in a commutative
/// subspace; `None` for other chains. A chain of two joints has the third unit vector as a third one.
pub fn flat_joints(chain: &Chain) -> Option<[LocalTwist; 3]> {
    match chain {
        Chain::Cylindrical(chain) => {
            let [p, q] =
                chain.joints().map(|joint| LocalTwist::new(joint.rotation, joint.advance, 0.0));
            Some([p, q, LocalTwist::z()])
        }
        Chain::Translational(chain) => {
            let [p, q] = chain.slides().map(|slide| LocalTwist::new(slide.re, slide.im, 0.0));
            Some([p, q, LocalTwist::z()])
        }
        Chain::Spatial(chain) => Some(*chain.slides()),
        Chain::Rigid | Chain::Part(_) | Chain::Planar(_) | Chain::Spherical(_) | Chain::Ball(_) => {
            None
        }
    }
}

impl Condition {
    /// The equation that joint number `held` at `displacement` imposes on the chain's displacement. `None` for
    /// a spherical joint, whose coordinates impose no such equation, and for a chain without joints.
    pub fn new(chain: &Chain, held: usize, displacement: JointDisplacement) -> Option<Self> {
        match chain {
            Chain::Planar(chain) => Some(planar(&chain.joints(), held, displacement)),
            Chain::Spherical(chain) => Some(spherical(chain.axes(), held, displacement)),
            Chain::Rigid | Chain::Part(_) | Chain::Ball(_) => None,
            Chain::Cylindrical(_) | Chain::Translational(_) | Chain::Spatial(_) => {
                let joints = flat_joints(chain)?;
                let others: [usize; 2] = match held {
                    0 => [1, 2],
                    1 => [0, 2],
                    _ => [0, 1],
                };
                let [p, q] = others.map(|joint| joints[joint]);
                let normal = p.cross(&q);
                Some(Self::Flat { normal, value: normal.dot(&joints[held]) * displacement.value() })
            }
        }
    }

    /// The subspace of the displacements that the condition is on; for `Flat`, one of the commutative ones.
    fn kind(&self) -> SubspaceKind {
        match self {
            Self::Circle { .. }
            | Self::Line { .. }
            | Self::CarriedLine { .. }
            | Self::Heading { .. } => SubspaceKind::Planar,
            Self::Cone { .. } => SubspaceKind::Spherical,
            Self::Flat { .. } => SubspaceKind::Cylindrical,
        }
    }

    /// The fixed and the carried direction and the cosine of the angle between them, of a condition on
    /// rotations about a centre.
    pub fn cone(&self) -> (Vector3<f64>, Vector3<f64>, f64) {
        match *self {
            Self::Cone { fixed, carried, cosine } => (fixed, carried, cosine),
            Self::Circle { .. }
            | Self::Line { .. }
            | Self::CarriedLine { .. }
            | Self::Heading { .. }
            | Self::Flat { .. } => mismatch(SubspaceKind::Spherical, self.kind()),
        }
    }

    /// By how much the condition is missed, where its [`value`](Self::value) is at least this far from zero.
    pub fn deficit(&self, value: f64) -> ReachDeficit {
        match self {
            Self::Circle { radius, .. } => {
                let square = (radius * radius + value).max(0.0);
                ReachDeficit::length((square.sqrt() - radius).abs())
            }
            Self::Line { .. } | Self::CarriedLine { .. } | Self::Flat { .. } => {
                ReachDeficit::length(value.abs())
            }
            Self::Heading { .. } => ReachDeficit::angle(value.clamp(-1.0, 1.0).asin().abs()),
            Self::Cone { cosine, .. } => {
                let arc = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
                ReachDeficit::angle((arc(cosine + value) - arc(*cosine)).abs())
            }
        }
    }

    /// Panics: the condition is not on displacements of a plane.
    pub fn not_planar(&self) -> ! {
        mismatch(SubspaceKind::Planar, self.kind())
    }

    /// The same condition with all lengths multiplied by a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Circle { point, centre, radius } => Self::Circle {
                point: point * factor,
                centre: centre * factor,
                radius: radius * factor,
            },
            Self::Line { point, normal, offset } => {
                Self::Line { point: point * factor, normal, offset: offset * factor }
            }
            Self::CarriedLine { point, normal, offset } => {
                Self::CarriedLine { point: point * factor, normal, offset: offset * factor }
            }
            Self::Heading { .. } | Self::Cone { .. } | Self::Flat { .. } => self,
        }
    }

    /// The condition on `g` that is equivalent to this condition on `g · h`.
    #[must_use]
    pub fn before(self, h: &Displacement) -> Self {
        match self {
            Self::Circle { point, centre, radius } => {
                Self::Circle { point: h.planar().apply(point), centre, radius }
            }
            Self::Line { point, normal, offset } => {
                Self::Line { point: h.planar().apply(point), normal, offset }
            }
            Self::CarriedLine { point, normal, offset } => {
                // normal · h⁻¹ z = (h normal) · (z − translation)
                let h = h.planar();
                let normal = h.rotation * normal;
                Self::CarriedLine { point, normal, offset: offset + dot(normal, h.translation) }
            }
            Self::Heading { rotation } => {
                Self::Heading { rotation: rotation * h.planar().rotation.conj() }
            }
            Self::Cone { fixed, carried, cosine } => {
                Self::Cone { fixed, carried: h.spherical() * carried, cosine }
            }
            Self::Flat { normal, value } => {
                Self::Flat { normal, value: value - normal.dot(&h.sum()) }
            }
        }
    }

    /// The condition on `g` that is equivalent to this condition on `h⁻¹ · g`.
    #[must_use]
    pub fn after(self, h: &Displacement) -> Self {
        match self {
            Self::Circle { point, centre, radius } => {
                Self::Circle { point, centre: h.planar().apply(centre), radius }
            }
            Self::Line { point, normal, offset } => {
                let h = h.planar();
                let normal = h.rotation * normal;
                Self::Line { point, normal, offset: offset + dot(normal, h.translation) }
            }
            Self::CarriedLine { point, normal, offset } => {
                Self::CarriedLine { point: h.planar().apply(point), normal, offset }
            }
            Self::Heading { rotation } => {
                Self::Heading { rotation: rotation * h.planar().rotation }
            }
            Self::Cone { fixed, carried, cosine } => {
                Self::Cone { fixed: h.spherical() * fixed, carried, cosine }
            }
            Self::Flat { normal, value } => {
                Self::Flat { normal, value: value + normal.dot(&h.sum()) }
            }
        }
    }
}

impl<C: Real> Condition<C> {
    /// The difference of the equation's two sides at a displacement, zero where that satisfies the condition. Of
    /// a circle it is that of the squared distances, square metres; of a heading, the sine of the angle.
    ///
    /// It is a polynomial of degree one in the components of the displacement, but for a circle: that is of
    /// degree two in a translation.
    #[inline(always)]
    pub fn value<T: Over<C>>(&self, g: &Displacement<T>) -> T {
        match *self {
            Self::Circle { point, centre, radius } => {
                (g.planar().apply(point) - centre).named("off").norm_sqr() - radius * radius
            }
            Self::Line { point, normal, offset } => g.planar().apply(point).dot(normal) - offset,
            Self::CarriedLine { point, normal, offset } => {
                g.planar().inverse().apply(point).dot(normal) - offset
            }
            Self::Heading { rotation } => (g.planar().rotation * rotation.conj()).im(),
            Self::Cone { fixed, carried, cosine } => {
                g.spherical().apply(carried).against(fixed) - cosine
            }
            Self::Flat { normal, value } => {
                let [x, y, z] = g.sums();
                T::Space::new(x, y, z).against(normal) - value
            }
        }
    }
}

/// `a · b`, as vectors of the plane.
#[inline]
pub fn dot(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re + a.im * b.im
}

/// The length of a vector of the plane, without protection from overflow.
#[inline]
pub fn length(z: Complex<f64>) -> f64 {
    z.norm_sqr().sqrt()
}

fn planar(joints: &[PlanarJoint; 3], held: usize, displacement: JointDisplacement) -> Condition {
    let known = joints[held].displacement(displacement);
    let none = PlanarDisplacement::IDENTITY;
    let (before, first, second, after) = match held {
        0 => (known, joints[1], joints[2], none),
        1 => (none, joints[0], joints[2].carried(&known), known),
        _ => (none, joints[0], joints[1], known),
    };
    let inner = after.inverse();
    match (first, second) {
        (PlanarJoint::Revolute { at: x, .. }, PlanarJoint::Revolute { at: y, .. }) => {
            let (point, centre) = (inner.apply(y), before.apply(x));
            Condition::Circle { point, centre, radius: length(y - x) }
        }
        (PlanarJoint::Prismatic { along }, PlanarJoint::Revolute { at: y, .. }) => {
            let normal = QUARTER * before.rotation * along;
            let offset = dot(normal, before.apply(y));
            Condition::Line { point: inner.apply(y), normal, offset }
        }
        (PlanarJoint::Revolute { at: x, .. }, PlanarJoint::Prismatic { along }) => {
            let normal = QUARTER * inner.rotation * along;
            let offset = dot(normal, inner.apply(x));
            Condition::CarriedLine { point: before.apply(x), normal, offset }
        }
        (PlanarJoint::Prismatic { .. }, PlanarJoint::Prismatic { .. }) => {
            Condition::Heading { rotation: before.rotation * after.rotation }
        }
    }
}

fn spherical(axes: &[Vector3<f64>; 3], held: usize, displacement: JointDisplacement) -> Condition {
    let known = rotation_about(&axes[held], displacement.unit_direction());
    let (fixed, carried, cosine) = match held {
        0 => (known * axes[1], axes[2], axes[1].dot(&axes[2])),
        1 => {
            let third = known * axes[2];
            (axes[0], axes[2], axes[0].dot(&third))
        }
        _ => (axes[0], known.tr_mul(&axes[1]), axes[0].dot(&axes[1])),
    };
    Condition::Cone { fixed, carried, cosine }
}
