//! The 5-DoF plano-spherical manipulator, 3-PRR(RR) + RRS (section 3.1 of the paper).
//!
//! The platform's point P moves in the base's xy plane, and the platform rotates freely about P: `P
//! = (x, y, 0)`, `R = Rz(ζ) Ry(ξ) Rz(ψ)`. Three slider legs hold the platform with spherical arcs,
//! and one arm carries P. With `e(t) = (cos t, sin t)` and `n(t) = e(t + π/2)`, slider leg i is
//! ```text
//! A = h e(α) + S n(α)      S{i}      prismatic along n(α), actuated
//! C = A + a1 e(α+π/2+φ1)   phi1{i}   revolute at A, along +z
//!   = P + a2 e(θ1)         phi2{i}   revolute at C, along +z;  θ1 = α + π/2 + φ1 + φ2
//! v = Rz(θ1) Rx(α1) z      theta2{i} revolute through P
//! w = R Rz(η) Ry(β) z      theta3{i} revolute through P, fixed in the platform
//! ```
//!
//! with `R Rz(η) Ry(β) = Rz(θ1) Rx(α1) Rz(θ2) Rx(α2) Rz(θ3)` (Eqs. 2-3, 13-16). The arm, leg 4, is
//! `P = D + b1 e(φ14) + b2 e(φ14 + φ24)` (Eqs. 10-12). Its joints `phi14` and `phi24` are both
//! actuated; the spherical joint `s4` at P has a rotation vector that is zero at home. The
//! imaginary joint of slider leg i is `theta1{i}`, a revolute about +z through P.

#[cfg(feature = "files")]
mod file;
mod parameters;

#[cfg(feature = "files")]
pub(in crate::mechanism) use file::FORM;

use super::assembly::{AssemblyError, Problems, all_legs, carried, out_of_reach};
use super::slider::{SliderChain, onto, pivot};
use crate::chain::Branch;
use crate::chain::planar::PlanarChain;
use crate::chain::spherical::SphericalChain;
use crate::group::JointDisplacement;
use crate::mechanism::joint::{Joint, JointKind, JointLimits};
use crate::mechanism::leg::{ImaginaryLabel, Leg};
use crate::mechanism::{BodyMasses, Mechanism, Shapes, TaskHints};
use nalgebra::{Complex, Point3, Rotation3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The number of slider legs.
pub const SLIDER_LEGS: usize = 3;

/// The pose in which the mechanism is assembled: metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    /// P along the base's x, metres.
    pub x: f64,
    /// P along the base's y, metres.
    pub y: f64,
    /// Euler angle ζ, about z, radians.
    pub zeta: f64,
    /// Euler angle ξ, about y as rotated by ζ, radians.
    pub xi: f64,
    /// Euler angle ψ, about z as rotated by ζ and ξ, radians.
    pub psi: f64,
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
    /// Limits of θ2.
    pub theta2: JointLimits,
    /// Limits of θ3.
    pub theta3: JointLimits,
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
    /// Length of the planar link that the slider carries.
    pub a1: f64,
    /// Length of the planar link at P.
    pub a2: f64,
    /// Arc α1 from z to v.
    pub alpha1: f64,
    /// Arc α2 from v to w.
    pub alpha2: f64,
    /// Angle η of w about the platform's z.
    pub eta: f64,
    /// Angle β between w and the platform's z.
    pub beta: f64,
    /// Branch of the upper section; `+`: `θ1 = atan2(wy, wx) + asin(k)`; `-`: the other solution of
    /// Eq. 3.
    pub upper: Branch,
    /// Branch of the lower section; `+`: S has the plus sign of the square root in Eq. 16.
    pub slider: Branch,
    /// Limits of the leg's joints.
    pub limits: SliderLimits,
}

