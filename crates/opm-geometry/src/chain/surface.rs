//! The targets at which a chain closes with one joint held, and where a path of the target crosses them.
//!
//! A joint enters or leaves its limits where it is at one of them, and the branches of a chain meet where
//! its middle joint is at one of two displacements. With a joint held there, the chain has one freedom less
//! than its subspace has dimensions: the targets at which it closes form a surface, the zeros of one
//! function. Along a row of a sweep, or as the intersection motion moves the target of an upper section,
//! that function is a polynomial or a harmonic of one number.
//!
//! A target closes the chain with the joint at its limit exactly where, to within rounding, the closed form
//! gives that value of the joint. So feasibility changes only where the function is within rounding of
//! zero, in every configuration of the chain: the function is never divided by anything, not even near a
//! singularity or where a path is tangent to a surface.

use super::equation::{Equation, Span};
use crate::group::{CylindricalDisplacement, Path, PlanarPath};
use nalgebra::{Complex, Matrix3, Vector3};

/// A function may be zero where its absolute value is below this, as a fraction of the largest number that
/// it can be computed from: a hundred times what rounding and
/// [`REACH_TOLERANCE`](super::REACH_TOLERANCE) change it by.
const SHARE: f64 = 1e-10;

/// How accurately a surface and a path are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// An upper bound of the lengths of the chain and the path, metres.
    pub size: f64,
    /// The uncertainty of the held displacement: radians, or metres over `size`.
    pub blur: f64,
}

/// The targets `g` at which a chain closes with one joint held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// `|g point - centre|² = square`: a link between two pivots remains.
    Circle {
        /// A point that moves with the target, metres.
        point: Complex<f64>,
        /// A fixed point, metres.
        centre: Complex<f64>,
        /// The square of the link's length, square metres.
        square: f64,
    },
    /// `across · g point = at`: a slider that carries a pivot remains.
    Line {
        /// A point that moves with the target, metres.
        point: Complex<f64>,
        /// A fixed unit vector, perpendicular to the slider.
        across: Complex<f64>,
        /// The value of the left side, metres.
        at: f64,
    },
    /// `across · g⁻¹ point = at`: a pivot that carries a slider remains.
    Carried {
        /// A fixed point, metres.
        point: Complex<f64>,
        /// A unit vector that moves with the target, perpendicular to the slider.
        across: Complex<f64>,
        /// The value of the left side, metres.
        at: f64,
    },
    /// The targets with the rotation `rotation` or its opposite: two sliders remain.
    Rotation {
        /// The rotation as a unit vector.
        rotation: Complex<f64>,
    },
    /// `fixed · g carried = cosine`: two revolutes through a centre remain.
    Cone {
        /// A fixed unit direction.
        fixed: Vector3<f64>,
        /// A unit direction that moves with the target.
        carried: Vector3<f64>,
        /// The cosine of the angle between the axes.
        cosine: f64,
    },
    /// `rotation · (angle of g) + advance · (advance of g) = at`, up to a whole number of periods: a coaxial
    /// joint remains.
    Coaxial {
        /// The coefficient of the angle, metres per radian.
        rotation: f64,
        /// The coefficient of the advance, dimensionless.
        advance: f64,
        /// The value of the left side, metres.
        at: f64,
        /// The period of the left side, metres; `None` where full revolutions are counted.
        period: Option<f64>,
    },
    /// `across · g = at`: a slider remains.
    Band {
        /// A vector of length at most one.
        across: Complex<f64>,
        /// The value of the left side, metres.
        at: f64,
    },
    /// `across · g = at` in space: two sliders remain.
    Slab {
        /// A vector of length at most one, perpendicular to the two sliders.
        across: Vector3<f64>,
        /// The value of the left side, metres.
        at: f64,
    },
}

impl Surface {
    /// Calls `found` with the intervals of `t` in which the target may be on the surface. The size of
    /// `uncertainty` covers both the chain and the path ([`Path::size`]).
    ///
    /// # Panics
    /// If the path is in another kind of subspace.
    pub fn meet(
        &self,
        path: &Path,
        span: &Span,
        uncertainty: Uncertainty,
        found: &mut impl FnMut([f64; 2]),
    ) {
        self.along(path).zeros(self.tolerance(uncertainty), span, found);
    }

