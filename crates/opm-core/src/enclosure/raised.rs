//! Chains of legs whose lift leans, over a box of heights: see [`crate::manipulator`]'s lifts.

use crate::boxes::Share;
use crate::boxes::chain::{share, solved};
use crate::boxes::{Affine, Plane};
use crate::boxes::{Enclosed, PlanarTarget};
use crate::chain::planar::PlanarChain;
use crate::chain::{Branch, ClosedForm};
use crate::group::PlanarDisplacement;
use crate::manipulator::Lean;
use nalgebra::Complex;

/// The chain of a leg's section without its lift, which leans, and what the chain has to reach.
pub struct RaisedChain<const N: usize> {
    chain: PlanarChain<Plane<N>>,
    target: PlanarTarget<N>,
}

impl<const N: usize> RaisedChain<N> {
    /// The chain at the heights above home `rise`, metres, for a target of the section.
    pub fn new(
        lean: &Lean,
        chain: &PlanarChain,
        rise: Affine<N>,
        target: &PlanarTarget<N>,
    ) -> Self {
        let step = displacement(lean, rise);
        let still = PlanarDisplacement {
            rotation: Plane::constant(Complex::ONE),
            translation: Plane::constant(Complex::ZERO),
        };
        let joints = chain.joints();
        let joints = std::array::from_fn(|number| {
            joints[number].carried(if number >= lean.before { &step } else { &still })
        });
        Self { chain: PlanarChain::of(joints), target: target.after(&step.inverse()) }
    }

    /// The share for which the chain exists and closes.
    pub fn closes(&self) -> Share<N> {
        let closes = ClosedForm::<Affine<N>>::closes(&self.chain, &self.target);
        let all = self.chain.regular().into_iter().chain([closes]);
        all.fold(Share::ALL, |all, one| all.and(share(&one, 0.0)))
    }

    /// The joints' displacements.
    pub fn displacements(&self, branch: Branch) -> [Enclosed<N>; 3] {
        solved(&self.chain, &self.target, branch)
    }
}

/// The displacement in the plane that a lift makes at heights above home, metres.
fn displacement<const N: usize>(lean: &Lean, rise: Affine<N>) -> PlanarTarget<N> {
    let [turn, re, im] = [lean.screw.x, lean.screw.y, lean.screw.z];
    let slide = Complex::new(re, im);
    if turn == 0.0 {
        let rotation = Plane::constant(Complex::ONE);
        return PlanarTarget { rotation, translation: Plane::constant(slide).scaled(rise) };
    }
    // A rotation r about the centre c: z ↦ r (z - c) + c, where the speed of a point z is i turn (z - c).
    let centre = slide * Complex::I / turn;
    let rotation = (rise * turn).unit_vector();
    PlanarTarget { rotation, translation: Plane::constant(centre) - rotation * centre }
}
