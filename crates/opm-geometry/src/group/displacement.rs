//! A displacement of any subgroup, and the algebra of a subgroup that is chosen at run time. Each operation
//! calls that of the trait [`Subgroup`].

use super::subgroup::{LocalTwist, Subgroup};
use super::{
    Cylindrical, CylindricalDisplacement, Identity, IdentityDisplacement, Planar,
    PlanarDisplacement, Spherical, SubspaceKind, TranslationalPlane, TranslationalSpace, mismatch,
};
use crate::numbers::{Plane, Real, Rotation, Space};
use nalgebra::{Complex, Matrix3, Rotation3, Vector3};

/// A displacement inside one subspace, in that subspace's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement<T: Real = f64> {
    /// No displacement.
    Identity(IdentityDisplacement),
    /// A planar displacement.
    Planar(PlanarDisplacement<T::Plane>),
    /// A rotation about a centre.
    Spherical(T::Rotation),
    /// A rotation about an axis and a translation along it.
    Cylindrical(CylindricalDisplacement<T>),
    /// A translation in a plane, metres.
    Translational(T::Plane),
    /// A translation in space, metres.
    Spatial(T::Space),
}

/// Calls a function of [`Subgroup`] for the subgroup of a kind, `G`.
macro_rules! of_kind {
    ($kind:expr, $G:ident => $call:expr) => {
        match $kind {
            SubspaceKind::Identity => {
                type $G = Identity;
                $call
            }
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
            SubspaceKind::TranslationalSpace => {
                type $G = TranslationalSpace;
                $call
            }
        }
    };
}

/// Calls a function of [`Subgroup`] for the subgroup of a displacement, `G`.
macro_rules! of_displacement {
    ($displacement:expr, $G:ident, $g:ident => $call:expr) => {
        match $displacement {
            Displacement::Identity($g) => {
                type $G = Identity;
                $call
            }
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
            Displacement::Spatial($g) => {
                type $G = TranslationalSpace;
                $call
            }
        }
    };
}

impl SubspaceKind {
    /// The dimension of the subspace: its number of degrees of freedom.
    #[inline]
    pub fn dimension(self) -> usize {
        of_kind!(self, G => G::DIMENSION)
    }

    /// Whether displacements of the subspace commute. Their logarithms then add up.
    #[inline]
    pub fn commutes(self) -> bool {
        of_kind!(self, G => G::COMMUTES)
    }

    /// The identity displacement.
    #[inline]
    pub fn identity(self) -> Displacement {
        Displacement::still(self)
    }

    /// The exponential: the displacement after moving with a constant twist for unit time. The table in
    /// the docs of [`group`](crate::group) says what the three components of the twist are.
    #[inline]
    pub fn exponential(self, twist: &Vector3<f64>) -> Displacement {
        of_kind!(self, G => G::exponential(twist).into())
    }

    /// A displacement that agrees with the exponential to first order.
    #[inline]
    pub fn first_order(self, twist: &LocalTwist) -> Displacement {
        of_kind!(self, G => G::first_order(twist).into())
    }

    /// The Lie bracket `[a, b]`: the rate of change of `b` when it moves with `a`.
    #[inline]
    pub fn bracket(self, a: &LocalTwist, b: &LocalTwist) -> LocalTwist {
        of_kind!(self, G => G::bracket(a, b))
    }

    /// A twist as two vectors in the frame: the angular velocity, and the velocity of the point at the
    /// frame's origin.
    pub(crate) fn embed(self, twist: &LocalTwist) -> [Vector3<f64>; 2] {
        of_kind!(self, G => G::embed(twist))
    }

    /// Whether a twist of the subspace is a translation. The zero twist is not.
    #[inline]
    pub fn is_translation(self, twist: &LocalTwist) -> bool {
        *twist != LocalTwist::zeros() && of_kind!(self, G => G::is_translation(twist))
    }

    /// The displacement with a given sum of logarithms, in a subspace whose displacements commute: the
    /// inverse of [`Displacement::sum`].
    #[inline]
    pub fn of_sum(self, sum: &LocalTwist) -> Displacement {
        self.exponential(sum)
    }

    /// The units of the components of a logarithm: one radian for an angle, `size` (metres) for a length.
    #[inline]
    pub fn sum_units(self, size: f64) -> LocalTwist {
        let unit = |twist: LocalTwist| if self.is_translation(&twist) { size } else { 1.0 };
        LocalTwist::new(unit(LocalTwist::x()), unit(LocalTwist::y()), unit(LocalTwist::z()))
    }

    /// The unit twists: a basis of the subspace's twists.
    pub fn basis(self) -> Vec<LocalTwist> {
        let axes = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
        axes[..self.dimension()].to_vec()
    }
}

impl Displacement {
    /// The product `self · other`: `other` is applied to points first.
    ///
    /// # Panics
    /// If the two displacements belong to different kinds of subspace.
    #[must_use]
    #[inline]
    pub fn after(&self, other: &Self) -> Self {
        match self {
            Self::Identity(g) => Identity::product(g, other.identity()).into(),
            Self::Planar(g) => Planar::product(g, other.planar()).into(),
            Self::Spherical(r) => Spherical::product(r, other.spherical()).into(),
            Self::Cylindrical(g) => Cylindrical::product(g, other.cylindrical()).into(),
            Self::Translational(t) => TranslationalPlane::product(t, other.translational()).into(),
            Self::Spatial(t) => TranslationalSpace::product(t, other.spatial()).into(),
        }
    }

    /// The inverse displacement.
    #[must_use]
    #[inline]
    pub fn inverse(&self) -> Self {
        of_displacement!(self, G, g => G::inverse(g).into())
    }

