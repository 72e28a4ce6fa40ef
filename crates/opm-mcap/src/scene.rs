//! Bodies made of simple solids: a scene shows them, and points on their surfaces for viewers that show
//! points only.

use foxglove::messages::line_primitive::Type as LineType;
use foxglove::messages::{
    Color, CubePrimitive, CylinderPrimitive, KeyValuePair, LinePrimitive, Point3, Pose, Quaternion,
    SceneEntity, SceneUpdate, SpherePrimitive, TextPrimitive, Timestamp, Vector3,
};

use crate::cloud::{ColoredPoint, encode_colored};
use crate::{CloudLayout, RecordError};

/// A body of a mechanism, drawn in its own frame.
///
/// ```
/// use opm_mcap::{Body, Shape, Solid};
///
/// let shape = Shape::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 0.2], radius: 0.01 };
/// let solids = vec![Solid { shape, color: [0.2, 0.4, 0.8, 1.0] }];
/// let base = Body { frame: "base".into(), parent: None, solids: vec![], notes: vec![] };
/// let crank = Body { frame: "crank".into(), parent: Some(0), solids, notes: vec![] };
/// # let _ = [base, crank];
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The name of the body and of its frame, which no other body has.
    pub frame: String,
    /// The number of the body in whose frame this one is placed; `None` for the first body, which is at rest.
    pub parent: Option<usize>,
    /// The solids that it is drawn as.
    pub solids: Vec<Solid>,
    /// Further keys and values, which viewers show when the body is picked.
    pub notes: Vec<(String, String)>,
}

/// A solid of one colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// The shape with its place in the body's frame.
    pub shape: Shape,
    /// The colour: red, green, blue, opacity, from 0 to 1.
    pub color: [f64; 4],
}

/// A shape that viewers draw, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A round rod.
    Cylinder {
        /// The middle of one end, metres.
        from: [f64; 3],
        /// The middle of the other end, metres.
        to: [f64; 3],
        /// The radius, metres.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// The middle, metres.
        centre: [f64; 3],
        /// The radius, metres.
        radius: f64,
    },
    /// A block with a square cross-section.
    Block {
        /// The middle, metres.
        centre: [f64; 3],
        /// The direction of its length, a unit vector.
        axis: [f64; 3],
        /// The length, metres.
        length: f64,
        /// The length of its other two sides, metres.
        width: f64,
    },
}

/// The distance between points on a surface, as a share of the thinnest solid's radius: near enough for a rod
/// to look like one.
const SPACING: f64 = 0.8;

/// Most points of one body, so that a rod that is a million times longer than thick can still be shown.
const MOST_POINTS: usize = 200_000;

/// Checks that every body has a name of its own, and a parent that comes before it.
pub(crate) fn check(bodies: &[Body]) -> Result<(), RecordError> {
    for (i, body) in bodies.iter().enumerate() {
        let frame = &body.frame;
        if frame.is_empty() {
            return Err(RecordError::Layout("a body has no name".into()));
        }
        if bodies[..i].iter().any(|other| other.frame == *frame) {
            return Err(RecordError::Layout(format!("body {frame} is given twice")));
        }
        if body.parent.is_none() != (i == 0) || body.parent.is_some_and(|parent| parent >= i) {
            let problem = format!("body {frame}: its parent is not one of the bodies before it");
            return Err(RecordError::Layout(problem));
        }
    }
    Ok(())
}

/// Whether the bodies follow the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum State {
    /// They are where the motion wants them.
    Moves,
    /// The motion is out of reach, and they stay where they were.
    Stuck,
}

/// The colour that bodies turn to while they are stuck, and its share.
const STUCK: ([f64; 3], f64) = ([0.86, 0.15, 0.15], 0.7);

/// The colour of bodies that interfere.
const INTERFERING: [f64; 4] = [0.90, 0.05, 0.05, 1.0];

impl State {
    fn tint(self, color: [f64; 4]) -> [f64; 4] {
        let (to, share) = match self {
            Self::Moves => return color,
            Self::Stuck => STUCK,
        };
        let [r, g, b] = std::array::from_fn(|i| color[i] + share * (to[i] - color[i]));
        [r, g, b, color[3]]
    }
}

