//! Section 3.2: the translational manipulator with a helical leg.

use super::{Misses, ROUNDING, e, n, printed, wrapped};
use fastrand::Rng;
use nalgebra::{Matrix2, Rotation2, Vector2, Vector3};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::family::translational_helical;
use opm_tests::paper::TranslationalLeg;
use std::f64::consts::TAU;

/// Visits legs of random translational manipulators with: the leg, its `k` (with S on the helical
/// leg), P, and the crate's slider, foot, and derivatives of the slider by x, y and S.
fn translational_legs(mut visit: impl FnMut(&TranslationalLeg, f64, [f64; 2], [f64; 2], [f64; 3])) {
    let mut rng = Rng::with_seed(32);
    for _ in 0..200 {
        let (mut legs, pitched) = TranslationalLeg::random(&mut rng);
        let turned = TAU * rng.f64();
        legs.iter_mut().for_each(|leg| leg.alpha += turned);
        let home = translational_helical::Home { x: rng.f64(), y: rng.f64(), phi: rng.f64() };
        let mechanism = TranslationalLeg::family(&legs, home).assemble().unwrap();
        let manipulator = Manipulator::new(mechanism).unwrap();
        let at = |pose: [f64; 3]| {
            let mut solution = manipulator.solution();
            assert!(manipulator.inverse(&pose, Mode::default(), &mut solution).unwrap().is_some());
            solution
        };
        let [x, y, phi] = [rng.f64() - 0.5, rng.f64() - 0.5, 10.0 * (rng.f64() - 0.5)];
        let found = at([x, y, phi]);
        let imaginary = legs[pitched].pitch * phi;
        // The crate has the coordinates of each leg in the order S, r, phi. They are linear, so a
        // difference with any step is exact.
        let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0 / legs[pitched].pitch]];
        let moved = steps.map(|[dx, dy, dphi]| at([x + dx, y + dy, phi + dphi]));
        for (i, leg) in legs.iter().enumerate() {
            let k = leg.k + if i == pitched { imaginary } else { 0.0 };
            let [slider, foot] = [found.joints()[3 * i], found.joints()[3 * i + 1]];
            let derivatives = [0, 1, 2].map(|d: usize| moved[d].joints()[3 * i] - slider);
            visit(leg, k, [x, y], [slider, foot], derivatives);
        }
    }
}

/// The loop `O A B C P`: along the slider `n(alpha)`, along the foot `e(alpha)`, and back along the
/// axis. If the whole manipulator is rotated, its platform rotates with it.
#[test]
fn eq_28_has_the_wrong_sign_at_the_slider() {
    let [mut print, mut unturned, mut right] = <[Misses; 3]>::default();
    translational_legs(|leg, k, p, [slider, foot], _| {
        let closed = |leg: &TranslationalLeg| {
            foot * e(leg.alpha) + slider * n(leg.alpha) - k * e(leg.alpha + leg.beta)
        };
        right.add((closed(leg) - Vector2::from(p)).norm());
        let [px, py] = printed::eqs_27_28(leg, k, foot, slider);
        right.add(px - p[0]);
        print.add(py - p[1]);

        let turn = Rotation2::new(1.0);
        let turned = TranslationalLeg { alpha: leg.alpha + 1.0, ..*leg };
        let printed = |leg| Vector2::from(printed::eqs_27_28(leg, k, foot, slider));
        unturned.add((turn * printed(leg) - printed(&turned)).norm());
        right.add((turn * closed(leg) - closed(&turned)).norm());
    });
    print.fail();
    unturned.fail();
    right.hold(ROUNDING);
}

/// The point `P + k e(alpha + beta)` is on the line through the slider along `e(alpha)`.
#[test]
fn the_sliders_are_divided_by_cos_2_alpha() {
    let [mut print, mut right, mut ours, mut opposite] = <[Misses; 4]>::default();
    let legs = |leg: &TranslationalLeg, k: f64, p: [f64; 2], [slider, _]: [f64; 2], _: [f64; 3]| {
        let c = Vector2::from(p) + k * e(leg.alpha + leg.beta);
        let off = |slider: f64| n(leg.alpha).dot(&(c - slider * n(leg.alpha)));
        print.add(off(printed::slider(leg, k, p)));
        let straight = leg.slider(p, if leg.pitch == 0.0 { 0.0 } else { (k - leg.k) / leg.pitch });
        right.add(off(straight));
        ours.add(slider - straight);
        // Eqs. 27 and 28 as printed, solved for the foot and the slider, have the opposite sign.
        let divisor = (2.0 * leg.alpha).cos();
        if divisor.abs() > 0.1 {
            let [zero, foot, slide] =
                [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(foot, slide)| -> Vector2<f64> {
                    printed::eqs_27_28(leg, k, foot, slide).into()
                });
            let solved = Matrix2::from_columns(&[foot - zero, slide - zero])
                .try_inverse()
                .map(|inverse| inverse * (Vector2::from(p) - zero));
            opposite.add((solved.unwrap()[1] + printed::slider(leg, k, p)) * divisor);
        }
    };
    translational_legs(legs);
    print.fail();
    right.hold(ROUNDING);
    ours.hold(ROUNDING);
    opposite.hold(ROUNDING);

    // With the printed parameters: twice the slider on two legs, minus the slider on the third.
    let shares = TranslationalLeg::printed().map(|leg| {
        let p = [0.03, -0.05];
        printed::slider(&leg, leg.k, p) / leg.slider(p, 0.0)
    });
    for (share, expected) in shares.iter().zip([2.0, 2.0, -1.0]) {
        assert!((share - expected).abs() < ROUNDING, "{shares:?}");
    }
}

/// Differences of a linear function are its derivatives.
#[test]
fn eq_29_is_divided_by_cos_2_alpha() {
    let [mut print, mut right] = <[Misses; 2]>::default();
    translational_legs(|leg, _, _, _, derivatives| {
        let ours = Vector3::from(derivatives);
        print.add((Vector3::from(printed::eq_29(leg)) - ours).norm());
        let helical = if leg.pitch == 0.0 { 0.0 } else { leg.beta.sin() };
        right.add((Vector3::new(-leg.alpha.sin(), leg.alpha.cos(), helical) - ours).norm());
    });
    print.fail();
    right.hold(ROUNDING);
}

/// "Rotation around the y-axis": the printed angles put the common axis at 255 degrees.
#[test]
fn the_printed_axis_is_not_y() {
    for leg in TranslationalLeg::printed() {
        let apart = wrapped(leg.alpha + leg.beta - 255_f64.to_radians());
        assert!(apart.abs() < ROUNDING, "{leg:?}");
    }
    let manipulator = Manipulator::example("translational-helical-3dof").unwrap();
    let SubspaceClass::Cylindrical { axis, .. } = manipulator.decomposition().upper else {
        panic!("{:?}", manipulator.decomposition().upper)
    };
    let along = e(255_f64.to_radians());
    assert!((axis.x * along.y - axis.y * along.x).abs() < ROUNDING && axis.z.abs() < ROUNDING);
    let from_y = axis.y.abs().acos().to_degrees();
    assert!((from_y - 15.0).abs() < 1e-9, "{from_y}");
}
