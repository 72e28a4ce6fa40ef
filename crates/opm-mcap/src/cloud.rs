//! Point clouds: `foxglove.PointCloud` with x y z and scalars as float32, then a colour.

use colorous::VIRIDIS;
use foxglove::Encode;
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{PackedElementField, PointCloud, Pose, Quaternion, Timestamp, Vector3};

use crate::RecordError;

/// Names of the position fields, in order.
pub const POSITION_FIELDS: [&str; 3] = ["x", "y", "z"];
/// Names of the colour fields, in order.
pub const COLOR_FIELDS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Protobuf key of the points in a `foxglove.PointCloud`: field 6, length-delimited.
pub(crate) const DATA_KEY: u8 = 6 << 3 | 2;
/// Bytes that the timestamp and the key and length of the points can take at most.
const STAMP_BYTES: usize = 32;
/// Colours in the table: as many as a byte a channel can tell apart along this map.
const SHADES: usize = 256;

/// What the points of a cloud are made of.
///
/// A point is handed over as a row of [`columns`](Self::columns): the three coordinates, the
/// scalars, and the value to colour by where that is none of them. SI units and radians.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudLayout {
    /// What the cloud's x, y and z are, for example `x`, `y`, `xi`.
    pub axes: [String; 3],
    /// Further values stored with every point, each a field of its own name.
    pub scalars: Vec<String>,
    /// The value that decides the colour: one of the axes or scalars, or one given for this alone.
    pub color: String,
    /// The values of `color` at the two ends of the colour map; what is outside is clamped.
    pub color_range: [f64; 2],
    /// The frame that the points are in.
    pub frame_id: String,
}

impl CloudLayout {
    /// The values of a row, in order.
    pub fn columns(&self) -> Vec<&str> {
        let mut columns: Vec<&str> = self.axes.iter().chain(&self.scalars).map(|n| &**n).collect();
        if !columns.contains(&&*self.color) {
            columns.push(&self.color);
        }
        columns
    }

    /// Bytes of an encoded point.
    pub fn stride(&self) -> usize {
        4 * (3 + self.scalars.len()) + COLOR_FIELDS.len()
    }

    fn check(&self) -> Result<(), RecordError> {
        let wrong = |reason| Err(RecordError::Layout(reason));
        for (i, name) in self.scalars.iter().enumerate() {
            if name.is_empty() {
                return wrong("a scalar has no name".into());
            }
            if POSITION_FIELDS.contains(&&**name) || COLOR_FIELDS.contains(&&**name) {
                return wrong(format!(
                    "scalar {name} has the name of a field that is always there"
                ));
            }
            if self.scalars[..i].contains(name) {
                return wrong(format!("scalar {name} is given twice"));
            }
        }
        let [low, high] = self.color_range;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return wrong(format!("colour range {low} to {high}, expected finite and ascending"));
        }
        if self.frame_id.is_empty() {
            return wrong("the frame has no name".into());
        }
        Ok(())
    }

    fn fields(&self) -> Vec<PackedElementField> {
        let floats = POSITION_FIELDS.into_iter().chain(self.scalars.iter().map(|name| &**name));
        let floats = floats.map(|name| (name, NumericType::Float32, 4));
        let bytes = COLOR_FIELDS.into_iter().map(|name| (name, NumericType::Uint8, 1));
        let mut end = 0;
        floats
            .chain(bytes)
            .map(|(name, kind, size)| {
                let offset = end;
                end += size;
                PackedElementField { name: name.into(), offset, r#type: kind as i32 }
            })
            .collect()
    }
}

/// Turns rows into encoded messages, one cloud at a time, in one buffer.
///
/// The buffer holds the message as it goes to the file, so that no cloud is ever in memory twice:
/// the points are packed behind room for the message's other fields, which are put right in front of
/// them once their length is known.
pub(crate) struct CloudEncoder {
    columns: Vec<String>,
    floats: usize,
    stride: usize,
    color_column: usize,
    color_low: f64,
    color_scale: f64,
    shades: Vec<[u8; 4]>,
    /// Everything but timestamp and points.
    template: PointCloud,
    /// Where the points start in `buffer`.
    head_room: usize,
    buffer: Vec<u8>,
}

impl CloudEncoder {
    /// `capacity`: points of the largest cloud to come.
    pub fn new(layout: &CloudLayout, capacity: usize) -> Result<Self, RecordError> {
        layout.check()?;
        let columns: Vec<String> = layout.columns().into_iter().map(String::from).collect();
        let color_column =
            columns.iter().position(|name| *name == layout.color).unwrap_or(columns.len() - 1);
        let [low, high] = layout.color_range;
        let template = PointCloud {
            timestamp: None,
            frame_id: layout.frame_id.clone(),
            pose: Some(identity()),
            point_stride: layout.stride() as u32,
            fields: layout.fields(),
            data: Default::default(),
        };
        let head_room = template.encoded_len().unwrap_or(0) + STAMP_BYTES;
        let mut buffer = Vec::with_capacity(head_room + capacity * layout.stride());
        buffer.resize(head_room, 0);
        Ok(Self {
            columns,
            floats: 3 + layout.scalars.len(),
            stride: layout.stride(),
            color_column,
            color_low: low,
            // A range of one value has one colour, the lowest.
            color_scale: if high > low { SHADES as f64 / (high - low) } else { 0.0 },
            shades: (0..SHADES).map(shade).collect(),
            template,
            head_room,
            buffer,
        })
    }

