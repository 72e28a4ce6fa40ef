//! The paper's closed forms, corrected: the oracle for the generic solver, and the plain scalar
//! code with which its speed is compared.
//!
//! The equations are those of M. Ö. Selvi, *Kinematic analysis of overconstrained manipulators with
//! partial subspaces using decomposition method*, Robotica. docs/errata.md lists the corrections.

mod random;
mod velocity;

use std::f64::consts::FRAC_PI_2;

/// A PRR(RR) leg of the plano-spherical manipulator (section 3.1); metres and radians.
#[derive(Clone, Copy, Debug)]
pub struct SliderLeg {
    /// Direction of the leg in the plane; the slider moves perpendicular to it.
    pub alpha: f64,
    /// Distance of the slider's line from the origin.
    pub h: f64,
    /// Length of the link between the slider and the second link.
    pub a1: f64,
    /// Length of the link at the platform.
    pub a2: f64,
    /// Arc of the first spherical link.
    pub arc1: f64,
    /// Arc of the second spherical link.
    pub arc2: f64,
    /// Azimuth of the platform axis.
    pub eta: f64,
    /// Polar angle of the platform axis.
    pub beta: f64,
}

/// The 5-DoF plano-spherical manipulator (section 3.1); metres and radians.
#[derive(Clone, Copy, Debug)]
pub struct PlanoSpherical {
    /// The three PRR(RR) legs.
    pub legs: [SliderLeg; 3],
    /// Base point of the RRS leg.
    pub d: [f64; 2],
    /// Lengths of the two links of the RRS leg.
    pub b: [f64; 2],
}

/// Signs of the working mode; `true` is plus.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// For each slider leg: the sign of the spherical choice, and that of the slider's root.
    pub legs: [[bool; 2]; 3],
    /// The sign of `sin phi24`.
    pub arm: bool,
}

/// A solution of the inverse kinematics; metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// The imaginary joints `theta_1i`.
    pub theta: [f64; 3],
    /// The sliders `S_i`.
    pub slider: [f64; 3],
    /// The angles `phi_14` and `phi_24`.
    pub arm: [f64; 2],
}

impl SliderLeg {
    /// Eq. 2: `w = rho Rz(eta) Ry(beta) s`.
    #[inline]
    pub fn platform_axis(&self, rho: &[[f64; 3]; 3]) -> [f64; 3] {
        let (sb, cb) = self.beta.sin_cos();
        let (se, ce) = self.eta.sin_cos();
        rho.map(|r| r[0] * ce * sb + r[1] * se * sb + r[2] * cb)
    }

    /// Below Eq. 5: `v = Rz(theta) Rx(arc1) u`.
    pub fn proximal_axis(&self, theta: f64) -> [f64; 3] {
        let (st, ct) = theta.sin_cos();
        let (s1, c1) = self.arc1.sin_cos();
        [s1 * st, -s1 * ct, c1]
    }
}

impl PlanoSpherical {
    /// The printed parameters, and chosen ones where the paper prints none.
    pub fn printed() -> Self {
        let leg = |i: f64| SliderLeg {
            alpha: (30.0 + 120.0 * i).to_radians(),
            h: 0.12,
            a1: 0.2,
            a2: 0.06,
            arc1: 75_f64.to_radians(),
            arc2: 75_f64.to_radians(),
            eta: (120.0 * i).to_radians(),
            beta: 60_f64.to_radians(),
        };
        Self { legs: [leg(0.0), leg(1.0), leg(2.0)], d: [0.0, 0.075], b: [0.1, 0.1] }
    }

    /// Solves equations 2-3 and 10-16 for the pose `x, y, zeta, xi, psi`; `None` if it is out of
    /// reach.
    pub fn inverse(&self, pose: &[f64; 5], signs: &Signs) -> Option<Joints> {
        let [x, y, zeta, xi, psi] = *pose;
        let rho = rotation(zeta, xi, psi);
        let mut theta = [0.0; 3];
        let mut slider = [0.0; 3];
        for (i, leg) in self.legs.iter().enumerate() {
            let w = leg.platform_axis(&rho);
            // Eq. 3: v . w = cos(arc2), v = Rz(theta) Rx(arc1) u.
            let (s1, c1) = leg.arc1.sin_cos();
            let k = (leg.arc2.cos() - c1 * w[2]) / (s1 * (w[0] * w[0] + w[1] * w[1]).sqrt());
            if k.is_nan() || k.abs() > 1.0 {
                return None;
            }
            let asin = k.asin();
            let t = w[1].atan2(w[0])
                + if signs.legs[i][0] { asin } else { std::f64::consts::PI - asin };
            theta[i] = t;
            slider[i] = slider_root(leg, [x, y], t, signs.legs[i][1])?;
        }
        let arm = self.arm([x, y], signs.arm)?;
        Some(Joints { theta, slider, arm })
    }

    /// Solves equations 10-12: the two-link arm from D to P.
    pub fn arm(&self, p: [f64; 2], plus: bool) -> Option<[f64; 2]> {
        let [b1, b2] = self.b;
        let (dx, dy) = (p[0] - self.d[0], p[1] - self.d[1]);
        let square = dx * dx + dy * dy;
        let cosine = (square - b1 * b1 - b2 * b2) / (2.0 * b1 * b2);
        if cosine.is_nan() || cosine.abs() > 1.0 {
            return None;
        }
        let phi24 = if plus { cosine.acos() } else { -cosine.acos() };
        let inner = (b1 * b1 - b2 * b2 + square) / (2.0 * b1 * square.sqrt());
        let inner = inner.clamp(-1.0, 1.0).acos();
        let phi14 = dy.atan2(dx) + if plus { -inner } else { inner };
        Some([phi14, phi24])
    }
}

