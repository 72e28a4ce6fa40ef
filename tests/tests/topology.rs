//! Components and boundaries of sets, compared with flood fills and geometry.

use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_workspace::{
    Axis, Components, Grid, GridSet, Modes, Progress, SetAxis, Sweep, boundary, mask_boundary,
};
use std::f64::consts::{PI, TAU};

fn shipped(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

fn reached(sweep: &Sweep<'_>) -> GridSet {
    GridSet::reached(sweep, &Progress::default()).unwrap()
}

/// A set of random points of a grid with these numbers of values.
fn random_set(rng: &mut Rng, counts: &[u64], circles: &[bool], share: f64) -> (GridSet, Vec<bool>) {
    let axes = counts.iter().zip(circles).enumerate().map(|(i, (&count, &circle))| {
        let axis = match count {
            1 => Axis::fixed(format!("a{i}"), 0.0),
            _ => Axis::new(format!("a{i}"), 0.0, (count - 1) as f64, count),
        };
        SetAxis { axis, circle }
    });
    let mask: Vec<bool> = (0..counts.iter().product()).map(|_| rng.f64() < share).collect();
    (GridSet::of(axes.collect(), |number| mask[number as usize]).unwrap(), mask)
}

/// The components of a mask by a flood fill, largest first; of equal size, in the order of their
/// first points.
fn flood(mask: &[bool], counts: &[u64], circles: &[bool]) -> Vec<Vec<u64>> {
    let mut left = mask.to_vec();
    let mut pieces = vec![];
    for start in 0..mask.len() {
        let mut open = if std::mem::take(&mut left[start]) { vec![start as u64] } else { vec![] };
        let mut piece = vec![];
        while let Some(point) = open.pop() {
            piece.push(point);
            let mut stride = 1;
            for (&count, &circle) in counts.iter().zip(circles) {
                let number = point / stride % count;
                let mut go = |to: u64| {
                    let next = point - number * stride + to * stride;
                    if std::mem::take(&mut left[next as usize]) {
                        open.push(next);
                    }
                };
                if number > 0 || circle {
                    go((number + count - 1) % count);
                }
                if number + 1 < count || circle {
                    go((number + 1) % count);
                }
                stride *= count;
            }
        }
        if !piece.is_empty() {
            piece.sort_unstable();
            pieces.push(piece);
        }
    }
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.len()));
    pieces
}

#[test]
fn components_are_those_of_a_flood_fill() {
    let mut rng = Rng::with_seed(53);
    let mut many = 0;
    for round in 0..3000 {
        let counts: Vec<u64> = (0..1 + rng.usize(..5))
            .map(|_| if rng.u8(..4) == 0 { 1 } else { 2 + rng.u64(..7) })
            .collect();
        let circles: Vec<bool> = counts.iter().map(|&n| n > 2 && rng.bool()).collect();
        let share = rng.f64();
        let (set, mask) = random_set(&mut rng, &counts, &circles, share);
        let expected = flood(&mask, &counts, &circles);
        let components = Components::new(&set);
        let mut found = vec![vec![]; components.sizes().len()];
        for (run, number) in components.runs() {
            found[number as usize].extend(run.from..run.to);
        }
        assert_eq!(found, expected, "round {round}: {counts:?} {circles:?}");
        let sizes: Vec<_> = expected.iter().map(|piece| piece.len() as u64).collect();
        assert_eq!(components.sizes(), sizes);
        assert_eq!(set.count(), sizes.iter().sum::<u64>());
        let numbers: Vec<u64> = (0..mask.len() as u64).filter(|&i| mask[i as usize]).collect();
        assert!(set.numbers().eq(numbers));
        many += u32::from(expected.len() > 3);
    }
    assert!(many > 500, "{many}");
}

