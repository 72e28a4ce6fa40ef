//! A 5-DoF manipulator of two planar subspaces, 3-PRR(RR) + RR(RRR), designed for this project.
//!
//! A vertical plane moves in the base's xy plane, and the platform moves in the vertical one: with
//! `e(t) = (cos t, sin t)`, `n(t) = e(t + π/2)`, `O = (x, y)` and all heights over the base, the
//! vertical plane contains O and the direction `n(θ)`, and its points are `(u, z)`, along `n(θ)`
//! from O and up. The platform's point is `(0, w)` in it, and φ turns the platform from `n(θ)`
//! upward. Three slider legs carry it on rods, one arm on a folding support. Slider leg i is
//!
//! ```text
//! A = h e(α) + S n(α)      S{i}      prismatic along n(α), actuated
//! C = A + a1 e(α+π/2+φ1)   phi1{i}   revolute at A, along +z
//!   = O + c e(θ) + σ n(θ)  phi2{i}   revolute at C, along +z;  θ = α + π/2 + φ1 + φ2
//! K = (σ, g) + l e(ρ)      rod{i}    revolute at (σ, g), along e(θ): ρ
//!   = (0, w) + platform, turned by φ
//!                          hinge{i}  revolute at K, along e(θ);  φ = ρ + hinge
//! ```
//!
//! and the arm, leg 4,
//!
//! ```text
//! E = D + b1 e(φ14)        phi14     revolute at D, along +z, actuated
//!   = O + c e(θ) + σ n(θ)  phi24     revolute at E, along +z, actuated;  θ = φ14 + φ24
//! K = (σ + f, g) + d1 e(fold1) + d2 e(fold1 + fold2)
//!   = (0, w) + platform, turned by φ
//!                          fold1 fold2 hinge4  revolutes, along e(θ);  φ = fold1 + fold2 + hinge4
//! ```
//!
//! The imaginary joint of slider leg i is `sigma{i}`, a slider along `n(θ)`. At home `θ = 0`.

mod file;

pub(in crate::mechanism) use file::read;

use super::assembly::{AssemblyError, Problems, all_legs, carried, out_of_reach};
use super::slider::{SliderChain, onto, pivot};
use crate::chain::Branch;
use crate::chain::planar::{PlanarChain, PlanarJoint};
use crate::group::PlanarDisplacement;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::{ImaginaryLabel, Leg};
use crate::mechanism::{Mechanism, TaskHints};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_2;

/// How many slider legs there are.
pub const SLIDER_LEGS: usize = 3;

/// The pose in which the mechanism is assembled: metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    /// O along the base's x.
    pub x: f64,
    /// O along the base's y.
    pub y: f64,
    /// Height of the platform's point.
    pub w: f64,
    /// φ.
    pub phi: f64,
}

/// Limits of a slider leg's joints, lowest and highest value; metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliderLimits {
    /// S.
    pub s: Option<[f64; 2]>,
    /// φ1.
    pub phi1: Option<[f64; 2]>,
    /// φ2.
    pub phi2: Option<[f64; 2]>,
    /// ρ.
    pub rod: Option<[f64; 2]>,
    /// The rod's joint at the platform.
    pub hinge: Option<[f64; 2]>,
}

/// A PRR(RR) leg: metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SliderLeg {
    /// Name, unique in the mechanism.
    pub name: String,
    /// α: the slider runs along `n(α)`.
    pub alpha: f64,
    /// h: distance of the slider's line from the base's origin.
    pub h: f64,
    /// Link that the slider carries.
    pub a1: f64,
    /// c: distance of C from the vertical plane, along `e(θ)`.
    pub c: f64,
    /// g: height of the rod's lower end.
    pub g: f64,
    /// l: the rod.
    pub l: f64,
    /// K in the platform: along `n(θ)` and up from the platform's point, where `φ = 0`.
    pub platform: [f64; 2],
    /// `+`: the rod stands on the side of larger u.
    pub upper: Branch,
    /// `+`: S with plus its square root.
    pub slider: Branch,
    /// Limits of its joints.
    pub limits: SliderLimits,
}

/// Limits of the arm's joints, lowest and highest value; radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmLimits {
    /// φ14.
    pub phi1: Option<[f64; 2]>,
    /// φ24.
    pub phi2: Option<[f64; 2]>,
    /// The support's joint at the arm.
    pub fold1: Option<[f64; 2]>,
    /// The support's middle joint.
    pub fold2: Option<[f64; 2]>,
    /// The support's joint at the platform.
    pub hinge: Option<[f64; 2]>,
}

