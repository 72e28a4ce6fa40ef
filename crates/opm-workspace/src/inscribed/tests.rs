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
fn a_rectangle_has_its_largest_box_but_for_its_corners() {
    // The sides are half way between points, so that the cells are exact. The boundary that is drawn cuts their corners, by
    // half of a step, which costs least along the longer side.
    let inside = |p: &[f64]| (-0.305..0.455).contains(&p[0]) && (-0.51..0.13).contains(&p[1]);
    let block = set(&[[-1.0, 1.0], [-1.0, 1.0]], &[201, 101], inside);
    let cuboid = found(&block, InscribedShape::Box, None);
    let close = |a: &[f64], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(&cuboid.centre, [0.075, -0.19]), "{cuboid:?}");
    assert!(close(&cuboid.radii, [0.375, 0.32]), "{cuboid:?}");
    assert!((cuboid.measure() - 0.75 * 0.64).abs() < 1e-12);
    let disc = found(&block, InscribedShape::Disc, None);
    assert!(close(&disc.radii, [0.32, 0.32]), "{disc:?}");
    let centred = found(&block, InscribedShape::Box, Some(&[0.2, 0.0]));
    assert!(close(&centred.radii, [0.25, 0.13]), "{centred:?}");
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

/// The distance from a place to the nearest cell that is outside of a set with steps of one, or to the end of all cells.
fn clearance(set: &GridSet, place: &[f64]) -> f64 {
    let counts: Vec<u64> = set.axes().iter().map(|a| a.axis.count).collect();
    let edge = place.iter().zip(&counts).map(|(&p, &n)| (p + 0.5).min(n as f64 - 0.5 - p));
    let edge = edge.fold(f64::INFINITY, f64::min);
    let outside = (0..set.points()).filter(|&number| !set.contains(number));
    outside.fold(edge, |least, number| {
        let gaps = set.point(number).into_iter().zip(place);
        let square = gaps.map(|(cell, p)| ((cell - p).abs() - 0.5).max(0.0).powi(2)).sum::<f64>();
        least.min(square.sqrt())
    })
}

/// Whether a place is inside the boundary that is drawn: even and odd crossings of a ray.
fn is_inside(rings: &[crate::Ring], [x, y]: [f64; 2]) -> bool {
    let crosses = |ring: &crate::Ring| {
        let ends = ring.points.iter().zip(ring.points.iter().cycle().skip(1));
        let meets = |(a, b): &(&[f64; 2], &[f64; 2])| {
            (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
        };
        ends.filter(meets).count()
    };
    rings.iter().map(crosses).sum::<usize>() % 2 == 1
}

/// Places along the sides of a box, a little inside.
fn sides(cuboid: &Inscribed) -> impl Iterator<Item = [f64; 2]> + '_ {
    const INSIDE: f64 = 1.0 - 1e-9;
    let at = |x: f64, y: f64| {
        [cuboid.centre[0] + x * cuboid.radii[0], cuboid.centre[1] + y * cuboid.radii[1]]
    };
    (-200..=200).flat_map(move |i| {
        let along = INSIDE * f64::from(i) / 200.0;
        let sides = [INSIDE, -INSIDE];
        sides.into_iter().flat_map(move |side| [at(along, side), at(side, along)])
    })
}

/// A square with a hole, a sector of an annulus, and an ellipse: discs that touch what geometry says, and boxes that do not
/// cross the boundary that is drawn.
#[test]
fn discs_and_boxes_of_plain_figures_are_those_of_geometry() {
    type Holds = fn(&[f64]) -> bool;
    let hole: Holds = |p| p[0].abs().max(p[1].abs()) < 0.9 && p[0].hypot(p[1]) > 0.3;
    let sector: Holds = |p| {
        let angle = p[1].atan2(p[0]);
        (0.4..0.95).contains(&p[0].hypot(p[1])) && (0.2..2.4).contains(&angle)
    };
    let ellipse: Holds = |p| (p[0] / 0.9).hypot(p[1] / 0.6) < 1.0;
    // In a corner of the square, between two sides and the hole: r (1 + √2) + 0.3 = 0.9 √2.
    let corner = (0.9 * 2_f64.sqrt() - 0.3) / (1.0 + 2_f64.sqrt());
    for (holds, disc, largest) in [
        (hole, corner, None),
        (sector, 0.275, None),
        // The largest box in an ellipse has the area 2 a b.
        (ellipse, 0.6, Some(2.0 * 0.9 * 0.6)),
    ] {
        for count in [41, 60, 113] {
            let set = set(&[[-1.0, 1.0], [-1.0, 1.0]], &[count, count], holds);
            let found = found(&set, InscribedShape::Disc, None);
            assert!((found.radii[0] - disc).abs() <= found.error[0], "{count}: {found:?} {disc}");
            let rings = crate::boundary(&set).unwrap().remove(0).rings;
            for centre in [None, Some([0.1, 0.5])] {
                let centre = centre.as_ref().map(|centre| &centre[..]);
                let cuboid = super::inscribed(&set, InscribedShape::Box, centre).unwrap().unwrap();
                assert!(sides(&cuboid).all(|place| is_inside(&rings, place)), "{count} {cuboid:?}");
                if let (Some(largest), None) = (largest, centre) {
                    let step = 2.0 / (count - 1) as f64;
                    assert!((cuboid.measure() - largest).abs() < 4.0 * step, "{count} {cuboid:?}");
                }
            }
        }
    }
}

