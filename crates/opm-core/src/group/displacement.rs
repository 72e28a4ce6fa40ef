//! A displacement of any subgroup, and the algebra of a subgroup that is known at run time: each operation
//! is that of [`Subgroup`], for the one at hand.

use super::subgroup::{LocalTwist, Subgroup};
use super::{
    Cylindrical, CylindricalDisplacement, Planar, PlanarDisplacement, Spherical, SubspaceKind,
    TranslationalPlane, mismatch,
};
use nalgebra::{Complex, Matrix3, Rotation3, Vector3};

/// A displacement inside one subspace, in that subspace's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement {
    /// A displacement of a plane.
    Planar(PlanarDisplacement),
    /// A rotation about a centre.
    Spherical(Matrix3<f64>),
    /// A displacement about and along an axis.
    Cylindrical(CylindricalDisplacement),
    /// A translation in a plane.
    Translational(Complex<f64>),
}

/// Calls a function of [`Subgroup`] for the subgroup of a kind, `G`.
macro_rules! of_kind {
    ($kind:expr, $G:ident => $call:expr) => {
        match $kind {
            SubspaceKind::Planar => {
                type $G = Planar;
                $call
            }
            SubspaceKind::Spherical => {
                type $G = Spherical;
                $call
            }
            SubspaceKind::Cylindrical => {
                type $G = Cylindrical;
                $call
            }
            SubspaceKind::TranslationalPlane => {
                type $G = TranslationalPlane;
                $call
            }
        }
    };
}

/// Calls a function of [`Subgroup`] for the subgroup of a displacement, `G`.
macro_rules! of_displacement {
    ($displacement:expr, $G:ident, $g:ident => $call:expr) => {
        match $displacement {
            Displacement::Planar($g) => {
                type $G = Planar;
                $call
            }
            Displacement::Spherical($g) => {
                type $G = Spherical;
                $call
            }
            Displacement::Cylindrical($g) => {
                type $G = Cylindrical;
                $call
            }
            Displacement::Translational($g) => {
                type $G = TranslationalPlane;
                $call
            }
        }
    };
}

impl SubspaceKind {
    /// Number of freedoms of the motion inside the subspace.
    pub fn dimension(self) -> usize {
        of_kind!(self, G => G::DIMENSION)
    }

    /// Whether its displacements commute, and so add up.
    pub fn commutes(self) -> bool {
        of_kind!(self, G => G::COMMUTES)
    }

    /// The displacement that leaves everything where it is.
    pub fn identity(self) -> Displacement {
        of_kind!(self, G => G::IDENTITY.into())
    }

    /// The displacement that a constant twist makes in unit time: see the table in the docs of
    /// [`group`](crate::group) for its three numbers.
    pub fn exponential(self, twist: &Vector3<f64>) -> Displacement {
        of_kind!(self, G => G::exponential(twist).into())
    }

    /// A displacement that agrees with the exponential to first order.
    pub(crate) fn first_order(self, twist: &LocalTwist) -> Displacement {
        of_kind!(self, G => G::first_order(twist).into())
    }

    /// Lie bracket: how the second twist changes when it is carried along by the first.
    #[inline]
    pub(crate) fn bracket(self, a: &LocalTwist, b: &LocalTwist) -> LocalTwist {
        of_kind!(self, G => G::bracket(a, b))
    }

    /// A twist as an angular velocity and the velocity of the point at the frame's origin, along the
    /// frame's directions.
    pub(crate) fn embed(self, twist: &LocalTwist) -> [Vector3<f64>; 2] {
        of_kind!(self, G => G::embed(twist))
    }

    /// Whether a twist of the subspace is a translation.
    pub(crate) fn is_translation(self, twist: &LocalTwist) -> bool {
        *twist != LocalTwist::zeros() && of_kind!(self, G => G::is_translation(twist))
    }

    /// Sums of displacements that commute, as a displacement: see [`Displacement::sum`].
    pub(crate) fn of_sum(self, [first, second]: [f64; 2]) -> Displacement {
        self.exponential(&LocalTwist::new(first, second, 0.0))
    }

    /// What the numbers of a sum are measured in: radians, or lengths in `size`.
    pub(crate) fn sum_units(self, size: f64) -> [f64; 2] {
        let unit = |twist: LocalTwist| if self.is_translation(&twist) { size } else { 1.0 };
        [unit(LocalTwist::x()), unit(LocalTwist::y())]
    }

    /// A basis of the subspace's twists.
    pub(crate) fn basis(self) -> Vec<LocalTwist> {
        let axes = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
        axes[..self.dimension()].to_vec()
    }
}

impl Displacement {
    /// The kind of subspace that it is a displacement of.
    pub fn kind(&self) -> SubspaceKind {
        of_displacement!(self, G, _g => G::KIND)
    }

