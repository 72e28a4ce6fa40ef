//! The upper section of section 3.1: the ranges of its imaginary joints, and its reach.

use super::{ROUNDING, wrapped};
use nalgebra::{Matrix3, Rotation3, Vector3};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::reach::LegBranch;
use opm_core::task::Displacement;
use opm_tests::paper::PlanoSpherical;
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep};
use std::f64::consts::TAU;

/// "The range of the imaginary joints is calculated for ±20° in all directions": this angle in
/// radians.
const PRINTED_RANGES: [[f64; 2]; 3] = [[-0.55, 0.55], [1.4, 3.2], [3.5, 4.9]];

/// Ranges with the Euler angles of Eq. 2, from the formulas in another language on a grid of 161
/// values per axis.
const RANGES: [[f64; 2]; 3] = [[-0.709956, 0.913700], [1.337808, 3.090115], [3.613413, 5.247141]];

/// Tolerance: half a digit of `RANGES`, plus what a grid of 41 values per axis may miss of an inner
/// extremum.
const RANGE_TOLERANCE: f64 = 1e-5;

/// The paper prints its ranges to a twentieth of a radian. Every range must differ by more than
/// twice that.
const NOT_READING: f64 = 0.1;

fn printed_manipulator() -> Manipulator {
    Manipulator::example("plano-spherical-5dof").unwrap()
}

/// The imaginary joint of a leg at an orientation that it reaches. Its second arc must be the angle
/// between the axes at its ends.
fn theta(
    manipulator: &Manipulator,
    leg: usize,
    rotation: Matrix3<f64>,
    mode: Mode,
    ways: &mut Vec<LegBranch>,
) -> f64 {
    ways.clear();
    manipulator.reach().leg_branches(leg, &Displacement::Spherical(rotation), Some(mode), ways);
    let (number, value) = manipulator.reach().imaginary_value(&ways[0]).unwrap();
    assert_eq!(number, leg);
    let geometry = PlanoSpherical::printed().legs[leg];
    let v = Vector3::from(geometry.proximal_axis(value));
    let w = Vector3::from(geometry.platform_axis(&rows(&rotation)));
    assert!((v.dot(&w) - geometry.arc2.cos()).abs() < ROUNDING);
    value
}

/// The largest difference between the ends of two lists of ranges, modulo 2π.
fn off(range: [f64; 2], other: [f64; 2]) -> f64 {
    wrapped(range[0] - other[0]).abs().max(wrapped(range[1] - other[1]).abs())
}

/// A sweep of the whole manipulator at the origin, where every leg closes at all these
/// orientations, gives the ranges of the formulas, not the printed ones.
#[test]
fn the_ranges_of_the_imaginary_joints() {
    let manipulator = printed_manipulator();
    let angle = 20_f64.to_radians();
    let axes = ["zeta", "xi", "psi"].map(|name| Axis::new(name, -angle, angle, 41));
    let grid = Grid::new(&manipulator, axes.into()).unwrap();
    let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
    let count = sweep.count(&Progress::default()).unwrap();
    assert_eq!([count.poses, count.reachable], [41 * 41 * 41; 2]);
    for (leg, range) in count.imaginary.iter().enumerate() {
        let range = range.unwrap();
        for (found, expected) in range.into_iter().zip(RANGES[leg]) {
            assert!((found - expected).abs() < RANGE_TOLERANCE, "theta1{} {range:?}", leg + 1);
        }
        assert!(off(range, PRINTED_RANGES[leg]) > NOT_READING, "theta1{} {range:?}", leg + 1);
    }
}