    /// The shortest twist whose exponential is this displacement. Its angle is at most π, except about the
    /// axis of a cylinder, where full revolutions count.
    #[inline]
    pub fn logarithm(&self) -> Vector3<f64> {
        of_displacement!(self, G, g => G::logarithm(g))
    }

    /// The components of the logarithm, which add up in products: [`Displacement::sums`].
    ///
    /// # Panics
    /// If displacements of this kind do not commute.
    #[inline]
    pub fn sum(&self) -> LocalTwist {
        self.sums().into()
    }

    /// The adjoint action: the twist displaced by this displacement.
    #[inline]
    pub fn adjoint(&self, twist: &LocalTwist) -> LocalTwist {
        of_displacement!(self, G, g => G::adjoint(g, twist))
    }

    /// The adjoint action of the inverse.
    #[inline]
    pub fn adjoint_of_inverse(&self, twist: &LocalTwist) -> LocalTwist {
        of_displacement!(self, G, g => G::adjoint_of_inverse(g, twist))
    }

    /// The image of a point, which is given in the subspace's frame, in metres.
    #[inline]
    pub fn act(&self, point: &Vector3<f64>) -> Vector3<f64> {
        of_displacement!(self, G, g => G::act(g, point))
    }

    /// The displacement as a rotation about the frame's origin, followed by a translation.
    pub(super) fn rotation_and_translation(&self) -> (Rotation3<f64>, Vector3<f64>) {
        of_displacement!(self, G, g => G::rotation_and_translation(g))
    }

    /// The largest component that can grow without bound, in radians or metres; zero for a rotation about
    /// a centre.
    #[inline]
    pub fn size(&self) -> f64 {
        of_displacement!(self, G, g => G::size(g))
    }
}

impl<T: Real> Displacement<T> {
    /// The displacement that leaves everything where it is.
    #[inline]
    pub fn still(kind: SubspaceKind) -> Self {
        let [none, one] = [0.0, 1.0].map(T::constant);
        let [zero, unit] = [none, one].map(|re| T::Plane::new(re, none));
        match kind {
            SubspaceKind::Identity => Self::Identity(IdentityDisplacement),
            SubspaceKind::Planar => {
                Self::Planar(PlanarDisplacement { rotation: unit, translation: zero })
            }
            SubspaceKind::Spherical => {
                let rows = [[one, none, none], [none, one, none], [none, none, one]];
                Self::Spherical(T::Rotation::from_rows(rows))
            }
            SubspaceKind::Cylindrical => {
                Self::Cylindrical(CylindricalDisplacement { angle: none, advance: none })
            }
            SubspaceKind::TranslationalPlane => Self::Translational(zero),
            SubspaceKind::TranslationalSpace => Self::Spatial(T::Space::new(none, none, none)),
        }
    }

    /// The components of the logarithm, which add up in products, in a subspace whose displacements commute; zeros beyond its
    /// dimension.
    ///
    /// # Panics
    /// If displacements of this kind do not commute.
    #[inline]
    pub fn sums(&self) -> [T; 3] {
        let none = T::constant(0.0);
        match *self {
            Self::Identity(_) => [none; 3],
            Self::Cylindrical(CylindricalDisplacement { angle, advance }) => [angle, advance, none],
            Self::Translational(t) => [t.re(), t.im(), none],
            Self::Spatial(t) => t.parts(),
            Self::Planar(_) | Self::Spherical(_) => mismatch(Cylindrical::KIND, self.kind()),
        }
    }

    /// The kind of subspace that the displacement belongs to.
    #[inline]
    pub fn kind(&self) -> SubspaceKind {
        of_displacement!(self, G, _g => G::KIND)
    }

    /// The identity. Panics if the displacement is of another kind.
    fn identity(&self) -> &IdentityDisplacement {
        match self {
            Self::Identity(g) => g,
            Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Identity::KIND, self.kind()),
        }
    }

    /// The planar displacement. Panics if it is of another kind.
    #[inline(always)]
    pub fn planar(&self) -> &PlanarDisplacement<T::Plane> {
        match self {
            Self::Planar(g) => g,
            Self::Identity(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Planar::KIND, self.kind()),
        }
    }

    /// The rotation about a centre. Panics if the displacement is of another kind.
    #[inline(always)]
    pub fn spherical(&self) -> &T::Rotation {
        match self {
            Self::Spherical(r) => r,
            Self::Identity(_)
            | Self::Planar(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Spherical::KIND, self.kind()),
        }
    }

    /// The cylindrical displacement. Panics if it is of another kind.
    #[inline(always)]
    pub fn cylindrical(&self) -> &CylindricalDisplacement<T> {
        match self {
            Self::Cylindrical(g) => g,
            Self::Identity(_)
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Cylindrical::KIND, self.kind()),
        }
    }

    /// The translation in a plane. Panics if the displacement is of another kind.
    #[inline(always)]
    pub fn translational(&self) -> &T::Plane {
        match self {
            Self::Translational(t) => t,
            Self::Identity(_)
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Spatial(_) => mismatch(TranslationalPlane::KIND, self.kind()),
        }
    }

    /// The translation in space. Panics if the displacement is of another kind.
    #[inline(always)]
    pub fn spatial(&self) -> &T::Space {
        match self {
            Self::Spatial(t) => t,
            Self::Identity(_)
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_) => mismatch(TranslationalSpace::KIND, self.kind()),
        }
    }
}

impl From<IdentityDisplacement> for Displacement {
    #[inline(always)]
    fn from(g: IdentityDisplacement) -> Self {
        Self::Identity(g)
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

impl From<Vector3<f64>> for Displacement {
    #[inline(always)]
    fn from(t: Vector3<f64>) -> Self {
        Self::Spatial(t)
    }
}
