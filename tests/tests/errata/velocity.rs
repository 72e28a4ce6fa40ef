//! Velocity formulas of section 3.1.

use super::sample::{Rates, samples};
use super::{DIFFERENCED, Misses, ROUNDING, e, printed};
use nalgebra::{Matrix2, Matrix3, SMatrix, Vector2, Vector3, Vector5};

/// The coefficients of Eq. 20 are the derivatives of the squared distance between two points, and
/// they relate the crate's rates. With one letter for both coordinates of P they do neither,
/// whichever coordinate it means.
#[test]
fn eq_20_has_one_letter_for_both_coordinates() {
    let [mut right, mut ours] = <[Misses; 2]>::default();
    let mut print = <[Misses; 3]>::default();
    for sample in samples() {
        let rates = sample.some_rates();
        let [x, y] = sample.p();
        for (i, leg) in sample.paper.legs.iter().enumerate() {
            let (theta, s) = (sample.joints.theta[i], sample.joints.slider[i]);
            let [cx, cy, ct, cs] = leg.rate_coefficients([x, y], theta, s);
            // Central differences that are exact: for a square with any step, for a sine after
            // division by its own.
            let half = |p: [f64; 2], theta: f64, s: f64| {
                let c = Vector2::from(p) + leg.a2 * e(theta);
                (c - sample.a(i, s)).norm_squared() / 2.0
            };
            let t = 0.1;
            right.add(cx + (half([x + t, y], theta, s) - half([x - t, y], theta, s)) / (2.0 * t));
            right.add(cy + (half([x, y + t], theta, s) - half([x, y - t], theta, s)) / (2.0 * t));
            let about = half([x, y], theta + t, s) - half([x, y], theta - t, s);
            right.add(ct + about / (2.0 * t.sin()));
            right.add(cs - (half([x, y], theta, s + t) - half([x, y], theta, s - t)) / (2.0 * t));

            let platform = cx * rates.p[0] + cy * rates.p[1];
            let unbalanced =
                |ct: f64, cs: f64| (platform + ct * rates.theta[i] - cs * rates.slider[i]) / leg.a1;
            ours.add(unbalanced(ct, cs));
            for (misses, p) in print.iter_mut().zip([x, y, x.hypot(y)]) {
                let [ct, cs] = printed::eq_20(leg, p, theta, s);
                misses.add(unbalanced(ct, cs));
            }
        }
    }
    print.iter().for_each(Misses::fail);
    right.hold(ROUNDING);
    ours.hold(DIFFERENCED);
}

/// A rotation of phi14 moves P along y too, and J_q,p must contain that. Its entry (5,4) is missing
/// in print.
#[test]
fn the_planar_jacobian_lacks_its_entry_5_4() {
    let [mut print, mut right, mut ours] = <[Misses; 3]>::default();
    for sample in samples() {
        let [_, inverse] = sample.paper.planar_jacobians(sample.p(), &sample.joints);
        let ([b1, b2], [phi14, phi24]) = (sample.paper.b, sample.joints.arm);
        let p = |phi14: f64, phi24: f64| b1 * e(phi14) + b2 * e(phi14 + phi24);
        let t = 0.1_f64;
        let by_phi14 = (p(phi14 + t, phi24) - p(phi14 - t, phi24)) / (2.0 * t.sin());
        let by_phi24 = (p(phi14, phi24 + t) - p(phi14, phi24 - t)) / (2.0 * t.sin());
        let jacobian = Matrix2::from_columns(&[by_phi14, by_phi24]);
        right.add((inverse.fixed_view::<2, 2>(3, 3) - jacobian).norm());

        let rates = sample.some_rates();
        let (arm, moved) = (Vector2::from(rates.arm), Vector2::from(rates.p));
        ours.add((inverse.fixed_view::<2, 2>(3, 3) * arm - moved).norm());
        let mut unlisted = jacobian;
        unlisted[(1, 0)] = 0.0;
        print.add((unlisted * arm - moved).norm());
    }
    print.fail();
    right.hold(ROUNDING);
    ours.hold(DIFFERENCED);
}

/// The platform's angular velocity follows from its rotation rho: `[omega] = rhodot rho⁻¹`. The `s`
/// of Eq. 2 is a vector, rotating with the platform or not, and has only a pseudo-inverse.
#[test]
fn eq_4_writes_s_for_rho() {
    let [mut print, mut right, mut ours] = <[Misses; 3]>::default();
    for sample in samples() {
        let rates = sample.some_rates();
        let rho = sample.rho();
        let turning = rates.rho * Matrix3::from_fn(|i, j| rho[j][i]);
        right.add((turning + turning.transpose()).norm());
        let omega = Vector3::new(turning.m32, turning.m13, turning.m21);
        let tip: Vector3<f64> = rates.rho.column(2).into();
        let s = Vector3::from(rho.map(|row| row[2]));
        for (velocity, s) in [(tip, s), (Vector3::zeros(), Vector3::z())] {
            print.add((velocity * s.transpose() / s.norm_squared() - turning).norm());
        }
        // Eqs. 5-9, which are printed correctly, need this omega.
        let [direct, inverse] = sample.paper.spherical_jacobians(&rho, &sample.joints.theta);
        ours.add((direct * omega - inverse * Vector3::from(rates.theta)).norm());
    }
    print.fail();
    right.hold(DIFFERENCED);
    ours.hold(DIFFERENCED);
}

/// "Using Eqs. (7) and (22)": these are four equations, without a slider in them, for the eight
/// rates of the joints. Eqs. 8 and 23 give all of them.
#[test]
fn the_whole_velocity_is_not_in_eqs_7_and_22() {
    /// Singular values below this share of the largest count as zero.
    const RANK: f64 = 1e-9;
    let mut ours = Misses::default();
    for sample in samples() {
        let rho = sample.rho();
        let rates = sample.some_rates();
        let [direct, inverse] = sample.paper.planar_jacobians(sample.p(), &sample.joints);
        let [spherical, imaginary] = sample.paper.spherical_jacobians(&rho, &sample.joints.theta);

        // The unknowns are theta1..3, S1..3, phi14, phi24.
        let mut all = SMatrix::<f64, 8, 8>::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&imaginary);
        all.fixed_view_mut::<5, 3>(3, 0).copy_from(&-direct.fixed_columns::<3>(0));
        all.fixed_view_mut::<5, 5>(3, 3).copy_from(&inverse);
        let mut print = SMatrix::<f64, 4, 8>::zeros();
        print.fixed_rows_mut::<3>(0).copy_from(&all.fixed_rows::<3>(0));
        print.row_mut(3).copy_from(&all.row(7));
        let rank = |values: &[f64]| values.iter().filter(|&&v| v > RANK * values[0]).count();
        assert_eq!(rank(all.singular_values().as_slice()), 8);
        assert_eq!(rank(print.singular_values().as_slice()), 4);
        assert!(print.fixed_columns::<3>(3).iter().all(|&slider| slider == 0.0));

        let turning = rates.rho * Matrix3::from_fn(|i, j| rho[j][i]);
        let omega = Vector3::new(turning.m32, turning.m13, turning.m21);
        let theta = imaginary.try_inverse().unwrap() * spherical * omega;
        let moved = Vector5::new(theta.x, theta.y, theta.z, rates.p[0], rates.p[1]);
        let found = inverse.try_inverse().unwrap() * direct * moved;
        let Rates { slider: [s1, s2, s3], arm: [phi14, phi24], .. } = rates;
        ours.add((found - Vector5::new(s1, s2, s3, phi14, phi24)).norm());
    }
    ours.hold(DIFFERENCED);
}
