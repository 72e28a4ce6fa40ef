//! Solids as shapes: cut into pieces, which are drawn from the farthest to the nearest.

use super::camera::{Camera, Seen, cross, dot, plus, unit};
use super::{Body, Point};
use crate::color::Color;
use crate::drawing::{Path, Pen, Shape, Step};
use std::f64::consts::{PI, TAU};

/// How far the corners of a circle are from its sides at most, in pixels, and their numbers.
const ROUND: f64 = 0.08;
const CORNERS: [f64; 2] = [8.0, 40.0];
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
    /// The part of a rod's side that it is, if it is one.
    part: Option<Part>,
}

/// A part of the side of a rod, between two of the ends of its pieces.
#[derive(Clone, Copy)]
struct Part {
    rod: usize,
    from: usize,
    to: usize,
}

/// The pieces of solids, the farthest first.
fn pieces(bodies: &[(Body, Color)], camera: &Camera) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (number, &(body, color)) in bodies.iter().enumerate() {
        match body {
            Body::Rod { from, to, radius } => {
                rod(&mut pieces, camera, [from, to], radius, (number, color));
            }
            Body::Ball { centre, radius } => pieces.push(ball(camera, centre, radius, color)),
            Body::Block { centre, axis, length, width } => {
                pieces.push(block(camera, centre, axis, [length, width], color));
            }
        }
    }
    pieces.sort_by(|a, b| a.near.total_cmp(&b.near));
    pieces
}

/// The shapes of solids.
pub fn solids(bodies: &[(Body, Color)], camera: &Camera) -> Vec<Shape> {
    joined(pieces(bodies, camera), |part| match bodies[part.rod] {
        (Body::Rod { from, to, radius }, color) => {
            let count = count(camera, [from, to]);
            let ends = [part.from, part.to].map(|i| along(camera, [from, to], i, count));
            tube(ends, radius, color).unwrap_or_default()
        }
        _ => Vec::new(),
    })
}

/// The shapes of pieces, the farthest first. Neighbours of a rod become one piece where nothing that is drawn between them is
/// over the second: it is drawn with the first then.
fn joined(pieces: Vec<Piece>, side: impl Fn(Part) -> Vec<Shape>) -> Vec<Shape> {
    /// Pieces that are drawn together, and the boxes around each.
    struct Group {
        piece: Piece,
        parts: usize,
        boxes: Vec<[[f64; 2]; 2]>,
    }
    let mut groups: Vec<Group> = Vec::new();
    for piece in pieces {
        let around = bounds(&piece.shapes);
        let mut before = None;
        for (number, group) in groups.iter().enumerate().rev() {
            let follows = group.piece.part.zip(piece.part).is_some_and(|(one, other)| {
                one.rod == other.rod && (one.to == other.from || other.to == one.from)
            });
            if follows {
                before = Some(number);
                break;
            }
            if piece.part.is_none() || group.boxes.iter().any(|b| overlap(b, &around)) {
                break;
            }
        }
        match (before.map(|number| &mut groups[number]), piece.part) {
            (Some(group), Some(part)) => {
                if let Some(known) = &mut group.piece.part {
                    known.from = known.from.min(part.from);
                    known.to = known.to.max(part.to);
                }
                group.parts += 1;
                group.boxes.push(around);
            }
            _ => groups.push(Group { piece, parts: 1, boxes: vec![around] }),
        }
    }
    let shapes = groups.into_iter().flat_map(|group| match group.piece.part {
        Some(part) if group.parts > 1 => side(part),
        _ => group.piece.shapes,
    });
    shapes.collect()
}

/// The box around shapes with their outlines: its least and its largest corner.
fn bounds(shapes: &[Shape]) -> [[f64; 2]; 2] {
    let mut found = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let paths = shapes.iter().filter_map(|shape| match shape {
        Shape::Area(path, _) | Shape::Line(path, _) => Some(path),
        _ => None,
    });
    for step in paths.flat_map(|path| &path.0) {
        if let Step::Move(at) | Step::Line(at) = step {
            for i in 0..2 {
                found[0][i] = found[0][i].min(at[i] - OUTLINE);
                found[1][i] = found[1][i].max(at[i] + OUTLINE);
            }
        }
    }
    found
}

fn overlap(one: &[[f64; 2]; 2], other: &[[f64; 2]; 2]) -> bool {
    (0..2).all(|i| one[0][i] < other[1][i] && other[0][i] < one[1][i])
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
    path.0.push(Step::Close);
    path
}

