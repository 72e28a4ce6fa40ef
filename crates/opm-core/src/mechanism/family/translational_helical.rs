//! The 3-DoF manipulator with a helical leg, 2-PPR + PPH (section 3.2 of the paper).
//!
//! The platform's point P moves in the base's xy plane and the platform turns by φ about one fixed
//! direction of that plane: `P = (x, y, 0)`. Every leg ends in a joint on the line through P along
//! the common direction `k̂ = e(α + β)`, two of them revolute, one helical. With
//! `e(t) = (cos t, sin t)` and `n(t) = e(t + π/2)`, leg i is
//!
//! ```text
//! C = S n(α) + r e(α)   S{i}    prismatic along n(α), actuated
//!                       r{i}    prismatic along e(α); the paper's h - a
//! P = C - k k̂           phi{i}  revolute at C about -k̂ (Eqs. 27-28)
//! P = C - (k + S) k̂     phi{i}  on the helical leg: helical about -k̂, S = p φ (Eqs. 24-25)
//! ```
//!
//! φ is counted about `-k̂`, the direction from the legs to P: turning forward a right-handed screw
//! (`p > 0`) drives P away from its leg. The helical leg's imaginary joint is `S`, a slider along
//! `k̂`.

mod file;

pub(in crate::mechanism) use file::read;

use super::assembly::{AssemblyError, AssemblyReason, Problems, all_legs, carried};
use crate::chain::cylindrical::{CoaxialJoint, CylindricalChain};
use crate::chain::translational::TranslationalChain;
use crate::group::{CylindricalDisplacement, JointDisplacement};
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::{ImaginaryLabel, Leg};
use crate::mechanism::{Mechanism, TaskHints};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Unit, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How many legs there are, one of them helical.
pub const LEGS: usize = 3;

/// How far, in radians, a leg's direction `α + β` may be from the first leg's: angles written with
/// six digits are meant to be the same. All legs take the first one's.
const SAME_DIRECTION: f64 = 1e-6;

/// The pose in which the mechanism is assembled: metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    /// P along the base's x.
    pub x: f64,
    /// P along the base's y.
    pub y: f64,
    /// φ, about `-k̂`; whole turns count.
    pub phi: f64,
}

/// Limits of a leg's joints, lowest and highest value; metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LegLimits {
    /// S.
    pub s: Option<[f64; 2]>,
    /// r.
    pub r: Option<[f64; 2]>,
    /// φ.
    pub phi: Option<[f64; 2]>,
}

/// A PPR leg, or the PPH leg where it has a pitch: metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TranslationalLeg {
    /// Name, unique in the mechanism.
    pub name: String,
    /// α: the slider runs along `n(α)`.
    pub alpha: f64,
    /// β: angle from `e(α)` to the common direction.
    pub beta: f64,
    /// k: from P to the leg's last joint, along the common direction.
    pub k: f64,
    /// p, metres per radian, of the one helical leg.
    pub pitch: Option<f64>,
    /// Limits of its joints.
    pub limits: LegLimits,
}

/// Geometric parameters of the manipulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TranslationalHelical {
    /// Name of the mechanism.
    pub name: String,
    /// Where it is assembled.
    pub home: Home,
    /// The legs, [`LEGS`] of them, exactly one with a pitch.
    pub legs: Vec<TranslationalLeg>,
}

impl TranslationalHelical {
    /// The mechanism, assembled at home.
    ///
    /// # Errors
    /// Every parameter out of its range, legs whose directions `α + β` differ, every joint that is
    /// outside its limits at home.
    pub fn assemble(&self) -> Result<Mechanism, AssemblyError> {
        let Home { x, y, phi } = self.home;
        let mut wrong = Problems::default();
        wrong.finite(&[("x", x), ("y", y), ("phi", phi)]);
        wrong.leg_count("leg", self.legs.len(), LEGS);
        let helical = self.legs.iter().filter(|leg| leg.pitch.is_some()).count();
        if helical == 0 {
            wrong.add(Some("leg"), AssemblyReason::NoHelicalLeg);
        }
        let direction = self.legs.first().map_or(0.0, TranslationalLeg::direction);
        let legs = self.legs.iter().enumerate().map(|(i, leg)| {
            let mut assembled = leg.assemble(&self.home, direction, i + 1);
            if leg.pitch.is_some() && self.legs[..i].iter().any(|other| other.pitch.is_some()) {
                let mut wrong = assembled.err().unwrap_or_default();
                wrong.add(Some("pitch"), AssemblyReason::HelicalLegs(helical));
                assembled = Err(wrong);
            }
            (leg.name.as_str(), assembled)
        });
        Ok(Mechanism {
            name: self.name.clone(),
            legs: all_legs(wrong, legs)?,
            platform: Point3::new(x, y, 0.0),
            task: TaskHints {
                axis: Some(-in_plane(unit(direction)).into_inner()),
                home: vec![("x".into(), x), ("y".into(), y), ("phi".into(), phi)],
                ..TaskHints::default()
            },
        })
    }
}

