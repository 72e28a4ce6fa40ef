//! Spherical chains: three revolute joints whose axes pass through one point, and the spherical joint.

use super::limits::{Components, Limits};
use super::shell::Shell;
use super::surface::Surface;
use super::{
    Attempt, Branch, ChainError, ClosedForm, DEGENERATE, Exception, REACH_TOLERANCE, ReachDeficit,
    closed_form,
};
use crate::group::{JointDisplacement, rotation_vector};
use nalgebra::{Complex, Matrix3, Rotation3, Unit, Vector3};

/// RRR about one point: `exp(a₁q₁) exp(a₂q₂) exp(a₃q₃) = R`. The branch is `+` where the triple product
/// `a₁ · (a₂ × a₃)` of the displaced axes is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalChain {
    axes: [Vector3<f64>; 3],
    /// `a₁·a₂` and `a₂·a₃`: cosines of the arcs of the two links.
    cosines: [f64; 2],
    /// The sines of these arcs.
    sines: [f64; 2],
    /// One over each.
    over_sines: [f64; 2],
    /// The component of `a₂` perpendicular to `a₁`, and `a₁ × a₂`: both have the length of the first arc's sine.
    second_on_first: [Vector3<f64>; 2],
    /// The second joint's rotation at which `a₃` is nearest to `a₁`.
    nearest: Complex<f64>,
    /// The unit direction along `a₂ × a₃`.
    beside_third: Vector3<f64>,
}

impl SphericalChain {
    /// The closed form of three revolutes with these axes at home, base first.
    ///
    /// # Errors
    /// Two neighbouring axes are parallel, so that the chain cannot rotate in all directions.
    pub fn new(axes: [Unit<Vector3<f64>>; 3]) -> Result<Self, ChainError> {
        let [a1, a2, a3] = axes.map(Unit::into_inner);
        // The component of one axis perpendicular to another. The second step removes what rounding leaves of the first: for
        // small arcs, the digits of the joints' rotations depend on it.
        let across = |a: Vector3<f64>, other: &Vector3<f64>| {
            let nearly = a - other * a.dot(other);
            nearly - other * nearly.dot(other)
        };
        let (second, third) = (across(a2, &a1), across(a3, &a2));
        let (n12, n23) = (a1.cross(&second), a2.cross(&third));
        let sines = [n12.norm(), n23.norm()];
        if sines[0].min(sines[1]) <= DEGENERATE {
            return Err(ChainError::Dependent("two neighbouring axes are parallel"));
        }
        // From where a₃ is nearest to a₁, the second joint is rotated by an angle with this direction at home.
        let at_home = Complex::new(-n12.dot(&n23), -n12.dot(&third));
        Ok(Self {
            axes: [a1, a2, a3],
            cosines: [a1.dot(&a2), a2.dot(&a3)],
            sines,
            over_sines: sines.map(f64::recip),
            second_on_first: [second, n12],
            nearest: at_home.conj() / at_home.norm(),
            beside_third: n23 / sines[1],
        })
    }

    /// The first joint's rotation as a unit vector, from the third axis's direction `w = R a₃`:
    /// `a₂ · exp(-a₁q₁) w = a₂ · a₃`, that is `A cos q₁ + B sin q₁ = d` (Eqs. 2-3 of the paper).
    ///
    /// # Errors
    /// The angle by which `w` is too near to the first axis or too far from it, where it is out of reach.
    #[inline(always)]
    pub fn first(&self, w: &Vector3<f64>, branch: Branch) -> Result<Complex<f64>, ReachDeficit> {
        let equation = self.equation(w);
        if equation.has_two() {
            Ok(equation.solve(branch.sign()))
        } else {
            self.first_at_boundary(w)
        }
    }

    #[inline(always)]
    fn equation(&self, w: &Vector3<f64>) -> Equation {
        let [a, b, axial] = self.carried(w);
        let d = self.cosines[1] - self.cosines[0] * axial;
        Equation { a, b, d, square: a * a + b * b }
    }

    /// The first joint's rotation on the boundary of reach, or the deficit. Where `w` lies on the first axis,
    /// which is in reach only where the links' arcs are equal or supplementary, the angle is free.
    #[cold]
    fn first_at_boundary(&self, w: &Vector3<f64>) -> Result<Complex<f64>, ReachDeficit> {
        let equation = self.equation(w);
        if equation.d.is_nan() || equation.has_none() {
            return Err(self.deficit(w));
        }
        let Equation { a, b, d, square } = equation;
        let length = square.sqrt();
        let on_axis = length <= REACH_TOLERANCE;
        Ok(if on_axis {
            Complex::new(1.0, 0.0)
        } else {
            Complex::new(a, b) * (d.signum() / length)
        })
    }

