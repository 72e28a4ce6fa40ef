//! Chains of legs whose lift leans, over a box of heights: see [`crate::manipulator`]'s lifts.

use super::affine::{Affine, Plane};
use super::planar::{self, Joint};
use super::share::Share;
use super::target::{Enclosed, PlanarTarget};
use crate::chain::Branch;
use crate::chain::planar::PlanarChain;
use crate::manipulator::Lean;
use nalgebra::Complex;

/// The chain of a leg's section without its lift, which leans, and what the chain has to reach.
pub struct RaisedChain<const N: usize> {
    joints: [Joint<Plane<N>>; 3],
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
        let carried = |place| step.rotation * place + step.translation;
        let joints = chain.joints();
        let joints = std::array::from_fn(|number| {
            match (Joint::from(joints[number]), number >= lean.before) {
                (Joint::Revolute { at, reversed }, true) => {
                    Joint::Revolute { at: carried(at), reversed }
                }
                (Joint::Prismatic { along }, true) => {
                    Joint::Prismatic { along: step.rotation * along }
                }
                (Joint::Revolute { at, reversed }, false) => {
                    Joint::Revolute { at: Plane::constant(at), reversed }
                }
                (Joint::Prismatic { along }, false) => {
                    Joint::Prismatic { along: Plane::constant(along) }
                }
            }
        });
        Self { joints, target: target.after(&step.inverse()) }
    }

    /// The share for which the chain exists and closes.
    pub fn closes(&self) -> Share<N> {
        planar::makes_a_chain(&self.joints).and(planar::closes(&self.joints, &self.target))
    }

    /// The joints' displacements.
    pub fn displacements(&self, branch: Branch) -> [Enclosed<N>; 3] {
        planar::displacements(&self.joints, &self.target, branch)
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
