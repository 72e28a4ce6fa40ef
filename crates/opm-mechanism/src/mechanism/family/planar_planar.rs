//! A 5-DoF manipulator of two planar subspaces, 3-PRR(RR) + RR(RRR), designed for this project.
//!
//! A vertical plane moves over the base's xy plane, and the platform moves in the vertical plane.
//! With `e(t) = (cos t, sin t)`, `n(t) = e(t + π/2)` and `O = (x, y)`, the vertical plane contains
//! O and the direction `n(θ)`. Its points are `(u, z)`: u along `n(θ)` from O, z the height over
//! the base. The platform's reference point is `(0, w)` in the vertical plane, and φ rotates the
//! platform from `n(θ)` upward. Three slider legs hold the platform with rods, and one arm holds it
//! with a folding support. Slider leg i is
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

#[cfg(feature = "files")]
mod file;
mod parameters;

#[cfg(feature = "files")]
pub(in crate::mechanism) use file::FORM;

use super::assembly::{AssemblyError, Problems, all_legs, carried, out_of_reach};
use super::slider::{SliderChain, onto, pivot};
use crate::chain::Branch;
use crate::chain::planar::{PlanarChain, PlanarJoint};
use crate::group::PlanarDisplacement;
use crate::mechanism::joint::{Joint, JointKind, JointLimits};
use crate::mechanism::leg::{ImaginaryLabel, Leg};
use crate::mechanism::{BodyMasses, Mechanism, Shapes, TaskHints};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_2;

/// The number of slider legs.
pub const SLIDER_LEGS: usize = 3;

/// The pose in which the mechanism is assembled: metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    /// O along the base's x, metres.
    pub x: f64,
    /// O along the base's y, metres.
    pub y: f64,
    /// Height of the platform's reference point, metres.
    pub w: f64,
    /// The platform's angle φ in the vertical plane, radians.
    pub phi: f64,
}

/// Limits of a slider leg's joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliderLimits {
    /// Limits of the slider S.
    pub s: JointLimits,
    /// Limits of φ1.
    pub phi1: JointLimits,
    /// Limits of φ2.
    pub phi2: JointLimits,
    /// Limits of the rod's angle ρ.
    pub rod: JointLimits,
    /// Limits of the rod's joint at the platform.
    pub hinge: JointLimits,
}

/// The parameters of a PRR(RR) leg, metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SliderLeg {
    /// The leg's name, unique in the mechanism.
    pub name: String,
    /// Angle α: the slider moves along `n(α)`.
    pub alpha: f64,
    /// Distance h of the slider's line from the base's origin.
    pub h: f64,
    /// Length of the link that the slider carries.
    pub a1: f64,
    /// Distance c of C from the vertical plane, along `e(θ)`.
    pub c: f64,
    /// Height g of the rod's lower end.
    pub g: f64,
    /// Length l of the rod.
    pub l: f64,
    /// The point K in the platform for `φ = 0`: its offset from the platform's reference point,
    /// along `n(θ)` and up.
    pub platform: [f64; 2],
    /// Branch of the upper section; `+`: the rod's lower end is on the side of larger u.
    pub upper: Branch,
    /// Branch of the lower section; `+`: S has the plus sign of its square root.
    pub slider: Branch,
    /// Limits of the leg's joints.
    pub limits: SliderLimits,
}

/// Limits of the arm's joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmLimits {
    /// Limits of φ14.
    pub phi1: JointLimits,
    /// Limits of φ24.
    pub phi2: JointLimits,
    /// Limits of the support's joint at the arm.
    pub fold1: JointLimits,
    /// Limits of the support's middle joint.
    pub fold2: JointLimits,
    /// Limits of the support's joint at the platform.
    pub hinge: JointLimits,
}

