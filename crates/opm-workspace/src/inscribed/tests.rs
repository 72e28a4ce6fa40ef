//! Shapes whose largest disc, ball or box geometry gives, and sets of few cells by trying everything.

use super::*;
use crate::grid::Axis;
use crate::set::SetAxis;

fn axes(ends: &[[f64; 2]], counts: &[u64]) -> Vec<SetAxis> {
    let names = ["x", "y", "z"];
    let made = names.iter().zip(ends.iter().zip(counts));
    made.map(|(name, (&[min, max], &count))| SetAxis {
        axis: Axis::new(*name, min, max, count),
        circle: false,
    })
    .collect()
}

/// The set of the points for which `holds` is true.
fn set(ends: &[[f64; 2]], counts: &[u64], holds: impl Fn(&[f64]) -> bool) -> GridSet {
    let all = GridSet::of(axes(ends, counts), |_| true).unwrap();
    GridSet::of(axes(ends, counts), |number| holds(&all.point(number))).unwrap()
}

fn found(set: &GridSet, shape: InscribedShape, centre: Option<&[f64]>) -> Inscribed {
    inscribed(set, shape, centre).unwrap().unwrap()
}

#[test]
fn a_disc_fills_the_width_of_an_annulus() {
    let ring =
        set(&[[-1.0, 1.0], [-1.2, 1.2]], &[201, 301], |p| (0.2..=0.8).contains(&p[0].hypot(p[1])));
    let disc = found(&ring, InscribedShape::Disc, None);
    assert!((disc.radii[0] - 0.3).abs() <= disc.error[0], "{disc:?}");
    assert!((disc.centre[0].hypot(disc.centre[1]) - 0.5).abs() <= 2.0 * disc.error[0]);
    assert!(!disc.at_edge);
    let given = found(&ring, InscribedShape::Disc, Some(&[0.0, 0.6]));
    assert!((given.radii[0] - 0.2).abs() <= given.error[0], "{given:?}");
    assert_eq!(inscribed(&ring, InscribedShape::Disc, Some(&[0.0, 0.0])).unwrap(), None);
}

#[test]
fn a_rectangle_is_its_own_largest_box() {
    // The sides are half way between points, so that the cells are exact.
    let inside = |p: &[f64]| (-0.305..0.455).contains(&p[0]) && (-0.51..0.13).contains(&p[1]);
    let block = set(&[[-1.0, 1.0], [-1.0, 1.0]], &[201, 101], inside);
    let cuboid = found(&block, InscribedShape::Box, None);
    let close = |a: &[f64], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(&cuboid.centre, [0.075, -0.19]), "{cuboid:?}");
    assert!(close(&cuboid.radii, [0.38, 0.32]), "{cuboid:?}");
    assert!((cuboid.measure() - 0.76 * 0.64).abs() < 1e-12);
    let disc = found(&block, InscribedShape::Disc, None);
    assert!(close(&disc.radii, [0.32, 0.32]), "{disc:?}");
    let centred = found(&block, InscribedShape::Box, Some(&[0.2, 0.0]));
    assert!(close(&centred.radii, [0.255, 0.13]), "{centred:?}");
}

#[test]
fn a_ball_in_a_cone_touches_its_side_and_its_base() {
    // The inscribed ball of a cone of height 1 and base radius 1/2: r = R h / (R + √(R² + h²)).
    let cone = |p: &[f64]| p[2] >= 0.0 && p[0].hypot(p[1]) <= 0.5 * (1.0 - p[2]);
    let ends = [[-0.6, 0.6], [-0.6, 0.6], [-0.1, 1.1]];
    let cone = set(&ends, &[61, 61, 61], cone);
    let ball = found(&cone, InscribedShape::Ball, None);
    let radius = 0.5 / (0.5 + 1.25_f64.sqrt());
    assert!((ball.radii[0] - radius).abs() <= ball.error[0], "{ball:?}");
    assert!((ball.centre[2] - radius).abs() <= 2.0 * ball.error[0], "{ball:?}");
    let at = found(&cone, InscribedShape::Ball, Some(&[0.0, 0.0, 0.1]));
    assert!((at.radii[0] - 0.1).abs() <= at.error[0], "{at:?}");
}

#[test]
fn the_largest_box_in_a_cylinder_is_a_prism_over_a_square() {
    let cylinder = |p: &[f64]| p[0].hypot(p[1]) <= 0.8 && p[2].abs() < 0.405;
    let cylinder = set(&[[-1.0, 1.0]; 3], &[101, 101, 101], cylinder);
    let cuboid = found(&cylinder, InscribedShape::Box, None);
    let side = 0.8 / 2_f64.sqrt();
    assert!((cuboid.measure() - 8.0 * side * side * 0.41).abs() < 0.05, "{cuboid:?}");
    assert!((cuboid.radii[2] - 0.41).abs() < 1e-12);
    let centred = found(&cylinder, InscribedShape::Box, Some(&[0.0, 0.0, 0.0]));
    assert!((centred.radii[0] - side).abs() <= 2.0 * centred.error[0], "{centred:?}");
    assert!((centred.radii[2] - 0.41).abs() < 1e-12);
}

