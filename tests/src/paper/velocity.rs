//! Velocities of the plano-spherical manipulator (Eqs. 4-9, 17-23), corrected; metres, radians and
//! seconds.
//!
//! With `V = P + a2 e(theta) - h e(alpha) - S n(alpha)`, the vector of link a1, a slider leg's
//! closure is `|V| = a1`, and its rates obey
//! `V . Pdot + a2 (V . n(theta)) thetadot = (V . n(alpha)) Sdot`.

use super::{Joints, PlanoSpherical, SliderLeg};
use nalgebra::{Matrix3, Matrix5, Vector3};

impl SliderLeg {
    /// Eq. 19, with its term in `a2 S`: the square of link a1's length for the slider at `s`.
    pub fn link_square(&self, [x, y]: [f64; 2], theta: f64, s: f64) -> f64 {
        let (b, c) = super::slider_quadratic(self, [x, y], theta);
        s * s + b * s + c + self.a1 * self.a1
    }

    /// Eq. 20: the coefficients of the rates of Px, Py and theta on its left side, and of S on its
    /// right.
    pub fn rate_coefficients(&self, [x, y]: [f64; 2], theta: f64, s: f64) -> [f64; 4] {
        let Self { alpha, h, a2, .. } = *self;
        let (sa, ca) = alpha.sin_cos();
        let (st, ct) = theta.sin_cos();
        let (sat, cat) = (alpha - theta).sin_cos();
        [
            -x - ct * a2 + ca * h - sa * s,
            -y - st * a2 + sa * h + ca * s,
            a2 * (-y * ct + x * st + sat * h + cat * s),
            -y * ca + x * sa + sat * a2 + s,
        ]
    }
}

impl PlanoSpherical {
    /// `J_x,s` and `J_q,s` of Eq. 7: `J_x,s omega = J_q,s thetadot`.
    pub fn spherical_jacobians(&self, rho: &[[f64; 3]; 3], theta: &[f64; 3]) -> [Matrix3<f64>; 2] {
        let crosses = [0, 1, 2].map(|i| {
            let v = Vector3::from(self.legs[i].proximal_axis(theta[i]));
            v.cross(&Vector3::from(self.legs[i].platform_axis(rho)))
        });
        let direct = Matrix3::from_rows(&crosses.map(|row| row.transpose()));
        [direct, Matrix3::from_diagonal(&direct.column(2).into_owned())]
    }

    /// `J_x,p` and `J_q,p` of Eq. 23, with the entry (5,4). The first one times the rates of
    /// `theta1..3, Px, Py` equals the second one times the rates of `S1..3, phi14, phi24`.
    pub fn planar_jacobians(&self, p: [f64; 2], joints: &Joints) -> [Matrix5<f64>; 2] {
        let mut direct = Matrix5::zeros();
        let mut inverse = Matrix5::zeros();
        for (i, leg) in self.legs.iter().enumerate() {
            let [x, y, theta, s] = leg.rate_coefficients(p, joints.theta[i], joints.slider[i]);
            direct[(i, i)] = theta;
            direct[(i, 3)] = x;
            direct[(i, 4)] = y;
            inverse[(i, i)] = s;
        }
        direct[(3, 3)] = 1.0;
        direct[(4, 4)] = 1.0;
        let [b1, b2] = self.b;
        let (s1, c1) = joints.arm[0].sin_cos();
        let (s12, c12) = (joints.arm[0] + joints.arm[1]).sin_cos();
        inverse[(3, 3)] = -b1 * s1 - b2 * s12;
        inverse[(3, 4)] = -b2 * s12;
        inverse[(4, 3)] = b1 * c1 + b2 * c12;
        inverse[(4, 4)] = b2 * c12;
        [direct, inverse]
    }
}