    /// All joints' rotations, from the first joint's.
    ///
    /// Vectors are taken in frames of the axes, where each joint's rotation and each link's arc is a rotation in a plane.
    #[inline(always)]
    fn with_first(&self, target: &Matrix3<f64>, q1: Complex<f64>) -> [JointDisplacement; 3] {
        let ([c12, c23], [s12, s23]) = (self.cosines, self.sines);
        let [over_first, over_second] = self.over_sines;
        // The components of a vector, as the first joint has rotated it: along a₂, along the component of a₁ perpendicular
        // to a₂, and perpendicular to both.
        let about_second = |vector: &Vector3<f64>| {
            let [x, y, z] = self.carried(vector);
            let (x, y) = (x * q1.re + y * q1.im, y * q1.re - x * q1.im);
            (x + c12 * z, s12 * z - c12 * (x * over_first), -y * over_first)
        };
        // The third axis is at the angle θ from where it is nearest to a₁.
        let (_, u, v) = about_second(&apply(target, &self.axes[2]));
        let theta = Complex::new(u * over_second, v * over_second);
        // The third joint rotates b = a₂ × a₃. Rotated back by θ, its components along b and along a₃ × b at home tell by how
        // much.
        let (along, u, v) = about_second(&apply(target, &self.beside_third));
        let (u, v) = (u * theta.re + v * theta.im, v * theta.re - u * theta.im);
        [
            JointDisplacement::Direction(q1),
            JointDisplacement::Direction(theta * self.nearest),
            JointDisplacement::Direction(Complex::new(v, s23 * along - c23 * u)),
        ]
    }

    /// The components of a vector along the component of `a₂` perpendicular to `a₁` and along `a₁ × a₂`, both times their
    /// length, and along `a₁`.
    #[inline(always)]
    fn carried(&self, v: &Vector3<f64>) -> [f64; 3] {
        let [x, y] = &self.second_on_first;
        [dot(x, v), dot(y, v), dot(&self.axes[0], v)]
    }

    /// The joints' rotations that rotate the outer link by `target`.
    ///
    /// # Errors
    /// The angle by which the target is out of reach.
    #[inline(always)]
    pub fn inverse(
        &self,
        target: &Matrix3<f64>,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let mut found = [JointDisplacement::Value(0.0); 3];
        closed_form::solve(self, target, branch, &mut found)?;
        Ok(found)
    }

    /// The branch on which the first joint has a known rotation, a unit vector; `None` where the chain closes with no
    /// rotation of it nearer than `within`, in radians.
    #[inline(always)]
    pub(super) fn branch_with(
        &self,
        target: &Matrix3<f64>,
        first: Complex<f64>,
        within: f64,
    ) -> Option<Branch> {
        let Equation { a, b, d, .. } = self.equation(&self.third_axis(target));
        // The derivative of the equation is the root that a branch is the sign of.
        let miss = a * first.re + b * first.im - d;
        let root = b * first.re - a * first.im;
        let branch = if root > 0.0 { Branch::Plus } else { Branch::Minus };
        (miss.abs() < within * root.abs()).then_some(branch)
    }

    /// The direction of the third axis at a target, the argument of [`SphericalChain::first`].
    #[inline(always)]
    pub fn third_axis(&self, target: &Matrix3<f64>) -> Vector3<f64> {
        apply(target, &self.axes[2])
    }