    /// First `other`, then `self`.
    ///
    /// # Panics
    /// If they are displacements of two kinds of subspace.
    #[must_use]
    pub fn after(&self, other: &Self) -> Self {
        match self {
            Self::Planar(g) => Planar::product(g, other.planar()).into(),
            Self::Spherical(r) => Spherical::product(r, other.spherical()).into(),
            Self::Cylindrical(g) => Cylindrical::product(g, other.cylindrical()).into(),
            Self::Translational(t) => TranslationalPlane::product(t, other.translational()).into(),
        }
    }

    /// The displacement back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        of_displacement!(self, G, g => G::inverse(g).into())
    }

    /// The shortest twist whose exponential it is: rotations by at most half a turn, but those about a
    /// cylinder's axis as they are.
    pub fn logarithm(&self) -> Vector3<f64> {
        of_displacement!(self, G, g => G::logarithm(g))
    }

    /// The two numbers that add up in products, of a subspace whose displacements commute.
    ///
    /// # Panics
    /// If its displacements do not commute.
    pub(crate) fn sum(&self) -> [f64; 2] {
        match self {
            Self::Cylindrical(_) | Self::Translational(_) => {
                let twist = self.logarithm();
                [twist.x, twist.y]
            }
            Self::Planar(_) | Self::Spherical(_) => mismatch(Cylindrical::KIND, self.kind()),
        }
    }

    /// The twist as it is after the displacement: adjoint action.
    #[inline]
    pub(crate) fn adjoint(&self, twist: &LocalTwist) -> LocalTwist {
        of_displacement!(self, G, g => G::adjoint(g, twist))
    }

    /// The adjoint action of the inverse.
    #[inline]
    pub(crate) fn adjoint_of_inverse(&self, twist: &LocalTwist) -> LocalTwist {
        of_displacement!(self, G, g => G::adjoint_of_inverse(g, twist))
    }

    /// Where a point, given in the subspace's frame, goes.
    #[inline]
    pub fn act(&self, point: &Vector3<f64>) -> Vector3<f64> {
        of_displacement!(self, G, g => G::act(g, point))
    }

    /// The displacement as a rotation about the frame's origin, then a translation.
    pub(super) fn rotation_and_translation(&self) -> (Rotation3<f64>, Vector3<f64>) {
        of_displacement!(self, G, g => G::rotation_and_translation(g))
    }

    /// Its largest number, radians or metres; of a rotation about a centre zero.
    pub(crate) fn size(&self) -> f64 {
        of_displacement!(self, G, g => G::size(g))
    }

    /// The displacement, which is one of a plane.
    #[inline(always)]
    pub(crate) fn planar(&self) -> &PlanarDisplacement {
        match self {
            Self::Planar(g) => g,
            Self::Spherical(_) | Self::Cylindrical(_) | Self::Translational(_) => {
                mismatch(Planar::KIND, self.kind())
            }
        }
    }

    /// The displacement, which is one about a centre.
    #[inline(always)]
    pub(crate) fn spherical(&self) -> &Matrix3<f64> {
        match self {
            Self::Spherical(r) => r,
            Self::Planar(_) | Self::Cylindrical(_) | Self::Translational(_) => {
                mismatch(Spherical::KIND, self.kind())
            }
        }
    }

    /// The displacement, which is one about and along an axis.
    #[inline(always)]
    pub(crate) fn cylindrical(&self) -> &CylindricalDisplacement {
        match self {
            Self::Cylindrical(g) => g,
            Self::Planar(_) | Self::Spherical(_) | Self::Translational(_) => {
                mismatch(Cylindrical::KIND, self.kind())
            }
        }
    }

    /// The displacement, which is a translation in a plane.
    #[inline(always)]
    pub(crate) fn translational(&self) -> &Complex<f64> {
        match self {
            Self::Translational(t) => t,
            Self::Planar(_) | Self::Spherical(_) | Self::Cylindrical(_) => {
                mismatch(TranslationalPlane::KIND, self.kind())
            }
        }
    }
}

impl From<PlanarDisplacement> for Displacement {
    #[inline(always)]
    fn from(g: PlanarDisplacement) -> Self {
        Self::Planar(g)
    }
}

impl From<Matrix3<f64>> for Displacement {
    #[inline(always)]
    fn from(r: Matrix3<f64>) -> Self {
        Self::Spherical(r)
    }
}

impl From<CylindricalDisplacement> for Displacement {
    #[inline(always)]
    fn from(g: CylindricalDisplacement) -> Self {
        Self::Cylindrical(g)
    }
}

impl From<Complex<f64>> for Displacement {
    #[inline(always)]
    fn from(t: Complex<f64>) -> Self {
        Self::Translational(t)
    }
}
