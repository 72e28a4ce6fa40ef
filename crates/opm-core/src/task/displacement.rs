//! Displacements inside one subspace, and steps along the intersection motion.

use crate::chain::Amount;
use crate::chain::cylindrical::CylindricalDisplacement;
use crate::chain::planar::PlanarDisplacement;
use crate::chain::surface::Path;
use nalgebra::{Complex, Matrix3, Vector3};

/// A displacement inside one subspace, in that subspace's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement {
    /// Of the plane.
    Planar(PlanarDisplacement),
    /// About the centre.
    Spherical(Matrix3<f64>),
    /// About and along the axis.
    Cylindrical(CylindricalDisplacement),
    /// In the plane, without rotation.
    Translational(Complex<f64>),
}

impl Displacement {
    /// Its largest number, radians or metres; of a rotation about a centre zero.
    pub(crate) fn size(&self) -> f64 {
        match self {
            Self::Planar(g) => g.translation.norm(),
            Self::Spherical(_) => 0.0,
            Self::Cylindrical(g) => g.angle.abs().max(g.advance.abs()),
            Self::Translational(t) => t.norm(),
        }
    }
}

/// The intersection motion as seen in one subspace's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// Rotation about the frame's origin and third direction.
    Turn,
    /// Translation in this direction of a plane.
    Slide(Complex<f64>),
    /// Translation along a cylinder's axis.
    Advance,
}

impl Cut {
    /// `v · exp(I τ)`.
    #[inline(always)]
    pub fn after(&self, v: &Displacement, tau: Amount) -> Displacement {
        match (self, v) {
            (Self::Turn, Displacement::Planar(v)) => Displacement::Planar(PlanarDisplacement {
                rotation: v.rotation * tau.turn(),
                translation: v.translation,
            }),
            (Self::Turn, Displacement::Spherical(r)) => {
                // Columns one and two of R turn; the third, the axis of I, stays.
                let e = tau.turn();
                let (x, y, z) = (r.column(0), r.column(1), r.column(2));
                Displacement::Spherical(Matrix3::from_columns(&[
                    x * e.re + y * e.im,
                    y * e.re - x * e.im,
                    z.into_owned(),
                ]))
            }
            _ => self.commuting(v, tau),
        }
    }

    /// `exp(I τ) · b`.
    #[inline(always)]
    pub fn before(&self, b: &Displacement, tau: Amount) -> Displacement {
        match (self, b) {
            (Self::Turn, Displacement::Planar(b)) => {
                let e = tau.turn();
                Displacement::Planar(PlanarDisplacement {
                    rotation: e * b.rotation,
                    translation: e * b.translation,
                })
            }
            (Self::Turn, Displacement::Spherical(r)) => {
                let e = tau.turn();
                let (x, y, z) = (r.row(0), r.row(1), r.row(2));
                Displacement::Spherical(Matrix3::from_rows(&[
                    x * e.re - y * e.im,
                    x * e.im + y * e.re,
                    z.into_owned(),
                ]))
            }
            (Self::Slide(along), Displacement::Planar(b)) => {
                Displacement::Planar(PlanarDisplacement {
                    rotation: b.rotation,
                    translation: b.translation + along * tau.value(),
                })
            }
            _ => self.commuting(b, tau),
        }
    }

    /// What a unit of it adds to a displacement that adds up.
    pub(crate) fn flat(&self) -> [f64; 2] {
        match self {
            Self::Turn => [1.0, 0.0],
            Self::Advance => [0.0, 1.0],
            Self::Slide(d) => [d.re, d.im],
        }
    }

    /// `exp(I τ) · b` for every τ.
    pub(crate) fn path(&self, b: &Displacement) -> Path {
        match (self, *b) {
            (Self::Slide(along), Displacement::Planar(start)) => {
                Path::Slide { start, rate: *along }
            }
            (_, Displacement::Planar(start)) => Path::Turn { start },
            (_, Displacement::Spherical(start)) => Path::Tilt { start, axis: Vector3::z() },
            (Self::Turn, Displacement::Cylindrical(start)) => {
                Path::Coaxial { start, rate: CylindricalDisplacement { angle: 1.0, advance: 0.0 } }
            }
            (_, Displacement::Cylindrical(start)) => {
                Path::Coaxial { start, rate: CylindricalDisplacement { angle: 0.0, advance: 1.0 } }
            }
            (Self::Slide(along), Displacement::Translational(start)) => {
                Path::Translation { start, rate: *along }
            }
            // A subspace that does not hold the motion, as below.
            (_, Displacement::Translational(start)) => {
                Path::Translation { start, rate: Complex::new(0.0, 0.0) }
            }
        }
    }

    /// The pairs for which the order does not matter, and `v · exp(I τ)` in a plane.
    #[inline(always)]
    fn commuting(&self, g: &Displacement, tau: Amount) -> Displacement {
        match (self, g) {
            (Self::Turn, Displacement::Cylindrical(g)) => {
                cylindrical(g.angle + tau.value(), g.advance)
            }
            (Self::Advance, Displacement::Cylindrical(g)) => {
                cylindrical(g.angle, g.advance + tau.value())
            }
            (Self::Slide(along), Displacement::Planar(g)) => {
                Displacement::Planar(PlanarDisplacement {
                    rotation: g.rotation,
                    translation: g.translation + g.rotation * along * tau.value(),
                })
            }
            (Self::Slide(along), Displacement::Translational(t)) => {
                Displacement::Translational(t + along * tau.value())
            }
            // A subspace that does not hold the motion: Subspace::cut never pairs them.
            _ => *g,
        }
    }
}

#[inline]
pub(super) fn planar(rotation: Complex<f64>, x: f64, y: f64) -> Displacement {
    Displacement::Planar(PlanarDisplacement { rotation, translation: Complex::new(x, y) })
}

#[inline]
pub(super) fn cylindrical(angle: f64, advance: f64) -> Displacement {
    Displacement::Cylindrical(CylindricalDisplacement { angle, advance })
}
