//! The default grid contains the workspace and fits it closely, whatever the workspace's size and
//! position.

use fastrand::Rng;
use nalgebra::{Matrix3, Vector3};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{Mechanism, examples, file};
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_workspace::{Extent, Grid, Modes, Progress, Sweep, default_grid};
use std::f64::consts::{PI, TAU};

fn example(name: &str, edit: impl Fn(&str) -> String) -> Mechanism {
    file::read(&edit(examples::find(name).unwrap().text)).unwrap().mechanism
}

/// Limits of this size about home on every joint: metres and radians.
fn limited(mut mechanism: Mechanism, metres: f64, radians: f64) -> Manipulator {
    let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    for coordinate in joints.flat_map(|joint| &mut joint.coordinates) {
        let width = if coordinate.quantity.unit() == "m" { metres } else { radians };
        coordinate.limits = Some([coordinate.home - width, coordinate.home + width]);
    }
    Manipulator::new(mechanism).unwrap()
}

fn fitted(manipulator: &Manipulator) -> (Grid, Vec<Extent>, u64) {
    let modes = Modes::One(manipulator.home_mode());
    let (grid, extents) = default_grid(manipulator, modes, &Progress::default()).unwrap();
    let count = Sweep::new(manipulator, &grid, modes).count(&Progress::default()).unwrap();
    (grid, extents, count.reachable)
}

/// The poses of the second manipulator within its sliders' limits are a parallelepiped. At its
/// corners three sliders are at their limits (NOTES: `S = n·P + sin(beta) (k + [i = 1] p phi)`).
#[test]
fn it_holds_the_second_manipulators_workspace_closely() {
    let manipulator =
        Manipulator::new(example("translational-helical-3dof", str::to_owned)).unwrap();
    let (alpha, beta) = ([210.0, 330.0, 90.0_f64], [45.0, 285.0, 165.0_f64]);
    let (k, pitch, end) = ([0.010, 0.015, 0.025], 0.020, 0.4);
    let sine = |i: usize| beta[i].to_radians().sin();
    let row = |i: usize| {
        let (sin, cos) = alpha[i].to_radians().sin_cos();
        [-sin, cos, if i == 0 { sine(0) * pitch } else { 0.0 }]
    };
    let rows = Matrix3::from_fn(|i, j| row(i)[j]).try_inverse().unwrap();
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for corner in 0..8 {
        let side = |i: usize| if corner >> i & 1 == 1 { end } else { -end };
        let pose = rows * Vector3::from_fn(|i, _| side(i) - sine(i) * k[i]);
        for (ends, &q) in ends.iter_mut().zip(pose.iter()) {
            *ends = [ends[0].min(q), ends[1].max(q)];
        }
    }
    let (grid, extents, _) = fitted(&manipulator);
    for ((axis, extent), [low, high]) in grid.axes().iter().zip(&extents).zip(ends) {
        assert!(!extent.unbounded);
        assert!(axis.min <= low && axis.max >= high, "{axis:?}, expected {low} to {high}");
        let wide = (axis.max - axis.min) / (high - low);
        assert!(wide < 1.15, "{axis:?} is {wide} times as wide as {low} to {high}");
    }
}

/// A workspace that fits between the poses of any coarse grid, about a home that is on no grid.
#[test]
fn it_finds_a_small_workspace() {
    for (xi, radians) in [(0.0, 0.05), (7.5, 0.05), (7.5, 0.002), (-40.0, 0.01), (200.0, 0.01)] {
        let turned = |text: &str| text.replace("xi = 0", &format!("zeta = 250, xi = {xi}"));
        let turned = |text: &str| turned(&text.replace("zeta = 0,", ""));
        let manipulator = limited(example("plano-spherical-5dof", turned), 0.003, radians);
        let (grid, _, reachable) = fitted(&manipulator);
        assert!(reachable > grid.poses() / 1000, "{reachable} of {grid:?} at {xi}, {radians}");
        for (axis, home) in grid.axes().iter().zip(manipulator.home_pose()) {
            assert!((axis.min..=axis.max).contains(&home), "{axis:?}");
        }
    }
}

