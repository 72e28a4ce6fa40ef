//! The MCAP file under every recording: its options, its chunks, and errors that are final.

use std::borrow::Cow;
use std::collections::BTreeMap;

use foxglove::Encode;
use mcap::records::{self, MessageHeader, Metadata as MetadataRecord};
use mcap::{Attachment, Compression, WriteOptions, Writer};

use crate::{RecordError, Sink};

/// A metadata record: pairs of keys and values, in the order of their keys.
pub type Metadata = BTreeMap<String, String>;

/// The number of uncompressed bytes after which a chunk is closed, unless a recording says otherwise. A process
/// that is killed may lose as much.
pub(crate) const CHUNK_BYTES: u64 = 1 << 20;
/// The level of zstd, which is its default. The number of matches takes the time, and this level finds longer
/// ones than level 1. Of levels above 4, most is not built (`.cargo/config.toml`).
pub const COMPRESSION_LEVEL: u32 = 3;

/// A topic of an open log.
pub(crate) struct Topic {
    channel: u16,
    sequence: u32,
}

/// An MCAP file being written.
///
/// The first error ends it: the writer is dropped without the closing records that would make a
/// broken file look whole (`mcap::Writer` writes them even when dropped, so it is taken apart
/// instead), and everything afterwards is [`RecordError::AfterFailure`]. Dropping the log does the
/// same.
///
/// Chunks are closed, and the operating system is given everything, by the volume of data and not
/// by the clock: the same messages give the same bytes, and a killed process loses at most the last
/// chunk and the message being written.
pub(crate) struct Log<'w> {
    writer: Option<Writer<Box<dyn Sink + 'w>>>,
    /// Uncompressed bytes after which a chunk is closed.
    chunk_bytes: u64,
    /// Message bytes in the open chunk.
    pending: u64,
}

impl<'w> Log<'w> {
    pub fn new(sink: Box<dyn Sink + 'w>, chunk_bytes: u64) -> Result<Self, RecordError> {
        let writer = WriteOptions::new()
            .library(concat!("opm-mcap/", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(COMPRESSION_LEVEL)
            .compression_threads(0)
            .chunk_size(None)
            .create(sink)?;
        Ok(Self { writer: Some(writer), chunk_bytes, pending: 0 })
    }

    /// Adds a topic that carries messages of type `M`.
    pub fn topic<M: Encode>(&mut self, name: &str) -> Result<Topic, RecordError> {
        self.attempt(|writer| {
            let schema = match M::get_schema() {
                Some(schema) => writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
                None => 0,
            };
            let encoding = M::get_message_encoding();
            let channel = writer.add_channel(schema, name, &encoding, &Metadata::new())?;
            Ok(Topic { channel, sequence: 0 })
        })
    }

    /// Adds a topic that carries protobuf messages of the type `schema`, which `descriptor` describes
    /// (an encoded `google.protobuf.FileDescriptorSet`).
    pub fn topic_of(
        &mut self,
        name: &str,
        schema: &str,
        descriptor: &[u8],
    ) -> Result<Topic, RecordError> {
        self.attempt(|writer| {
            let schema = writer.add_schema(schema, "protobuf", descriptor)?;
            let channel = writer.add_channel(schema, name, "protobuf", &Metadata::new())?;
            Ok(Topic { channel, sequence: 0 })
        })
    }

    /// Adds a schema as it stands in another file.
    pub fn schema(&mut self, name: &str, encoding: &str, data: &[u8]) -> Result<u16, RecordError> {
        self.attempt(|writer| Ok(writer.add_schema(name, encoding, data)?))
    }

    /// Adds a topic as it stands in another file; `schema` is one that [`Log::schema`] gave, or 0.
    pub fn channel(&mut self, schema: u16, like: &records::Channel) -> Result<Topic, RecordError> {
        self.attempt(|writer| {
            let encoding = &like.message_encoding;
            let channel = writer.add_channel(schema, &like.topic, encoding, &like.metadata)?;
            Ok(Topic { channel, sequence: 0 })
        })
    }

    /// Writes one encoded message. `time` is in nanoseconds and must not go back.
    pub fn message(
        &mut self,
        topic: &mut Topic,
        time: u64,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let size = data.len() as u64;
        // A big message gets a chunk of its own, so that reading its neighbours stays cheap.
        if size >= self.chunk_bytes && self.pending > 0 {
            self.flush()?;
        }
        let header = MessageHeader {
            channel_id: topic.channel,
            sequence: topic.sequence,
            log_time: time,
            publish_time: time,
        };
        self.attempt(|writer| Ok(writer.write_to_known_channel(&header, data)?))?;
        topic.sequence = topic.sequence.wrapping_add(1);
        self.pending += size;
        if self.pending >= self.chunk_bytes { self.flush() } else { Ok(()) }
    }

    /// Writes a metadata record.
    pub fn metadata(&mut self, name: &str, metadata: &Metadata) -> Result<(), RecordError> {
        let record = MetadataRecord { name: name.into(), metadata: metadata.clone() };
        self.attempt(|writer| Ok(writer.write_metadata(&record)?))?;
        self.pending = 0;
        Ok(())
    }

    /// Attaches a file, stamped with `time` in nanoseconds.
    pub fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        time: u64,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let attachment = Attachment {
            log_time: time,
            create_time: time,
            name: name.into(),
            media_type: media_type.into(),
            data: Cow::Borrowed(data),
        };
        self.attempt(|writer| Ok(writer.attach(&attachment)?))?;
        self.pending = 0;
        Ok(())
    }

    /// Closes the chunk and hands everything to the operating system: what is written so far can
    /// be read even if the process is killed.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.attempt(|writer| Ok(writer.flush()?))?;
        self.pending = 0;
        Ok(())
    }

    /// Writes the closing records and commits the sink.
    pub fn finish(mut self) -> Result<(), RecordError> {
        self.attempt(|writer| Ok(writer.finish()?))?;
        let writer = self.writer.take().ok_or(RecordError::AfterFailure)?;
        writer.into_inner().commit().map_err(RecordError::Io)
    }

    /// Ends the log where it stands.
    pub fn give_up(&mut self) {
        if let Some(writer) = self.writer.take() {
            // Unlike dropping the writer, this leaves the file without an end.
            drop(writer.into_inner());
        }
    }

    fn attempt<T>(
        &mut self,
        action: impl FnOnce(&mut Writer<Box<dyn Sink + 'w>>) -> Result<T, RecordError>,
    ) -> Result<T, RecordError> {
        let writer = self.writer.as_mut().ok_or(RecordError::AfterFailure)?;
        let result = action(writer);
        if result.is_err() {
            self.give_up();
        }
        result
    }
}

impl Drop for Log<'_> {
    fn drop(&mut self) {
        self.give_up();
    }
}
