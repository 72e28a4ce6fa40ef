//! Makes a recording that was cut short whole again, as far as it goes.

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::path::Path;

use mcap::records::{Record, op};

use crate::log::{CHUNK_BYTES, Log, Topic};
use crate::reader::{End, attachment, parse, records};
use crate::{Metadata, PartialFile, ReadError, RecordError, Sink};

/// Name of the metadata record of a recovered recording: where it comes from.
pub const RECOVERED: &str = "recovered";

/// What was recovered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recovered {
    /// The number of messages.
    pub messages: u64,
    /// The times of the first and the last message, nanoseconds; `None` without messages.
    pub time_range: Option<[u64; 2]>,
    /// The number of attached files.
    pub attachments: u64,
    /// What ended the reading, if the file is damaged rather than cut short.
    pub damage: Option<String>,
}

/// Why a recording could not be recovered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecoverError {
    /// It cannot be read at all.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// What was read cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// Nothing is missing.
    #[error("the recording is whole: there is nothing to recover")]
    Whole,
    /// A run still writes it.
    #[error("it is being written by another process")]
    Busy,
}

/// Copies what a recording holds, up to where it was cut short or damaged, into a file with an end and an index, which
/// every viewer opens.
///
/// Its metadata tell that the run was cut short: [`Recording::complete`](crate::Recording::complete) stays false, and
/// there is a record [`RECOVERED`].
///
/// # Errors
/// [`RecoverError`]: the file cannot be read or is not MCAP, is whole, or is being written; or `target` cannot be
/// written. Then nothing is left of `target`.
pub fn recover(path: &Path, target: &Path) -> Result<Recovered, RecoverError> {
    let failed = |source| ReadError::Io { path: path.into(), source };
    let file = File::open(path).map_err(failed)?;
    if let Err(TryLockError::WouldBlock) = file.try_lock_shared() {
        return Err(RecoverError::Busy);
    }
    let sink = PartialFile::create(target)?;
    let unfinished = sink.path().to_owned();
    copy(path, Box::new(sink)).inspect_err(|_| {
        // If it stays, its name tells that it is not whole.
        let _ = fs::remove_file(unfinished);
    })
}

fn copy(path: &Path, sink: Box<dyn Sink>) -> Result<Recovered, RecoverError> {
    let mut copy = Copy {
        log: Log::new(sink, CHUNK_BYTES)?,
        schemas: BTreeMap::new(),
        topics: BTreeMap::new(),
        found: Recovered { messages: 0, time_range: None, attachments: 0, damage: None },
    };
    match records(path, |opcode, data| copy.record(opcode, data))? {
        End::Whole => return Err(RecoverError::Whole),
        End::Early => {}
        End::Damaged(error) => {
            let cause = std::error::Error::source(&error).map(|cause| format!(": {cause}"));
            copy.found.damage = Some(format!("{error}{}", cause.unwrap_or_default()));
        }
    }
    let Copy { mut log, found, .. } = copy;
    let from = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let origin = [
        ("from", from.unwrap_or_default()),
        ("messages", found.messages.to_string()),
        ("reason", found.damage.clone().unwrap_or_else(|| "cut short".to_owned())),
    ];
    let origin: Metadata = origin.map(|(key, value)| (key.to_owned(), value)).into();
    log.metadata(RECOVERED, &origin)?;
    log.finish()?;
    Ok(found)
}

struct Copy {
    log: Log<'static>,
    /// The numbers of schemas in the new file, by those in the old one.
    schemas: BTreeMap<u16, u16>,
    topics: BTreeMap<u16, Topic>,
    found: Recovered,
}

impl Copy {
    fn record(&mut self, opcode: u8, data: &[u8]) -> Result<(), RecoverError> {
        match opcode {
            op::ATTACHMENT => {
                let attached = attachment(data, usize::MAX)?;
                let time = data.first_chunk().map_or(0, |time| u64::from_le_bytes(*time));
                let content = attached.content.unwrap_or_default();
                self.log.attach(&attached.name, &attached.media_type, time, &content)?;
                self.found.attachments += 1;
            }
            op::SCHEMA | op::CHANNEL | op::METADATA | op::MESSAGE => {
                self.parsed(parse(opcode, data)?)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn parsed(&mut self, record: Record<'_>) -> Result<(), RecoverError> {
        match record {
            // Both are declared again in the summary.
            Record::Schema { header, data } if !self.schemas.contains_key(&header.id) => {
                let number = self.log.schema(&header.name, &header.encoding, &data)?;
                self.schemas.insert(header.id, number);
            }
            Record::Channel(channel) if !self.topics.contains_key(&channel.id) => {
                let schema = self.schemas.get(&channel.schema_id).copied().unwrap_or_default();
                let topic = self.log.channel(schema, &channel)?;
                self.topics.insert(channel.id, topic);
            }
            Record::Metadata(record) => self.log.metadata(&record.name, &record.metadata)?,
            Record::Message { header, data } => {
                let time = header.log_time;
                let Some(topic) = self.topics.get_mut(&header.channel_id) else {
                    let what = format!("message at {time} ns");
                    let reason = format!("channel {} is not declared", header.channel_id);
                    return Err(ReadError::Malformed { what, reason }.into());
                };
                self.log.message(topic, time, &data)?;
                self.found.messages += 1;
                let [first, last] = self.found.time_range.get_or_insert([time, time]);
                (*first, *last) = ((*first).min(time), (*last).max(time));
            }
            _ => {}
        }
        Ok(())
    }
}