/// The components of the complement of a mask, joined at corners too, except the outer one.
fn holes(mask: &[bool], [width, height]: [u64; 2]) -> usize {
    let (w, h) = (width as i64 + 2, height as i64 + 2);
    let mut left: Vec<bool> = (0..w * h)
        .map(|p| {
            let (i, j) = (p % w - 1, p / w - 1);
            let within = i >= 0 && j >= 0 && i < w - 2 && j < h - 2;
            !(within && mask[(j * (w - 2) + i) as usize])
        })
        .collect();
    let mut pieces = 0;
    for start in 0..left.len() {
        let mut open = if std::mem::take(&mut left[start]) { vec![start as i64] } else { vec![] };
        pieces += open.len();
        while let Some(p) = open.pop() {
            for (di, dj) in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))) {
                let (i, j) = (p % w + di, p / w + dj);
                let within = i >= 0 && j >= 0 && i < w && j < h;
                if within && std::mem::take(&mut left[(j * w + i) as usize]) {
                    open.push(j * w + i);
                }
            }
        }
    }
    pieces - 1
}

/// Outer rings correspond to components and inner rings to holes, with the areas that Pick's
/// theorem gives.
#[test]
fn boundaries_of_random_masks_have_their_topology_and_area() {
    let mut rng = Rng::with_seed(54);
    for round in 0..3000 {
        let counts = [2 + rng.u64(..12), 2 + rng.u64(..12)];
        let share = rng.f64();
        let (set, mask) = random_set(&mut rng, &counts, &[false; 2], share);
        let outlines = boundary(&set).unwrap();
        let [outline] = &outlines[..] else { panic!("{} outlines", outlines.len()) };
        // A single point in a corner of the grid has a small area.
        let outer = outline.rings.iter().filter(|ring| ring.area() > 0.0).count();
        let inner = outline.rings.iter().filter(|ring| ring.area() < 0.0).count();
        assert_eq!(outer, flood(&mask, &counts, &[false; 2]).len(), "round {round}");
        assert_eq!(inner, holes(&mask, counts), "round {round}");
        assert_eq!(outer + inner, outline.rings.len());
        // Marching squares, square by square: the area within each of them.
        let has = |i: u64, j: u64| usize::from(mask[(j * counts[0] + i) as usize]);
        let squares = (0..counts[1] - 1).flat_map(|j| (0..counts[0] - 1).map(move |i| (i, j)));
        let expected: f64 = squares
            .map(|(i, j)| {
                let corners = [has(i, j), has(i + 1, j), has(i + 1, j + 1), has(i, j + 1)];
                match corners.iter().sum::<usize>() {
                    0 => 0.0,
                    1 => 0.125,
                    2 if corners[0] == corners[2] => 0.25,
                    2 => 0.5,
                    3 => 0.875,
                    _ => 1.0,
                }
            })
            .sum();
        assert!((outline.area() - expected).abs() < 1e-9, "{} {expected}", outline.area());
    }
}

/// One slice for each value of the third axis, whichever axes have a single value.
#[test]
fn boundaries_of_solids_are_those_of_their_slices() {
    let mut rng = Rng::with_seed(55);
    for _ in 0..200 {
        let (w, h, d) = (2 + rng.u64(..8), 2 + rng.u64(..8), 2 + rng.u64(..4));
        let (set, mask) = random_set(&mut rng, &[1, w, 1, h, d], &[false; 5], 0.6);
        let outlines = boundary(&set).unwrap();
        assert_eq!(outlines.len() as u64, d);
        for (slice, outline) in outlines.iter().enumerate() {
            assert_eq!(outline.slice, Some(slice as u64));
            let area = (w * h) as usize;
            let axis = |n: u64| Axis::new("a", 0.0, (n - 1) as f64, n);
            let part = &mask[slice * area..(slice + 1) * area];
            assert_eq!(outline.rings, mask_boundary(&axis(w), &axis(h), part).unwrap());
        }
        assert_eq!(boundary(&random_set(&mut rng, &[w], &[false], 0.5).0), None);
        assert_eq!(boundary(&random_set(&mut rng, &[2; 4], &[false; 4], 0.5).0), None);
    }
}