    /// The targets at which the chain closes with joint number `joint` held at `displacement`: the angle
    /// between the other two axes is then constant.
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let [a1, a2, a3] = self.axes;
        let turned =
            |v: &Vector3<f64>, q: Complex<f64>| rotate_back(&self.axes[joint], q.conj(), v);
        let rotation = displacement.unit_direction();
        let (fixed, carried, cosine) = match joint {
            // E₂E₃ = E₁⁻¹ R
            0 => (turned(&a2, rotation), a3, a2.dot(&a3)),
            // a₁ · R a₃ = a₁ · E₂ a₃
            1 => (a1, a3, a1.dot(&turned(&a3, rotation))),
            // E₁E₂ = R E₃⁻¹
            _ => (a1, turned(&a2, rotation.conj()), a1.dot(&a2)),
        };
        Surface::Cone { fixed, carried, cosine }
    }

    /// The targets at which the chain closes on a branch with its second joint within limits; `None` where these leave
    /// two ranges of it.
    pub fn shell(&self, branch: Branch, limits: &Limits) -> Option<Shell> {
        let [a1, _, a3] = self.axes;
        // The second joint rotates a₃ from where it is nearest to a₁, by an angle from 0 to π on either branch. The
        // triple product of the axes is negative where that is counter-clockwise.
        let cosines = match limits.arc() {
            None => [-1.0, 1.0],
            Some(arc) => {
                let from_nearest = arc.turned(self.nearest.conj());
                let of_branch = match branch {
                    Branch::Plus => from_nearest.reflected(|e| e.conj()),
                    Branch::Minus => from_nearest,
                };
                // The cosine of the angle is the component of its direction against that of a right angle less.
                let Components { whole, hole: None } =
                    Components::of(&of_branch.turned(-Complex::I))
                else {
                    return None;
                };
                [(-whole[1]).max(-1.0), (-whole[0]).min(1.0)]
            }
        };
        let [level, swing] =
            [self.cosines, self.sines].map(|[of_first, of_second]| of_first * of_second);
        Some(Shell {
            fixed: a1,
            carried: a3,
            cosines: cosines.map(|cosine| level + swing * cosine),
        })
    }

    /// The second joint's two rotations at which the branches meet: the three axes are then in one plane.
    pub(super) fn folds(&self) -> [JointDisplacement; 2] {
        [self.nearest, -self.nearest].map(JointDisplacement::Direction)
    }

    /// The joints' axes at home, base first.
    pub fn axes(&self) -> &[Vector3<f64>; 3] {
        &self.axes
    }

    /// The rotation of the outer link: the product of the joints' rotations, base first.
    pub fn forward(&self, displacements: &[JointDisplacement; 3]) -> Matrix3<f64> {
        self.axes.iter().zip(displacements).fold(Matrix3::identity(), |r, (axis, displacement)| {
            r * Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), displacement.value())
                .into_inner()
        })
    }

    #[cold]
    fn deficit(&self, w: &Vector3<f64>) -> ReachDeficit {
        let arc = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
        let [a12, a23] = self.cosines.map(arc);
        let to_first = arc(self.axes[0].dot(w));
        let nearest = (a12 - a23).abs();
        let farthest = (a12 + a23).min(std::f64::consts::TAU - a12 - a23);
        ReachDeficit::angle((nearest - to_first).max(to_first - farthest))
    }
}

impl ClosedForm for SphericalChain {
    type Target = Matrix3<f64>;

    #[inline(always)]
    fn attempt(&self, target: &Matrix3<f64>, sign: f64) -> Attempt {
        let equation = self.equation(&self.third_axis(target));
        let displacements = self.with_first(target, equation.solve(sign));
        Attempt { displacements, holds: equation.has_two(), beyond: equation.has_none() }
    }

    #[cold]
    fn exception(&self, target: &Matrix3<f64>, _: f64) -> Exception {
        match self.first_at_boundary(&self.third_axis(target)) {
            Ok(q1) => Exception {
                special: Some((true, self.with_first(target, q1))),
                ..Exception::length(0.0)
            },
            Err(ReachDeficit { excess, quantity }) => Exception { excess, quantity, special: None },
        }
    }
}

/// `a cos q + b sin q = d`, with `square = a² + b²`.
struct Equation {
    a: f64,
    b: f64,
    d: f64,
    square: f64,
}

impl Equation {
    /// Whether the equation has two distinct solutions.
    #[inline(always)]
    fn has_two(&self) -> bool {
        (self.square > self.d * self.d) & (self.square > REACH_TOLERANCE * REACH_TOLERANCE)
    }

    /// Whether the equation certainly has no solution: the target is not even on the boundary of reach.
    #[inline(always)]
    fn has_none(&self) -> bool {
        let certain = self.d.abs() - REACH_TOLERANCE;
        (certain > 0.0) & (certain * certain > self.square)
    }

    /// The solution on a branch, as a unit vector.
    #[inline(always)]
    fn solve(&self, sign: f64) -> Complex<f64> {
        let Self { a, b, d, square } = *self;
        let root = sign * (square - d * d).max(0.0).sqrt();
        let over = 1.0 / square;
        Complex::new((a * d + b * root) * over, (b * d - a * root) * over)
    }
}

/// A spherical joint. It can make any rotation; its coordinates are the rotation vector in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The axes of the frame that targets are given in, base coordinates, as columns.
    pub axes: Matrix3<f64>,
}

