//! Random geometries of the paper's manipulators, and the families' mechanisms of the same geometry.

use super::{PlanoSpherical, Signs, SliderLeg, TranslationalLeg};
use fastrand::Rng;
use opm_core::chain::Branch;
use opm_core::mechanism::family::{plano_spherical, translational_helical};
use opm_core::mechanism::joint::JointLimits;
use std::f64::consts::TAU;

impl PlanoSpherical {
    /// Random parameters of about the printed size.
    pub fn random(rng: &mut Rng) -> Self {
        let mut within = |low: f64, high: f64| low + (high - low) * rng.f64();
        let legs = [0.0, 1.0, 2.0].map(|i| SliderLeg {
            alpha: 2.1 * i + within(-0.5, 0.5),
            h: within(0.05, 0.2),
            a1: within(0.1, 0.3),
            a2: within(0.03, 0.1),
            arc1: within(0.8, 1.6),
            arc2: within(0.8, 1.6),
            eta: 2.1 * i + within(-0.4, 0.4),
            beta: within(0.6, 1.4),
        });
        Self {
            legs,
            d: [within(-0.1, 0.1), within(-0.1, 0.1)],
            b: [within(0.06, 0.15), within(0.06, 0.15)],
        }
    }

    /// The family with these parameters, at this home and in this mode.
    pub fn family(
        &self,
        home: plano_spherical::Home,
        signs: &Signs,
    ) -> plano_spherical::PlanoSpherical {
        let slider_legs = self.legs.iter().zip(signs.legs).enumerate().map(|(i, (leg, signs))| {
            plano_spherical::SliderLeg {
                name: format!("leg{}", i + 1),
                alpha: leg.alpha,
                h: leg.h,
                a1: leg.a1,
                a2: leg.a2,
                alpha1: leg.arc1,
                alpha2: leg.arc2,
                eta: leg.eta,
                beta: leg.beta,
                upper: branch(signs[0]),
                slider: branch(signs[1]),
                limits: Default::default(),
            }
        });
        plano_spherical::PlanoSpherical {
            name: "random".into(),
            home,
            slider_legs: slider_legs.collect(),
            arm_leg: plano_spherical::ArmLeg {
                name: "leg4".into(),
                base: self.d,
                b1: self.b[0],
                b2: self.b[1],
                elbow: branch(signs.arm),
                phi1: JointLimits::default(),
                phi2: JointLimits::default(),
            },
        }
    }
}

impl Signs {
    /// Random signs.
    pub fn random(rng: &mut Rng) -> Self {
        Self { legs: [0; 3].map(|_| [rng.bool(), rng.bool()]), arm: rng.bool() }
    }

    /// The working mode in its text form.
    pub fn written(&self) -> String {
        let sign = |plus: bool| if plus { '+' } else { '-' };
        let mut groups: Vec<String> =
            self.legs.iter().map(|leg| leg.iter().map(|&plus| sign(plus)).collect()).collect();
        groups.push(sign(self.arm).to_string());
        groups.join(" ")
    }
}

impl TranslationalLeg {
    /// Three legs of random geometry, and the index of the helical one.
    pub fn random(rng: &mut Rng) -> ([Self; 3], usize) {
        let direction = rng.f64() * TAU;
        let pitched = rng.usize(..3);
        let legs = [0, 1, 2].map(|i| {
            // The slider must not be parallel to the common axis.
            let alpha = 2.0944 * i as f64 + 0.3 * rng.f64();
            let pitch = if i == pitched { 0.005 + 0.05 * rng.f64() } else { 0.0 };
            Self { alpha, beta: direction - alpha, k: 0.03 * rng.f64(), pitch }
        });
        (legs, pitched)
    }

    /// The family with these legs, at this home.
    pub fn family(
        legs: &[Self],
        home: translational_helical::Home,
    ) -> translational_helical::TranslationalHelical {
        let leg = |(i, leg): (usize, &Self)| translational_helical::TranslationalLeg {
            name: format!("leg{}", i + 1),
            alpha: leg.alpha,
            beta: leg.beta,
            k: leg.k,
            pitch: (leg.pitch != 0.0).then_some(leg.pitch),
            limits: Default::default(),
        };
        translational_helical::TranslationalHelical {
            name: "random".into(),
            home,
            legs: legs.iter().enumerate().map(leg).collect(),
        }
    }
}

fn branch(plus: bool) -> Branch {
    if plus { Branch::Plus } else { Branch::Minus }
}
