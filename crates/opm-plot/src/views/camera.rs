//! From points in space to points of the picture.

use super::Point;
use crate::drawing::Rect;
use crate::frame::Frame;

/// The direction from which the perspective view is seen, before it is normalised.
const FROM: Point = [0.55, -1.0, 0.55];
/// The distance of the eye from the middle, in radii of the sphere that holds everything.
const DISTANCE: f64 = 4.0;

/// The share of the view that is filled, which leaves room for names.
const FILLED: f64 = 0.86;

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The point `a + s b`.
pub fn plus(a: Point, s: f64, b: Point) -> Point {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// The vector of length one in this direction; zero for zero.
pub fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    if length > 0.0 { a.map(|value| value / length) } else { a }
}

/// The place of a point of space in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The place, in pixels.
    pub at: [f64; 2],
    /// How near it is to the viewer: larger is nearer.
    pub near: f64,
    /// The pixels of a unit of length there.
    pub scale: f64,
}

/// The way in which space is seen.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    right: Point,
    up: Point,
    toward: Point,
    /// The point in the middle of the picture, and its place there.
    middle: Point,
    at: [f64; 2],
    /// The pixels of a unit of length at that point.
    scale: f64,
    /// The distance of the eye from that point; infinite for parallel rays.
    distance: f64,
}

impl Camera {
    /// The view along a coordinate axis: the coordinates of these numbers point right and up.
    pub fn along_axis([across, up]: [usize; 2], frame: &Frame<'_>) -> Self {
        let axis = |number: usize| std::array::from_fn(|i| f64::from(u8::from(i == number)));
        let ([x, x_end], y) = (frame.x.range, frame.y.range[0]);
        let (right, up_axis) = (axis(across), axis(up));
        Self {
            right,
            up: up_axis,
            toward: cross(right, up_axis),
            middle: std::array::from_fn(|i| match i {
                i if i == across => x,
                i if i == up => y,
                _ => 0.0,
            }),
            at: frame.at(x, y),
            scale: frame.place.width / (x_end - x),
            distance: f64::INFINITY,
        }
    }

    /// A view in perspective of everything in these ranges. It is as large as the corners of `boxes` allow.
    pub fn in_perspective(
        ranges: [[f64; 2]; 3],
        boxes: impl Iterator<Item = [[f64; 2]; 3]>,
        place: Rect,
    ) -> Self {
        let toward = unit(FROM);
        let right = unit(cross([0.0, 0.0, 1.0], toward));
        let half = ranges.map(|[low, high]| 0.5 * (high - low));
        let mut camera = Self {
            right,
            up: cross(toward, right),
            toward,
            middle: ranges.map(|[low, high]| 0.5 * (low + high)),
            at: [0.0; 2],
            scale: 1.0,
            distance: DISTANCE * dot(half, half).sqrt(),
        };
        let mut seen = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for corners in boxes {
            for number in 0..8_usize {
                let corner = std::array::from_fn(|i| corners[i][number >> i & 1]);
                for (range, value) in seen.iter_mut().zip(camera.see(corner).at) {
                    *range = [range[0].min(value), range[1].max(value)];
                }
            }
        }
        let sides = [place.width, place.height];
        let scale = |i: usize| FILLED * sides[i] / (seen[i][1] - seen[i][0]);
        camera.scale = scale(0).min(scale(1));
        let middle = [place.x + 0.5 * place.width, place.y + 0.5 * place.height];
        camera.at = [0, 1].map(|i| middle[i] - 0.5 * camera.scale * (seen[i][0] + seen[i][1]));
        camera
    }

    /// The place of a point.
    pub fn see(&self, point: Point) -> Seen {
        let from = plus(point, -1.0, self.middle);
        let near = dot(from, self.toward);
        let grown =
            if self.distance.is_finite() { self.distance / (self.distance - near) } else { 1.0 };
        let scale = self.scale * grown;
        let [right, up] = self.turned(from);
        Seen { at: [self.at[0] + scale * right, self.at[1] - scale * up], near, scale }
    }

    /// The components of a vector to the right and up.
    pub fn turned(&self, vector: Point) -> [f64; 2] {
        [dot(vector, self.right), dot(vector, self.up)]
    }

    /// The direction from a point to the viewer.
    pub fn ray(&self, point: Point) -> Point {
        if self.distance.is_infinite() {
            return self.toward;
        }
        let eye = plus(self.middle, self.distance, self.toward);
        unit(plus(eye, -1.0, point))
    }

    /// The direction to the light, behind the viewer's left shoulder.
    pub fn light(&self) -> Point {
        unit(plus(plus(self.toward, 0.8, self.up), -0.5, self.right))
    }
}