/// The colour of a body that is in a state, and interferes or does not.
fn tinted((state, interfering): (State, bool), color: [f64; 4]) -> [f64; 4] {
    if interfering { INTERFERING } else { state.tint(color) }
}

/// The scene: an entity a body, fixed to the body's frame. The bodies with these numbers interfere.
pub(crate) fn update(
    bodies: &[Body],
    (state, interfering): (State, &[usize]),
    time: Timestamp,
) -> SceneUpdate {
    let entities = bodies.iter().enumerate().map(|(number, body)| {
        let red = interfering.contains(&number);
        let note = |(key, value): &(String, String)| KeyValuePair {
            key: key.clone(),
            value: value.clone(),
        };
        let mut entity = SceneEntity {
            timestamp: Some(time),
            frame_id: body.frame.clone(),
            id: body.frame.clone(),
            frame_locked: true,
            metadata: body.notes.iter().map(note).collect(),
            ..SceneEntity::default()
        };
        for solid in &body.solids {
            let color = color(tinted((state, red), solid.color));
            match solid.shape {
                Shape::Cylinder { from, to, radius } => {
                    let (axis, length) = direction(from, to);
                    let middle = std::array::from_fn(|i| 0.5 * (from[i] + to[i]));
                    entity.cylinders.push(CylinderPrimitive {
                        pose: Some(along(middle, axis)),
                        size: Some(Vector3 { x: 2.0 * radius, y: 2.0 * radius, z: length }),
                        bottom_scale: 1.0,
                        top_scale: 1.0,
                        color,
                    });
                }
                Shape::Ball { centre, radius } => entity.spheres.push(SpherePrimitive {
                    pose: Some(along(centre, [0.0, 0.0, 1.0])),
                    size: Some(Vector3 { x: 2.0 * radius, y: 2.0 * radius, z: 2.0 * radius }),
                    color,
                }),
                Shape::Block { centre, axis, length, width } => {
                    entity.cubes.push(CubePrimitive {
                        pose: Some(along(centre, axis)),
                        size: Some(Vector3 { x: width, y: width, z: length }),
                        color,
                    });
                }
            }
        }
        entity
    });
    SceneUpdate { deletions: Vec::new(), entities: entities.collect() }
}

/// The points of a line, whose last point is joined to its first.
pub type ClosedLine = Vec<[f64; 3]>;

/// The width of a line, in pixels of a screen.
const LINE_PIXELS: f64 = 2.5;
/// The colour of lines: it is seen on dark and light backgrounds, and on every colour of points.
const LINE_COLOR: [f64; 4] = [0.9, 0.1, 0.4, 1.0];
/// Points on each side of a ring, so that they look like a line.
const DOTS: usize = 12;

/// The boundary of a set, which replaces the one before.
pub(crate) fn lines(frame_id: &str, time: Timestamp, rings: &[ClosedLine]) -> SceneUpdate {
    let ring = |ring: &ClosedLine| LinePrimitive {
        r#type: LineType::LineLoop as i32,
        pose: Some(along([0.0; 3], [0.0, 0.0, 1.0])),
        thickness: LINE_PIXELS,
        scale_invariant: true,
        points: ring.iter().map(|&[x, y, z]| Point3 { x, y, z }).collect(),
        color: color(LINE_COLOR),
        colors: vec![],
        indices: vec![],
    };
    let entity = SceneEntity {
        timestamp: Some(time),
        frame_id: frame_id.to_owned(),
        id: "boundary".to_owned(),
        lines: rings.iter().map(ring).collect(),
        ..SceneEntity::default()
    };
    SceneUpdate { deletions: Vec::new(), entities: vec![entity] }
}

/// The boundary of a set as points, for viewers that show points only: an encoded `foxglove.PointCloud`.
pub(crate) fn dots(
    frame_id: &str,
    time: Timestamp,
    rings: &[ClosedLine],
) -> Result<Vec<u8>, RecordError> {
    let rgba = LINE_COLOR.map(|c| (c * 255.0).round() as u8);
    let mut points = Vec::new();
    for ring in rings {
        for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            points.extend((0..DOTS).map(|i| {
                let share = i as f64 / DOTS as f64;
                let at = std::array::from_fn(|k| from[k] + share * (to[k] - from[k]));
                ColoredPoint { at, rgba }
            }));
        }
    }
    encode_colored(frame_id, time, &points)
}

