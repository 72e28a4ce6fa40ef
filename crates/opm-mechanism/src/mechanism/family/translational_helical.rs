//! The 3-DoF manipulator with a helical leg, 2-PPR + PPH (section 3.2 of the paper).
//!
//! The platform's point P moves in the base's xy plane, and the platform rotates by φ about one
//! fixed direction in that plane: `P = (x, y, 0)`. Every leg ends in a joint on the line through P
//! along the common direction `k̂ = e(α + β)`; two of these joints are revolute, one is helical.
//! With `e(t) = (cos t, sin t)` and `n(t) = e(t + π/2)`, leg i is
//!
//! ```text
//! C = S n(α) + r e(α)   S{i}    prismatic along n(α), actuated
//!                       r{i}    prismatic along e(α); the paper's h - a
//! P = C - k k̂           phi{i}  revolute at C about -k̂ (Eqs. 27-28)
//! P = C - (k + S) k̂     phi{i}  on the helical leg: helical about -k̂, S = p φ (Eqs. 24-25)
//! ```
//!
//! φ is positive about `-k̂`, the direction from the legs to P: rotation in the positive direction
//! drives P away from the leg if the screw is right-handed (`p > 0`). The helical leg's imaginary
//! joint is `S`, a slider along `k̂`.

#[cfg(feature = "files")]
mod file;
mod parameters;

#[cfg(feature = "files")]
pub(in crate::mechanism) use file::FORM;

use super::assembly::{AssemblyError, AssemblyReason, Problems, all_legs, carried};
use crate::chain::cylindrical::{CoaxialJoint, CylindricalChain};
use crate::chain::translational::TranslationalChain;
use crate::group::{CylindricalDisplacement, JointDisplacement};
use crate::mechanism::joint::{Joint, JointKind, JointLimits};
use crate::mechanism::leg::{ImaginaryLabel, Leg};
use crate::mechanism::{BodyMasses, Mechanism, Shapes, TaskHints};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Unit, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The number of legs, one of which is helical.
pub const LEGS: usize = 3;

/// Largest difference in radians between a leg's direction `α + β` and the first leg's. Angles
/// written with six digits are meant to be equal within it. All legs get the first leg's direction.
const SAME_DIRECTION: f64 = 1e-6;

/// The pose in which the mechanism is assembled: metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    /// P along the base's x, metres.
    pub x: f64,
    /// P along the base's y, metres.
    pub y: f64,
    /// The platform's angle φ about `-k̂`, radians. Full revolutions count.
    pub phi: f64,
}

/// Limits of a leg's joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LegLimits {
    /// Limits of the slider S.
    pub s: JointLimits,
    /// Limits of the passive slider r.
    pub r: JointLimits,
    /// Limits of φ.
    pub phi: JointLimits,
}

/// The parameters of a PPR leg, or of the PPH leg if it has a pitch; metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TranslationalLeg {
    /// The leg's name, unique in the mechanism.
    pub name: String,
    /// Angle α: the slider moves along `n(α)`.
    pub alpha: f64,
    /// Angle β from `e(α)` to the common direction.
    pub beta: f64,
    /// Distance k from P to the leg's last joint, along the common direction.
    pub k: f64,
    /// Pitch p of the helical leg, metres per radian; `None` for the other legs.
    pub pitch: Option<f64>,
    /// Limits of the leg's joints.
    pub limits: LegLimits,
}

/// The geometric parameters of the manipulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TranslationalHelical {
    /// The mechanism's name.
    pub name: String,
    /// The pose in which the mechanism is assembled.
    pub home: Home,
    /// The legs; there must be [`LEGS`], exactly one with a pitch.
    pub legs: Vec<TranslationalLeg>,
}

impl TranslationalHelical {
    /// Assembles the mechanism at home.
    ///
    /// # Errors
    /// [`AssemblyError`] lists every parameter out of its range, every leg whose direction `α + β`
    /// differs from the first leg's, and every joint that is outside its limits at home.
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
            differences: Vec::new(),
            task: TaskHints {
                axis: Some(-in_plane(unit(direction)).into_inner()),
                home: vec![("x".into(), x), ("y".into(), y), ("phi".into(), phi)],
                ..TaskHints::default()
            },
            bodies: BodyMasses::default(),
            shapes: Shapes::default(),
            units: Default::default(),
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

        // Upper section, about and along -k̂: the imaginary slider along k̂ compensates the advance
        // of the last joint.
        let pitch = self.pitch.unwrap_or(0.0);
        let [imaginary, phi] = CylindricalChain::new([
            CoaxialJoint { rotation: 0.0, advance: -1.0 },
            CoaxialJoint { rotation: 1.0, advance: pitch },
        ])?
        .inverse(&CylindricalDisplacement { angle: home.phi, advance: 0.0 });
        // A revolute joint has home's φ too, including full revolutions, unless its limits choose
        // others.
        let phi = match (self.pitch, self.limits.phi.range) {
            (None, None) => JointDisplacement::Value(home.phi),
            _ => phi,
        };

        // Lower section: the sliders bring C from the origin to its position at home.
        let c = Complex::new(home.x, home.y) + k_hat * (self.k + imaginary.value());
        let [s, r] = TranslationalChain::new(slides)?.inverse(c);

        let joint = |symbol: &str, kind, axis, limits| {
            Joint::new(format!("{symbol}{number}"), kind, axis, Point3::origin()).limited(limits)
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
        // A direction that is NaN does not count as different: it has been reported already.
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
