//! Solids as shapes: cut into pieces, which are drawn from the farthest to the nearest.

use super::camera::{Camera, Seen, cross, dot, plus, unit};
use super::{Body, Point};
use crate::color::Color;
use crate::drawing::{Path, Pen, Shape};
use std::f64::consts::TAU;

/// The number of corners of a circle.
const CORNERS: usize = 28;
/// The length of the pieces of a rod, in pixels, and the most pieces.
const PIECE: f64 = 14.0;
const MOST_PIECES: f64 = 60.0;
/// The width of outlines, in pixels.
const OUTLINE: f64 = 0.9;
/// The shades of an outline and of a highlight.
const DARK: f64 = -0.45;
const BRIGHT: f64 = 0.35;

/// A piece of a solid.
struct Piece {
    near: f64,
    shapes: Vec<Shape>,
}

/// The shapes of solids.
pub fn solids(bodies: &[(Body, Color)], camera: &Camera) -> Vec<Shape> {
    let mut pieces = Vec::new();
    for &(body, color) in bodies {
        match body {
            Body::Rod { from, to, radius } => rod(&mut pieces, camera, [from, to], radius, color),
            Body::Ball { centre, radius } => pieces.push(ball(camera, centre, radius, color)),
            Body::Block { centre, axis, length, width } => {
                pieces.push(block(camera, centre, axis, [length, width], color));
            }
        }
    }
    pieces.sort_by(|a, b| a.near.total_cmp(&b.near));
    pieces.into_iter().flat_map(|piece| piece.shapes).collect()
}

/// A colour that is darker, down to -1, or brighter, up to 1.
fn shade(color: Color, by: f64) -> Color {
    let end = if by < 0.0 { 0.0 } else { 255.0 };
    color.map(|value| (f64::from(value) + by.abs() * (end - f64::from(value))).round() as u8)
}

/// The colour of a surface with this normal.
fn lit(camera: &Camera, normal: Point, color: Color) -> Color {
    shade(color, 0.55 * (dot(normal, camera.light()) - 0.65).clamp(-1.0, 0.4))
}

fn outlined(path: &Path, color: Color, line: Color) -> [Shape; 2] {
    [Shape::Area(path.clone(), color), Shape::Line(path.clone(), Pen::new(line, OUTLINE))]
}

fn closed(points: impl IntoIterator<Item = [f64; 2]>) -> Path {
    let mut path = Path::through(points);
    path.0.push(crate::drawing::Step::Close);
    path
}