/// The colour of the box round points and of its labels, and the height of these, pixels.
const BOX_COLOR: [f64; 4] = [0.55, 0.55, 0.55, 1.0];
const LABEL_PIXELS: f64 = 14.0;

/// A box round points, with the values of the axes at its ends: those before they were scaled.
pub(crate) fn labelled_box(
    layout: &CloudLayout,
    bounds: [[f64; 2]; 3],
    time: Timestamp,
) -> SceneUpdate {
    let corner = |bits: usize| -> [f64; 3] { std::array::from_fn(|i| bounds[i][bits >> i & 1]) };
    // Of the edges along an axis, each starts where that axis is at its low end.
    let edges = (0..3).flat_map(|i| {
        let starts = (0..8).filter(move |bits| bits >> i & 1 == 0);
        starts.flat_map(move |bits| [bits, bits | 1 << i])
    });
    let edges = LinePrimitive {
        r#type: LineType::LineList as i32,
        pose: Some(along([0.0; 3], [0.0, 0.0, 1.0])),
        thickness: 1.0,
        scale_invariant: true,
        points: edges.map(corner).map(|[x, y, z]| Point3 { x, y, z }).collect(),
        color: color(BOX_COLOR),
        colors: vec![],
        indices: vec![],
    };
    let labels = end_labels(bounds, |i| {
        (layout.axes[i].clone(), layout.units[i].to_owned(), layout.scale[i])
    });
    let labels = labels.into_iter().map(|(at, text)| TextPrimitive {
        pose: Some(along(at, [0.0, 0.0, 1.0])),
        billboard: true,
        font_size: LABEL_PIXELS,
        scale_invariant: true,
        color: color(BOX_COLOR),
        text,
    });
    let entity = SceneEntity {
        timestamp: Some(time),
        frame_id: layout.frame_id.clone(),
        id: "axes".to_owned(),
        lines: vec![edges],
        texts: labels.collect(),
        ..SceneEntity::default()
    };
    SceneUpdate { deletions: Vec::new(), entities: vec![entity] }
}

/// A value with its name and unit.
pub(crate) fn label(name: &str, value: f64, unit: &str) -> String {
    format!("{name} = {} {unit}", short(value))
}

/// Words about the slice that is shown, above a box round all points.
pub(crate) fn slice_label(
    frame_id: &str,
    bounds: [[f64; 2]; 3],
    text: &str,
    time: Timestamp,
) -> SceneUpdate {
    let [x, y, _] = bounds.map(|[low, high]| 0.5 * (low + high));
    let [low, high] = bounds[2];
    let z = high + BESIDE * (high - low);
    let text = TextPrimitive {
        pose: Some(along([x, y, z], [0.0, 0.0, 1.0])),
        billboard: true,
        font_size: LABEL_PIXELS,
        scale_invariant: true,
        color: color(BOX_COLOR),
        text: text.to_owned(),
    };
    let entity = SceneEntity {
        timestamp: Some(time),
        frame_id: frame_id.to_owned(),
        id: "slice".to_owned(),
        texts: vec![text],
        ..SceneEntity::default()
    };
    SceneUpdate { deletions: Vec::new(), entities: vec![entity] }
}

/// The distance of labels from the box, as a share of its extent.
const BESIDE: f64 = 0.12;

