//! A small drawing of a mechanism in characters: its legs and its platform at home, seen from the front above.

use nalgebra::{Point3, Vector3};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::JointKind;

/// The size of a drawing, characters.
pub const WIDTH: usize = 24;
const HEIGHT: usize = 8;

/// Dots of a character: Braille patterns have two columns of four.
const DOTS: [usize; 2] = [2, 4];

/// The first Braille pattern, which is empty.
const EMPTY: u32 = 0x2800;

/// Its lines, from the top.
pub fn lines(mechanism: &Mechanism) -> Vec<String> {
    let lines: Vec<Vec<Point3<f64>>> = drawn(mechanism);
    let flat = |p: &Point3<f64>| seen(p.coords);
    let all: Vec<[f64; 2]> = lines.iter().flatten().map(flat).collect();
    let range = |axis: usize| {
        let values = all.iter().map(|p| p[axis]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        (low, values.fold(f64::NEG_INFINITY, f64::max) - low)
    };
    let [(left, width), (bottom, height)] = [range(0), range(1)];
    let canvas = [WIDTH * DOTS[0] - 1, HEIGHT * DOTS[1] - 1];
    let scale = (canvas[0] as f64 / width.max(1e-9)).min(canvas[1] as f64 / height.max(1e-9));
    let margin = 0.5 * (canvas[0] as f64 - scale * width);
    let place = |p: &Point3<f64>| {
        let [x, y] = flat(p);
        [margin + scale * (x - left), scale * (bottom + height - y)]
    };
    let rows = ((scale * height) as usize / DOTS[1] + 1).min(HEIGHT);
    let mut dots = vec![0_u32; WIDTH * rows];
    for line in &lines {
        for pair in line.windows(2) {
            let [from, to] = [place(&pair[0]), place(&pair[1])];
            let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().max(1.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                let [x, y] = [0, 1].map(|axis| {
                    (from[axis] + share * (to[axis] - from[axis])).round().max(0.0) as usize
                });
                let (column, row) = ((x / DOTS[0]).min(WIDTH - 1), (y / DOTS[1]).min(rows - 1));
                // The bits of a pattern: three rows of two columns, then a fourth row.
                let bit = match (x % DOTS[0], y % DOTS[1]) {
                    (column, 3) => 6 + column,
                    (column, row) => row + 3 * column,
                };
                dots[row * WIDTH + column] |= 1 << bit;
            }
        }
    }
    let letter =
        |&dots: &u32| if dots == 0 { ' ' } else { char::from_u32(EMPTY + dots).unwrap_or(' ') };
    let text = |row: &[u32]| row.iter().map(letter).collect::<String>().trim_end().to_owned();
    dots.chunks(WIDTH).map(text).collect()
}

/// A point as it is seen: from the front, somewhat from the right and above. What is level is seen from above.
fn seen(p: Vector3<f64>) -> [f64; 2] {
    let (turn, tilt) = (20_f64.to_radians(), 25_f64.to_radians());
    let (x, depth) = (p.x * turn.cos() - p.y * turn.sin(), p.x * turn.sin() + p.y * turn.cos());
    [x, p.z * tilt.cos() + depth * tilt.sin()]
}

/// The lines of a drawing: each leg from base to platform, and the platform around the last joints.
fn drawn(mechanism: &Mechanism) -> Vec<Vec<Point3<f64>>> {
    let points: Vec<Point3<f64>> = mechanism.joints().map(|joint| joint.point).collect();
    let size = points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max);
    // Where all axes meet, joints are drawn on their axes, on a sphere, as arcs are.
    if size < 1e-9 {
        let leg = |leg: &opm_core::Leg| {
            arcs(&leg.joints.iter().map(|joint| *joint.axis).collect::<Vec<_>>())
        };
        let ends: Vec<Vector3<f64>> =
            mechanism.legs.iter().filter_map(|leg| Some(*leg.joints.last()?.axis)).collect();
        let mut lines: Vec<_> = mechanism.legs.iter().map(leg).collect();
        lines.push(closed(ends.into_iter().map(Point3::from).collect()));
        return lines;
    }
    let mut lines = Vec::new();
    let mut corners = Vec::new();
    for leg in &mechanism.legs {
        let mut line: Vec<Point3<f64>> = leg.joints.iter().map(|joint| joint.point).collect();
        let first = &leg.joints[0];
        if first.kind == JointKind::Prismatic {
            // A rail.
            let half = *first.axis * (0.2 * size);
            lines.push(vec![line[0] - half, line[0] + half]);
        }
        corners.extend(line.last().copied());
        if leg.joints.last().is_some_and(|joint| joint.kind == JointKind::Prismatic) {
            line.push(mechanism.platform);
        }
        lines.push(line);
    }
    corners.dedup();
    if corners.iter().all(|corner| (corner - corners[0]).norm() < 1e-9 * size) {
        corners.push(mechanism.platform);
    }
    lines.push(closed(corners));
    lines
}

fn closed(mut corners: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    corners.extend(corners.first().copied());
    corners
}

/// Arcs of a sphere between directions.
fn arcs(directions: &[Vector3<f64>]) -> Vec<Point3<f64>> {
    const PARTS: usize = 12;
    let arc = |pair: &[Vector3<f64>]| -> Vec<Point3<f64>> {
        let chord = |part: usize| pair[0].lerp(&pair[1], part as f64 / PARTS as f64);
        let on_sphere = |v: Vector3<f64>| v.try_normalize(1e-6).unwrap_or(pair[0]);
        (0..=PARTS).map(|part| Point3::from(on_sphere(chord(part)))).collect()
    };
    directions.windows(2).flat_map(arc).collect()
}