/// Eq. 16, with the whole numerator divided by two: `S = (-b ± sqrt(b² - 4c)) / 2`.
pub fn slider_root(leg: &SliderLeg, p: [f64; 2], theta: f64, plus: bool) -> Option<f64> {
    let (b, c) = slider_quadratic(leg, p, theta);
    let discriminant = b * b - 4.0 * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    Some((-b + if plus { root } else { -root }) / 2.0)
}

/// The coefficients of the quadratic of Eq. 16, as printed.
pub fn slider_quadratic(leg: &SliderLeg, [x, y]: [f64; 2], theta: f64) -> (f64, f64) {
    let SliderLeg { alpha, h, a1, a2, .. } = *leg;
    let (sa, ca) = alpha.sin_cos();
    let (sat, cat) = (alpha - theta).sin_cos();
    let (st, ct) = theta.sin_cos();
    let b = -2.0 * y * ca + 2.0 * (x * sa + a2 * sat);
    let c = -a1 * a1 + a2 * a2 + h * h + x * x + y * y
        - 2.0 * h * x * ca
        - 2.0 * a2 * h * cat
        - 2.0 * h * y * sa
        + 2.0 * a2 * (x * ct + y * st);
    (b, c)
}

/// The rows of `Rz(zeta) Ry(xi) Rz(psi)`.
pub fn rotation(zeta: f64, xi: f64, psi: f64) -> [[f64; 3]; 3] {
    let ((sz, cz), (sx, cx), (sp, cp)) = (zeta.sin_cos(), xi.sin_cos(), psi.sin_cos());
    [
        [cz * cx * cp - sz * sp, -cz * cx * sp - sz * cp, cz * sx],
        [sz * cx * cp + cz * sp, -sz * cx * sp + cz * cp, sz * sx],
        [-sx * cp, sx * sp, cx],
    ]
}

/// A leg of the translational-helical manipulator (section 3.2); metres and radians.
#[derive(Clone, Copy, Debug)]
pub struct TranslationalLeg {
    /// Direction of the leg; the slider moves perpendicular to it.
    pub alpha: f64,
    /// Angle from the leg's direction to the common axis.
    pub beta: f64,
    /// Offset along the common axis.
    pub k: f64,
    /// Pitch in metres per radian; zero for a PPR leg.
    pub pitch: f64,
}

impl TranslationalLeg {
    /// The printed parameters.
    pub fn printed() -> [Self; 3] {
        let leg = |alpha: f64, beta: f64, k, pitch| Self {
            alpha: alpha.to_radians(),
            beta: beta.to_radians(),
            k,
            pitch,
        };
        [
            leg(210.0, 45.0, 0.010, 0.020),
            leg(330.0, 285.0, 0.015, 0.0),
            leg(90.0, 165.0, 0.025, 0.0),
        ]
    }

    /// The slider, `S_i = n(alpha) . P + sin(beta) (k + S)` with `S = p phi` (Eqs. 24, 27, 28
    /// without the printed divisor).
    pub fn slider(&self, [x, y]: [f64; 2], phi: f64) -> f64 {
        let (sa, ca) = self.alpha.sin_cos();
        y * ca - x * sa + self.beta.sin() * (self.k + self.pitch * phi)
    }
}

/// The unit vector `e(t)` of the angle t.
pub fn e(t: f64) -> [f64; 2] {
    [t.cos(), t.sin()]
}

/// The unit vector `n(t) = e(t + pi/2)`.
pub fn n(t: f64) -> [f64; 2] {
    e(t + FRAC_PI_2)
}

/// The paper's first manipulator with fewer joints in its arm, as mechanism files: a universal joint or one revolute
/// joint in place of the ball, or one planar joint less. As many joints are actuated as it has degrees of freedom.
pub fn fewer_joints() -> [(&'static str, String); 3] {
    let text = opm_core::mechanism::examples::find("plano-spherical-5dof-joints")
        .expect("it is shipped")
        .text;
    let replaced = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let ball = r#"{ name = "s4", type = "spherical", point = [0, 0, 0] },"#;
    // Motors that the platform does not need are left out.
    let passive = |text: &str, joint: &str| {
        let line = text.lines().find(|line| line.contains(joint)).expect("it has that joint");
        replaced(text, line, &line.replace(", actuated = true", ""))
    };
    let two_sliders = passive(text, "\"S3\"");
    let one_slider = passive(&two_sliders, "\"S2\"");
    let universal = r#"{ name = "u4", type = "universal", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [0, 0, 0] },"#;
    let revolute = r#"{ name = "r4", type = "revolute", axis = [1, 0, 0], point = [0, 0, 0] },"#;
    let shorter: Vec<&str> = text.lines().filter(|line| !line.contains("\"phi24\"")).collect();
    [
        ("a universal joint", replaced(&two_sliders, ball, universal)),
        ("a revolute joint", replaced(&one_slider, ball, revolute)),
        ("one planar joint less", shorter.join("\n")),
    ]
}