/// The parameters of the RRS leg, metres and radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmLeg {
    /// The leg's name, unique in the mechanism.
    pub name: String,
    /// The point D where the arm is mounted, in the base's xy plane.
    pub base: [f64; 2],
    /// Length of the link from D to the elbow.
    pub b1: f64,
    /// Length of the link from the elbow to P.
    pub b2: f64,
    /// Branch of the arm; `+`: `sin φ24 > 0`.
    pub elbow: Branch,
    /// Limits of φ14.
    pub phi1: JointLimits,
    /// Limits of φ24.
    pub phi2: JointLimits,
}

/// The geometric parameters of the manipulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanoSpherical {
    /// The mechanism's name.
    pub name: String,
    /// The pose in which the mechanism is assembled.
    pub home: Home,
    /// The slider legs; there must be [`SLIDER_LEGS`].
    pub slider_legs: Vec<SliderLeg>,
    /// The arm: leg 4.
    pub arm_leg: ArmLeg,
}

impl PlanoSpherical {
    /// Assembles the mechanism at home.
    ///
    /// # Errors
    /// [`AssemblyError`] lists every parameter out of its range, every leg that does not reach
    /// home, and every joint that is outside its limits there.
    pub fn assemble(&self) -> Result<Mechanism, AssemblyError> {
        let Home { x, y, zeta, xi, psi } = self.home;
        let mut wrong = Problems::default();
        wrong.finite(&[("x", x), ("y", y), ("zeta", zeta), ("xi", xi), ("psi", psi)]);
        wrong.leg_count("slider_leg", self.slider_legs.len(), SLIDER_LEGS);
        let sliders = self.slider_legs.iter().enumerate();
        let legs = sliders
            .map(|(i, leg)| (leg.name.as_str(), leg.assemble(&self.home, i + 1)))
            .chain([(self.arm_leg.name.as_str(), self.arm_leg.assemble(&self.home))]);
        Ok(Mechanism {
            name: self.name.clone(),
            legs: all_legs(wrong, legs)?,
            platform: self.home.point(),
            differences: Vec::new(),
            task: TaskHints {
                axis: Some(Vector3::z()),
                home: [("x", x), ("y", y), ("zeta", zeta), ("xi", xi), ("psi", psi)]
                    .map(|(name, value)| (name.to_owned(), value))
                    .into(),
                ..TaskHints::default()
            },
            bodies: BodyMasses::default(),
            shapes: Shapes::default(),
            units: Default::default(),
        })
    }

    /// The working mode of home, such as `++ ++ ++ +`.
    pub fn mode(&self) -> String {
        let sign = |branch| if branch == Branch::Plus { '+' } else { '-' };
        let mut mode = String::new();
        for leg in &self.slider_legs {
            mode.extend([sign(leg.upper), sign(leg.slider), ' ']);
        }
        mode.push(sign(self.arm_leg.elbow));
        mode
    }
}

impl Home {
    fn point(&self) -> Point3<f64> {
        Point3::new(self.x, self.y, 0.0)
    }

    fn rotation(&self) -> Rotation3<f64> {
        rz(self.zeta) * ry(self.xi) * rz(self.psi)
    }

    fn is_finite(&self) -> bool {
        [self.x, self.y, self.zeta, self.xi, self.psi].iter().all(|v| v.is_finite())
    }
}

