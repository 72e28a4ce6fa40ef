//! Aspects, compared with flood fills of determinants that are written here from the geometry of the mechanism.

use fastrand::Rng;
use opm_core::motion::{Ends, Instant, Spline};
use opm_core::nalgebra::{Complex, Matrix3, Matrix6, RowVector3, SVector};
use opm_core::{Manipulator, Mode};
use opm_workspace::{
    Aspects, Axis, Components, Grid, GridSet, Modes, NoPath, Progress, Sweep, find_path,
    singular_curves,
};
use std::f64::consts::PI;

fn shipped(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

/// The poses of a grid in reach in a mode, and their aspects.
fn aspects_of(manipulator: &Manipulator, mode: Mode, axes: Vec<Axis>) -> (GridSet, Aspects) {
    let grid = Grid::new(manipulator, axes).unwrap();
    let sweep = Sweep::new(manipulator, &grid, Modes::One(mode));
    let set = GridSet::reached(&sweep, &Progress::default()).unwrap();
    let aspects = Aspects::new(manipulator, mode, &set, &Progress::default()).unwrap();
    (set, aspects)
}

/// The aspect of each pose of a grid, 0 where it has none.
fn labels(set: &GridSet, aspects: &Aspects) -> Vec<u32> {
    (0..set.points()).map(|number| aspects.label(number).unwrap_or(0)).collect()
}

/// The number of places between two neighbours at which a flood fill looks.
const BETWEEN: u64 = 64;

/// Connected parts of equal signs, the largest first, as labels from 1 on. Two neighbours are joined if every place on the
/// line between them is in reach and has the same sign.
fn flood(sign: impl Fn(&[f64]) -> Option<bool>, set: &GridSet) -> Vec<u32> {
    let mut parts: Vec<Vec<u64>> = vec![];
    let mut seen = vec![false; set.points() as usize];
    let joined = |from: &[f64], to: &[f64], own: Option<bool>| {
        (1..=BETWEEN).all(|i| {
            let share = i as f64 / BETWEEN as f64;
            let place: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
            sign(&place) == own
        })
    };
    for start in 0..set.points() {
        let own = sign(&set.point(start));
        let new = own.is_some() && !std::mem::replace(&mut seen[start as usize], true);
        let mut open = if new { vec![start] } else { vec![] };
        let mut part = vec![];
        while let Some(point) = open.pop() {
            part.push(point);
            let (from, mut stride) = (set.point(point), 1);
            for (i, axis) in set.axes().iter().enumerate() {
                let count = axis.axis.count;
                let place = point / stride % count;
                let mut go = |to: u64, turn: f64| {
                    let next = point - place * stride + to * stride;
                    let mut there = set.point(next);
                    there[i] += turn;
                    if !seen[next as usize] && joined(&from, &there, own) {
                        seen[next as usize] = true;
                        open.push(next);
                    }
                };
                if place > 0 {
                    go(place - 1, 0.0);
                } else if axis.circle {
                    go(count - 1, -2.0 * PI);
                }
                if place + 1 < count {
                    go(place + 1, 0.0);
                } else if axis.circle {
                    go(0, 2.0 * PI);
                }
                stride *= count;
            }
        }
        if !part.is_empty() {
            parts.push(part);
        }
    }
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let mut labels = vec![0; seen.len()];
    for (number, part) in parts.iter().enumerate() {
        part.iter().for_each(|&point| labels[point as usize] = number as u32 + 1);
    }
    labels
}

/// Holds that aspects are the parts that a flood fill finds.
#[track_caller]
fn assert_flood(sign: impl Fn(&[f64]) -> Option<bool>, set: &GridSet, aspects: &Aspects) {
    let (found, expected) = (labels(set, aspects), flood(sign, set));
    let differ: Vec<_> = (0..set.points())
        .filter(|&number| found[number as usize] != expected[number as usize])
        .map(|number| (set.point(number), found[number as usize], expected[number as usize]))
        .collect();
    let parts = expected.iter().max().unwrap();
    let some = &differ[..differ.len().min(5)];
    assert!(
        differ.is_empty(),
        "{} of {} poses, {} and {parts} parts: {some:?}",
        differ.len(),
        set.count(),
        aspects.list().len()
    );
}

/// The planar 3-RPR of Innocenti and Merlet, metres.
mod rpr {
    use super::*;

    pub const BASES: [[f64; 2]; 3] = [[0.0, 0.0], [0.01591, 0.0], [0.0, 0.01]];
    pub const LENGTHS: [f64; 3] = [0.01498, 0.01538, 0.012];
    const SIDES: [f64; 3] = [0.01704, 0.01654, 0.02084];

    /// The angle of the platform's first side at home.
    pub fn home_angle() -> f64 {
        let [b1, b2] =
            [(14.9201332471544, -1.33791774304624), (24.0976354874709, 13.0194863617697)];
        f64::atan2(b2.1 - b1.1, b2.0 - b1.0)
    }

    /// The telescopes' lengths, and the determinant of the lines that they are on, at a pose x, y, theta.
    pub fn at(pose: &[f64]) -> ([f64; 3], f64) {
        let [one, two, three] = SIDES;
        let foot = (one * one + three * three - two * two) / (2.0 * one);
        let height = (three * three - foot * foot).sqrt();
        let corners = [[0.0, 0.0], [one, 0.0], [foot, height]].map(|[x, y]| Complex::new(x, y));
        let turn = Complex::from_polar(1.0, pose[2] + home_angle());
        let mut lines = Matrix3::zeros();
        let mut lengths = [0.0; 3];
        for leg in 0..3 {
            let arm = corners[leg] * turn;
            let end = Complex::new(pose[0], pose[1]) + arm;
            let along = end - Complex::new(BASES[leg][0], BASES[leg][1]);
            lengths[leg] = along.norm();
            let unit = along / lengths[leg];
            let moment = (arm.re * unit.im - arm.im * unit.re) / one;
            lines.set_row(leg, &RowVector3::new(unit.re, unit.im, moment));
        }
        (lengths, lines.determinant())
    }

    /// The sign of the determinant at a pose within the telescopes' limits.
    pub fn sign(pose: &[f64]) -> Option<bool> {
        let (lengths, determinant) = at(pose);
        lengths.iter().all(|length| (0.005..=0.035).contains(length)).then_some(determinant > 0.0)
    }
}

fn planar(reach: f64, count: u64, angle: f64, angles: u64) -> Vec<Axis> {
    vec![
        Axis::new("x", -reach, reach, count),
        Axis::new("y", -reach, reach, count),
        Axis::new("theta", -angle, angle, angles),
    ]
}

/// In a full turn of the platform, the planar 3-RPR has two aspects, and small ones at the edge of its grid.
#[test]
fn a_planar_3rpr_has_the_aspects_that_a_flood_fill_of_its_determinant_finds() {
    let manipulator = shipped("planar-3rpr");
    let (set, aspects) =
        aspects_of(&manipulator, manipulator.home_mode(), planar(0.036, 31, PI, 31));
    assert_flood(rpr::sign, &set, &aspects);
    let [first, second, rest @ ..] = aspects.list() else { panic!("{aspects:?}") };
    assert!(first.poses > 4000 && second.poses > 4000 && rest.iter().all(|one| one.poses < 10));
    assert_ne!(first.is_positive(), second.is_positive());
    // Every pose of an aspect lies in its extent, and its runs are those of its set.
    for (number, (aspect, part)) in aspects.list().iter().zip(aspects.sets()).enumerate() {
        let part = part.unwrap();
        assert_eq!(part.count(), aspect.poses);
        for pose in part.numbers() {
            assert_eq!(aspects.label(pose), Some(number as u32 + 1));
            let mut within = part.point(pose).into_iter().zip(&aspect.extent);
            assert!(within.all(|(value, [low, high])| (*low..=*high).contains(&value)));
        }
    }
}

/// The elbow of an arm of two links from a shoulder to a hand, on the side of this sign.
fn elbow(
    shoulder: Complex<f64>,
    hand: Complex<f64>,
    [upper, fore]: [f64; 2],
    side: f64,
) -> Option<Complex<f64>> {
    let d = hand - shoulder;
    let n = d.norm();
    let cosine = (upper * upper + n * n - fore * fore) / (2.0 * upper * n);
    (cosine.abs() <= 1.0)
        .then(|| shoulder + d / n * Complex::from_polar(upper, side * cosine.acos()))
}

fn cross(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.im - a.im * b.re
}

/// A five-bar is singular where its forearms are in line.
#[test]
fn a_five_bar_has_the_aspects_that_a_flood_fill_finds() {
    let manipulator = shipped("five-bar");
    let axes = vec![Axis::new("x", -0.61, 0.6, 81), Axis::new("y", -0.51, 0.5, 71)];
    let (set, aspects) = aspects_of(&manipulator, manipulator.home_mode(), axes);
    let sign = |pose: &[f64]| {
        let hand = Complex::new(pose[0], pose[1]);
        let arms = [(-0.16, 1.0), (0.16, -1.0)];
        let [left, right] =
            arms.map(|(at, side)| elbow(Complex::new(at, 0.0), hand, [0.138, 0.307], side));
        Some(cross(hand - left?, hand - right?) > 0.0)
    };
    assert_flood(sign, &set, &aspects);
    assert!(aspects.list().len() > 1 && aspects.list()[1].poses > 30, "{:?}", aspects.list());
}

/// The elbows of the planar 3-RRR on these sides: positive is clockwise from the arm.
fn rrr_sign(pose: &[f64], sides: [f64; 3]) -> Option<bool> {
    let (base, platform) = (0.331 / 3.0_f64.sqrt(), 0.07506);
    let mut lines = Matrix3::zeros();
    for (leg, azimuth) in [210.0_f64, 330.0, 90.0].into_iter().enumerate() {
        let towards = Complex::from_polar(1.0, azimuth.to_radians());
        let arm = towards * platform * Complex::from_polar(1.0, pose[2]);
        let hand = Complex::new(pose[0], pose[1]) + arm;
        let fore = hand - elbow(towards * base, hand, [0.166, 0.110], sides[leg])?;
        lines.set_row(leg, &RowVector3::new(fore.re, fore.im, cross(arm, fore) / platform));
    }
    Some(lines.determinant() > 0.0)
}

/// The planar 3-RRR in its mode of home and in the one with all elbows on the other side, which is the mirror image.
#[test]
fn a_planar_3rrr_has_the_aspects_that_a_flood_fill_finds_and_they_are_mirrored() {
    let manipulator = shipped("planar-3rrr");
    let axes = || planar(0.2, 25, 1.0, 13);
    let home = manipulator.format_mode(manipulator.home_mode());
    let other: String = home
        .chars()
        .map(|c| {
            if c == '+' {
                '-'
            } else if c == '-' {
                '+'
            } else {
                c
            }
        })
        .collect();
    let modes = [manipulator.home_mode(), manipulator.parse_mode(&other).unwrap()];
    let [(set, aspects), (mirrored_set, mirrored)] =
        modes.map(|mode| aspects_of(&manipulator, mode, axes()));
    for (side, set, aspects) in [(-1.0, &set, &aspects), (1.0, &mirrored_set, &mirrored)] {
        assert_flood(|pose| rrr_sign(pose, [side; 3]), set, aspects);
    }
    let sizes =
        |aspects: &Aspects| -> Vec<u64> { aspects.list().iter().map(|one| one.poses).collect() };
    assert_eq!(sizes(&aspects), sizes(&mirrored));
    assert!(aspects.list().len() > 3);
    for number in set.numbers() {
        let pose = set.point(number);
        let image = mirrored.nearest(&[-pose[0], pose[1], -pose[2]]);
        let size = |aspects: &Aspects, number| {
            aspects.list()[aspects.label(number).unwrap() as usize - 1].poses
        };
        assert_eq!(size(&aspects, number), size(&mirrored, image));
    }
}

/// Two sliders and screws along three axes, and a wrist on a Cartesian robot, have a constant determinant.
#[test]
fn a_mechanism_without_parallel_singularities_has_one_aspect_for_each_component() {
    for (name, count) in [("translational-helical-3dof", 21), ("cartesian-wrist-6dof", 5)] {
        let manipulator = shipped(name);
        let mode = manipulator.home_mode();
        let (grid, _) =
            opm_workspace::default_grid(&manipulator, Modes::One(mode), &Progress::default())
                .unwrap();
        let axes = grid.axes().iter().map(|axis| Axis::new(&*axis.name, axis.min, axis.max, count));
        let (set, aspects) = aspects_of(&manipulator, mode, axes.collect());
        let sizes: Vec<u64> = aspects.list().iter().map(|aspect| aspect.poses).collect();
        assert_eq!(sizes, Components::new(&set).sizes(), "{name}");
        assert!(set.count() > 100);
    }
}

/// Two poses of the same sign are not joined if the determinant changes its sign twice on the way.
#[test]
fn a_step_that_passes_a_singularity_twice_joins_nothing() {
    let manipulator = shipped("planar-3rpr");
    let mode = manipulator.home_mode();
    let mut rng = Rng::with_seed(1);
    let (mut passed, mut clear) = (0, 0);
    while passed < 20 || clear < 200 {
        let [x, y, angle] = [0.05, 0.05, 6.0].map(|width| width * (rng.f64() - 0.5));
        let step = 0.03 * rng.f64() + 1e-3;
        let along = |share: f64| [x + share * step, y, angle];
        let way: Vec<_> = (0..=400).map(|i| rpr::at(&along(f64::from(i) / 400.0))).collect();
        let within = |at: &([f64; 3], f64)| at.0.iter().all(|l| (0.0051..0.0349).contains(l));
        if !way.iter().all(within) || way[0].1 * way[400].1 <= 0.0 {
            continue;
        }
        let least = way.iter().map(|at| at.1 * way[0].1.signum()).fold(f64::INFINITY, f64::min);
        // Nearer to a singularity, the scan does not tell.
        if least.abs() < 1e-3 {
            continue;
        }
        let axes =
            vec![Axis::new("x", x, x + step, 2), Axis::fixed("y", y), Axis::fixed("theta", angle)];
        let (_, aspects) = aspects_of(&manipulator, mode, axes);
        assert_eq!(aspects.list().len(), if least < 0.0 { 2 } else { 1 }, "{x} {y} {angle} {step}");
        if least < 0.0 { passed += 1 } else { clear += 1 }
    }
}

#[test]
fn aspects_do_not_depend_on_the_number_of_threads() {
    let manipulator = shipped("planar-3rrr");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            aspects_of(&manipulator, manipulator.home_mode(), planar(0.2, 31, PI, 24)).1
        })
    };
    let one = on(1);
    assert!(one.list().len() > 1);
    assert_eq!(one, on(3));
}