/// The parameters of the RR(RRR) leg, metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmLeg {
    /// The leg's name, unique in the mechanism.
    pub name: String,
    /// The point D where the arm is mounted, in the base's xy plane.
    pub base: [f64; 2],
    /// Length of the arm's link from D.
    pub b1: f64,
    /// Distance c of E from the vertical plane, along `e(θ)`.
    pub c: f64,
    /// Distance f from E to the support, along `n(θ)`.
    pub f: f64,
    /// Height g of the support's lower end.
    pub g: f64,
    /// Length of the support's lower link.
    pub d1: f64,
    /// Length of the support's upper link.
    pub d2: f64,
    /// The point K in the platform, as for the slider legs.
    pub platform: [f64; 2],
    /// Branch of the lower section; `+`: E is on the side of larger u, seen from D.
    pub lower: Branch,
    /// Branch of the upper section; `+`: `sin fold2 > 0`.
    pub fold: Branch,
    /// Limits of the arm's joints.
    pub limits: ArmLimits,
}

/// The geometric parameters of the manipulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanarPlanar {
    /// The mechanism's name.
    pub name: String,
    /// The pose in which the mechanism is assembled.
    pub home: Home,
    /// The slider legs; there must be [`SLIDER_LEGS`].
    pub slider_legs: Vec<SliderLeg>,
    /// The arm: leg 4.
    pub arm_leg: ArmLeg,
}

impl PlanarPlanar {
    /// Assembles the mechanism at home.
    ///
    /// # Errors
    /// [`AssemblyError`] lists every parameter out of its range, every leg that does not reach
    /// home, and every joint that is outside its limits there.
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
            differences: Vec::new(),
            task: TaskHints {
                axis: Some(Vector3::y()),
                home: [("x", x), ("y", y), ("theta", 0.0), ("w", w), ("phi", phi)]
                    .map(|(name, value)| (name.to_owned(), value))
                    .into(),
                ..TaskHints::default()
            },
            bodies: BodyMasses::default(),
            shapes: Shapes::default(),
            units: Default::default(),
        })
    }

    /// The working mode of home, such as `++ ++ ++ ++`.
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

    /// The point O.
    fn origin(&self) -> Complex<f64> {
        Complex::new(self.x, self.y)
    }

    /// The displacement, in the vertical plane, of the platform at home from a layout where it is
    /// level and has its point K at `k`.
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
        // Upper section, in the vertical plane: the imaginary slider and the rod, with the rod laid
        // out along u.
        let (foot, k) = (Complex::new(0.0, self.g), Complex::new(self.l, self.g));
        let [sigma, rod, hinge] = PlanarChain::new([along(1.0.into()), pivot(foot), pivot(k)])?
            .inverse(&home.platform_from(k, self.platform), self.upper)
            .map_err(out_of_reach("rods"))?;

        // Lower section, laid out with e(θ) along the slider.
        let chain = SliderChain::new(self.alpha, self.h, self.a1);
        let c = home.origin() + Complex::new(self.c, sigma.value());
        let lower = chain.reach(c, 1.0.into(), self.slider)?;

        let name = |symbol: &str| format!("{symbol}{number}");
        let limits = &self.limits;
        // The directions e(θ) and n(θ) in the layout.
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
        // Lower section: laid out along x, with E at u = 0 in the vertical plane. The imaginary
        // slider then moves O from there by -σ.
        let d = Complex::new(self.base[0], self.base[1]);
        let e = d + self.b1;
        let [phi1, phi2, slide] = PlanarChain::new([pivot(d), pivot(e), along(Complex::i())])?
            .inverse(&onto(e - self.c, home.origin(), 1.0.into()), self.lower)
            .map_err(out_of_reach("links"))?;

        // Upper section, in the vertical plane: the support, laid out along u from E.
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
    limits: JointLimits,
) -> Joint {
    Joint::new(name, JointKind::Revolute, axis, point).limited(limits)
}

fn at(z: Complex<f64>, height: f64) -> Point3<f64> {
    Point3::new(z.re, z.im, height)
}

fn direction(z: Complex<f64>) -> Unit<Vector3<f64>> {
    Unit::new_unchecked(at(z, 0.0).coords)
}

#[cfg(test)]
mod tests;