/// The RR(RRR) leg: metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmLeg {
    /// Name, unique in the mechanism.
    pub name: String,
    /// D, where it stands in the plane.
    pub base: [f64; 2],
    /// Link from D.
    pub b1: f64,
    /// c: distance of E from the vertical plane, along `e(θ)`.
    pub c: f64,
    /// f: from E to the support, along `n(θ)`.
    pub f: f64,
    /// g: height of the support's lower end.
    pub g: f64,
    /// Lower link of the support.
    pub d1: f64,
    /// Upper link of the support.
    pub d2: f64,
    /// K in the platform, as for the slider legs.
    pub platform: [f64; 2],
    /// `+`: E stands on the side of larger u, seen from D.
    pub lower: Branch,
    /// `+`: `sin fold2 > 0`.
    pub fold: Branch,
    /// Limits of its joints.
    pub limits: ArmLimits,
}

/// Geometric parameters of the manipulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanarPlanar {
    /// Name of the mechanism.
    pub name: String,
    /// Where it is assembled.
    pub home: Home,
    /// The slider legs, [`SLIDER_LEGS`] of them.
    pub slider_legs: Vec<SliderLeg>,
    /// The arm.
    pub arm_leg: ArmLeg,
}

impl PlanarPlanar {
    /// The mechanism, assembled at home.
    ///
    /// # Errors
    /// Every parameter out of its range, every leg that does not reach home, every joint that is
    /// outside its limits there.
    pub fn assemble(&self) -> Result<Mechanism, AssemblyError> {
        let Home { x, y, w, phi } = self.home;
        let mut wrong = Problems::default();
        wrong.finite(&[("x", x), ("y", y), ("w", w), ("phi", phi)]);
        wrong.leg_count("slider_leg", self.slider_legs.len(), SLIDER_LEGS);
        let sliders = self.slider_legs.iter().enumerate();
        let legs = sliders
            .map(|(i, leg)| (leg.name.as_str(), leg.assemble(&self.home, i + 1)))
            .chain([(self.arm_leg.name.as_str(), self.arm_leg.assemble(&self.home))]);
        Ok(Mechanism {
            name: self.name.clone(),
            legs: all_legs(wrong, legs)?,
            platform: Point3::new(x, y, w),
            task: TaskHints {
                axis: Some(Vector3::y()),
                home: [("x", x), ("y", y), ("theta", 0.0), ("w", w), ("phi", phi)]
                    .map(|(name, value)| (name.to_owned(), value))
                    .into(),
                ..TaskHints::default()
            },
        })
    }

    /// The working mode of home, `++ ++ ++ ++` for instance.
    pub fn mode(&self) -> String {
        let sign = |branch| if branch == Branch::Plus { '+' } else { '-' };
        let mut mode = String::new();
        for leg in &self.slider_legs {
            mode.extend([sign(leg.upper), sign(leg.slider), ' ']);
        }
        mode.extend([sign(self.arm_leg.lower), sign(self.arm_leg.fold)]);
        mode
    }
}

impl Home {
    fn is_finite(&self) -> bool {
        [self.x, self.y, self.w, self.phi].iter().all(|v| v.is_finite())
    }

    /// O.
    fn origin(&self) -> Complex<f64> {
        Complex::new(self.x, self.y)
    }

    /// What brings the platform here in the vertical plane from where it is level and has K at `k`.
    fn platform_from(&self, k: Complex<f64>, [p, q]: [f64; 2]) -> PlanarDisplacement {
        onto(k - Complex::new(p, q), Complex::new(0.0, self.w), unit(self.phi))
    }
}

