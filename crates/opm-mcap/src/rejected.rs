//! Points that are not in a workspace, coloured by what rejects them.

use crate::cloud::CloudEncoder;
use crate::{CloudLayout, Metadata, RecordError};

/// The topic of the points that are rejected.
pub const REJECTED_TOPIC: &str = "/workspace/rejected";
/// The name of the metadata record that tells what they are.
pub const REJECTED_RECORD: &str = "rejected";
/// The scalar with the number of the cause.
pub const CAUSE: &str = "cause";
/// The scalar with the number of the slice that a point is in.
pub const SLICE: &str = "slice";
/// Most causes that have a colour and a number of their own.
pub const MAX_CAUSES: usize = 255;

/// What rejects points, in words, with its colour: red, green, blue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RejectedCause {
    /// The number that points have as [`CAUSE`].
    pub number: usize,
    /// What it is.
    pub text: String,
    /// The colour of its points.
    pub color: [u8; 3],
}

impl RejectedCause {
    /// The causes of a recording, by its record [`REJECTED_RECORD`], ascending. Those that cannot be read are left out.
    pub fn read(record: &Metadata) -> Vec<Self> {
        let cause = |(key, value): (&String, &String)| {
            let number = key.strip_prefix(CAUSE)?.strip_prefix('.')?.parse().ok()?;
            let (color, text) = value.split_once(' ')?;
            let channel = |i: usize| u8::from_str_radix(color.get(2 * i + 1..2 * i + 3)?, 16).ok();
            let color = [channel(0)?, channel(1)?, channel(2)?];
            Some(Self { number, text: text.to_owned(), color })
        };
        let mut causes: Vec<Self> = record.iter().filter_map(cause).collect();
        causes.sort_by_key(|cause| cause.number);
        causes
    }
}

/// Points that are rejected, for [`WorkspaceRecorder::rejected`](crate::WorkspaceRecorder::rejected).
///
/// ```
/// use opm_mcap::{CloudLayout, RejectedPoints};
///
/// # fn main() -> Result<(), opm_mcap::RecordError> {
/// let layout = CloudLayout {
///     axes: ["x", "y", "z"].map(String::from),
///     scalars: vec!["slice".into(), "cause".into()],
///     color: "cause".into(),
///     color_range: [0.0, 0.0], // that of the numbers of the colours
///     frame_id: "task".into(),
///     scale: [1.0; 3],
///     units: ["m"; 3],
/// };
/// let colors = [[120, 120, 120], [0, 114, 178]];
/// let mut points = RejectedPoints::new(&layout, 100, &colors)?;
/// points.push(&[0.1, 0.2, 0.0, 0.0, 1.0])?; // blue, in slice 0
/// # Ok(())
/// # }
/// ```
pub struct RejectedPoints {
    pub(crate) encoder: CloudEncoder,
}

impl RejectedPoints {
    /// No points, with room for `capacity` of them. The colour of a point is the one whose number is the value that the
    /// layout names as its colour.
    ///
    /// # Errors
    /// [`RecordError::Layout`] for a layout that contradicts itself, or without colours.
    pub fn new(
        layout: &CloudLayout,
        capacity: usize,
        colors: &[[u8; 3]],
    ) -> Result<Self, RecordError> {
        if !(1..=MAX_CAUSES + 1).contains(&colors.len()) {
            let problem = format!("{} colours, expected 1 to {}", colors.len(), MAX_CAUSES + 1);
            return Err(RecordError::Layout(problem));
        }
        // The number of a colour is in the middle of its part of the range.
        let color_range = [-0.5, colors.len() as f64 - 0.5];
        let layout = CloudLayout { color_range, ..layout.clone() };
        let mut encoder = CloudEncoder::new(&layout, capacity)?;
        encoder.paint(colors);
        Ok(Self { encoder })
    }

    /// Adds points, as rows of [`CloudLayout::columns`].
    ///
    /// # Errors
    /// Points that do not fit the layout ([`RecordError::Row`]) or are not finite ([`RecordError::NonFinite`]).
    pub fn push(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        self.encoder.push(rows)
    }

    /// The number of points so far.
    pub fn len(&self) -> usize {
        self.encoder.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The record that tells what the points are: one of `every` of all that are rejected.
pub(crate) fn describe(causes: &[RejectedCause], points: usize, every: u64) -> Metadata {
    let mut record: Metadata = causes
        .iter()
        .map(|RejectedCause { number, text, color: [r, g, b] }| {
            (format!("{CAUSE}.{number}"), format!("#{r:02x}{g:02x}{b:02x} {text}"))
        })
        .collect();
    record.insert("points".to_owned(), points.to_string());
    record.insert("every".to_owned(), every.to_string());
    record
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_read_back() {
        let causes: Vec<RejectedCause> = [(0, "several causes"), (11, "leg2: S2 above its limit")]
            .map(|(number, text)| RejectedCause {
                number,
                text: text.to_owned(),
                color: [number as u8, 0xd5, 0],
            })
            .into();
        let mut record = describe(&causes, 7, 1);
        assert_eq!(RejectedCause::read(&record), causes);
        record.insert("cause.x".to_owned(), "#000000 none".to_owned());
        record.insert("cause.3".to_owned(), "black".to_owned());
        assert_eq!(RejectedCause::read(&record), causes);
    }
}