/// The printed ranges do not belong to any other three successive rotations either, on neither
/// branch and for none of the three legs.
#[test]
fn no_order_of_rotations_gives_the_printed_ranges() {
    const COUNT: usize = 17;
    let manipulator = printed_manipulator();
    let values: [f64; COUNT] =
        std::array::from_fn(|i| (40.0 * i as f64 / (COUNT - 1) as f64 - 20.0).to_radians());
    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let turns =
        axes.map(|axis| values.map(|value| Rotation3::from_axis_angle(&axis, value).into_inner()));
    let mut ways = Vec::new();
    let mut orders = 0;
    for (first, second, third) in (0..27).map(|order| (order / 9, order / 3 % 3, order % 3)) {
        if first == second || second == third {
            continue;
        }
        orders += 1;
        for branch in ["++ ++ ++ +", "-+ -+ -+ +"] {
            let mode = manipulator.parse_mode(branch).unwrap();
            for (leg, printed) in PRINTED_RANGES.into_iter().enumerate() {
                let mut at = |r| theta(&manipulator, leg, r, mode, &mut ways);
                let home = at(Matrix3::identity());
                let [mut low, mut high] = [home; 2];
                for a in &turns[first] {
                    for b in &turns[second] {
                        for c in &turns[third] {
                            let value = home + wrapped(at(a * b * c) - home);
                            (low, high) = (low.min(value), high.max(value));
                        }
                    }
                }
                let order = [first, second, third].map(|axis| ["x", "y", "z"][axis]).concat();
                assert!(
                    off([low, high], printed) > NOT_READING,
                    "{order} {branch} theta1{}: {low}..{high}",
                    leg + 1
                );
            }
        }
    }
    assert_eq!(orders, 12);
}

/// A leg's arcs add up to 150 degrees, so its platform axis reaches everything except a cap of 30
/// degrees about -z. The three axes are more than 60 degrees apart, so the caps, seen from the
/// platform, are disjoint. A cap of angle a is a share of (1 - cos a) / 2 of the sphere.
#[test]
fn the_reachable_share_of_all_orientations() {
    const EXPECTED: f64 = 0.799_038_105_676_658;
    let cap = 30_f64.to_radians();
    assert!((1.0 - 1.5 * (1.0 - cap.cos()) - EXPECTED).abs() < ROUNDING);
    let paper = PlanoSpherical::printed();
    let axes = paper.legs.map(|leg| Vector3::from(leg.platform_axis(&rows(&Matrix3::identity()))));
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        assert!(axes[i].dot(&axes[j]).acos() > 2.0 * cap);
    }

    // Haar measure is uniform in zeta, cos xi and psi. The cells have equal measure in (cos xi,
    // psi). Zeta, which rotates the axes about z and so does not matter, follows the golden ratio.
    const CELLS: usize = 1500;
    let manipulator = printed_manipulator();
    let mut ways = Vec::new();
    let mut reached = 0_u64;
    for row in 0..CELLS {
        let tilt = 1.0 - (2 * row + 1) as f64 / CELLS as f64;
        let xi = tilt.acos();
        for column in 0..CELLS {
            let psi = TAU * (column as f64 + 0.5) / CELLS as f64;
            let zeta = TAU * ((row * CELLS + column) as f64 * 0.618_033_988_749_895).fract();
            let b = manipulator.task().upper(&[zeta, xi, psi]);
            let Displacement::Spherical(rotation) = b else { panic!("{b:?}") };
            let mut whole = true;
            for (leg, axis) in axes.iter().enumerate() {
                ways.clear();
                manipulator.reach().leg_branches(leg, &b, None, &mut ways);
                let above = (rotation * axis).z + cap.cos();
                // The boundary of reach is left to rounding.
                assert!(above.abs() < 1e-9 || ways.is_empty() == (above < 0.0), "{rotation} {leg}");
                whole &= !ways.is_empty();
            }
            reached += u64::from(whole);
        }
    }
    // Only cells that the boundary of a cap crosses can be counted wrongly. The boundary of a cap
    // 60 degrees from the pole spans cos 30 - cos 90 in cos xi and 2 asin(sin 30 / sin 60) in psi.
    // It consists of four monotone arcs, each of which crosses no more cells than its width plus
    // its height in cells, plus three.
    let spans = cap.cos() / 2.0 + 2.0 * (cap.sin() / (2.0 * cap).sin()).asin() / TAU;
    let bound = 3.0 * (2.0 * spans * CELLS as f64 + 12.0) / (CELLS * CELLS) as f64;
    let share = reached as f64 / (CELLS * CELLS) as f64;
    println!("{share} expected {EXPECTED}, bound {bound}");
    assert!(bound < 0.003 && (share - EXPECTED).abs() < bound, "{share} +- {bound}");
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    matrix.transpose().into()
}
