//! Spherical chains: three revolute joints whose axes pass through one point, and the spherical joint.

use super::limits::{Components, Limits};
use super::shell::Shell;
use super::surface::Surface;
use super::{Attempt, Branch, ChainError, ClosedForm, DEGENERATE, REACH_TOLERANCE, ReachDeficit};
use crate::group::{JointDisplacement, rotation_vector};
use nalgebra::{Complex, Matrix3, Rotation3, Unit, Vector3};

/// RRR about one point: `exp(a₁q₁) exp(a₂q₂) exp(a₃q₃) = R`. The branch is `+` where the triple product
/// `a₁ · (a₂ × a₃)` of the displaced axes is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalChain {
    axes: [Vector3<f64>; 3],
    /// `a₁·a₂` and `a₂·a₃`: cosines of the arcs of the two links.
    cosines: [f64; 2],
    /// The component of `a₂` perpendicular to `a₁`, and `a₁ × a₂`.
    second_on_first: [Vector3<f64>; 2],
    /// The component of `a₃` perpendicular to `a₂`, and `a₂ × a₃`, both over the square of their length: their
    /// products with `a₃` as it rotates about `a₂` are the cosine and the sine of the angle.
    third_on_second: [Vector3<f64>; 2],
    /// Two unit directions that make a right-handed orthonormal frame with `a₃`.
    beside_third: [Vector3<f64>; 2],
}