/// Between two long sides the largest disc may have its centre anywhere on a line.
#[test]
fn a_strip_has_the_disc_of_its_width() {
    for (ends, holds) in [
        ([[0.0, 30.0], [0.0, 8.0]], (|p: &[f64]| (1.6..6.4).contains(&p[1])) as fn(&[f64]) -> bool),
        ([[0.0, 8.0], [0.0, 30.0]], |p| (1.6..6.4).contains(&p[0])),
    ] {
        let counts = ends.map(|[_, end]| end as u64 + 1);
        let disc = found(&set(&ends, &counts, holds), InscribedShape::Disc, None);
        assert!((disc.radii[0] - 2.5).abs() < 1e-9, "{disc:?}");
        assert!(disc.error[0] < 0.7072, "the search came to its end: {disc:?}");
    }
    let slab = |p: &[f64]| (1.6..6.4).contains(&p[2]);
    let slab = set(&[[0.0, 9.0], [0.0, 11.0], [0.0, 8.0]], &[10, 12, 9], slab);
    let ball = found(&slab, InscribedShape::Ball, None);
    assert!((ball.radii[0] - 2.5).abs() < 1e-9 && ball.error[0] < 0.8661, "{ball:?}");
}

#[test]
fn a_centre_between_the_points_of_the_lattice_is_found() {
    // Below x + y = 7.5: a triangle whose hypotenuse is a staircase.
    let triangle = |p: &[f64]| p[0] + p[1] < 7.5 && p[0] > 0.5 && p[1] > 0.5;
    let set = set(&[[0.0, 8.0], [0.0, 8.0]], &[9, 9], triangle);
    let disc = found(&set, InscribedShape::Disc, None);
    // It touches the sides at 0.5, and the cell outside that has its corner at (3.5, 3.5): c - 0.5 = √2 (3.5 - c).
    let c = (3.5 * 2_f64.sqrt() + 0.5) / (1.0 + 2_f64.sqrt());
    assert!((disc.radii[0] - (c - 0.5)).abs() < 1e-9, "{disc:?}, expected {}", c - 0.5);
    assert!(disc.centre.iter().all(|centre| (centre - c).abs() < 1e-6), "{disc:?}, expected {c}");
}

#[test]
fn no_other_disc_and_no_other_box_is_larger() {
    const FINE: f64 = 0.05;
    for seed in 0..40 {
        let counts = [7 + seed % 3, 6];
        let set = random(&counts, 60 + seed, seed);
        let mut radius = 0.0_f64;
        for i in 0..=counts[0] * 20 {
            for j in 0..=counts[1] * 20 {
                radius = radius.max(clearance(&set, &[i, j].map(|i| FINE * i as f64 - 0.5)));
            }
        }
        let disc = inscribed(&set, InscribedShape::Disc, None).unwrap();
        let found = disc.as_ref().map_or(0.0, |disc| disc.radii[0]);
        assert!(found >= radius - 1e-9 && found <= radius + FINE, "seed {seed}: {found} {radius}");
        if let Some(disc) = disc {
            assert!((clearance(&set, &disc.centre) - found).abs() < 1e-12, "seed {seed}: {disc:?}");
        }
        // Halves of cells that the boundary leaves whole, by the places near their corners.
        let rings = crate::boundary(&set).unwrap().remove(0).rings;
        let [nx, ny] = counts.map(|count| 2 * (count - 1));
        let whole: Vec<bool> = (0..nx * ny)
            .map(|number| {
                let low = [number % nx, number / nx].map(|i| 0.5 * i as f64);
                let ends = [0.01, 0.49];
                let mut corners = ends.iter().flat_map(|x| ends.map(|y| [low[0] + x, low[1] + y]));
                corners.all(|corner| is_inside(&rings, corner))
            })
            .collect();
        let mut size = 0.0_f64;
        for x in 0..nx {
            for y in 0..ny {
                for to_x in x..nx {
                    for to_y in y..ny {
                        let mut halves =
                            (x..=to_x).flat_map(|i| (y..=to_y).map(move |j| j * nx + i));
                        if halves.all(|number| whole[number as usize]) {
                            size = size.max(0.25 * ((to_x - x + 1) * (to_y - y + 1)) as f64);
                        }
                    }
                }
            }
        }
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
        // Half sides at which a side meets that of half a cell.
        let halves =
            |axis: usize| (0..=10).map(move |side| (0.5 * side as f64 - centre[axis]).abs());
        let ends = [4.0, 5.0, 3.0];
        // A half is left whole if in no plane of two axes both of its point's neighbours there are outside.
        let counts = [5, 6, 4];
        let has = |p: [u64; 3]| set.contains((p[2] * counts[1] + p[1]) * counts[0] + p[0]);
        let mut cut: Vec<[f64; 3]> = Vec::new();
        for number in 0..8 * 10 * 6 {
            let half = [number % 8, number / 8 % 10, number / 80];
            let point = half.map(|i: u64| i.div_ceil(2));
            let without = |axis: usize| {
                let mut other = point;
                other[axis] = half[axis] / 2 * 2 + 1 - point[axis];
                !has(other)
            };
            let planes = [(0, 1), (0, 2), (1, 2)];
            if !has(point) || planes.into_iter().any(|(a, b)| without(a) && without(b)) {
                cut.push(half.map(|i| 0.5 * i as f64 + 0.25));
            }
        }
        let mut best = 0.0_f64;
        for x in halves(0) {
            for y in halves(1) {
                for z in halves(2) {
                    let half = [x, y, z];
                    let fits = (0..3)
                        .all(|i| centre[i] - half[i] >= 0.0 && centre[i] + half[i] <= ends[i]);
                    let meets = |middle: &[f64; 3]| {
                        (0..3).all(|i| (middle[i] - centre[i]).abs() < half[i] + 0.25 - 1e-9)
                    };
                    if fits && !cut.iter().any(meets) {
                        best = best.max(8.0 * x * y * z);
                    }
                }
            }
        }
        assert!((found - best).abs() < 1e-9, "seed {seed}: {found}, expected {best}");
    }
}
