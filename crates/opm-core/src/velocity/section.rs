//! The differential kinematics of one section of a leg: joint rates from the twist of its outer link.

use super::rotation_vector::RotationVector;
use super::screws::Screws;
use super::{SINGULAR, SingularCause};
use crate::chain::Chain;
use crate::chain::partial::PartialChain;
use crate::group::{JointDisplacement, LocalTwist, SubspaceKind};
use crate::manipulator::{CompiledLeg, CompiledSection, Lean};
use nalgebra::Matrix3;

/// The displaced screws of a section at one configuration, and the reciprocal screws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Differential {
    /// The displaced screws.
    pub screws: Screws,
    /// The reciprocal screws times the determinant, which are defined at singularities too.
    pub crosses: [LocalTwist; 3],
    /// The reciprocal screws, which give the joint rates; zeros at a singularity.
    pub reciprocal: [LocalTwist; 3],
    /// The serial measure: the determinant over its unit, dimensionless.
    pub measure: f64,
    /// The rotation vector of a section that is a spherical joint, which has three coordinates but no joint
    /// screws.
    ball: Option<RotationVector>,
}

impl Differential {
    /// The differential of a section whose rates are not asked for.
    pub const UNUSED: Self = {
        let zeros = [LocalTwist::new(0.0, 0.0, 0.0); 3];
        let screws = Screws { kind: SubspaceKind::Identity, moved: zeros };
        Self { screws, crosses: zeros, reciprocal: zeros, measure: 1.0, ball: None }
    };

    /// The differential of a section, whose joints have these displacements. For a spherical joint, `vector`
    /// gives its rotation vector from home in base coordinates, by the number of its first coordinate; full
    /// revolutions count. `length` is the characteristic length, metres.
    #[inline(always)]
    pub fn new(
        kind: SubspaceKind,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
        vector: impl FnOnce(usize) -> LocalTwist,
        length: f64,
    ) -> Self {
        if let Chain::Ball(ball) = &section.chain {
            let first = section.coordinates[0].map_or(0, |coordinate| coordinate.number);
            let vector = RotationVector::new(ball.axes.tr_mul(&vector(first)));
            let rows = ball.axes * vector.angular_velocity_to_rates();
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
        if let Some(partial) = &section.partial {
            return Self::of_partial(kind, section, partial, displacements, length);
        }
        let screws = Screws::new(kind, &section.screws, displacements);
        Self::of_screws(screws, section.scale)
    }

    /// The differential of a section that constrains the platform. Locked joints do not move: any screws will do
    /// that are independent of the others here.
    #[cold]
    fn of_partial(
        kind: SubspaceKind,
        section: &CompiledSection,
        partial: &PartialChain,
        displacements: &[JointDisplacement; 3],
        length: f64,
    ) -> Self {
        let mut screws = Screws::new(kind, &section.screws, displacements);
        let scale = partial.complete(&mut screws.moved, length);
        Self::of_screws(screws, scale)
    }

    /// The differential for displaced screws, whose determinant has the unit `scale`.
    #[inline(always)]
    fn of_screws(screws: Screws, scale: f64) -> Self {
        let (crosses, determinant) = screws.reciprocal();
        let measure = determinant / scale;
        let reciprocal = if measure.abs() < SINGULAR {
            [LocalTwist::zeros(); 3]
        } else {
            let inverse = determinant.recip();
            crosses.map(|row| row * inverse)
        };
        Self { screws, crosses, reciprocal, measure, ball: None }
    }

    /// Why the joints have no rates; `None` if they have.
    #[inline]
    pub fn singular(&self) -> Option<SingularCause> {
        if self.measure.abs() < SINGULAR {
            return Some(SingularCause::Serial);
        }
        let full_revolution = self.ball.is_some_and(|vector| vector.is_singular());
        full_revolution.then_some(SingularCause::RotationVector)
    }

    /// The rates of the section's joints, from the base on, for a twist of its outer link.
    #[inline]
    pub fn rates(&self, twist: &LocalTwist) -> LocalTwist {
        LocalTwist::from_fn(|joint, _| self.rate(joint, twist))
    }

    /// The rate of one joint for a twist of the section's outer link.
    #[inline]
    pub fn rate(&self, joint: usize, twist: &LocalTwist) -> f64 {
        self.reciprocal[joint].dot(twist)
    }

    /// The part of a section's twist and of its derivative that is left to the joints of its chain, in a leg with a lift
    /// that leans. `rise` has the rate and the acceleration of the height, and `displacements` are the joints'.
    ///
    /// With the lift's displaced screw `s` between the others, `V = Σ sₖ q̇ₖ + s ḣ`, and the derivative has brackets of
    /// `s ḣ` with the joints before it and behind it.
    #[cold]
    pub fn behind(
        &self,
        leg: &CompiledLeg,
        lean: &Lean,
        displacements: &[JointDisplacement; 3],
        [twist, derivative]: [LocalTwist; 2],
        [rate, acceleration]: [f64; 2],
    ) -> [LocalTwist; 2] {
        let screw = lean.moved_screw(leg, displacements);
        let own = screw * rate;
        let twist = twist - own;
        let rates = self.rates(&twist);
        let parts = self.screws.moved.iter().zip(&rates).map(|(screw, rate)| screw * *rate);
        let (before, behind) = parts.enumerate().fold(
            (LocalTwist::zeros(), LocalTwist::zeros()),
            |(before, behind), (joint, part)| match joint < lean.before {
                true => (before + part, behind),
                false => (before, behind + part),
            },
        );
        let kind = self.screws.kind;
        let brackets = kind.bracket(&before, &own) + kind.bracket(&own, &behind);
        [twist, derivative - screw * acceleration - brackets]
    }

    /// The accelerations of the section's joints, for a twist of its outer link, the derivative of the twist,
    /// and the joint rates.
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