impl SliderLeg {
    fn assemble(&self, home: &Home, number: usize) -> Result<Leg, Problems> {
        self.check()?;
        if !home.is_finite() {
            return Err(Problems::default());
        }
        // Upper section, in the vertical plane: the imaginary slider and the rod, laid out level.
        let (foot, k) = (Complex::new(0.0, self.g), Complex::new(self.l, self.g));
        let [sigma, rod, hinge] = PlanarChain::new([along(1.0.into()), pivot(foot), pivot(k)])?
            .inverse(&home.platform_from(k, self.platform), self.upper)
            .map_err(out_of_reach("rods"))?;

        // Lower section, laid out with e(θ) along the slider.
        let chain = SliderChain::new(self.alpha, self.h, self.a1);
        let place = home.origin() + Complex::new(self.c, sigma.value());
        let lower = chain.reach(place, 1.0.into(), self.slider)?;

        let name = |symbol: &str| format!("{symbol}{number}");
        let limits = &self.limits;
        // e(θ) and n(θ) as laid out.
        let (level, upright) = (direction(chain.along), chain.along * unit(FRAC_PI_2));
        let above = [
            (revolute(name("rod"), level, at(chain.c, self.g), limits.rod), rod),
            (
                revolute(
                    name("hinge"),
                    level,
                    at(chain.c + upright * self.l, self.g),
                    limits.hinge,
                ),
                hinge,
            ),
        ];
        let below = chain.joints(number, [limits.s, limits.phi1, limits.phi2]);
        let joints = carried(below.into_iter().zip(lower).chain(above))?;
        let imaginary =
            ImaginaryLabel { name: name("sigma"), home: sigma.value(), positive: Vector3::y() };
        Ok(Leg { name: self.name.clone(), joints, imaginary: Some(imaginary) })
    }

    fn check(&self) -> Result<(), Problems> {
        let mut wrong = Problems::default();
        wrong.finite(&[("alpha", self.alpha), ("c", self.c), ("g", self.g)]);
        wrong.finite(&self.platform.map(|coordinate| ("platform", coordinate)));
        wrong.not_negative(&[("h", self.h)]);
        wrong.positive(&[("a1", self.a1), ("l", self.l)]);
        wrong.none()
    }
}

impl ArmLeg {
    fn assemble(&self, home: &Home) -> Result<Leg, Problems> {
        self.check()?;
        if !home.is_finite() {
            return Err(Problems::default());
        }
        // Lower section: laid out along x, with E in the vertical plane's u = 0; the imaginary
        // slider then moves O from there, by -σ.
        let d = Complex::new(self.base[0], self.base[1]);
        let e = d + self.b1;
        let [phi1, phi2, slide] = PlanarChain::new([pivot(d), pivot(e), along(Complex::i())])?
            .inverse(&onto(e - self.c, home.origin(), 1.0.into()), self.lower)
            .map_err(out_of_reach("links"))?;

        // Upper section, in the vertical plane: the support, stretched level from E.
        let foot = Complex::new(self.f - slide.value(), self.g);
        let (knee, k) = (foot + self.d1, foot + self.d1 + self.d2);
        let [fold1, fold2, hinge] = PlanarChain::new([foot, knee, k].map(pivot))?
            .inverse(&home.platform_from(k, self.platform), self.fold)
            .map_err(out_of_reach("links"))?;

        let limits = &self.limits;
        let (up, level) = (Vector3::z_axis(), Vector3::x_axis());
        let upright = |u: f64| at(e + Complex::i() * (self.f + u), self.g);
        let driven = |name: &str, point, limits| {
            revolute(name.to_owned(), up, at(point, 0.0), limits).actuated()
        };
        let hinged = |name: &str, u, limits| revolute(name.to_owned(), level, upright(u), limits);
        let joints = carried([
            (driven("phi14", d, limits.phi1), phi1),
            (driven("phi24", e, limits.phi2), phi2),
            (hinged("fold1", 0.0, limits.fold1), fold1),
            (hinged("fold2", self.d1, limits.fold2), fold2),
            (hinged("hinge4", self.d1 + self.d2, limits.hinge), hinge),
        ])?;
        Ok(Leg::new(self.name.clone(), joints))
    }

    fn check(&self) -> Result<(), Problems> {
        let mut wrong = Problems::default();
        wrong.finite(&[("c", self.c), ("f", self.f), ("g", self.g)]);
        wrong.finite(&self.base.map(|coordinate| ("base", coordinate)));
        wrong.finite(&self.platform.map(|coordinate| ("platform", coordinate)));
        wrong.positive(&[("b1", self.b1), ("d1", self.d1), ("d2", self.d2)]);
        wrong.none()
    }
}

fn along(direction: Complex<f64>) -> PlanarJoint {
    PlanarJoint::Prismatic { along: direction }
}

fn revolute(
    name: String,
    axis: Unit<Vector3<f64>>,
    point: Point3<f64>,
    limits: Option<[f64; 2]>,
) -> Joint {
    Joint::new(name, JointKind::Revolute, axis, point).within(limits)
}

fn at(z: Complex<f64>, height: f64) -> Point3<f64> {
    Point3::new(z.re, z.im, height)
}

fn direction(z: Complex<f64>) -> Unit<Vector3<f64>> {
    Unit::new_unchecked(at(z, 0.0).coords)
}

#[cfg(test)]
mod tests;