/// Two directions that are at right angles to a unit vector and to each other.
fn across(axis: Point) -> [Point; 2] {
    let other = if axis[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let first = unit(cross(axis, other));
    [first, cross(axis, first)]
}

fn rod(pieces: &mut Vec<Piece>, camera: &Camera, ends: [Point; 2], radius: f64, color: Color) {
    let axis = unit(plus(ends[1], -1.0, ends[0]));
    let seen = ends.map(|end| camera.see(end));
    let [from, to] = seen.map(|seen| seen.at);
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let count = (length / PIECE).ceil().clamp(1.0, MOST_PIECES) as usize;
    let dark = shade(color, DARK);
    for (end, outward) in [(ends[0], -1.0), (ends[1], 1.0)] {
        // The end that is turned away shows its rim alone, behind the rest.
        let normal = axis.map(|value| outward * value);
        let faces = dot(normal, camera.ray(end)) > 0.0;
        let rim = closed(disc(camera, end, axis, radius));
        let fill = if faces { lit(camera, normal, color) } else { shade(color, 0.5 * DARK) };
        let near = camera.see(end).near + if faces { 1e-3 } else { -1e-3 } * radius;
        pieces.push(Piece { near, shapes: outlined(&rim, fill, dark).into() });
    }
    for number in 0..count {
        let at = |i: usize| {
            camera.see(plus(ends[0], i as f64 / count as f64, plus(ends[1], -1.0, ends[0])))
        };
        let [a, b] = [at(number), at(number + 1)];
        if let Some(shapes) = tube([a, b], radius, color) {
            pieces.push(Piece { near: 0.5 * (a.near + b.near), shapes });
        }
    }
}

/// The side of a piece of a rod: its dark edges, its colour, and a stripe of light. There is none if the rod is seen
/// from its end.
fn tube([a, b]: [Seen; 2], radius: f64, color: Color) -> Option<Vec<Shape>> {
    let along = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
    let length = along[0].hypot(along[1]);
    if length < 1e-6 {
        return None;
    }
    let along = along.map(|value| value / length);
    // The light comes from the upper left.
    let mut side = [-along[1], along[0]];
    if side[0] + side[1] > 0.0 {
        side = side.map(|value| -value);
    }
    // Neighbours overlap, so that no gap is seen between them.
    let over = 0.3_f64.min(0.5 * length);
    let strip = |inner: f64, outer: f64, less: f64| {
        let point = |seen: Seen, share: f64, along_by: f64| {
            let off = share * radius * seen.scale - less * share.signum();
            [0, 1].map(|i| seen.at[i] + off * side[i] + along_by * along[i])
        };
        closed([
            point(a, inner, -over),
            point(b, inner, over),
            point(b, outer, over),
            point(a, outer, -over),
        ])
    };
    let mut shapes = vec![Shape::Area(strip(-1.0, 1.0, 0.0), shade(color, DARK))];
    if radius * a.scale.min(b.scale) > OUTLINE {
        shapes.push(Shape::Area(strip(-1.0, 1.0, OUTLINE), color));
        if radius * a.scale > 3.0 * OUTLINE {
            shapes.push(Shape::Area(strip(0.15, 0.55, 0.0), shade(color, BRIGHT)));
        }
    }
    Some(shapes)
}

/// The corners of a disc.
fn disc(
    camera: &Camera,
    centre: Point,
    axis: Point,
    radius: f64,
) -> impl Iterator<Item = [f64; 2]> {
    let [u, w] = across(axis);
    (0..CORNERS).map(move |i| {
        let (sin, cos) = (TAU * i as f64 / CORNERS as f64).sin_cos();
        camera.see(plus(plus(centre, radius * cos, u), radius * sin, w)).at
    })
}

fn ball(camera: &Camera, centre: Point, radius: f64, color: Color) -> Piece {
    let seen = camera.see(centre);
    let circle = |share: f64, shift: f64| {
        let size = radius * seen.scale;
        closed((0..CORNERS).map(|i| {
            let (sin, cos) = (TAU * i as f64 / CORNERS as f64).sin_cos();
            let at = |place: f64, part: f64| place + size * (share * part - shift);
            [at(seen.at[0], cos), at(seen.at[1], sin)]
        }))
    };
    let mut shapes: Vec<Shape> = outlined(&circle(1.0, 0.0), color, shade(color, DARK)).into();
    shapes.push(Shape::Area(circle(0.35, 0.3), shade(color, BRIGHT)));
    Piece { near: seen.near, shapes }
}

fn block(
    camera: &Camera,
    centre: Point,
    axis: Point,
    [length, width]: [f64; 2],
    color: Color,
) -> Piece {
    let [u, w] = across(axis);
    let sides = [(axis, 0.5 * length), (u, 0.5 * width), (w, 0.5 * width)];
    let mut shapes = Vec::new();
    for (number, (normal, half)) in sides.into_iter().enumerate() {
        let [(b, b_half), (c, c_half)] = [sides[(number + 1) % 3], sides[(number + 2) % 3]];
        for sign in [-1.0, 1.0] {
            let normal = normal.map(|value| sign * value);
            let middle = plus(centre, half, normal);
            if dot(normal, camera.ray(middle)) <= 1e-9 {
                continue;
            }
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let path = closed(
                corners
                    .map(|(s, t)| camera.see(plus(plus(middle, s * b_half, b), t * c_half, c)).at),
            );
            shapes.extend(outlined(&path, lit(camera, normal, color), shade(color, DARK)));
        }
    }
    Piece { near: camera.see(centre).near, shapes }
}
