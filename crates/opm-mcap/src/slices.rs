//! What the slices of a workspace are: the values at which the coordinates that are the same within a slice are held.

use crate::joints::fields;
use crate::scene::label;
use crate::{Message, ReadError, RecordError};

/// The topic that tells which slice is shown.
pub const SLICE_TOPIC: &str = "/workspace/slice";
/// The fields of its messages beside the coordinates: the number of the slice, the number of its points so far, and their area.
const NUMBER: &str = "slice";
const COUNT: &str = "count";
const AREA: &str = "area";

/// A coordinate that is held within a slice.
#[derive(Debug, Clone, PartialEq)]
pub struct SliceAxis {
    /// The name of the coordinate.
    pub name: String,
    /// Its SI unit.
    pub unit: &'static str,
    /// The first and the last of its values, which are equally spaced.
    pub ends: [f64; 2],
    /// The number of its values.
    pub count: u64,
}

impl SliceAxis {
    fn value(&self, i: u64) -> f64 {
        let [first, last] = self.ends;
        match i {
            0 => first,
            i if i + 1 >= self.count => last,
            i => first + (last - first) * (i as f64 / (self.count - 1) as f64),
        }
    }
}

/// The slices of a workspace: one for each combination of the values of their coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Slices {
    /// The coordinates, the one that changes from slice to slice first.
    pub axes: Vec<SliceAxis>,
    /// The area that a point stands for: the product of the extents of the coordinates that vary within a slice, over the
    /// number of points that a slice may have. SI.
    pub point_area: f64,
}

impl Slices {
    /// The number of slices.
    pub fn count(&self) -> u64 {
        self.axes.iter().fold(1, |count: u64, axis| count.saturating_mul(axis.count))
    }

    /// The values of the coordinates in a slice.
    pub fn at(&self, mut slice: u64) -> Vec<f64> {
        let values = self.axes.iter().map(|axis| {
            let value = axis.value(slice % axis.count);
            slice /= axis.count;
            value
        });
        values.collect()
    }

    /// The names of the values of [`Self::row`].
    pub(crate) fn names(&self) -> Result<Vec<String>, RecordError> {
        let coordinates = self.axes.iter().map(|axis| axis.name.clone());
        let names = [NUMBER.to_owned()].into_iter().chain(coordinates);
        fields(&names.chain([COUNT, AREA].map(str::to_owned)).collect::<Vec<_>>())
    }

    /// A slice in words.
    pub(crate) fn words(&self, slice: u64, points: u64) -> String {
        let held = self.axes.iter().zip(self.at(slice));
        let held: Vec<String> =
            held.map(|(axis, value)| label(&axis.name, value, axis.unit)).collect();
        format!("{}: {points} points", held.join(", "))
    }

    /// The values of a message of [`SLICE_TOPIC`].
    pub(crate) fn row(&self, slice: u64, points: u64) -> Vec<f64> {
        let mut row = vec![slice as f64];
        row.extend(self.at(slice));
        row.extend([points as f64, points as f64 * self.point_area]);
        row
    }
}

/// Follows the slices of a recording that is read.
///
/// Each message of points comes after one that says which slice it belongs to.
#[derive(Debug, Clone, Default)]
pub struct SliceReader {
    now: Option<u64>,
    values: Vec<f64>,
}

impl SliceReader {
    /// The number of the slice that the points at this message belong to; `None` before the first.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if the message is not what its schema says.
    pub fn slice(&mut self, message: &Message<'_>) -> Result<Option<u64>, ReadError> {
        if message.topic == SLICE_TOPIC && message.values(&mut self.values)? {
            let names = message.flat.map(|flat| &*flat.names).unwrap_or_default();
            let number = names.iter().position(|name| name == NUMBER);
            // A cast saturates; a number that is none is slice zero.
            self.now = number.map(|i| self.values[i] as u64);
        }
        Ok(self.now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_count_like_a_clock() {
        let axis =
            |name: &str, ends, count| SliceAxis { name: name.to_owned(), unit: "rad", ends, count };
        let axes =
            vec![axis("zeta", [0.0, 2.0], 3), axis("xi", [-1.0, 1.0], 2), axis("psi", [5.0; 2], 1)];
        let slices = Slices { axes, point_area: 0.5 };
        assert_eq!(slices.count(), 6);
        assert_eq!(slices.at(0), [0.0, -1.0, 5.0]);
        assert_eq!(slices.at(2), [2.0, -1.0, 5.0]);
        assert_eq!(slices.at(4), [1.0, 1.0, 5.0]);
        assert_eq!(slices.row(4, 3), [4.0, 1.0, 1.0, 5.0, 3.0, 1.5]);
        assert_eq!(slices.names().unwrap(), ["slice", "zeta", "xi", "psi", "count", "area"]);
        let whole = Slices { axes: vec![], point_area: 1.0 };
        assert_eq!((whole.count(), whole.at(0)), (1, vec![]));
    }
}