impl SphericalChain {
    /// The closed form of three revolutes with these axes at home, base first.
    ///
    /// # Errors
    /// Two neighbouring axes are parallel, so that the chain cannot rotate in all directions.
    pub fn new(axes: [Unit<Vector3<f64>>; 3]) -> Result<Self, ChainError> {
        let [a1, a2, a3] = axes.map(Unit::into_inner);
        let (n12, n23) = (a1.cross(&a2), a2.cross(&a3));
        if n12.norm().min(n23.norm()) <= DEGENERATE {
            return Err(ChainError::Dependent("two neighbouring axes are parallel"));
        }
        let beside = n23.normalize();
        Ok(Self {
            axes: [a1, a2, a3],
            cosines: [a1.dot(&a2), a2.dot(&a3)],
            second_on_first: [a2 - a1 * a1.dot(&a2), n12],
            third_on_second: [
                (a3 - a2 * a2.dot(&a3)) / n23.norm_squared(),
                n23 / n23.norm_squared(),
            ],
            beside_third: [beside, a3.cross(&beside)],
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
        if equation.has_two() { Ok(equation.solve(branch)) } else { self.first_at_boundary(w) }
    }

    #[inline(always)]
    fn equation(&self, w: &Vector3<f64>) -> Equation {
        let a = dot(&self.second_on_first[0], w);
        let b = dot(&self.second_on_first[1], w);
        let d = self.cosines[1] - self.cosines[0] * dot(&self.axes[0], w);
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
    #[inline(always)]
    fn with_first(&self, target: &Matrix3<f64>, q1: Complex<f64>) -> [JointDisplacement; 3] {
        let w1 = rotate_back(&self.axes[0], q1, &apply(target, &self.axes[2]));
        let q2 = angle(&self.third_on_second, &w1);
        let beside1 = rotate_back(&self.axes[0], q1, &apply(target, &self.beside_third[0]));
        let beside2 = rotate_back(&self.axes[1], q2, &beside1);
        let q3 = angle(&self.beside_third, &beside2);
        [
            JointDisplacement::Direction(q1),
            JointDisplacement::Direction(q2),
            JointDisplacement::Direction(q3),
        ]
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
        self.solve(target, branch, &mut found)?;
        Ok(found)
    }

    /// All joints' rotations with a known one of the first joint, a unit vector, and their branch; `None` where the chain
    /// closes with no rotation of it nearer than `within`, in radians.
    #[inline(always)]
    pub(super) fn completed(
        &self,
        target: &Matrix3<f64>,
        first: Complex<f64>,
        within: f64,
    ) -> Option<([JointDisplacement; 3], Branch)> {
        let Equation { a, b, d, .. } = self.equation(&self.third_axis(target));
        // The derivative of the equation is the root that a branch is the sign of.
        let miss = a * first.re + b * first.im - d;
        let root = b * first.re - a * first.im;
        let branch = if root > 0.0 { Branch::Plus } else { Branch::Minus };
        (miss.abs() < within * root.abs()).then(|| (self.with_first(target, first), branch))
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
    pub(crate) fn shell(&self, branch: Branch, limits: &Limits) -> Option<Shell> {
        let [a1, a2, a3] = self.axes;
        // The second joint rotates a₃ from where it is nearest to a₁, by an angle from 0 to π on either branch. The
        // triple product of the axes is negative where that is counter-clockwise.
        let nearest = angle(&self.third_on_second, &a1);
        let cosines = match limits.arc() {
            None => [-1.0, 1.0],
            Some(arc) => {
                let from_nearest = arc.turned(nearest.conj() / nearest.norm());
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
            [self.cosines[0] * self.cosines[1], a1.cross(&a2).norm() * a2.cross(&a3).norm()];
        Some(Shell {
            fixed: a1,
            carried: a3,
            cosines: cosines.map(|cosine| level + swing * cosine),
        })
    }

    /// The second joint's two rotations at which the branches meet: the three axes are then in one plane.
    pub(super) fn folds(&self) -> [JointDisplacement; 2] {
        let rotation = angle(&self.third_on_second, &self.axes[0]);
        [JointDisplacement::Direction(rotation), JointDisplacement::Direction(-rotation)]
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
    fn attempt(&self, target: &Matrix3<f64>, branch: Branch) -> Attempt {
        let equation = self.equation(&self.third_axis(target));
        let displacements = self.with_first(target, equation.solve(branch));
        Attempt { displacements, holds: equation.has_two(), beyond: equation.has_none() }
    }

    #[cold]
    fn exception(
        &self,
        target: &Matrix3<f64>,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let q1 = self.first_at_boundary(&self.third_axis(target))?;
        Ok(self.with_first(target, q1))
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
        self.d.abs() > self.square.sqrt() + REACH_TOLERANCE
    }

    /// The solution on a branch, as a unit vector.
    #[inline(always)]
    fn solve(&self, branch: Branch) -> Complex<f64> {
        let Self { a, b, d, square } = *self;
        let root = branch.sign() * (square - d * d).max(0.0).sqrt();
        Complex::new((a * d + b * root) / square, (b * d - a * root) / square)
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
        self.attempt(target, Branch::Plus).displacements
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
    fn attempt(&self, target: &Matrix3<f64>, _: Branch) -> Attempt {
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

/// The rotation, as a unit vector, that takes the first of two perpendicular directions to the direction
/// of `v`.
#[inline(always)]
fn angle(directions: &[Vector3<f64>; 2], v: &Vector3<f64>) -> Complex<f64> {
    Complex::new(dot(&directions[0], v), dot(&directions[1], v))
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
        /// The rotation of the first joint tells the branch and the other rotations that were found with it. A rotation
        /// with which the chain does not close tells nothing.
        #[test]
        fn the_first_rotation_tells_the_others(
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
                let completed = chain.completed(&target, first, 1e-9);
                let (rotations, of) = completed.expect("the first rotation closes the chain");
                prop_assert_eq!(of, branch);
                for (one, other) in rotations.iter().zip(found) {
                    let apart = (one.unit_direction() - other.unit_direction()).norm();
                    prop_assert!(apart < 1e-9, "{:e}", apart);
                }
                for aside in [1e-8, -1e-8, 0.01, -0.01] {
                    prop_assert!(chain.completed(&target, first * unit(aside), 1e-9).is_none());
                }
            }
        }
    }
}