/// Paper, section 3.2: at a fixed phi the workspace is the intersection of three strips, a convex
/// polygon.
#[test]
fn the_boundary_of_the_helical_mechanism_is_its_polygon() {
    let manipulator = shipped("translational-helical-3dof");
    for phi in [0.0, 0.7, -1.9] {
        // Within S_i = n(alpha_i) P + sin(beta_i) (k_i + [i = 1] S) in ±400 mm, S = p phi.
        let (alpha, beta) = ([210_f64, 330.0, 90.0], [45_f64, 285.0, 165.0]);
        let (k, pitch) = ([0.010, 0.015, 0.025], 0.020);
        let strip = |i: usize| {
            let (s, c) = alpha[i].to_radians().sin_cos();
            let shift = if i == 0 { pitch * phi } else { 0.0 };
            ([-s, c], beta[i].to_radians().sin() * (k[i] + shift))
        };
        let mut polygon = vec![[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
        for (n, offset) in [0, 1, 2].map(strip) {
            for side in [1.0, -1.0] {
                polygon = clipped(&polygon, n.map(|c| c * side), 0.4 - side * offset);
            }
        }
        let exact = shoelace(&polygon);
        let count = 801;
        let axes = vec![
            Axis::new("x", -0.6, 0.6, count),
            Axis::new("y", -0.6, 0.6, count),
            Axis::fixed("phi", phi),
        ];
        let grid = Grid::new(&manipulator, axes).unwrap();
        let set = reached(&Sweep::new(&manipulator, &grid, Modes::Any));
        let outlines = boundary(&set).unwrap();
        let [outline] = &outlines[..] else { panic!("{} outlines", outlines.len()) };
        assert_eq!(outline.rings.len(), 1);
        assert_eq!(Components::new(&set).sizes(), [set.count()]);
        let step = 1.2 / (count - 1) as f64;
        // Every corner is within a grid step of the polygon, and the areas differ by less than such
        // a step all around it.
        for corner in &outline.rings[0].points {
            let distance = distance_to(&polygon, *corner);
            assert!(distance < step, "{corner:?} is {distance} from the polygon");
        }
        let around: f64 = sides(&polygon).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum();
        let error = (outline.area() - exact).abs() / (around * step);
        println!("phi {phi}: {} of {exact} m^2, {error} of the boundary", outline.area());
        assert!(error < 0.1);
    }
}

fn sides(polygon: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    (0..polygon.len()).map(|i| [polygon[i], polygon[(i + 1) % polygon.len()]])
}

fn shoelace(polygon: &[[f64; 2]]) -> f64 {
    sides(polygon).map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

fn distance_to(polygon: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let to_side = |[a, b]: [[f64; 2]; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let along = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let along = along.clamp(0.0, 1.0);
        (p[0] - a[0] - along * d[0]).hypot(p[1] - a[1] - along * d[1])
    };
    sides(polygon).map(to_side).fold(f64::MAX, f64::min)
}

/// The part of a convex polygon with `n · p <= most`.
fn clipped(polygon: &[[f64; 2]], n: [f64; 2], most: f64) -> Vec<[f64; 2]> {
    let over = |p: [f64; 2]| n[0] * p[0] + n[1] * p[1] - most;
    let mut left = vec![];
    for [a, b] in sides(polygon) {
        let (u, v) = (over(a), over(b));
        if u <= 0.0 {
            left.push(a);
        }
        if u * v < 0.0 {
            let t = u / (u - v);
            left.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    left
}

/// A disc and a ring of known radii: the reach of a two-link arm, with an outer boundary or with
/// both.
#[test]
fn rings_have_the_areas_of_discs() {
    for (inner, outer) in [(0.0, 1.0), (0.4, 1.0), (0.05, 0.9)] {
        let count = 1001;
        let axis = |name: &str| Axis::new(name, -1.3, 1.3, count);
        let (x, y) = (axis("x"), axis("y"));
        let radius = |number: u64| x.value(number % count).hypot(y.value(number / count));
        let axes = [&x, &y].map(|axis| SetAxis { axis: axis.clone(), circle: false });
        let set = GridSet::of(axes.to_vec(), |number| {
            let radius = radius(number);
            radius <= outer && (inner == 0.0 || radius >= inner)
        })
        .unwrap();
        let outline = &boundary(&set).unwrap()[0];
        let area = PI * (outer * outer - inner * inner);
        assert_eq!(outline.rings.len(), if inner > 0.0 { 2 } else { 1 });
        let boundary = TAU * (inner + outer) * 2.6 / (count - 1) as f64;
        assert!((outline.area() - area).abs() < 0.05 * boundary, "{} {area}", outline.area());
    }
}
