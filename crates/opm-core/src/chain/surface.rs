//! Targets on which a chain closes with one joint held, and where a path of the target meets them.
//!
//! A joint enters or leaves its limits where it is at one of them, and the branches of a chain meet where
//! its middle joint is at one of two amounts. Held there, it leaves the chain one freedom less than its
//! subspace: the targets that it closes on are a surface, the zeros of one function. Along a row of a
//! sweep, or as a cut moves the target of an upper section, that function is a polynomial or a
//! harmonic of one number.
//!
//! What closes a chain with the joint at its limit closes it to within rounding where its closed form
//! says that the joint is there. So the closed form changes its mind only where the function is within
//! rounding of zero, however the chain is bent: neither near a singularity nor where a path only just
//! touches a surface has the function to be divided by anything.

use super::equation::{Equation, Span};
use crate::group::{CylindricalDisplacement, Path, PlanarPath};
use nalgebra::{Complex, Vector3};

/// How near to zero a function is that may be zero, as a share of the largest number that it can be
/// computed from: a hundred times what rounding and [`REACH_TOLERANCE`](super::REACH_TOLERANCE) make of it.
const SHARE: f64 = 1e-10;

/// The targets `g` on which a chain closes with one joint held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// `|g point - centre|² = square`: what is left is a link between two pivots.
    Circle {
        /// Carried by the target.
        point: Complex<f64>,
        /// Fixed.
        centre: Complex<f64>,
        /// Of the link's length.
        square: f64,
    },
    /// `across · g point = at`: a slider that carries a pivot.
    Line {
        /// Carried by the target.
        point: Complex<f64>,
        /// Unit, fixed.
        across: Complex<f64>,
        /// Metres.
        at: f64,
    },
    /// `across · g⁻¹ point = at`: a pivot that carries a slider.
    Carried {
        /// Fixed.
        point: Complex<f64>,
        /// Unit, carried by the target.
        across: Complex<f64>,
        /// Metres.
        at: f64,
    },
    /// Those turned by `rotation`, or by half a turn more: two sliders.
    Rotation {
        /// Unit.
        rotation: Complex<f64>,
    },
    /// `fixed · g carried = cosine`: two axes through a centre.
    Cone {
        /// Unit.
        fixed: Vector3<f64>,
        /// Unit.
        carried: Vector3<f64>,
        /// Of the angle between the axes.
        cosine: f64,
    },
    /// `turn · angle + advance · advance of g = at`, or a whole number of periods more: a coaxial joint.
    Coaxial {
        /// Metres.
        turn: f64,
        /// No unit.
        advance: f64,
        /// Metres.
        at: f64,
        /// Metres; `None` where whole turns count.
        period: Option<f64>,
    },
    /// `across · g = at`: a slider.
    Band {
        /// At most unit.
        across: Complex<f64>,
        /// Metres.
        at: f64,
    },
}

impl Surface {
    /// Gives the intervals of `t` in which the target may be on the surface. No number of the chain and
    /// of the path ([`Path::size`]) together is larger than `size`, and its joint is held to within
    /// `blur`, radians or lengths over `size`.
    ///
    /// # Panics
    /// If the path is one of another kind of subspace.
    pub fn meet(
        &self,
        path: &Path,
        span: &Span,
        [size, blur]: [f64; 2],
        found: &mut impl FnMut([f64; 2]),
    ) {
        let scale = match *self {
            Self::Circle { .. } => size * size,
            Self::Line { .. } | Self::Carried { .. } | Self::Band { .. } => size,
            Self::Rotation { .. } | Self::Cone { .. } => 1.0,
            Self::Coaxial { turn, advance, at, .. } => {
                (turn.abs() + advance.abs()) * size.max(1.0) + at.abs()
            }
        };
        self.along(path).zeros((SHARE + 2.0 * blur) * scale, span, found);
    }

    /// The function whose zeros are the targets, along a path.
    fn along(&self, path: &Path) -> Equation {
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
                let carried = start * carried;
                let kept = fixed.dot(axis) * axis.dot(&carried);
                let sine = fixed.dot(&axis.cross(&carried));
                Equation::Harmonic([kept - cosine, fixed.dot(&carried) - kept, sine])
            }
            Self::Coaxial { turn, advance, at, period } => {
                let [start, rate] = path.cylindrical();
                let of = |g: &CylindricalDisplacement| turn * g.angle + advance * g.advance;
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
        }
    }
}

fn dot(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re + a.im * b.im
}