/// The values at the ends of the axes with their places: x in front of the box, y to its right, z to its left.
/// `axis` gives the name, the unit, and what the values were multiplied by; an axis without a unit has no labels.
pub(crate) fn end_labels(
    bounds: [[f64; 2]; 3],
    axis: impl Fn(usize) -> (String, String, f64),
) -> Vec<([f64; 3], String)> {
    // For each axis, whether the other two are at their high ends, and which of them moves the labels away from the box.
    const EDGES: [([usize; 3], usize); 3] = [([0, 0, 0], 1), ([1, 0, 0], 0), ([0, 0, 0], 0)];
    let mut labels = Vec::new();
    for (i, (at, away)) in EDGES.into_iter().enumerate() {
        let (name, unit, scale) = axis(i);
        let ends = match bounds[i] {
            _ if unit.is_empty() => continue,
            [low, high] if low < high => vec![low, high],
            [low, _] => vec![low],
        };
        for end in ends {
            let mut place: [f64; 3] = std::array::from_fn(|k| bounds[k][at[k]]);
            place[i] = end;
            let [low, high] = bounds[away];
            let outward = if at[away] == 1 { 1.0 } else { -1.0 };
            place[away] += outward * BESIDE * (high - low);
            labels.push((place, label(&name, end / scale, &unit)));
        }
    }
    labels
}

/// A value with three digits.
fn short(value: f64) -> String {
    let digits = 2.0 - value.abs().log10().floor();
    if !(0.0..=6.0).contains(&digits) {
        return if value == 0.0 { "0".to_owned() } else { format!("{value:.2e}") };
    }
    let text = format!("{value:.*}", digits as usize);
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A body's surface as an encoded `foxglove.PointCloud`.
pub(crate) fn surface(
    body: &Body,
    bodies: &[Body],
    look: (State, bool),
    time: Timestamp,
) -> Result<Vec<u8>, RecordError> {
    let radius = |solid: &Solid| match solid.shape {
        Shape::Cylinder { radius, .. } | Shape::Ball { radius, .. } => radius,
        Shape::Block { width, .. } => 0.5 * width,
    };
    let solids = bodies.iter().flat_map(|body| &body.solids);
    let thinnest = solids.map(radius).fold(f64::INFINITY, f64::min);
    let mut points = Vec::new();
    for solid in &body.solids {
        let rgba = tinted(look, solid.color).map(|c| (c * 255.0).round() as u8);
        cover(&solid.shape, SPACING * thinnest, &mut |at| {
            if points.len() < MOST_POINTS {
                points.push(ColoredPoint { at, rgba });
            }
        });
    }
    encode_colored(&body.frame, time, &points)
}

/// Points all over a surface.
fn cover(shape: &Shape, spacing: f64, point: &mut impl FnMut([f64; 3])) {
    let steps = |length: f64| ((length / spacing).ceil() as usize).clamp(1, MOST_POINTS);
    match *shape {
        Shape::Cylinder { from, to, radius } => {
            let (axis, length) = direction(from, to);
            let [u, v] = beside(axis);
            let around = steps(std::f64::consts::TAU * radius).max(6);
            let rings = steps(length);
            for ring in 0..=rings {
                let s = length * ring as f64 / rings as f64;
                for i in 0..around {
                    // Every other ring is rotated by half a step.
                    let angle = std::f64::consts::TAU * (i as f64 + 0.5 * (ring % 2) as f64)
                        / around as f64;
                    let (sin, cos) = angle.sin_cos();
                    point(std::array::from_fn(|k| {
                        from[k] + axis[k] * s + radius * (cos * u[k] + sin * v[k])
                    }));
                }
            }
        }
        Shape::Ball { centre, radius } => {
            // A spiral: each point has the same share of the sphere.
            let count = steps(4.0 * std::f64::consts::PI * radius * radius / spacing).max(12);
            let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
            for i in 0..count {
                let z = 1.0 - (2 * i + 1) as f64 / count as f64;
                let (sin, cos) = (golden * i as f64).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                let direction = [flat * cos, flat * sin, z];
                point(std::array::from_fn(|k| centre[k] + radius * direction[k]));
            }
        }
        Shape::Block { centre, axis, length, width } => {
            let [u, v] = beside(axis);
            let (long, wide) = (steps(length), steps(width));
            for i in 0..=long {
                let s = length * (i as f64 / long as f64 - 0.5);
                for j in 0..=wide {
                    for k in 0..=wide {
                        if i % long != 0 && j % wide != 0 && k % wide != 0 {
                            continue; // inside
                        }
                        let [a, b] = [j, k].map(|n| width * (n as f64 / wide as f64 - 0.5));
                        point(std::array::from_fn(|m| {
                            centre[m] + axis[m] * s + u[m] * a + v[m] * b
                        }));
                    }
                }
            }
        }
    }
}

fn color([r, g, b, a]: [f64; 4]) -> Option<Color> {
    Some(Color { r, g, b, a })
}

/// The unit vector from one point to another, and their distance.
fn direction(from: [f64; 3], to: [f64; 3]) -> ([f64; 3], f64) {
    let way: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { (way.map(|x| x / length), length) } else { ([0.0, 0.0, 1.0], 0.0) }
}

/// Two unit vectors that are perpendicular to a unit vector and to each other.
fn beside(axis: [f64; 3]) -> [[f64; 3]; 2] {
    let Quaternion { x, y, z, w } = upright(axis);
    // The first two columns of the rotation that takes z to the axis.
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
    ]
}

