//! The formulas exactly as printed.

use opm_tests::paper::{SliderLeg, TranslationalLeg, slider_quadratic};
use std::f64::consts::FRAC_PI_2;

/// Eq. 16: `S = -b ± sqrt(b² - 4c)`.
pub fn eq_16(leg: &SliderLeg, p: [f64; 2], theta: f64, sign: f64) -> f64 {
    let (b, c) = slider_quadratic(leg, p, theta);
    -b + sign * (b * b - 4.0 * c).sqrt()
}

/// The formula printed below Eq. 12.
pub fn phi14([dx, dy]: [f64; 2], [b1, b2]: [f64; 2], [px, py]: [f64; 2], sign: f64) -> f64 {
    let square = (dx - px).powi(2) + (dy - py).powi(2);
    let cosine = (b1 * b1 + b2 * b2 + square) / (-2.0 * b1 * square.sqrt());
    (dy - py).atan2(dx - px) + sign * cosine.acos()
}

/// The formula printed below `phi14`; it is right if `phi14` is.
pub fn phi24([dx, dy]: [f64; 2], b1: f64, [px, py]: [f64; 2], phi14: f64) -> f64 {
    -phi14 + (py - dy - b1 * phi14.sin()).atan2(px - dx - b1 * phi14.cos())
}

/// Eq. 19: the square of a1.
pub fn eq_19(leg: &SliderLeg, [px, py]: [f64; 2], theta: f64, s: f64) -> f64 {
    let SliderLeg { alpha, h, a2, .. } = *leg;
    h * h + s * s + px * px + py * py + a2 * a2
        - 2.0 * px * h * alpha.cos()
        - 2.0 * h * (alpha - theta).cos() * a2
        - 2.0 * px * s * (alpha + FRAC_PI_2).cos()
        + 2.0 * px * a2 * theta.cos()
        - 2.0 * py * h * alpha.sin()
        - 2.0 * py * s * (alpha + FRAC_PI_2).sin()
        + 2.0 * py * a2 * theta.sin()
}

/// Eq. 20: the coefficients of the rates of theta and S, with the same letter P for both
/// coordinates.
pub fn eq_20(leg: &SliderLeg, p: f64, theta: f64, s: f64) -> [f64; 2] {
    let SliderLeg { alpha, h, a2, .. } = *leg;
    let (sat, cat) = (alpha - theta).sin_cos();
    [
        a2 * (-p * theta.cos() + p * theta.sin() + sat * h + cat * s),
        -p * alpha.cos() + p * alpha.sin() + sat * a2 + s,
    ]
}

/// Eqs. 27 and 28, where `k` is `k_1 + S` on the helical leg and `foot` is `h - a`.
pub fn eqs_27_28(leg: &TranslationalLeg, k: f64, foot: f64, s: f64) -> [f64; 2] {
    let TranslationalLeg { alpha, beta, .. } = *leg;
    [
        foot * alpha.cos() - s * alpha.sin() - k * (beta + alpha).cos(),
        foot * alpha.sin() - s * alpha.cos() - k * (beta + alpha).sin(),
    ]
}

/// The formula printed below Eq. 28.
pub fn slider(leg: &TranslationalLeg, k: f64, [px, py]: [f64; 2]) -> f64 {
    let TranslationalLeg { alpha, beta, .. } = *leg;
    (py * alpha.cos() - px * alpha.sin() + beta.sin() * k) / (2.0 * alpha).cos()
}

/// Eq. 29: a row times the rates of Px, Py and S.
pub fn eq_29(leg: &TranslationalLeg) -> [f64; 3] {
    let TranslationalLeg { alpha, beta, pitch, .. } = *leg;
    let divisor = (2.0 * alpha).cos();
    let helical = if pitch == 0.0 { 0.0 } else { beta.sin() / divisor };
    [-alpha.sin() / divisor, alpha.cos() / divisor, helical]
}
