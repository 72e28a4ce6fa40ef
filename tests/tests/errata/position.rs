//! Position formulas of section 3.1.

use super::sample::{Sample, samples};
use super::{Misses, ROUNDING, e, printed, wrapped};
use fastrand::Rng;
use nalgebra::Vector2;
use opm_tests::paper::{self, Joints};
use std::f64::consts::TAU;

/// Link a1 reaches from the slider to `P + a2 e(theta)`.
#[test]
fn eq_16_is_not_divided_by_two() {
    let [mut print, mut right, mut ours] = <[Misses; 3]>::default();
    for sample in samples() {
        for (i, leg) in sample.paper.legs.iter().enumerate() {
            let theta = sample.joints.theta[i];
            let link = |slider: f64| (sample.c(i) - sample.a(i, slider)).norm() - leg.a1;
            let plus = sample.signs.legs[i][1];
            let sign = if plus { 1.0 } else { -1.0 };
            print.add(link(printed::eq_16(leg, sample.p(), theta, sign)));
            let root = paper::slider_root(leg, sample.p(), theta, plus).unwrap();
            right.add(link(root));
            ours.add(root - sample.joints.slider[i]);
        }
    }
    print.fail();
    right.hold(ROUNDING);
    ours.hold(ROUNDING);
}

/// Link b2 reaches from the elbow `D + b1 e(phi14)` to P, in the direction `phi14 + phi24`.
#[test]
fn phi14_has_plus_for_minus_b2_squared() {
    let [mut print, mut right, mut ours] = <[Misses; 3]>::default();
    for Sample { paper, signs, joints, pose, .. } in samples() {
        let (p, d, [b1, b2]) = ([pose[0], pose[1]], Vector2::from(paper.d), paper.b);
        let elbow = |phi14: f64| d + b1 * e(phi14);
        let link = |phi14: f64| (Vector2::from(p) - elbow(phi14)).norm() - b2;
        let sign = if signs.arm { 1.0 } else { -1.0 };
        let undefined = printed::phi14(paper.d, paper.b, p, sign);
        // b1² + b2² + d² > 2 b1 d, so this is never a cosine.
        assert!(undefined.is_nan());
        print.add(link(undefined));

        let apart = d - Vector2::from(p);
        let cosine = (b1 * b1 - b2 * b2 + apart.norm_squared()) / (-2.0 * b1 * apart.norm());
        let phi14 = apart.y.atan2(apart.x) + sign * cosine.acos();
        let phi24 = printed::phi24(paper.d, b1, p, phi14);
        right.add(link(phi14));
        right.add((elbow(phi14) + b2 * e(phi14 + phi24) - Vector2::from(p)).norm());
        ours.add(wrapped(phi14 - joints.arm[0]));
        ours.add(wrapped(phi24 - joints.arm[1]));
    }
    print.fail();
    right.hold(ROUNDING);
    ours.hold(ROUNDING);
}

/// For a leg whose loop is closed with plain vectors, Eq. 19 must give the link's length.
#[test]
fn eq_19_lacks_a_term_in_a2_and_the_slider() {
    let [mut print, mut right, mut ours] = <[Misses; 3]>::default();
    let mut rng = Rng::with_seed(31);
    for sample in samples() {
        for (i, leg) in sample.paper.legs.iter().enumerate() {
            // The slider, theta and the direction of a1 are arbitrary; P is where they lead.
            let (s, theta, along) = (rng.f64() - 0.5, TAU * rng.f64(), TAU * rng.f64());
            let closed = sample.a(i, s) + leg.a1 * e(along) - leg.a2 * e(theta);
            let (p, square) = (closed.into(), leg.a1 * leg.a1);
            print.add((printed::eq_19(leg, p, theta, s) - square) / 0.1);
            let missing = 2.0 * leg.a2 * s * (leg.alpha - theta).sin();
            right.add(printed::eq_19(leg, p, theta, s) + missing - square);
            right.add(leg.link_square(p, theta, s) - square);
            let Joints { theta, slider, .. } = sample.joints;
            ours.add(leg.link_square(sample.p(), theta[i], slider[i]) - square);
        }
    }
    print.fail();
    right.hold(ROUNDING);
    ours.hold(ROUNDING);
}