impl SliderLeg {
    fn assemble(&self, home: &Home, number: usize) -> Result<Leg, Problems> {
        self.check()?;
        if !home.is_finite() {
            return Err(Problems::default());
        }
        let z = Vector3::z_axis();

        // The layout has every joint at zero: the links a1 and a2 and the direction θ1 are along
        // the slider, and the arcs α1 and α2 add up.
        let chain = SliderChain::new(self.alpha, self.h, self.a1);
        let p = chain.c - chain.along * self.a2;
        let theta1_zero = rz(self.alpha + FRAC_PI_2);
        let v = rx(self.alpha1) * z;
        let w = rx(self.alpha1 + self.alpha2) * z;

        // Upper section: θ1 θ2 θ3 rotate the platform's frame from Rx(α1+α2) to home's.
        let target =
            home.rotation() * rz(self.eta) * ry(self.beta) * rx(-self.alpha1 - self.alpha2);
        let [theta1, theta2, theta3] = SphericalChain::new([z, v, w])?
            .inverse(target.matrix(), self.upper)
            .map_err(out_of_reach("arcs"))?;

        // Lower section: the slider and both revolutes bring P and the direction θ1 to their home
        // values.
        let c = Complex::new(home.x, home.y) + theta1.unit_direction() * self.a2;
        let lower = chain.reach(c, theta1.unit_direction(), self.slider)?;

        let name = |symbol: &str| format!("{symbol}{number}");
        let limits = &self.limits;
        let revolute = |symbol, axis, limits| {
            Joint::new(name(symbol), JointKind::Revolute, axis, in_plane(p)).limited(limits)
        };
        let above = [
            (revolute("theta2", theta1_zero * v, limits.theta2), theta2),
            (revolute("theta3", theta1_zero * w, limits.theta3), theta3),
        ];
        let below = chain.joints(number, [limits.s, limits.phi1, limits.phi2]);
        let joints = carried(below.into_iter().zip(lower).chain(above))?;
        let imaginary = ImaginaryLabel {
            name: name("theta1"),
            home: positive_angle(theta1),
            positive: Vector3::z(),
        };
        Ok(Leg { name: self.name.clone(), joints, imaginary: Some(imaginary) })
    }

    fn check(&self) -> Result<(), Problems> {
        let mut wrong = Problems::default();
        wrong.finite(&[("alpha", self.alpha), ("eta", self.eta), ("beta", self.beta)]);
        wrong.not_negative(&[("h", self.h)]);
        wrong.positive(&[("a1", self.a1), ("a2", self.a2)]);
        wrong.arcs(&[("alpha1", self.alpha1), ("alpha2", self.alpha2)]);
        wrong.none()
    }
}

impl ArmLeg {
    fn assemble(&self, home: &Home) -> Result<Leg, Problems> {
        let mut wrong = Problems::default();
        wrong.finite(&self.base.map(|coordinate| ("base", coordinate)));
        wrong.positive(&[("b1", self.b1), ("b2", self.b2)]);
        wrong.none()?;
        if !home.is_finite() {
            return Err(Problems::default());
        }
        // The layout has every joint at zero: the arm is stretched along x.
        let d = Complex::new(self.base[0], self.base[1]);
        let elbow = d + self.b1;
        let p = elbow + self.b2;
        let [phi1, phi2, _] = PlanarChain::new([d, elbow, p].map(pivot))?
            .inverse(&onto(p, Complex::new(home.x, home.y), 1.0.into()), self.elbow)
            .map_err(out_of_reach("links"))?;

        let revolute = |name: &str, at, limits| {
            Joint::new(name, JointKind::Revolute, Vector3::z_axis(), in_plane(at))
                .actuated()
                .limited(limits)
        };
        let mut joints = carried([
            (revolute("phi14", d, self.phi1), phi1),
            (revolute("phi24", elbow, self.phi2), phi2),
        ])?;
        joints.push(Joint::new("s4", JointKind::Spherical, Vector3::z_axis(), home.point()));
        Ok(Leg::new(self.name.clone(), joints))
    }
}

/// The angle in `[0, 2π)`.
fn positive_angle(angle: JointDisplacement) -> f64 {
    let angle = angle.value().rem_euclid(TAU);
    // Rounding maps a tiny negative angle to 2π itself.
    if angle < TAU { angle } else { 0.0 }
}

fn in_plane(z: Complex<f64>) -> Point3<f64> {
    Point3::new(z.re, z.im, 0.0)
}

fn rx(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::x_axis(), angle)
}

fn ry(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::y_axis(), angle)
}

fn rz(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

#[cfg(test)]
mod tests;