/// A pose whose third direction is `axis`.
fn along([x, y, z]: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose { position: Some(Vector3 { x, y, z }), orientation: Some(upright(axis)) }
}

/// The shortest rotation that takes z to a unit vector.
fn upright([x, y, z]: [f64; 3]) -> Quaternion {
    if z < -1.0 + 1e-12 {
        return Quaternion { x: 1.0, y: 0.0, z: 0.0, w: 0.0 };
    }
    // (1 + z·a, z × a), normalised.
    let scale = (2.0 * (1.0 + z)).sqrt();
    Quaternion { x: -y / scale, y: x / scale, z: 0.0, w: 0.5 * scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quaternion rotates z onto the unit vector: `v' = v + 2 w (q × v) + 2 q × (q × v)`.
    #[test]
    fn a_rod_points_from_end_to_end() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.48, 0.64, 0.6]] {
            let Quaternion { x, y, z, w } = upright(axis);
            let third = [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)];
            for k in 0..3 {
                assert!((third[k] - axis[k]).abs() < 1e-14, "{axis:?}: {third:?}");
            }
            let [u, v] = beside(axis);
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            for (value, expected) in
                [(dot(u, u), 1.0), (dot(v, v), 1.0), (dot(u, v), 0.0), (dot(u, axis), 0.0)]
            {
                assert!((value - expected).abs() < 1e-14, "{axis:?}");
            }
        }
    }

    #[test]
    fn points_lie_on_the_surface_and_cover_it() {
        let off = |shape: Shape, distance: &dyn Fn([f64; 3]) -> f64| {
            let mut count = 0;
            cover(&shape, 0.1, &mut |p| {
                count += 1;
                assert!(distance(p).abs() < 1e-12, "{shape:?}: {p:?}");
            });
            count
        };
        let rod = Shape::Cylinder { from: [1.0, 0.0, 0.0], to: [1.0, 0.0, 3.0], radius: 0.5 };
        let points = off(rod, &|[x, y, _]| (x - 1.0).hypot(y) - 0.5);
        // Its area over that of a square of the spacing.
        assert!((940..1100).contains(&points), "{points}");
        let ball = Shape::Ball { centre: [0.0, 2.0, 0.0], radius: 1.0 };
        let points = off(ball, &|[x, y, z]| (x * x + (y - 2.0) * (y - 2.0) + z * z).sqrt() - 1.0);
        assert!((1250..1265).contains(&points), "{points}");
        let block =
            Shape::Block { centre: [0.0; 3], axis: [1.0, 0.0, 0.0], length: 2.0, width: 1.0 };
        off(block, &|[x, y, z]| (x.abs() - 1.0).max(y.abs() - 0.5).max(z.abs() - 0.5));
    }

    #[test]
    fn bodies_make_a_tree() {
        let body = |frame: &str, parent| Body {
            frame: frame.into(),
            parent,
            solids: Vec::new(),
            notes: Vec::new(),
        };
        assert!(check(&[body("base", None), body("a", Some(0)), body("b", Some(1))]).is_ok());
        for wrong in [
            vec![body("base", Some(0))],
            vec![body("base", None), body("a", None)],
            vec![body("base", None), body("a", Some(2)), body("b", Some(0))],
            vec![body("base", None), body("base", Some(0))],
            vec![body("", None)],
        ] {
            assert!(matches!(check(&wrong), Err(RecordError::Layout(_))));
        }
    }
}