#[test]
fn a_full_grid_is_left_at_its_edge() {
    let full = set(&[[0.0, 1.0], [0.0, 2.0]], &[11, 11], |_| true);
    let disc = found(&full, InscribedShape::Disc, None);
    assert!(disc.at_edge && (disc.radii[0] - 0.55).abs() < 1e-12, "{disc:?}");
    let empty = set(&[[0.0, 1.0], [0.0, 2.0]], &[11, 11], |_| false);
    assert_eq!(inscribed(&empty, InscribedShape::Box, None).unwrap(), None);
    let error = inscribed(&full, InscribedShape::Ball, None).unwrap_err();
    assert!(error.to_string().contains("varies in x, y"), "{error}");
}

/// A random set: each cell is inside with this chance.
fn random(counts: &[u64], chance: u64, seed: u64) -> GridSet {
    let ends: Vec<[f64; 2]> = counts.iter().map(|&n| [0.0, (n - 1) as f64]).collect();
    let mut state = seed;
    let mut drawn: Vec<bool> = Vec::new();
    for _ in 0..counts.iter().product::<u64>() {
        // A linear congruential generator (Knuth's MMIX).
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        drawn.push((state >> 33) % 100 < chance);
    }
    GridSet::of(axes(&ends, counts), |number| drawn[number as usize]).unwrap()
}

/// The distance from a place to the nearest cell that is outside of a set with steps of one.
fn clearance(set: &GridSet, place: &[f64]) -> f64 {
    let counts: Vec<u64> = set.axes().iter().map(|a| a.axis.count).collect();
    let edge = place.iter().zip(&counts).map(|(p, &n)| (p + 0.5).min(n as f64 - 0.5 - p));
    let edge = edge.fold(f64::INFINITY, f64::min);
    let outside = (0..set.points()).filter(|&number| !set.contains(number));
    outside.fold(edge, |least, number| {
        let gaps = set.point(number).into_iter().zip(place);
        let square = gaps.map(|(cell, p)| ((cell - p).abs() - 0.5).max(0.0).powi(2)).sum::<f64>();
        least.min(square.sqrt())
    })
}

#[test]
fn no_other_disc_and_no_other_box_of_cells_is_larger() {
    for seed in 0..40 {
        let counts = [7 + seed % 3, 6];
        let set = random(&counts, 60 + seed, seed);
        let (mut radius, mut size) = (0.0_f64, 0.0_f64);
        for i in 0..=2 * counts[0] {
            for j in 0..=2 * counts[1] {
                let place = [0.5 * i as f64 - 0.5, 0.5 * j as f64 - 0.5];
                radius = radius.max(clearance(&set, &place));
            }
        }
        for x in 0..counts[0] {
            for y in 0..counts[1] {
                for to_x in x..counts[0] {
                    for to_y in y..counts[1] {
                        let cells =
                            (x..=to_x).flat_map(|i| (y..=to_y).map(move |j| j * counts[0] + i));
                        if cells.into_iter().all(|number| set.contains(number)) {
                            size = size.max(((to_x - x + 1) * (to_y - y + 1)) as f64);
                        }
                    }
                }
            }
        }
        let disc = inscribed(&set, InscribedShape::Disc, None).unwrap();
        let disc = disc.map_or(0.0, |disc| disc.radii[0]);
        assert!((disc - radius).abs() < 1e-12, "seed {seed}: {disc}, expected {radius}");
        let cuboid = inscribed(&set, InscribedShape::Box, None).unwrap();
        let cuboid = cuboid.map_or(0.0, |cuboid| cuboid.measure());
        assert!((cuboid - size).abs() < 1e-9, "seed {seed}: {cuboid}, expected {size}");
    }
}

#[test]
fn no_box_about_a_centre_is_larger_in_space() {
    for seed in 0..20 {
        let set = random(&[5, 6, 4], 90, seed);
        let centre = [1.9, 2.6, 1.3];
        let found = inscribed(&set, InscribedShape::Box, Some(&centre)).unwrap();
        let found = found.map_or(0.0, |cuboid| cuboid.measure());
        // Half sides at which a side meets that of a cell, or just a little less than any.
        let halves = |axis: usize| {
            let sides = (0..=6).map(|side| (side as f64 - 0.5 - centre[axis]).abs());
            sides.collect::<Vec<f64>>()
        };
        let ends = [4.5, 5.5, 3.5];
        let mut best = 0.0_f64;
        for &x in &halves(0) {
            for &y in &halves(1) {
                for &z in &halves(2) {
                    let half = [x, y, z];
                    let fits = (0..3)
                        .all(|i| centre[i] - half[i] >= -0.5 && centre[i] + half[i] <= ends[i]);
                    let meets = |number: u64| {
                        let cell = set.point(number);
                        (0..3).all(|i| (cell[i] - centre[i]).abs() < half[i] + 0.5 - 1e-9)
                    };
                    let mut outside = (0..set.points()).filter(|&n| !set.contains(n));
                    if fits && !outside.any(meets) {
                        best = best.max(8.0 * x * y * z);
                    }
                }
            }
        }
        assert!((found - best).abs() < 1e-9, "seed {seed}: {found}, expected {best}");
    }
}
