//! Legs that are solved whole, over a box of poses.

use super::affine::{Affine, Plane};
use super::share::Share;
use super::target::{Enclosed, Rotation};
use crate::chain::kernel::Row;
use crate::chain::whole::{General, Invariant, LegReach, MOST_FREEDOMS, Roots, scale};
use crate::numbers::Plane as _;

/// How far from zero a number under a root is certainly on one side of it, as a share of its scale: ten times what counts as
/// reached.
const SLACK: f64 = 1e-11;

/// Bounds of the share of a box of poses that a branch of a leg reaches, and of the displacements of the joints that were asked
/// for, by their freedoms. These hold where the branch reaches a pose.
pub fn enclose<const N: usize>(
    leg: &LegReach,
    target: (Rotation<N>, [Affine<N>; 3]),
    signs: [f64; 2],
) -> (Share<N>, [Enclosed<N>; MOST_FREEDOMS]) {
    let mut roots = Shared { share: Share::ALL, size: leg.size() };
    let displacements = leg.displacements::<Affine<N>>(target, signs, &mut roots);
    (roots.share, displacements)
}

/// Roots over a box, and the share of it where they are real.
struct Shared<const N: usize> {
    share: Share<N>,
    size: f64,
}

impl<const N: usize> Shared<N> {
    /// Asks for a number that is not negative, relative to its scale.
    fn real(&mut self, number: Affine<N>) {
        self.share = self.share.and(Share::within(&number, [0.0, f64::INFINITY], SLACK));
    }

    fn general(&self) -> General<Affine<N>> {
        General::new(self.size)
    }
}

impl<const N: usize> Roots<Affine<N>> for Shared<N> {
    fn twofold(&mut self, row: Row<Affine<N>>, of: Invariant<Affine<N>>, sign: f64) -> Plane<N> {
        let per = 1.0 / scale(&of, self.size);
        let [cosine, sine, constant] = [row.cosine, row.sine, row.constant].map(|part| part * per);
        let axis = Plane::new(cosine, sine);
        let square = axis.norm_sqr() - constant.square();
        self.real(square);
        let slope = square.sqrt() * sign;
        (axis * Plane::new(constant, -slope)).scaled(axis.norm_sqr().recip())
    }

    fn double(&mut self, row: Row<Affine<N>>, of: Invariant<Affine<N>>) -> Plane<N> {
        self.general().double(row, of)
    }

    fn pair(&mut self, rows: [Row<Affine<N>>; 2]) -> Plane<N> {
        self.general().pair(rows)
    }

    fn turned(&mut self, vector: Plane<N>, square: Affine<N>, scale: f64) -> Plane<N> {
        self.general().turned(vector, square, scale)
    }

    fn linear(&mut self, rate: Affine<N>, constant: Affine<N>) -> Affine<N> {
        self.general().linear(rate, constant)
    }

    fn quadratic(
        &mut self,
        half: Affine<N>,
        constant: Affine<N>,
        _: Affine<N>,
        sign: f64,
    ) -> Affine<N> {
        let square = half.square() - constant;
        self.real(square * (1.0 / (self.size * self.size)));
        square.sqrt() * sign - half
    }
}

#[cfg(test)]
mod tests;