/// Two directions that are at right angles to a unit vector and to each other.
fn across(axis: Point) -> [Point; 2] {
    let other = if axis[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let first = unit(cross(axis, other));
    [first, cross(axis, first)]
}

/// The number of pieces of a rod.
fn count(camera: &Camera, ends: [Point; 2]) -> usize {
    let [from, to] = ends.map(|end| camera.see(end).at);
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    (length / PIECE).ceil().clamp(1.0, MOST_PIECES) as usize
}

/// The end of one of the pieces of a rod.
fn along(camera: &Camera, ends: [Point; 2], number: usize, count: usize) -> Seen {
    let way = plus(ends[1], -1.0, ends[0]);
    camera.see(plus(ends[0], number as f64 / count as f64, way))
}

fn rod(
    pieces: &mut Vec<Piece>,
    camera: &Camera,
    ends: [Point; 2],
    radius: f64,
    (number, color): (usize, Color),
) {
    let axis = unit(plus(ends[1], -1.0, ends[0]));
    let count = count(camera, ends);
    let dark = shade(color, DARK);
    for (end, outward) in [(ends[0], -1.0), (ends[1], 1.0)] {
        // The end that is turned away shows its rim alone, behind the rest.
        let normal = axis.map(|value| outward * value);
        let faces = dot(normal, camera.ray(end)) > 0.0;
        let rim = closed(disc(camera, end, axis, radius));
        let fill = if faces { lit(camera, normal, color) } else { shade(color, 0.5 * DARK) };
        let near = camera.see(end).near + if faces { 1e-3 } else { -1e-3 } * radius;
        pieces.push(Piece { near, shapes: outlined(&rim, fill, dark).into(), part: None });
    }
    for from in 0..count {
        let [a, b] = [from, from + 1].map(|i| along(camera, ends, i, count));
        if let Some(shapes) = tube([a, b], radius, color) {
            let part = Some(Part { rod: number, from, to: from + 1 });
            pieces.push(Piece { near: 0.5 * (a.near + b.near), shapes, part });
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

/// The number of corners of a circle of this radius, in pixels: with n of them, its sides are radius (1 - cos(pi / n)) away from
/// it.
fn corners(radius: f64) -> usize {
    let half = (1.0 - ROUND / radius.max(ROUND)).acos();
    (PI / half).clamp(CORNERS[0], CORNERS[1]).ceil() as usize
}

/// The corners of a disc.
fn disc(
    camera: &Camera,
    centre: Point,
    axis: Point,
    radius: f64,
) -> impl Iterator<Item = [f64; 2]> {
    let [u, w] = across(axis);
    let corners = corners(radius * camera.see(centre).scale);
    (0..corners).map(move |i| {
        let (sin, cos) = (TAU * i as f64 / corners as f64).sin_cos();
        camera.see(plus(plus(centre, radius * cos, u), radius * sin, w)).at
    })
}

fn ball(camera: &Camera, centre: Point, radius: f64, color: Color) -> Piece {
    let seen = camera.see(centre);
    let circle = |share: f64, shift: f64| {
        let size = radius * seen.scale;
        let corners = corners(share * size);
        closed((0..corners).map(|i| {
            let (sin, cos) = (TAU * i as f64 / corners as f64).sin_cos();
            let at = |place: f64, part: f64| place + size * (share * part - shift);
            [at(seen.at[0], cos), at(seen.at[1], sin)]
        }))
    };
    let mut shapes: Vec<Shape> = outlined(&circle(1.0, 0.0), color, shade(color, DARK)).into();
    shapes.push(Shape::Area(circle(0.35, 0.3), shade(color, BRIGHT)));
    Piece { near: seen.near, shapes, part: None }
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
    Piece { near: camera.see(centre).near, shapes, part: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Drawing, Rect, Size};

    /// Rods that lie over each other in turn, a rod with a block and a ball on it, and a bundle.
    fn scene() -> Vec<(Body, Color)> {
        let rod = |from, to| Body::Rod { from, to, radius: 4.0 };
        let mut bodies = vec![
            rod([-50.0, -20.0, -8.0], [50.0, -20.0, 8.0]),
            rod([30.0, -50.0, -8.0], [0.0, 50.0, 8.0]),
            rod([30.0, 50.0, -8.0], [-30.0, -50.0, 8.0]),
            rod([-60.0, 40.0, -40.0], [60.0, 45.0, 40.0]),
            Body::Ball { centre: [10.0, 42.0, 8.0], radius: 9.0 },
            Body::Block {
                centre: [-20.0, 41.0, -13.0],
                axis: [1.0, 0.0, 0.0],
                length: 20.0,
                width: 16.0,
            },
        ];
        bodies.extend((0..8).map(|i| {
            let turn = TAU * f64::from(i) / 8.0;
            rod(
                [70.0 * turn.cos(), 70.0 * turn.sin(), -60.0],
                [-60.0 * turn.sin(), 60.0 * turn.cos(), 60.0],
            )
        }));
        (0..).zip(bodies).map(|(i, body)| (body, [40 + 14 * i, 200 - 12 * i, 90])).collect()
    }

    /// Pieces that are drawn as one look as if each were drawn by itself, from any side.
    #[test]
    fn joined_rods_look_the_same() {
        let place = Rect { x: 0.0, y: 0.0, width: 400.0, height: 400.0 };
        let bodies = scene();
        let box_of = std::iter::once([[-80.0, 80.0]; 3]);
        let camera = Camera::in_perspective([[-80.0, 80.0]; 3], box_of, place);
        let plain: Vec<Shape> =
            pieces(&bodies, &camera).into_iter().flat_map(|piece| piece.shapes).collect();
        let joined = solids(&bodies, &camera);
        assert!(3 * joined.len() < 2 * plain.len(), "{} of {}", joined.len(), plain.len());
        let [plain, joined] = [plain, joined].map(|shapes| {
            let size = Size { width: 400.0, height: 400.0 };
            let bytes = Drawing { size, title: String::new(), shapes }.to_png().expect("a PNG");
            let mut reader =
                png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
            let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut pixels).expect("a whole PNG");
            pixels
        });
        let drawn = plain.iter().filter(|value| **value < 250).count();
        // Where pieces met, edges that are smoothed twice are a little darker.
        let differ = plain.iter().zip(&joined).filter(|(a, b)| a.abs_diff(**b) > 40).count();
        assert!(drawn > 50_000 && 500 * differ < drawn, "{differ} of {drawn}");
    }

    #[test]
    fn circles_are_round() {
        for radius in [0.5, 3.0, 20.0, 60.0] {
            let corners = corners(radius);
            assert!((8..=40).contains(&corners));
            let off = radius * (1.0 - (PI / corners as f64).cos());
            assert!(off <= ROUND || corners == 40, "{radius}: {off}");
        }
    }
}