/// The example of C. Innocenti and V. Parenti-Castelli (*Singularity-free evolution from one configuration to another
/// in serial and fully-parallel manipulators*, 1998) and of Merlet: with the same lengths of the telescopes the platform
/// has six assemblies, and each determinant has three of them. M. Husty (*Non-singular assembly mode change in
/// 3-RPR-parallel manipulators*, 2009) proves that those of one sign are always joined.
#[test]
fn a_planar_3rpr_changes_between_three_of_its_assemblies_without_a_singularity() {
    let manipulator = shipped("planar-3rpr");
    let mode = manipulator.home_mode();
    let (_, aspects) = aspects_of(&manipulator, mode, planar(0.036, 31, PI, 31));
    let assemblies = manipulator.forward(&rpr::LENGTHS).unwrap().list;
    assert_eq!(assemblies.len(), 6);
    let positive = assemblies.iter().filter(|one| rpr::at(&one.pose).1 > 0.0).count();
    assert_eq!(positive, 3);
    for (i, from) in assemblies.iter().enumerate() {
        let (lengths, start) = rpr::at(&from.pose);
        let off = lengths.iter().zip(rpr::LENGTHS).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9);
        for to in &assemblies[i + 1..] {
            let ends = [&from.pose[..], &to.pose[..]];
            let found = find_path(&manipulator, mode, &aspects, ends, 10.0, &Progress::default());
            if start * rpr::at(&to.pose).1 < 0.0 {
                assert!(matches!(found, Err(NoPath::Apart { .. })), "{found:?}");
                continue;
            }
            let path = found.unwrap();
            let (first, last) = (&path.poses[0], path.poses.last().unwrap());
            assert_eq!(first, &from.pose);
            for (i, (a, b)) in last.iter().zip(&to.pose).enumerate() {
                let turns = if i == 2 { ((a - b) / (2.0 * PI)).round() } else { 0.0 };
                assert!((a - b - 2.0 * PI * turns).abs() < 1e-12);
            }
            // The motion that a table of these poses gives, far between its samples.
            let column = |i: usize| path.poses.iter().map(|pose| pose[i]).collect();
            let spline =
                Spline::new(path.times.clone(), (0..3).map(column).collect(), Ends::Rest).unwrap();
            let mut instant = Instant::new(3);
            for sample in 0..=20_000 {
                spline.at(path.times.last().unwrap() * f64::from(sample) / 20_000.0, &mut instant);
                let (lengths, determinant) = rpr::at(&instant.pose);
                assert!(determinant * start > 0.0, "{:?}", instant.pose);
                assert!(lengths.iter().all(|l| (0.005..=0.035).contains(l)), "{lengths:?}");
            }
        }
    }
}

