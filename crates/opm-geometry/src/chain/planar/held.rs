//! Planar chains with one joint held. The two other joints then form a link, a slider with a pivot or a
//! cross slide.

use super::{PlanarChain, PlanarJoint};
use crate::chain::surface::Surface;
use crate::group::{JointDisplacement, PlanarDisplacement};
use PlanarJoint::{Prismatic, Revolute};
use nalgebra::Complex;

impl PlanarChain {
    /// The targets at which the chain closes with joint number `joint` held at `displacement`.
    pub(in crate::chain) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let joints = self.joints();
        let hold = joints[joint].displacement(displacement);
        let free = PlanarDisplacement::IDENTITY;
        match joint {
            // E₂E₃ = E₁⁻¹ g
            0 => pair([joints[1], joints[2]], [hold, free]),
            // E₁ (E₂E₃E₂⁻¹) = g E₂⁻¹
            1 => pair([joints[0], joints[2].carried(&hold)], [free, hold]),
            // E₁E₂ = g E₃⁻¹
            _ => pair([joints[0], joints[1]], [free, hold]),
        }
    }

    /// The displacements of the middle joint at which the two branches meet, or at which two sliders become
    /// parallel.
    pub(in crate::chain) fn folds(&self) -> Vec<JointDisplacement> {
        // The rotation of one direction to another, and the rotation to its opposite.
        let aligned = |from: Complex<f64>, to: Complex<f64>, reversed: bool| {
            let rotation = to * from.conj();
            let rotation = if reversed { rotation.conj() } else { rotation };
            vec![JointDisplacement::Direction(rotation), JointDisplacement::Direction(-rotation)]
        };
        let square = Complex::<f64>::i();
        match self.joints() {
            [Revolute { at: p1, .. }, Revolute { at: p2, reversed }, Revolute { at: p3, .. }] => {
                aligned(p3 - p2, p2 - p1, reversed)
            }
            [Prismatic { along }, Revolute { at: p2, reversed }, Revolute { at: p3, .. }] => {
                aligned(p3 - p2, along * square, reversed)
            }
            [Revolute { at: p1, .. }, Revolute { at: p2, reversed }, Prismatic { along }] => {
                aligned(along, (p2 - p1) * square, reversed)
            }
            [Revolute { at: p1, .. }, Prismatic { along }, Revolute { at: p3, .. }] => {
                vec![JointDisplacement::Value(-((p3 - p1) * along.conj()).re)]
            }
            [Prismatic { along: d1 }, Revolute { reversed, .. }, Prismatic { along: d3 }] => {
                aligned(d3, d1, reversed)
            }
            [Revolute { .. }, Prismatic { .. }, Prismatic { .. }]
            | [Prismatic { .. }, Prismatic { .. }, Revolute { .. } | Prismatic { .. }] => {
                Vec::new()
            }
        }
    }

    /// Whether a joint's displacement is a rotation.
    pub fn is_rotation(&self, joint: usize) -> bool {
        matches!(self.joints()[joint], Revolute { .. })
    }

    /// The sum of the pivots' distances from the origin, metres.
    pub(in crate::chain) fn size(&self) -> f64 {
        let size = |joint: &PlanarJoint| match joint {
            Revolute { at, .. } => at.norm(),
            Prismatic { .. } => 0.0,
        };
        self.joints().iter().map(size).sum()
    }
}

/// The targets `g` for which `first⁻¹ g last⁻¹` is a product of displacements of the two joints.
fn pair(joints: [PlanarJoint; 2], [first, last]: [PlanarDisplacement; 2]) -> Surface {
    let back = last.inverse();
    match joints {
        [Revolute { at: a, .. }, Revolute { at: b, .. }] => Surface::Circle {
            point: back.apply(b),
            centre: first.apply(a),
            square: (b - a).norm_sqr(),
        },
        [Prismatic { along }, Revolute { at, .. }] => {
            let across = first.rotation * along * Complex::i();
            let on = first.apply(at);
            Surface::Line { point: back.apply(at), across, at: (across.conj() * on).re }
        }
        [Revolute { at, .. }, Prismatic { along }] => {
            let across = back.rotation * along * Complex::i();
            let on = back.apply(at);
            Surface::Carried { point: first.apply(at), across, at: (across.conj() * on).re }
        }
        [Prismatic { .. }, Prismatic { .. }] => {
            Surface::Rotation { rotation: first.rotation * last.rotation }
        }
    }
}