    /// The least absolute value of the function ([`Surface::along`]) at which a target is certainly not on the surface. The
    /// size of the uncertainty covers both the chain and the target.
    pub fn tolerance(&self, Uncertainty { size, blur }: Uncertainty) -> f64 {
        let scale = match *self {
            Self::Circle { .. } => size * size,
            Self::Line { .. } | Self::Carried { .. } | Self::Band { .. } | Self::Slab { .. } => {
                size
            }
            Self::Rotation { .. } | Self::Cone { .. } => 1.0,
            Self::Coaxial { rotation, advance, at, .. } => {
                (rotation.abs() + advance.abs()) * size.max(1.0) + at.abs()
            }
        };
        (SHARE + 2.0 * blur) * scale
    }

    /// The function of the path parameter whose zeros are the targets on the surface. Panics if the path is in
    /// another kind of subspace.
    #[inline(always)]
    pub fn along(&self, path: &Path) -> Equation {
        match *self {
            Self::Circle { point, centre, square } => match *path.planar() {
                PlanarPath::Translation { start, rate } => {
                    let from = start.apply(point) - centre;
                    let c0 = from.norm_sqr() - square;
                    Equation::Polynomial([c0, 2.0 * dot(from, rate), rate.norm_sqr()])
                }
                PlanarPath::Rotation { start } => {
                    let from = start.apply(point);
                    let k = 2.0 * centre.conj() * from;
                    let c0 = from.norm_sqr() + centre.norm_sqr() - square;
                    Equation::Harmonic([c0, -k.re, k.im])
                }
            },
            Self::Line { point, across, at } => match *path.planar() {
                PlanarPath::Translation { start, rate } => {
                    let c0 = dot(across, start.apply(point)) - at;
                    Equation::Polynomial([c0, dot(across, rate), 0.0])
                }
                PlanarPath::Rotation { start } => {
                    let k = across.conj() * start.apply(point);
                    Equation::Harmonic([-at, k.re, -k.im])
                }
            },
            Self::Carried { point, across, at } => match *path.planar() {
                PlanarPath::Translation { start, rate } => {
                    let across = start.rotation * across;
                    let c0 = dot(across, point - start.translation) - at;
                    Equation::Polynomial([c0, -dot(across, rate), 0.0])
                }
                PlanarPath::Rotation { start } => {
                    let across = start.rotation * across;
                    let k = across.conj() * point;
                    Equation::Harmonic([-dot(across, start.translation) - at, k.re, k.im])
                }
            },
            Self::Rotation { rotation } => match *path.planar() {
                PlanarPath::Translation { start, .. } => {
                    Equation::Polynomial([(rotation.conj() * start.rotation).im, 0.0, 0.0])
                }
                PlanarPath::Rotation { start } => {
                    let k = rotation.conj() * start.rotation;
                    Equation::Harmonic([0.0, k.im, k.re])
                }
            },
            Self::Cone { fixed, carried, cosine } => {
                let (start, axis) = path.spherical();
                let carried = apply(start, &carried);
                let kept = inner(&fixed, axis) * inner(axis, &carried);
                let sine = inner(&cross(&fixed, axis), &carried);
                Equation::Harmonic([kept - cosine, inner(&fixed, &carried) - kept, sine])
            }
            Self::Coaxial { rotation, advance, at, period } => {
                let [start, rate] = path.cylindrical();
                let of = |g: &CylindricalDisplacement| rotation * g.angle + advance * g.advance;
                let [c0, c1] = [of(start) - at, of(rate)];
                match period {
                    Some(period) => Equation::Periodic([c0, c1], period),
                    None => Equation::Polynomial([c0, c1, 0.0]),
                }
            }
            Self::Band { across, at } => {
                let [start, rate] = path.translational();
                Equation::Polynomial([dot(across, *start) - at, dot(across, *rate), 0.0])
            }
            Self::Slab { across, at } => {
                let [start, rate] = path.spatial();
                Equation::Polynomial([across.dot(start) - at, across.dot(rate), 0.0])
            }
        }
    }
}

#[inline(always)]
fn dot(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re + a.im * b.im
}

// Written out, so that a loop over many paths is vectorised.

#[inline(always)]
fn apply(r: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        r.m11 * v.x + r.m12 * v.y + r.m13 * v.z,
        r.m21 * v.x + r.m22 * v.y + r.m23 * v.z,
        r.m31 * v.x + r.m32 * v.y + r.m33 * v.z,
    )
}

#[inline(always)]
fn inner(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