/// Angles beyond the grid are the same poses, and the path begins where it was asked to.
#[test]
fn a_path_begins_at_its_start_after_full_turns() {
    let manipulator = shipped("planar-3rpr");
    let mode = manipulator.home_mode();
    let (_, aspects) = aspects_of(&manipulator, mode, planar(0.036, 21, PI, 21));
    let (home, to) = (manipulator.home_pose(), [-0.0134, -0.0066, -0.415]);
    for turns in [-2.0, 1.0] {
        let from = [home[0], home[1], home[2] + 2.0 * PI * turns];
        let ends = [&from[..], &to];
        let path =
            find_path(&manipulator, mode, &aspects, ends, 2.0, &Progress::default()).unwrap();
        assert_eq!((&path.poses[0][..], path.times[path.times.len() - 1]), (&from[..], 2.0));
        let off = (path.poses.last().unwrap()[2] - to[2]) / (2.0 * PI);
        assert!((off - off.round()).abs() < 1e-12 && off.abs() < 3.0, "{off}");
        let steps = path.poses.windows(2).map(|two| (two[0][2] - two[1][2]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.4);
    }
}

#[test]
fn a_path_from_nowhere_is_refused() {
    let manipulator = shipped("planar-3rpr");
    let mode = manipulator.home_mode();
    let (_, aspects) = aspects_of(&manipulator, mode, planar(0.036, 9, PI, 9));
    let home = manipulator.home_pose();
    let find = |ends: [&[f64]; 2], aspects: &Aspects| {
        find_path(&manipulator, mode, aspects, ends, 1.0, &Progress::default())
    };
    let far = [1.0, 0.0, 0.0];
    let error = find([&home, &far], &aspects).unwrap_err();
    let error = error.to_string();
    assert!(error.starts_with("the goal is beyond the limits of joints: S1 is 1 m"), "{error}");
    let error = find([&[f64::NAN, 0.0, 0.0], &home], &aspects).unwrap_err();
    assert!(error.to_string().starts_with("the start is no pose of this mechanism"), "{error}");
    let stopped = Progress::default();
    stopped.cancel();
    let found = find_path(&manipulator, mode, &aspects, [&home, &home], 1.0, &stopped);
    assert!(matches!(found, Err(NoPath::Cancelled(_))), "{found:?}");
}

/// At a constant orientation the singularities of a planar 3-RPR are a conic (J. Sefrioui, C. Gosselin, *On the quadratic
/// nature of the singularity curves of planar three-degree-of-freedom parallel manipulators*, 1995).
#[test]
fn singularity_curves_are_where_the_determinant_vanishes() {
    let manipulator = shipped("planar-3rpr");
    let mode = manipulator.home_mode();
    let axes = vec![
        Axis::new("x", -0.036, 0.036, 41),
        Axis::new("y", -0.036, 0.036, 37),
        Axis::new("theta", -1.0, 1.5, 6),
    ];
    let (set, _) = aspects_of(&manipulator, mode, axes);
    let curves = singular_curves(&manipulator, mode, &set, &Progress::default()).unwrap().unwrap();
    assert_eq!(curves.len(), 6);
    for curves in &curves {
        let slice = curves.slice.unwrap();
        let angle = set.axes()[2].axis.value(slice);
        assert!(!curves.lines.is_empty());
        let mut points: Vec<[f64; 2]> = curves.lines.iter().flatten().copied().collect();
        for &[x, y] in &points {
            assert!(rpr::at(&[x, y, angle]).1.abs() < 1e-10, "{x} {y} {angle}");
        }
        // One point on every step of the grid on which the sign changes, beside a cell that is all in reach.
        let sign = |i: u64, j: u64| {
            let point = set.point(slice * 41 * 37 + j * 41 + i);
            (i < 41 && j < 37).then(|| rpr::sign(&point)).flatten()
        };
        let cell = |i: u64, j: u64| {
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
                .iter()
                .all(|&(i, j)| sign(i, j).is_some())
        };
        let mut expected = 0;
        for (i, j) in (0..37).flat_map(|j| (0..41).map(move |i| (i, j))) {
            let right = cell(i, j) || j > 0 && cell(i, j - 1);
            let up = cell(i, j) || i > 0 && cell(i - 1, j);
            expected += usize::from(right && sign(i, j) != sign(i + 1, j));
            expected += usize::from(up && sign(i, j) != sign(i, j + 1));
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        assert_eq!(points.len(), expected, "{angle}");
        // The conic through all points: the smallest singular value of their monomials.
        let scaled = points.iter().map(|[x, y]| [x / 0.03, y / 0.03]);
        let rows: Vec<[f64; 6]> = scaled.map(|[x, y]| [x * x, x * y, y * y, x, y, 1.0]).collect();
        let mut square = Matrix6::zeros();
        for row in &rows {
            let row = SVector::<f64, 6>::from_row_slice(row);
            square += row * row.transpose();
        }
        let values = square.symmetric_eigenvalues();
        assert!(values.min().abs() < 1e-18_f64.max(1e-13 * values.max()), "{values}");
    }
}
