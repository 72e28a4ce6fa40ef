//! Reads recordings, whole or cut short, in the memory of one message.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use lz4_flex::frame::FrameDecoder;
use mcap::McapError;
use mcap::records::{self, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::cloud::COLOR_FIELDS;
use crate::decode::Cloud;
use crate::flat::Flat;
use crate::recover::RECOVERED;
use crate::rejected::REJECTED_TOPIC;
use crate::shard::{self, RUNS_SCHEMA};
use crate::workspace::BOUNDARY_POINTS_TOPIC;
use crate::{Metadata, ReadError};

/// The longest record or chunk that is read. Those of recordings are a quarter of it; a longer one in a
/// damaged file must not become an allocation.
const RECORD_LIMIT: usize = 512 << 20;
/// The number of bytes of attachments that are kept, in the order of the file: more than any mechanism file has.
const ATTACHMENT_LIMIT: usize = 16 << 20;

/// The content of a recording, without its messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The topics, in the order of their names.
    pub topics: Vec<TopicInfo>,
    /// The times of the first and the last message, nanoseconds; `None` without messages.
    pub time_range: Option<[u64; 2]>,
    /// The range of every field of the clouds except the colours, in the order of the fields.
    pub extents: Vec<Extent>,
    /// The metadata records with their names, in the order of the file.
    pub metadata: Vec<(String, Metadata)>,
    /// The attachments, in the order of the file.
    pub attachments: Vec<AttachmentInfo>,
    /// Whether the file has its end, and, if it is of this program, a metadata record says `complete = "true"`. If not, the
    /// run that wrote it was cut short, and this is what reached the file.
    pub complete: bool,
}

impl Recording {
    /// The last metadata record of this name.
    pub fn metadata(&self, name: &str) -> Option<&Metadata> {
        self.metadata.iter().rev().find(|(found, _)| found == name).map(|(_, record)| record)
    }

    /// The topic of this name.
    pub fn topic(&self, name: &str) -> Option<&TopicInfo> {
        self.topics.iter().find(|topic| topic.name == name)
    }
}

/// A topic of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TopicInfo {
    /// The name of the topic.
    pub name: String,
    /// The name of its messages' schema, for example `foxglove.PointCloud`; empty without one.
    pub schema: String,
    /// The number of messages.
    pub messages: u64,
    /// The number of points in these messages; `None` if they are not point clouds.
    pub points: Option<u64>,
}

/// The range of one field of the clouds.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// The name of the field.
    pub field: String,
    /// The smallest value.
    pub min: f64,
    /// The largest value.
    pub max: f64,
}

/// An attached file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttachmentInfo {
    /// The name of the file.
    pub name: String,
    /// The media type, for instance `application/toml`.
    pub media_type: String,
    /// The size in bytes.
    pub size: u64,
    /// The file itself; `None` if it and the attachments before it are more than 16 MiB.
    pub content: Option<Vec<u8>>,
}

/// A message of a recording, as [`read`] shows it.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    /// The name of the topic.
    pub topic: &'a str,
    /// The name of the topic's schema; empty if it has none.
    pub schema: &'a str,
    /// The time of the message, nanoseconds.
    pub time: u64,
    /// The encoded message.
    pub data: &'a [u8],
    /// The names of its values, if its schema says that all of them are doubles.
    pub flat: Option<&'a Flat>,
}

