//! Point clouds: `foxglove.PointCloud` with x y z and scalars as float32, then a colour.

use colorous::VIRIDIS;
use foxglove::Encode;
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{PackedElementField, PointCloud, Pose, Quaternion, Timestamp, Vector3};

use crate::RecordError;

/// The names of the position fields of every cloud, in order.
pub const POSITION_FIELDS: [&str; 3] = ["x", "y", "z"];
/// The names of the colour fields of every cloud, in order.
pub const COLOR_FIELDS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Protobuf key of the points in a `foxglove.PointCloud`: field 6, length-delimited.
pub(crate) const DATA_KEY: u8 = 6 << 3 | 2;
/// Bytes that the timestamp and the key and length of the points can take at most.
const STAMP_BYTES: usize = 32;
/// The number of colours in the table: as many as bytes can tell apart along this colour map.
const SHADES: usize = 256;
/// A grey that is faint on dark and on light backgrounds.
const GREY: u8 = 112;

/// The values of a point of a cloud.
///
/// A point is given as a row of [`columns`](Self::columns), SI and radians: the three coordinates, the
/// scalars, and the value that decides the colour, unless that is one of them.
///
/// ```
/// use opm_mcap::CloudLayout;
///
/// let layout = CloudLayout {
///     axes: ["x", "y", "xi"].map(String::from),
///     scalars: vec!["S1".into()],
///     color: "condition".into(),
///     color_range: [1.0, 20.0],
///     frame_id: "base".into(),
///     scale: [1.0; 3],
///     units: ["m", "m", "rad"],
/// };
/// assert_eq!(layout.columns(), ["x", "y", "xi", "S1", "condition"]);
/// assert_eq!(layout.stride(), 4 * 4 + 4); // four float32 and four bytes of colour
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CloudLayout {
    /// The names of the values that are the cloud's x, y and z, for example `x`, `y`, `xi`.
    pub axes: [String; 3],
    /// The names of further values that are stored with every point, each as a field.
    pub scalars: Vec<String>,
    /// The name of the value that decides the colour: an axis, a scalar, or a value for this purpose alone.
    pub color: String,
    /// The values of `color` at the two ends of the colour map, ascending. Values outside are clamped.
    pub color_range: [f64; 2],
    /// The name of the frame that the points are in.
    pub frame_id: String,
    /// What the values of each axis are multiplied by to be x, y and z: lengths beside angles may differ much. Without
    /// scales, ones. Rows have the values themselves.
    pub scale: [f64; 3],
    /// The SI unit of each axis; empty for an axis without values.
    pub units: [&'static str; 3],
}

impl CloudLayout {
    /// The names of the values of a row, in order.
    pub fn columns(&self) -> Vec<&str> {
        let mut columns: Vec<&str> = self.axes.iter().chain(&self.scalars).map(|n| &**n).collect();
        if !columns.contains(&&*self.color) {
            columns.push(&self.color);
        }
        columns
    }

    /// The number of bytes of a packed point.
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
        if !self.scale.iter().all(|factor| *factor > 0.0 && factor.is_finite()) {
            return wrong(format!("scale {:?}, expected numbers above 0", self.scale));
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

/// Packs points as they are stored in a cloud. Recorders do this themselves; a packer is for points that are
/// made on many threads, to pack them there.
///
/// ```
/// use opm_mcap::{CloudLayout, Packer};
///
/// # fn main() -> Result<(), opm_mcap::RecordError> {
/// let layout = CloudLayout {
///     axes: ["x", "y", "z"].map(String::from),
///     scalars: vec![],
///     color: "z".into(),
///     color_range: [0.0, 1.0],
///     frame_id: "base".into(),
///     scale: [1.0; 3],
///     units: ["m", "m", "rad"],
/// };
/// let packer = Packer::new(&layout)?;
/// let (mut points, mut line) = (vec![], vec![]);
/// packer.pack(&[0.0, 2.0, 3.0, 0.1, 2.0, 3.0], &mut points)?;
/// // The same two points, which differ in x alone.
/// packer.pack_line(&[0.0, 2.0, 3.0], Some(0), &[0.0, 0.1], &mut line)?;
/// assert_eq!(points, line);
/// assert_eq!(points.len(), 2 * packer.stride());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Packer {
    columns: Vec<String>,
    floats: usize,
    stride: usize,
    color_column: usize,
    color_low: f64,
    color_scale: f64,
    /// What each of the floats is multiplied by.
    factors: Vec<f64>,
    shades: Vec<[u8; 4]>,
}

impl Packer {
    /// A packer for the points of this layout.
    ///
    /// # Errors
    /// [`RecordError::Layout`] if the layout contradicts itself.
    pub fn new(layout: &CloudLayout) -> Result<Self, RecordError> {
        layout.check()?;
        let columns: Vec<String> = layout.columns().into_iter().map(String::from).collect();
        let color_column =
            columns.iter().position(|name| *name == layout.color).unwrap_or(columns.len() - 1);
        let [low, high] = layout.color_range;
        let mut factors = vec![1.0; 3 + layout.scalars.len()];
        factors[..3].copy_from_slice(&layout.scale);
        Ok(Self {
            columns,
            factors,
            floats: 3 + layout.scalars.len(),
            stride: layout.stride(),
            color_column,
            color_low: low,
            // A range of one value has one colour, the lowest.
            color_scale: if high > low { SHADES as f64 / (high - low) } else { 0.0 },
            shades: (0..SHADES).map(shade).collect(),
        })
    }

    /// The number of values in a row.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// The number of bytes of a packed point.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Packs points, given as rows of [`CloudLayout::columns`], and adds them to `points`.
    ///
    /// # Errors
    /// [`RecordError::Row`] if `rows` is not a whole number of rows, [`RecordError::NonFinite`] if a value is
    /// not a finite float32.
    pub fn pack(&self, rows: &[f64], points: &mut Vec<u8>) -> Result<(), RecordError> {
        let columns = self.columns.len();
        if !rows.len().is_multiple_of(columns) {
            return Err(RecordError::Row { values: rows.len(), columns });
        }
        let first = points.len();
        points.resize(first + rows.len() / columns * self.stride, 0);
        let mut finite = true;
        let packed = points[first..].chunks_exact_mut(self.stride);
        for (row, point) in rows.chunks_exact(columns).zip(packed) {
            let (packed, rgba) = point.split_at_mut(4 * self.floats);
            let floats = row.iter().zip(&self.factors).zip(packed.as_chunks_mut().0);
            for ((value, factor), bytes) in floats {
                let value = (value * factor) as f32;
                finite &= value.is_finite();
                *bytes = value.to_le_bytes();
            }
            let value = row[self.color_column];
            finite &= value.is_finite();
            rgba.copy_from_slice(self.shade(value));
        }
        if finite { Ok(()) } else { Err(self.non_finite(rows, first / self.stride)) }
    }

    /// Packs one point for each of `values`: the point of `row`, with the value put into one column, if
    /// there is a `column`. It is faster than packing the points row by row, with the same result.
    ///
    /// # Errors
    /// As [`Packer::pack`]; [`RecordError::Row`] also if `row` is not one row, or has no such column.
    pub fn pack_line(
        &self,
        row: &[f64],
        column: Option<usize>,
        values: &[f64],
        points: &mut Vec<u8>,
    ) -> Result<(), RecordError> {
        let columns = self.columns.len();
        if row.len() != columns || column.is_some_and(|column| column >= columns) {
            return Err(RecordError::Row { values: row.len(), columns });
        }
        let Some(count) = values.len().checked_sub(1) else { return Ok(()) };
        let (start, end) = (points.len(), points.len() + values.len() * self.stride);
        points.reserve(end - start);
        self.pack(row, points)?;
        // The points so far are copied behind themselves, twice as many every time.
        let mut there = 1;
        while there <= count {
            let more = there.min(count + 1 - there);
            points.extend_from_within(start..start + more * self.stride);
            there += more;
        }
        let Some(column) = column else { return Ok(()) };
        let factor = self.factors.get(column).copied().unwrap_or(1.0);
        let mut finite = true;
        let packed = points[start..].chunks_exact_mut(self.stride);
        for (&value, point) in values.iter().zip(packed) {
            let single = (value * factor) as f32;
            finite &= single.is_finite();
            let (floats, rgba) = point.split_at_mut(4 * self.floats);
            if let Some(bytes) = floats.as_chunks_mut().0.get_mut(column) {
                *bytes = single.to_le_bytes();
            }
            if column == self.color_column {
                rgba.copy_from_slice(self.shade(value));
            }
        }
        if finite {
            return Ok(());
        }
        let bad = values.iter().find(|value| !(**value as f32).is_finite());
        let mut row = row.to_vec();
        row[column] = bad.copied().unwrap_or_default();
        Err(self.non_finite(&row, start / self.stride))
    }

    /// The colour of a value.
    #[inline]
    fn shade(&self, value: f64) -> &[u8; 4] {
        // A cast from float to integer saturates, which clamps at both ends.
        let level = ((value - self.color_low) * self.color_scale) as usize;
        &self.shades[level.min(SHADES - 1)]
    }

    /// The error for the first value that is not a finite float32, in rows behind `before` points.
    fn non_finite(&self, rows: &[f64], before: usize) -> RecordError {
        let columns = self.columns.len();
        let bad = |value: &f64| !(*value as f32).is_finite();
        let at = rows.iter().position(bad).unwrap_or(0);
        RecordError::NonFinite {
            column: self.columns[at % columns].clone(),
            point: before + at / columns,
            value: rows[at],
        }
    }
}

/// Turns points into encoded messages, one cloud at a time, in one buffer.
///
/// The buffer holds the message as it goes to the file, so that no cloud is ever in memory twice:
/// the points are packed behind room for the message's other fields, which are put right in front of
/// them once their length is known.
pub(crate) struct CloudEncoder {
    packer: Packer,
    /// The message without timestamp and points.
    template: PointCloud,
    /// Where the points start in `buffer`.
    head_room: usize,
    buffer: Vec<u8>,
}

impl CloudEncoder {
    /// `capacity` is the number of points of the largest cloud to come.
    pub fn new(layout: &CloudLayout, capacity: usize) -> Result<Self, RecordError> {
        let packer = Packer::new(layout)?;
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
        Ok(Self { packer, template, head_room, buffer })
    }

    /// Gives the points these colours instead of those of the colour map: the range of the colour's values is divided
    /// into as many parts.
    pub fn paint(&mut self, colors: &[[u8; 3]]) {
        let of = |i: usize| colors.get(i * colors.len() / SHADES).copied().unwrap_or([GREY; 3]);
        self.packer.shades = (0..SHADES).map(of).map(|[r, g, b]| [r, g, b, u8::MAX]).collect();
    }

    /// The packer of its points.
    pub fn packer(&self) -> &Packer {
        &self.packer
    }

    /// The number of points in the cloud so far.
    pub fn len(&self) -> usize {
        (self.buffer.len() - self.head_room) / self.packer.stride
    }

    /// Adds points, row by row.
    pub fn push(&mut self, rows: &[f64]) -> Result<(), RecordError> {
        let head = self.head_room / self.packer.stride;
        self.packer.pack(rows, &mut self.buffer).map_err(|error| match error {
            RecordError::NonFinite { column, point, value } => {
                RecordError::NonFinite { column, point: point - head, value }
            }
            other => other,
        })
    }

    /// Adds points that are packed.
    pub fn push_packed(&mut self, points: &[u8]) {
        self.buffer.extend_from_slice(points);
    }

    /// The range of x, y and z of the points; `None` without any.
    pub fn bounds(&self) -> Option<[[f64; 2]; 3]> {
        // Four numbers fit into a vector. What follows z has a range, too, which is of no use.
        let (mut low, mut high) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for point in self.buffer[self.head_room..].chunks_exact(self.packer.stride) {
            let Some((bytes, _)) = point.split_first_chunk::<16>() else { break };
            for (i, bytes) in bytes.as_chunks().0.iter().enumerate() {
                let value = f32::from_le_bytes(*bytes);
                low[i] = if value < low[i] { value } else { low[i] };
                high[i] = if value > high[i] { value } else { high[i] };
            }
        }
        let bounds = [0, 1, 2].map(|i| [low[i], high[i]].map(f64::from));
        (self.len() > 0).then_some(bounds)
    }

    /// Moves the colours of the points half of the way to grey.
    pub fn fade(&mut self) {
        for point in self.buffer[self.head_room..].chunks_exact_mut(self.packer.stride) {
            let (_, rgba) = point.split_at_mut(4 * self.packer.floats);
            for color in &mut rgba[..3] {
                *color = (*color / 2) + (GREY / 2);
            }
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
    /// The position, metres.
    pub at: [f64; 3],
    /// The colour: red, green, blue, opacity.
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
        scale: [1.0; 3],
        units: [""; 3],
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A line is its points one by one, whichever column differs, whichever decides the colour.
    #[test]
    fn a_line_is_packed_like_its_points() {
        for color in ["x", "xi", "S1", "other"] {
            let layout = CloudLayout {
                axes: ["x", "y", "xi"].map(String::from),
                scalars: vec!["S1".into()],
                color: color.into(),
                color_range: [0.0, 5.0],
                frame_id: "base".into(),
                scale: [1.0, 1.0, 0.2],
                units: ["m", "m", "rad"],
            };
            let packer = Packer::new(&layout).unwrap();
            let row: Vec<f64> = (0..packer.columns()).map(|i| 0.3 + i as f64).collect();
            for column in (0..packer.columns()).map(Some).chain([None]) {
                for count in [0, 1, 2, 3, 7, 64, 100] {
                    let values: Vec<f64> = (0..count).map(|i| f64::from(i) * 0.07).collect();
                    let (mut line, mut points) = (vec![], vec![]);
                    for packed in [&mut line, &mut points] {
                        packer.pack(&row, packed).unwrap();
                    }
                    packer.pack_line(&row, column, &values, &mut line).unwrap();
                    for &value in &values {
                        let mut row = row.clone();
                        if let Some(column) = column {
                            row[column] = value;
                        }
                        packer.pack(&row, &mut points).unwrap();
                    }
                    assert!(line == points, "{color} {column:?} {count}");
                }
            }
            assert!(packer.pack_line(&row[1..], Some(0), &[1.0], &mut vec![]).is_err(), "{color}");
            assert!(packer.pack_line(&row, Some(row.len()), &[1.0], &mut vec![]).is_err());
            let values = [1.0, f64::NAN];
            assert!(packer.pack_line(&row, Some(0), &values, &mut vec![]).is_err(), "{color}");
        }
    }
}
