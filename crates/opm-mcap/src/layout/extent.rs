//! The box that the bodies of a motion stay in.

use crate::trajectory::{BODIES_TOPIC, FRAMES_TOPIC};
use crate::{Message, ReadError};
use foxglove::Decode;
use foxglove::messages::{FrameTransforms, Quaternion, Vector3};
use std::collections::BTreeMap;

/// A box in space, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Extent {
    /// The box of one point.
    fn of(point: [f64; 3]) -> Self {
        Self { low: point, high: point }
    }

    fn add(&mut self, point: [f64; 3]) {
        for (i, value) in point.into_iter().enumerate() {
            self.low[i] = self.low[i].min(value);
            self.high[i] = self.high[i].max(value);
        }
    }

    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|i| 0.5 * (self.low[i] + self.high[i]))
    }

    /// Half of its diagonal; one, if it is a point.
    pub fn radius(&self) -> f64 {
        let square: f64 = (0..3).map(|i| (self.high[i] - self.low[i]).powi(2)).sum();
        let radius = 0.5 * square.sqrt();
        if radius > 0.0 { radius } else { 1.0 }
    }

    fn corners(&self) -> [[f64; 3]; 8] {
        let side = |corner: usize, i: usize| match corner >> i & 1 {
            0 => self.low[i],
            _ => self.high[i],
        };
        std::array::from_fn(|corner| std::array::from_fn(|i| side(corner, i)))
    }
}

/// The bodies of a motion: the box of each in its own frame, and the box of all of them wherever they have been.
#[derive(Default)]
pub struct Frames {
    bodies: BTreeMap<String, Extent>,
    root: Option<String>,
    all: Option<Extent>,
}

/// A place: rotation (rows), then translation.
type FramePlace = ([[f64; 3]; 3], [f64; 3]);

const AT_ROOT: FramePlace = ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);

impl Frames {
    pub fn add(&mut self, message: &Message<'_>) -> Result<(), ReadError> {
        if message.topic.starts_with(BODIES_TOPIC)
            && let Some(cloud) = message.cloud()?
        {
            let columns = ["x", "y", "z"].map(|name| cloud.column(name));
            if let [Some(x), Some(y), Some(z)] = columns {
                for point in x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]) {
                    let body = self.bodies.entry(cloud.frame_id.clone());
                    body.or_insert_with(|| Extent::of(point)).add(point);
                }
            }
        } else if message.topic == FRAMES_TOPIC {
            let frames = FrameTransforms::decode(message.data).map_err(|reason| {
                let what = format!("{} at {} ns", message.topic, message.time);
                ReadError::Malformed { what, reason: reason.to_string() }
            })?;
            self.place(&frames);
        }
        Ok(())
    }

    /// Extends the box of all bodies to where they are now. Parents come first.
    fn place(&mut self, frames: &FrameTransforms) {
        let mut places: BTreeMap<&str, FramePlace> = BTreeMap::new();
        for frame in &frames.transforms {
            let parent = *places.entry(&frame.parent_frame_id).or_insert(AT_ROOT);
            let rotation = frame.rotation.unwrap_or(Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 });
            let shift = frame.translation.unwrap_or(Vector3 { x: 0.0, y: 0.0, z: 0.0 });
            let turned = matrix(rotation);
            let own = std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).map(|k| parent.0[i][k] * turned[k][j]).sum())
            });
            let at = moved(parent, [shift.x, shift.y, shift.z]);
            places.insert(&frame.child_frame_id, (own, at));
        }
        if self.root.is_none() {
            self.root = frames.transforms.first().map(|first| first.parent_frame_id.clone());
        }
        for (name, place) in places {
            let Some(body) = self.bodies.get(name) else { continue };
            for point in body.corners().map(|corner| moved(place, corner)) {
                self.all.get_or_insert_with(|| Extent::of(point)).add(point);
            }
        }
    }

    /// The name of the frame at rest, and the box of all bodies in it; `None` without bodies.
    pub fn extent(&self) -> Option<(String, Extent)> {
        let extent = self.all.or_else(|| self.bodies.values().next().copied())?;
        let root = self.root.clone().or_else(|| self.bodies.keys().next().cloned())?;
        Some((root, extent))
    }
}

fn moved((rotation, shift): FramePlace, point: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| shift[i] + (0..3).map(|j| rotation[i][j] * point[j]).sum::<f64>())
}

/// The matrix of a unit quaternion.
fn matrix(Quaternion { x, y, z, w }: Quaternion) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