impl<'a> Message<'a> {
    /// The point cloud in this message; `None` if the message is of another schema.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if the message claims the schema and cannot be decoded.
    ///
    /// ```
    /// use opm_mcap::{Message, ReadError};
    ///
    /// /// Adds the values of one field to `values`.
    /// fn collect(
    ///     message: &Message<'_>,
    ///     field: &str,
    ///     values: &mut Vec<f64>,
    /// ) -> Result<(), ReadError> {
    ///     if let Some(cloud) = message.cloud()? {
    ///         values.extend(cloud.column(field).into_iter().flatten());
    ///     }
    ///     Ok(())
    /// }
    /// ```
    pub fn cloud(&self) -> Result<Option<Cloud<'a>>, ReadError> {
        if self.schema != Cloud::SCHEMA {
            return Ok(None);
        }
        Cloud::decode(self.data).map(Some).map_err(|reason| self.malformed(reason))
    }

    /// Puts the values of a message of doubles into `values`, in the order of the names of
    /// [`Self::flat`]. Returns false, with no values, for any other message.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if the message is not what its schema says.
    pub fn values(&self, values: &mut Vec<f64>) -> Result<bool, ReadError> {
        values.clear();
        let Some(flat) = self.flat else { return Ok(false) };
        flat.decode(self.data, values).map_err(|reason| self.malformed(reason))?;
        Ok(true)
    }

    /// The runs of poses, `[from, to)`, in a message of [`crate::shard`]; `None` if the message is of another
    /// schema.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if the message claims the schema and cannot be decoded.
    pub fn runs(&self) -> Result<Option<Vec<[u64; 2]>>, ReadError> {
        if self.schema != RUNS_SCHEMA {
            return Ok(None);
        }
        shard::decode(self.data).map(Some).map_err(|reason| self.malformed(reason.into()))
    }

    fn malformed(&self, reason: String) -> ReadError {
        let topic = self.topic.escape_debug();
        ReadError::Malformed { what: format!("{topic} at {} ns", self.time), reason }
    }
}

/// Reads a recording from front to back, shows every message to `visit`, and returns what is in it.
///
/// A file that ends early is read as far as it is whole. Checksums are verified before a message is shown.
/// It takes the memory of about one message, at most half a GiB.
///
/// # Errors
/// [`ReadError`]: the file cannot be read, is not MCAP, is damaged before its end, or has clouds that cannot
/// be decoded. The first error of `visit` ends the reading, too.
///
/// The example of the [crate](crate) reads a recording.
pub fn read<E: From<ReadError>>(
    path: &Path,
    mut visit: impl FnMut(&Message<'_>) -> Result<(), E>,
) -> Result<Recording, E> {
    let mut contents = Contents::default();
    let end = records(path, |opcode, data| contents.record(opcode, data, &mut visit))?;
    match end {
        End::Whole => Ok(contents.finish(true)),
        End::Early => Ok(contents.finish(false)),
        End::Damaged(error) => Err(error.into()),
    }
}

/// Where reading has ended.
pub(crate) enum End {
    /// At the end of a whole file.
    Whole,
    /// At the end of a file that was cut short.
    Early,
    /// At damage.
    Damaged(ReadError),
}

/// Shows every record of a file to `visit`, with its opcode, from front to back.
pub(crate) fn records<E: From<ReadError>>(
    path: &Path,
    mut visit: impl FnMut(u8, &[u8]) -> Result<(), E>,
) -> Result<End, E> {
    let failed = |source| ReadError::Io { path: path.into(), source };
    let mut file = File::open(path).map_err(failed)?;
    let options = LinearReaderOptions::default()
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_emit_chunks(true)
        .with_record_length_limit(RECORD_LIMIT);
    let damaged =
        |offset, source| End::Damaged(ReadError::Damaged { path: path.into(), offset, source });
    let mut reader = LinearReader::new_with_options(options);
    let mut offset = 0;
    let mut begun = false;

    loop {
        match reader.next_event() {
            None => return Ok(End::Whole),
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                // More at a time than asked for: the requests inside a chunk are small.
                let count = file.read(reader.insert(wanted.max(1 << 16))).map_err(failed)?;
                reader.notify_read(count);
                offset += count as u64;
            }
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                begun = true;
                if opcode != op::CHUNK {
                    visit(opcode, data)?;
                    continue;
                }
                let content = match unpacked(data) {
                    Ok(content) => content,
                    Err(source) => return Ok(damaged(offset, source)),
                };
                if let Err(source) = each(&content, &mut visit)? {
                    return Ok(damaged(offset, source));
                }
            }
            // The writer gives a chunk its length when it closes it.
            Some(Err(
                McapError::UnexpectedEof
                | McapError::UnexpectedEoc
                | McapError::RecordTooLarge { opcode: op::CHUNK, len: u64::MAX },
            )) if begun => {
                return Ok(End::Early);
            }
            Some(Err(McapError::BadMagic | McapError::UnexpectedEof)) if !begun => {
                return Err(ReadError::NotMcap { path: path.into() }.into());
            }
            Some(Err(source)) => return Ok(damaged(offset, source)),
        }
    }
}

