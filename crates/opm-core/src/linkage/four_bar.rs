//! The spherical four-bar: a closed loop of four revolutes through one point,
//!
//! ```text
//! exp(a₀q₀) exp(a₁q₁) exp(a₂q₂) exp(a₃q₃) = 1
//! ```
//!
//! with the axes in the order of the loop, at home, where all `q` are zero. A cyclic shift of the
//! factors is a conjugation and leaves the product the identity, so any of the four can be `a₀`,
//! the input. The other three are then a spherical chain with a known target,
//!
//! ```text
//! exp(a₁q₁) exp(a₂q₂) exp(a₃q₃) = exp(-a₀q₀)
//! ```
//!
//! Its first equation is the input-output equation `A cos q₁ + B sin q₁ = C` of the textbooks (J.
//! M. McCarthy and G. S. Soh, *Geometric Design of Linkages*, on spherical linkages): the link
//! between `a₁` and `a₂` keeps its arc, seen from the position `w = exp(-a₀q₀) a₃` given by the
//! input.
//!
//! The loop closes exactly where the arc between `a₁` and `w` can be spanned by the two links
//! between them, arcs `α` and `β`:
//!
//! ```text
//! cos(α + β) <= a₁·w = P cos q₀ + Q sin q₀ + R <= cos(α - β)
//! ```
//!
//! * Folded or stretched links (an equality) count as closing; the two branches meet there.
//! * Where the links' arcs are equal or supplementary and `w` lies on `a₁`, `q₁` is arbitrary:
//!   both branches return zero, its home value.
//! * A change point is an equality that the input passes without leaving the range. A branch keeps
//!   its sign on both sides; the smooth motion changes it.
//! * Two parallel axes that are neighbours in the loop form a single joint: this is an error.

use crate::chain::spherical::SphericalChain;
use crate::chain::{Branch, ChainError, ReachDeficit};
use crate::group::JointDisplacement;
use nalgebra::{Complex, Matrix3, Unit, Vector3};

/// A closed loop of four revolutes through one point, at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    driven: [DrivenFourBar; 4],
}

/// A four-bar driven by one of its joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenFourBar {
    /// The axis `a₀` of the input.
    input: Vector3<f64>,
    /// The chain of the other joints, `a₁ a₂ a₃`.
    chain: SphericalChain,
    reach: Reach,
    home: Branch,
}

/// The condition `lowest <= p cos q₀ + q sin q₀ <= highest`, under which the loop closes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reach {
    p: f64,
    q: f64,
    lowest: f64,
    highest: f64,
}

impl FourBar {
    /// Builds the loop with these unit axes at home, in the order of the loop.
    ///
    /// # Errors
    /// [`ChainError`] if two neighbouring axes are parallel.
    pub fn new(axes: [Unit<Vector3<f64>>; 4]) -> Result<Self, ChainError> {
        let driven = |input: usize| DrivenFourBar::new([0, 1, 2, 3].map(|i| axes[(input + i) % 4]));
        Ok(Self { driven: [driven(0)?, driven(1)?, driven(2)?, driven(3)?] })
    }

    /// The four-bar driven by its joint with index `input`, modulo four.
    pub fn driven_by(&self, input: usize) -> &DrivenFourBar {
        &self.driven[input % 4]
    }
}

impl DrivenFourBar {
    /// Builds the four-bar from its axes, the input's first.
    fn new(axes: [Unit<Vector3<f64>>; 4]) -> Result<Self, ChainError> {
        let [a0, a1, a2, a3] = axes.map(Unit::into_inner);
        let [_, first, second, third] = axes;
        let chain = SphericalChain::new([first, second, third])?;
        // The condition on a₁ · exp(-a₀q₀) a₃, with the constant part on the other side.
        let constant = a1.dot(&a0) * a0.dot(&a3);
        let (cosines, sines) =
            (a1.dot(&a2) * a2.dot(&a3), a1.cross(&a2).norm() * a2.cross(&a3).norm());
        let reach = Reach {
            p: a1.dot(&a3) - constant,
            q: -a1.dot(&a0.cross(&a3)),
            lowest: cosines - sines - constant,
            highest: cosines + sines - constant,
        };
        let home = if a1.dot(&a2.cross(&a3)) < 0.0 { Branch::Minus } else { Branch::Plus };
        Ok(Self { input: a0, chain, reach, home })
    }

    /// The rotations of the three joints that follow the input in the loop. The branch `+` is the
    /// one where the triple product of their moved axes is positive.
    ///
    /// # Errors
    /// The reach deficit, an angle, if the loop does not close at this input.
    #[inline]
    pub fn solve(
        &self,
        input: Complex<f64>,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        self.chain.inverse(&self.target(input), branch)
    }

    /// Whether the loop closes at this input.
    #[inline]
    pub fn closes(&self, input: Complex<f64>) -> bool {
        let w = self.chain.third_axis(&self.target(input));
        self.chain.first(&w, Branch::Plus).is_ok()
    }

    /// The branch in which the loop is assembled at home.
    pub fn home(&self) -> Branch {
        self.home
    }

    /// The inputs, at most four, between which the loop changes between closing and not closing,
    /// and those at which it only folds (dead points).
    pub fn dead_points(&self) -> impl Iterator<Item = Complex<f64>> + use<> {
        let Reach { p, q, lowest, highest } = self.reach;
        let axis = Complex::new(p, q);
        let square = axis.norm_sqr();
        let length = square.sqrt();
        [lowest, highest].into_iter().flat_map(move |bound| {
            let below = (length - bound) * (length + bound);
            let roots = (below >= 0.0).then(|| [below.sqrt(), -below.sqrt()]);
            roots.into_iter().flatten().map(move |root| axis * Complex::new(bound, root) / square)
        })
    }

    /// The rotation `exp(-a₀q₀)`.
    #[inline]
    fn target(&self, turn: Complex<f64>) -> Matrix3<f64> {
        let a = &self.input;
        Matrix3::identity() * turn.re + a * a.transpose() * (1.0 - turn.re)
            - a.cross_matrix() * turn.im
    }
}

#[cfg(test)]
mod tests;