impl Ball {
    /// The three components of the rotation vector of `target`, whose length is at most π.
    #[inline(always)]
    pub fn inverse(&self, target: &Matrix3<f64>) -> [JointDisplacement; 3] {
        self.attempt(target, 1.0).displacements
    }

    /// The rotation with this rotation vector.
    pub fn forward(&self, displacements: &[JointDisplacement; 3]) -> Matrix3<f64> {
        let vector = Vector3::from_fn(|i, _| displacements[i].value());
        Rotation3::new(self.axes.tr_mul(&vector)).into_inner()
    }
}

impl ClosedForm for Ball {
    type Target = Matrix3<f64>;

    #[inline(always)]
    fn attempt(&self, target: &Matrix3<f64>, _: f64) -> Attempt {
        let vector = apply(&self.axes, &rotation_vector(target));
        let displacements = [
            JointDisplacement::Value(vector.x),
            JointDisplacement::Value(vector.y),
            JointDisplacement::Value(vector.z),
        ];
        Attempt::decided(displacements, true)
    }
}

/// The product `r v`.
#[inline(always)]
fn apply(r: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    r.column(0) * v.x + r.column(1) * v.y + r.column(2) * v.z
}

#[inline(always)]
fn dot(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// The vector `exp(-axis q) v`, with the angle `q` given as a unit vector.
#[inline(always)]
fn rotate_back(axis: &Vector3<f64>, q: Complex<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    v * q.re - axis.cross(v) * q.im + axis * (dot(axis, v) * (1.0 - q.re))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::angle::unit;
    use proptest::prelude::*;

    /// A direction that is not near a pole.
    fn direction() -> impl Strategy<Value = Unit<Vector3<f64>>> {
        proptest::array::uniform3(-1.0..1.0_f64)
            .prop_filter("no direction", |v| Vector3::from(*v).norm() > 0.1)
            .prop_map(|v| Unit::new_normalize(v.into()))
    }

    proptest! {
        /// The joints' rotations lead back to the target, in chains with small arcs, too: these magnify the rounding.
        #[test]
        fn rotations_lead_to_the_target(
            [first, second, turned] in [direction(), direction(), direction()],
            arcs in [-3.0..0.0_f64, -3.0..0.0_f64],
            rotations in proptest::array::uniform3(-3.0..3.0_f64),
        ) {
            let away = |axis: &Vector3<f64>, towards: &Vector3<f64>, exponent: f64| {
                let across = axis.cross(towards);
                prop_assume!(across.norm() > 0.1);
                let (sin, cos) = 10_f64.powf(exponent).sin_cos();
                Ok(Unit::new_normalize(axis * cos + across.normalize() * sin))
            };
            let second = away(&first, &second, arcs[0])?;
            let third = away(&second, &turned, arcs[1])?;
            let chain = SphericalChain::new([first, second, third]).unwrap();
            let target = chain.forward(&rotations.map(JointDisplacement::Value));
            let near = Branch::BOTH.map(|branch| chain.inverse(&target, branch));
            let shortest = arcs[0].min(arcs[1]);
            for found in near.into_iter().flatten() {
                let off = (chain.forward(&found) - target).amax();
                prop_assert!(off < 100.0 * f64::EPSILON / 10_f64.powf(shortest), "{:e}", off);
            }
        }

        /// The rotation of the first joint tells the branch that it was found on. A rotation with which the chain does not
        /// close tells nothing.
        #[test]
        fn the_first_rotation_tells_the_branch(
            axes in [direction(), direction(), direction()],
            rotations in proptest::array::uniform3(-3.0..3.0_f64),
        ) {
            let Ok(chain) = SphericalChain::new(axes) else { return Ok(()) };
            let target = chain.forward(&rotations.map(JointDisplacement::Value));
            let found = Branch::BOTH.map(|branch| chain.inverse(&target, branch));
            let [Ok(plus), Ok(minus)] = &found else { return Ok(()) };
            let apart = (plus[0].unit_direction() - minus[0].unit_direction()).norm();
            prop_assume!(apart > 0.1);
            for (branch, found) in Branch::BOTH.into_iter().zip([plus, minus]) {
                let first = found[0].unit_direction();
                prop_assert_eq!(chain.branch_with(&target, first, 1e-9), Some(branch));
                for aside in [1e-8, -1e-8, 0.01, -0.01] {
                    prop_assert_eq!(chain.branch_with(&target, first * unit(aside), 1e-9), None);
                }
            }
        }
    }
}