    /// Values that a row has.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// Points in the cloud so far.
    pub fn len(&self) -> usize {
        (self.buffer.len() - self.head_room) / self.stride
    }

    /// Adds points, row by row.
    pub fn push(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        let columns = self.columns.len();
        if !rows.len().is_multiple_of(columns) {
            return Err(RecordError::Row { values: rows.len(), columns });
        }
        let first = self.buffer.len();
        self.buffer.resize(first + rows.len() / columns * self.stride, 0);
        let mut finite = true;
        let points = self.buffer[first..].chunks_exact_mut(self.stride);
        for (row, point) in rows.chunks_exact(columns).zip(points) {
            let (packed, rgba) = point.split_at_mut(4 * self.floats);
            for (value, bytes) in row.iter().zip(packed.as_chunks_mut().0) {
                let value = *value as f32;
                finite &= value.is_finite();
                *bytes = value.to_le_bytes();
            }
            let value = row[self.color_column];
            finite &= value.is_finite();
            // A cast from float to integer saturates, which clamps at both ends.
            let level = ((value - self.color_low) * self.color_scale) as usize;
            rgba.copy_from_slice(&self.shades[level.min(SHADES - 1)]);
        }
        if finite { Ok(()) } else { Err(self.non_finite(rows)) }
    }

    /// Names the first value that is not a finite float32.
    fn non_finite(&self, rows: &[f64]) -> RecordError {
        let columns = self.columns.len();
        let bad = |value: &f64| !(*value as f32).is_finite();
        let at = rows.iter().position(bad).unwrap_or(0);
        let before = self.len() - rows.len() / columns;
        RecordError::NonFinite {
            column: self.columns[at % columns].clone(),
            point: before + at / columns,
            value: rows[at],
        }
    }

    /// The cloud as an encoded message stamped with `time`, in nanoseconds.
    pub fn message(&mut self, time: Timestamp) -> Result<&[u8], RecordError> {
        self.template.timestamp = Some(time);
        let mut head = Vec::with_capacity(self.head_room);
        self.template
            .encode(&mut head)
            .map_err(|reason| RecordError::Layout(format!("the message: {reason}")))?;
        // Protobuf: a base-128 length in front of the field's bytes.
        head.push(DATA_KEY);
        let mut length = self.buffer.len() - self.head_room;
        while length >= 0x80 {
            head.push(length as u8 | 0x80);
            length >>= 7;
        }
        head.push(length as u8);
        let start = self.head_room - head.len();
        self.buffer[start..self.head_room].copy_from_slice(&head);
        Ok(&self.buffer[start..])
    }

    /// Starts the next cloud.
    pub fn clear(&mut self) {
        self.buffer.truncate(self.head_room);
    }
}

/// A point with a colour of its own.
pub(crate) struct ColoredPoint {
    /// Metres.
    pub at: [f64; 3],
    /// Red, green, blue, opacity.
    pub rgba: [u8; 4],
}

/// A cloud of coloured points as an encoded `foxglove.PointCloud`.
pub(crate) fn encode_colored(
    frame_id: &str,
    time: Timestamp,
    points: &[ColoredPoint],
) -> Result<Vec<u8>, RecordError> {
    let plain = CloudLayout {
        axes: POSITION_FIELDS.map(String::from),
        scalars: Vec::new(),
        color: POSITION_FIELDS[0].into(),
        color_range: [0.0, 0.0],
        frame_id: frame_id.into(),
    };
    let mut data = Vec::with_capacity(points.len() * plain.stride());
    for ColoredPoint { at, rgba } in points {
        data.extend(at.iter().flat_map(|&value| (value as f32).to_le_bytes()));
        data.extend_from_slice(rgba);
    }
    let cloud = PointCloud {
        timestamp: Some(time),
        frame_id: plain.frame_id.clone(),
        pose: Some(identity()),
        point_stride: plain.stride() as u32,
        fields: plain.fields(),
        data: data.into(),
    };
    let mut message = Vec::new();
    cloud
        .encode(&mut message)
        .map_err(|reason| RecordError::Layout(format!("the message: {reason}")))?;
    Ok(message)
}

/// The pose of a cloud that is given in its frame.
fn identity() -> Pose {
    Pose {
        position: Some(Vector3 { x: 0.0, y: 0.0, z: 0.0 }),
        orientation: Some(Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
    }
}

/// The colour of level `i` of [`SHADES`]: viridis, which is perceptually uniform, opaque.
fn shade(i: usize) -> [u8; 4] {
    let color = VIRIDIS.eval_rational(i, SHADES);
    [color.r, color.g, color.b, u8::MAX]
}
