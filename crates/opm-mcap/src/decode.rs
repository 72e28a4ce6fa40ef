//! Reads a `foxglove.PointCloud` in place: its points are never copied.

use foxglove::Decode;
use foxglove::messages::PointCloud;
use foxglove::messages::packed_element_field::NumericType;

use crate::cloud::DATA_KEY;

/// A point cloud that is read in place, without copying its points. [`Message::cloud`](crate::Message::cloud)
/// gives one; the example there reads its columns.
#[derive(Debug, Clone)]
pub struct Cloud<'a> {
    /// The frame that the points are in.
    pub frame_id: String,
    /// The time stamp of the cloud itself, nanoseconds.
    pub time: Option<u64>,
    fields: Vec<Field>,
    stride: usize,
    data: &'a [u8],
}

#[derive(Debug, Clone)]
struct Field {
    name: String,
    offset: usize,
    kind: NumericType,
}

impl<'a> Cloud<'a> {
    /// The name of the schema that this type reads.
    pub const SCHEMA: &'static str = "foxglove.PointCloud";

    /// Reads an encoded message; the error says what is wrong with it.
    pub(crate) fn decode(message: &'a [u8]) -> Result<Self, String> {
        let (head, data) = split(message).ok_or("not a protobuf message")?;
        let head = PointCloud::decode(&*head).map_err(|reason| reason.to_string())?;
        let stride = head.point_stride as usize;
        if !data.is_empty() && (stride == 0 || !data.len().is_multiple_of(stride)) {
            return Err(format!("{} bytes are no whole number of points of {stride}", data.len()));
        }
        let fields = head.fields.iter().map(|field| {
            let (name, offset) = (field.name.clone(), field.offset as usize);
            let kind = NumericType::try_from(field.r#type).unwrap_or(NumericType::Unknown);
            if size(kind).is_none_or(|size| offset + size > stride) {
                return Err(format!("field {name} does not lie in a point of {stride} bytes"));
            }
            Ok(Field { name, offset, kind })
        });
        Ok(Self {
            fields: fields.collect::<Result<_, _>>()?,
            frame_id: head.frame_id,
            time: head.timestamp.map(|stamp| stamp.total_nanos()),
            stride,
            data,
        })
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.data.len().checked_div(self.stride).unwrap_or(0)
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// The names of the fields, in order.
    pub fn fields(&self) -> impl Iterator<Item = &str> {
        self.fields.iter().map(|field| &*field.name)
    }

    /// The values of one field, point by point; `None` if there is no such field.
    pub fn column(&self, field: &str) -> Option<Column<'a>> {
        let Field { offset, kind, .. } = self.fields.iter().find(|found| found.name == field)?;
        let points = self.data.chunks_exact(self.stride.max(1));
        Some(Column { points, offset: *offset, kind: *kind })
    }
}

/// The values of one field of a cloud, point by point.
#[derive(Debug, Clone)]
pub struct Column<'a> {
    points: std::slice::ChunksExact<'a, u8>,
    offset: usize,
    kind: NumericType,
}

impl Column<'_> {
    /// The values in another unit, of which each has `size`.
    pub fn in_units_of(self, size: f64) -> Vec<f64> {
        self.map(|value| value / size).collect()
    }
}

impl Iterator for Column<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        fn at<const N: usize>(bytes: &[u8]) -> Option<[u8; N]> {
            bytes.first_chunk().copied()
        }
        let bytes = self.points.next()?.get(self.offset..)?;
        match self.kind {
            NumericType::Unknown => None,
            NumericType::Uint8 => at(bytes).map(|b| u8::from_le_bytes(b).into()),
            NumericType::Int8 => at(bytes).map(|b| i8::from_le_bytes(b).into()),
            NumericType::Uint16 => at(bytes).map(|b| u16::from_le_bytes(b).into()),
            NumericType::Int16 => at(bytes).map(|b| i16::from_le_bytes(b).into()),
            NumericType::Uint32 => at(bytes).map(|b| u32::from_le_bytes(b).into()),
            NumericType::Int32 => at(bytes).map(|b| i32::from_le_bytes(b).into()),
            NumericType::Float32 => at(bytes).map(|b| f32::from_le_bytes(b).into()),
            NumericType::Float64 => at(bytes).map(f64::from_le_bytes),
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.points.size_hint()
    }
}

impl ExactSizeIterator for Column<'_> {}

/// The number of bytes of a value.
fn size(kind: NumericType) -> Option<usize> {
    match kind {
        NumericType::Unknown => None,
        NumericType::Uint8 | NumericType::Int8 => Some(1),
        NumericType::Uint16 | NumericType::Int16 => Some(2),
        NumericType::Uint32 | NumericType::Int32 | NumericType::Float32 => Some(4),
        NumericType::Float64 => Some(8),
    }
}

/// Separates the points from a message's other fields. `None` if the message is not protobuf.
fn split(message: &[u8]) -> Option<(Vec<u8>, &[u8])> {
    let (mut head, mut data) = (Vec::new(), &[][..]);
    let mut rest = message;
    while !rest.is_empty() {
        let field = rest;
        let key = varint(&mut rest)?;
        // Wire types: the length of what follows the key.
        let length = match key & 7 {
            0 => {
                varint(&mut rest)?;
                0
            }
            1 => 8,
            2 => usize::try_from(varint(&mut rest)?).ok()?,
            5 => 4,
            _ => return None,
        };
        let (value, tail) = rest.split_at_checked(length)?;
        rest = tail;
        if key == u64::from(DATA_KEY) {
            data = value;
        } else {
            head.extend_from_slice(&field[..field.len() - tail.len()]);
        }
    }
    Some((head, data))
}

/// Reads a base-128 number, the least significant digit first.
pub(crate) fn varint(rest: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let (byte, tail) = rest.split_first()?;
        *rest = tail;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}