/// No pose of a finer and wider grid that is in reach is outside, however thin parts of the
/// workspace are.
#[test]
fn nothing_in_reach_is_outside_it() {
    let mut checked = 0;
    for example in examples::EXAMPLES {
        let Ok(manipulator) = Manipulator::new(self::example(example.name, str::to_owned)) else {
            continue;
        };
        // Legs that are solved whole are asked pose by pose.
        let poses: f64 = if manipulator.is_whole() { 2e5 } else { 1e7 };
        let (fitted, extents, _) = fitted(&manipulator);
        let coordinates = manipulator.task_coordinates();
        // An even number, so that home is not on the grid and the values differ from those of the
        // search.
        let count = 2 * (0.5 * poses.powf(1.0 / coordinates.len() as f64)) as u64;
        let axes =
            fitted.axes().iter().zip(&extents).zip(coordinates).map(|((axis, extent), c)| {
                let wider = 0.25 * (axis.max - axis.min);
                let (home, half) = match c.name {
                    "xi" => (PI / 2.0, PI / 2.0),
                    "nu" | "pitch" => (c.home, PI / 2.0),
                    _ if c.quantity.unit() == "m" || manipulator.counts_turns(c.kind()) => {
                        (c.home, f64::INFINITY)
                    }
                    _ => (c.home, PI),
                };
                let [min, max] = match extent.unbounded {
                    true => [axis.min, axis.max],
                    false => [axis.min - wider, axis.max + wider],
                };
                opm_workspace::Axis::new(c.name, min.max(home - half), max.min(home + half), count)
            });
        let wide = Grid::new(&manipulator, axes.collect()).unwrap();
        let modes = Modes::One(manipulator.home_mode());
        let mut outside: Option<Vec<f64>> = None;
        let sweep = Sweep::new(&manipulator, &wide, modes);
        let found = sweep.points(
            &Progress::default(),
            |hits, outside: &mut Option<Vec<f64>>| {
                let rows = [hits.first[0], hits.first[hits.first.len() - 1]];
                for first in rows {
                    let pose: Vec<f64> =
                        std::iter::once(first).chain(hits.others.iter().copied()).collect();
                    let beyond = pose.iter().zip(fitted.axes()).any(|(value, axis)| {
                        let rounding = 1e-9 * (axis.max - axis.min);
                        *value < axis.min - rounding || *value > axis.max + rounding
                    });
                    if beyond {
                        *outside = Some(pose);
                    }
                }
            },
            || None,
            |some| {
                outside = outside.take().or(some);
                Ok::<(), opm_workspace::Cancelled>(())
            },
        );
        found.unwrap();
        assert_eq!(outside, None, "{}: outside of {:?}", example.name, fitted.axes());
        checked += 1;
    }
    assert!(checked >= 10, "{checked} mechanisms");
}

/// Locked joints leave one pose: the grid shrinks around it and stops.
#[test]
fn it_ends_at_a_workspace_of_one_pose() {
    let manipulator = limited(example("plano-spherical-5dof", str::to_owned), 0.0, 0.0);
    let (grid, _, reachable) = fitted(&manipulator);
    assert!(reachable >= 1);
    assert!(grid.axes()[0].max - grid.axes()[0].min < 1e-5);
}

/// Without limits many workspaces are unbounded. The grid is then as large as the mechanism, and
/// angles cover one revolution unless a helical joint counts revolutions.
#[test]
fn an_unbounded_workspace_is_reported_and_limited_to_the_mechanisms_size() {
    let mut rng = Rng::with_seed(31);
    let mut unbounded = 0;
    for pair in PAIRS {
        let options = Options { limited: 0.0, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let mechanism = manipulator.mechanism();
        let distances = mechanism.joints().map(|joint| (joint.point - mechanism.platform).norm());
        // To both sides of home, and outward to round numbers, by at most a tenth.
        let far = 2.4 * distances.fold(0.0, f64::max);
        let (grid, extents, reachable) = fitted(&manipulator);
        assert!(reachable > 0, "{pair:?}");
        for ((axis, extent), c) in
            grid.axes().iter().zip(&extents).zip(manipulator.task_coordinates())
        {
            let width = axis.max - axis.min;
            let angle = c.quantity.unit() == "rad";
            if angle && !manipulator.counts_turns(c.kind()) {
                assert!(width <= TAU + 1e-9 && !extent.unbounded, "{pair:?} {axis:?}");
            }
            if c.name == "nu" {
                assert!(width <= PI + 1e-9, "{pair:?} {axis:?}");
            }
            if extent.unbounded {
                // An angle that counts revolutions stays within one, rounded outward.
                let most = if angle { 1.1 * TAU } else { far };
                assert!(width < most, "{pair:?} {axis:?} {far}");
                unbounded += 1;
            }
        }
    }
    assert!(unbounded > 10, "{unbounded} coordinates without an end");
}