/// The records of a chunk as they are without compression; its checksum is verified. (The reader of `mcap` takes for
/// granted that the last record of a chunk ends with it.)
fn unpacked(chunk: &[u8]) -> Result<Cow<'_, [u8]>, McapError> {
    let Record::Chunk { header, data } = mcap::parse_record(op::CHUNK, chunk)? else {
        return Ok(Cow::default());
    };
    let size = usize::try_from(header.uncompressed_size).ok().filter(|&size| size <= RECORD_LIMIT);
    let size = size.ok_or(McapError::ChunkTooLarge(header.uncompressed_size))?;
    let content = match &*header.compression {
        "" => data,
        "lz4" => {
            let mut content = Vec::new();
            let decoded = FrameDecoder::new(&*data).take(size as u64 + 1).read_to_end(&mut content);
            match decoded {
                Ok(found) if found == size => Cow::Owned(content),
                Ok(_) => {
                    let problem = format!("more or less than the {size} bytes of its header");
                    return Err(McapError::DecompressionError(problem));
                }
                Err(error) => return Err(McapError::DecompressionError(error.to_string())),
            }
        }
        "zstd" => match zstd::bulk::decompress(&data, size) {
            Ok(content) => Cow::Owned(content),
            Err(error) => return Err(McapError::DecompressionError(error.to_string())),
        },
        other => return Err(McapError::UnsupportedCompression(other.to_owned())),
    };
    // Zero stands for none.
    let (saved, calculated) = (header.uncompressed_crc, crc32fast::hash(&content));
    match saved {
        0 => Ok(content),
        _ if saved == calculated => Ok(content),
        _ => Err(McapError::BadChunkCrc { saved, calculated }),
    }
}

/// Shows every record of an unpacked chunk to `visit`.
fn each<E>(
    mut rest: &[u8],
    visit: &mut impl FnMut(u8, &[u8]) -> Result<(), E>,
) -> Result<Result<(), McapError>, E> {
    while let Some((&opcode, tail)) = rest.split_first() {
        let Some((length, tail)) = tail.split_first_chunk() else {
            return Ok(Err(McapError::UnexpectedEoc));
        };
        let length = u64::from_le_bytes(*length);
        let record = usize::try_from(length).ok().and_then(|length| tail.split_at_checked(length));
        let Some((record, tail)) = record else {
            return Ok(Err(McapError::RecordTooLarge { opcode, len: length }));
        };
        visit(opcode, record)?;
        rest = tail;
    }
    Ok(Ok(()))
}

/// The content that was found so far.
#[derive(Default)]
struct Contents {
    schemas: BTreeMap<u16, Schema>,
    channels: BTreeMap<u16, Channel>,
    time_range: Option<[u64; 2]>,
    extents: Vec<Extent>,
    metadata: Vec<(String, Metadata)>,
    attachments: Vec<AttachmentInfo>,
}

#[derive(Clone, Default)]
struct Schema {
    name: Arc<str>,
    flat: Option<Arc<Flat>>,
}

struct Channel {
    topic: Arc<str>,
    schema: Schema,
    messages: u64,
    points: Option<u64>,
}

impl Contents {
    fn record<E: From<ReadError>>(
        &mut self,
        opcode: u8,
        data: &[u8],
        visit: &mut impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        match opcode {
            op::ATTACHMENT => {
                let kept = self.attachments.iter().filter_map(|a| a.content.as_ref());
                let room = ATTACHMENT_LIMIT - kept.map(Vec::len).sum::<usize>();
                self.attachments.push(attachment(data, room)?);
            }
            op::SCHEMA | op::CHANNEL | op::METADATA | op::MESSAGE => match parse(opcode, data)? {
                Record::Schema { header, data } => {
                    let flat = (header.encoding == Flat::ENCODING)
                        .then(|| Flat::of(&header.name, &data))
                        .flatten();
                    let schema = Schema { name: header.name.into(), flat: flat.map(Arc::new) };
                    self.schemas.insert(header.id, schema);
                }
                Record::Channel(channel) => self.channel(channel),
                Record::Metadata(record) => self.metadata.push((record.name, record.metadata)),
                Record::Message { header, data } => self.message(header, &data, visit)?,
                _ => {}
            },
            _ => {}
        }
        Ok(())
    }

    /// Channels are declared a second time behind the data.
    fn channel(&mut self, channel: records::Channel) {
        let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
        self.channels.entry(channel.id).or_insert_with(|| Channel {
            topic: channel.topic.into(),
            points: (&*schema.name == Cloud::SCHEMA).then_some(0),
            schema,
            messages: 0,
        });
    }