impl TranslationalLeg {
    fn direction(&self) -> f64 {
        self.alpha + self.beta
    }

    fn assemble(&self, home: &Home, direction: f64, number: usize) -> Result<Leg, Problems> {
        self.check(direction)?;
        if ![home.x, home.y, home.phi, direction].iter().all(|v| v.is_finite()) {
            return Err(Problems::default());
        }
        let k_hat = unit(direction);
        let slides = [unit(self.alpha + FRAC_PI_2), unit(self.alpha)];

        // Upper section, about and along -k̂: the imaginary slider along k̂ takes back what the
        // last joint advances.
        let pitch = self.pitch.unwrap_or(0.0);
        let [imaginary, phi] = CylindricalChain::new([
            CoaxialJoint { turn: 0.0, advance: -1.0 },
            CoaxialJoint { turn: 1.0, advance: pitch },
        ])?
        .inverse(&CylindricalDisplacement { angle: home.phi, advance: 0.0 });
        // A revolute joint is at home's φ too, whole turns included, unless its limits say where.
        let phi = match (self.pitch, self.limits.phi) {
            (None, None) => JointDisplacement::Value(home.phi),
            _ => phi,
        };

        // Lower section: the sliders bring C from the origin to its place.
        let c = Complex::new(home.x, home.y) + k_hat * (self.k + imaginary.value());
        let [s, r] = TranslationalChain::new(slides)?.inverse(c);

        let joint = |symbol: &str, kind, axis, limits| {
            Joint::new(format!("{symbol}{number}"), kind, axis, Point3::origin()).within(limits)
        };
        let prismatic =
            |symbol, along, limits| joint(symbol, JointKind::Prismatic, in_plane(along), limits);
        let last = match self.pitch {
            Some(pitch) => JointKind::Helical { pitch },
            None => JointKind::Revolute,
        };
        let joints = carried([
            (prismatic("S", slides[0], self.limits.s).actuated(), s),
            (prismatic("r", slides[1], self.limits.r), r),
            (joint("phi", last, -in_plane(k_hat), self.limits.phi), phi),
        ])?;
        let imaginary = self.pitch.map(|_| ImaginaryLabel {
            name: "S".into(),
            home: imaginary.value(),
            positive: in_plane(k_hat).into_inner(),
        });
        Ok(Leg { name: self.name.clone(), joints, imaginary })
    }

    fn check(&self, direction: f64) -> Result<(), Problems> {
        let mut wrong = Problems::default();
        wrong.finite(&[("alpha", self.alpha), ("beta", self.beta), ("k", self.k)]);
        if let Some(pitch) = self.pitch {
            wrong.finite(&[("pitch", pitch)]);
            if pitch == 0.0 {
                wrong.add(Some("pitch"), AssemblyReason::NoPitch);
            }
        }
        let apart = self.direction() - direction;
        // NaN is not far: it has been reported as what it is.
        if (apart - TAU * (apart / TAU).round()).abs() > SAME_DIRECTION {
            let [angle, expected] = [self.direction(), direction].map(|a| a.rem_euclid(TAU));
            wrong.add(Some("beta"), AssemblyReason::Direction { angle, expected });
        }
        wrong.none()
    }
}

fn in_plane(z: Complex<f64>) -> Unit<Vector3<f64>> {
    Unit::new_unchecked(Vector3::new(z.re, z.im, 0.0))
}

#[cfg(test)]
mod tests;
