//! One section of a leg at one configuration: from the twist of its outer link to its joints' rates.

use super::rotation_vector::RotationVector;
use super::screws::Screws;
use super::{SINGULAR, SingularCause};
use crate::chain::Chain;
use crate::group::{JointDisplacement, LocalTwist, SubspaceKind};
use crate::manipulator::CompiledSection;
use nalgebra::Matrix3;

/// A section's screws as they have moved, and the reciprocal ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Differential {
    pub screws: Screws,
    /// The reciprocal screws times the determinant: as regular as the screws.
    pub crosses: [LocalTwist; 3],
    /// Rows that give the rates; zeros where there are none.
    pub reciprocal: [LocalTwist; 3],
    /// The determinant over what it is measured in: dimensionless.
    pub measure: f64,
    /// Where the section is a spherical joint: it has no screws, but three coordinates.
    ball: Option<RotationVector>,
}

impl Differential {
    /// Of a section that is at `amounts`; a spherical joint at the rotation vector `vector` from home,
    /// whole turns counted, in base coordinates.
    #[inline]
    pub fn new(
        kind: SubspaceKind,
        section: &CompiledSection,
        amounts: &[JointDisplacement; 3],
        vector: impl FnOnce(usize) -> LocalTwist,
    ) -> Self {
        if let Chain::Ball(ball) = &section.chain {
            let first = section.coordinates[0].map_or(0, |slot| slot.number);
            let vector = RotationVector::new(ball.axes.tr_mul(&vector(first)));
            let rows = ball.axes * vector.rates_of_spin();
            let reciprocal = if vector.is_singular() {
                [LocalTwist::zeros(); 3]
            } else {
                [0, 1, 2].map(|i| rows.row(i).transpose())
            };
            return Self {
                screws: Screws { kind, moved: section.screws },
                crosses: section.screws,
                reciprocal,
                measure: 1.0,
                ball: Some(vector),
            };
        }
        let screws = Screws::new(kind, &section.screws, amounts);
        let (crosses, determinant) = screws.reciprocal();
        let measure = determinant / section.scale;
        let reciprocal = if measure.abs() < SINGULAR {
            [LocalTwist::zeros(); 3]
        } else {
            let inverse = determinant.recip();
            crosses.map(|row| row * inverse)
        };
        Self { screws, crosses, reciprocal, measure, ball: None }
    }

    /// Why there are no rates for a twist, if there are none.
    #[inline]
    pub fn singular(&self) -> Option<SingularCause> {
        if self.measure.abs() < SINGULAR {
            return Some(SingularCause::Serial);
        }
        let whole_turn = self.ball.is_some_and(|vector| vector.is_singular());
        whole_turn.then_some(SingularCause::RotationVector)
    }

    /// The rates of its joints, base first, for a twist of its outer link.
    #[inline]
    pub fn rates(&self, twist: &LocalTwist) -> LocalTwist {
        LocalTwist::from_fn(|joint, _| self.rate(joint, twist))
    }

    /// The rate of one joint.
    #[inline]
    pub fn rate(&self, joint: usize, twist: &LocalTwist) -> f64 {
        self.reciprocal[joint].dot(twist)
    }

    /// The accelerations of its joints for a twist of its outer link, that twist's derivative, and the
    /// rates that go with them.
    #[inline]
    pub fn accelerations(
        &self,
        twist: &LocalTwist,
        derivative: &LocalTwist,
        rates: &LocalTwist,
    ) -> LocalTwist {
        match &self.ball {
            Some(vector) => {
                let axes = Matrix3::from_rows(&self.screws.moved.map(|screw| screw.transpose()));
                let bias = vector.bias(&axes.tr_mul(rates), twist);
                self.rates(derivative) + axes * bias
            }
            None => self.rates(&(derivative - self.screws.bias(rates))),
        }
    }
}