    fn message<E: From<ReadError>>(
        &mut self,
        header: records::MessageHeader,
        data: &[u8],
        visit: &mut impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(channel) = self.channels.get_mut(&header.channel_id) else {
            let what = format!("message at {} ns", header.log_time);
            let reason = format!("channel {} is not declared", header.channel_id);
            return Err(ReadError::Malformed { what, reason }.into());
        };
        let time = header.log_time;
        let [first, last] = self.time_range.get_or_insert([time, time]);
        (*first, *last) = ((*first).min(time), (*last).max(time));
        channel.messages += 1;

        let (topic, schema) = (channel.topic.clone(), channel.schema.clone());
        let flat = schema.flat.as_deref();
        let message = Message { topic: &topic, schema: &schema.name, time, data, flat };
        if let Some(cloud) = message.cloud()? {
            *channel.points.get_or_insert(0) += cloud.len() as u64;
            // A boundary is between points of the grid, and has no values of its own; what is rejected is elsewhere.
            if !matches!(&*topic, BOUNDARY_POINTS_TOPIC | REJECTED_TOPIC) {
                self.extend(&cloud);
            }
        }
        visit(&message)
    }

    fn extend(&mut self, cloud: &Cloud<'_>) {
        for name in cloud.fields().filter(|name| !COLOR_FIELDS.contains(name)) {
            let Some((min, max)) = range(cloud.column(name)) else { continue };
            match self.extents.iter_mut().find(|extent| extent.field == name) {
                Some(extent) => {
                    extent.min = extent.min.min(min);
                    extent.max = extent.max.max(max);
                }
                None => self.extents.push(Extent { field: name.into(), min, max }),
            }
        }
    }

    fn finish(self, ended: bool) -> Recording {
        let mut topics: Vec<TopicInfo> = (self.channels.into_values())
            .map(|Channel { topic, schema, messages, points }| TopicInfo {
                name: topic.to_string(),
                schema: schema.name.to_string(),
                messages,
                points,
            })
            .collect();
        topics.sort_by(|a, b| a.name.cmp(&b.name));
        let done = |record: &Metadata| record.get("complete").is_some_and(|value| value == "true");
        // Recordings of this program say at their beginning what run they are of, and recovered ones where they come from.
        let ours = self.metadata.iter().any(|(name, _)| name == "run" || name == RECOVERED);
        Recording {
            topics,
            time_range: self.time_range,
            extents: self.extents,
            complete: ended && (!ours || self.metadata.iter().any(|(_, record)| done(record))),
            metadata: self.metadata,
            attachments: self.attachments,
        }
    }
}

/// Smallest and largest value; None when there are none.
fn range(values: Option<impl Iterator<Item = f64>>) -> Option<(f64, f64)> {
    values?.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((min, max)) => Some((value.min(min), value.max(max))),
    })
}

pub(crate) fn parse(opcode: u8, data: &[u8]) -> Result<Record<'_>, ReadError> {
    mcap::parse_record(opcode, data).map_err(|reason| ReadError::Malformed {
        what: format!("record of type {opcode:#04x}"),
        reason: reason.to_string(),
    })
}

/// What an attachment record holds, with its content if that is no longer than `room`. (The parser of `mcap`
/// takes for granted that the record is long enough.)
pub(crate) fn attachment(record: &[u8], room: usize) -> Result<AttachmentInfo, ReadError> {
    /// The bytes of log time and creation time.
    const TIMES: usize = 16;
    fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        let (length, tail) = rest.split_first_chunk()?;
        let (text, tail) = tail.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        *rest = tail;
        Some(text)
    }
    let parts = |mut rest: &[u8]| {
        let name = String::from_utf8_lossy(text(&mut rest)?).into_owned();
        let media_type = String::from_utf8_lossy(text(&mut rest)?).into_owned();
        let (size, rest) = rest.split_first_chunk()?;
        let size = u64::from_le_bytes(*size);
        let content = rest.get(..usize::try_from(size).ok()?)?;
        let content = (content.len() <= room).then(|| content.to_vec());
        Some(AttachmentInfo { name, media_type, size, content })
    };
    record.get(TIMES..).and_then(parts).ok_or_else(|| ReadError::Malformed {
        what: "attachment".into(),
        reason: format!("{} bytes do not hold what its header says", record.len()),
    })
}
