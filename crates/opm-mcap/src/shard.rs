//! The file of a shard: the reachable poses of a part of a sweep, by their numbers.
//!
//! | record | content |
//! |---|---|
//! | attachment | the mechanism file |
//! | metadata `run` | the caller's description of the whole run, which is the same in all of its shards |
//! | metadata `shard` | which part this is |
//! | topic [`RUNS_TOPIC`] | the poses, as `opm.Runs` |
//! | metadata `result` | the caller's description of the outcome; last, with `complete = "true"` |
//!
//! `opm.Runs` is `message Runs { uint64 start = 1; repeated uint64 lengths = 2; }`. From pose number
//! `start` on, `lengths` are in alternation the numbers of poses out of reach and in reach; the last of them
//! are in reach. Messages follow each other in the order of their poses. The poses between the last run
//! of one message and the `start` of the next, and behind the last message, are out of reach.

use crate::decode::varint;
use crate::joints::{self, Field};
use crate::log::{CHUNK_BYTES, Log, Topic};
use crate::{Metadata, RecordError, Sink};

/// The topic of the runs.
pub const RUNS_TOPIC: &str = "/shard/runs";
/// The schema of its messages.
pub const RUNS_SCHEMA: &str = "opm.Runs";

/// The time of the first message, and between messages, nanoseconds. Messages are counted with it, not time.
const START: u64 = 1_000_000_000;
const STEP: u64 = 1_000_000;
/// The number of bytes of lengths after which a message is closed.
const MESSAGE_BYTES: usize = 1 << 18;

/// Keys of the message's fields: number 1, an integer; number 2, packed integers.
const START_KEY: u8 = 1 << 3;
const LENGTHS_KEY: u8 = 2 << 3 | 2;

/// The head of a shard's file.
#[derive(Debug, Clone)]
pub struct Shard<'a> {
    /// The name of the mechanism file.
    pub mechanism_name: &'a str,
    /// The mechanism file itself (TOML).
    pub mechanism: &'a [u8],
    /// The description of the whole run.
    pub run: Metadata,
    /// The description of this part of it.
    pub shard: Metadata,
}

/// Writes a shard's file. Any error is final. It takes the memory of one message.
///
/// ```
/// use opm_mcap::{Metadata, PartialFile, ReadError, Shard, ShardRecorder, read};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("part.mcap");
/// let shard = Shard {
///     mechanism_name: "m.toml",
///     mechanism: b"",
///     run: Metadata::new(),
///     shard: Metadata::from([("number".into(), "1".into())]),
/// };
/// let mut recorder = ShardRecorder::new(PartialFile::create(&path)?, &shard)?;
/// recorder.push(3, 10)?;
/// recorder.push(12, 13)?;
/// recorder.finish(&Metadata::new())?;
///
/// let mut runs = Vec::new();
/// read::<ReadError>(&path, |message| {
///     runs.extend(message.runs()?.into_iter().flatten());
///     Ok(())
/// })?;
/// assert_eq!(runs, [[3, 10], [12, 13]]);
/// # Ok(())
/// # }
/// ```
pub struct ShardRecorder<'w> {
    log: Log<'w>,
    topic: Topic,
    messages: u64,
    /// The first pose of the open message, and one more than its last pose.
    open: [u64; 2],
    lengths: Vec<u8>,
}

impl<'w> ShardRecorder<'w> {
    /// Starts a file that is written to `sink`.
    ///
    /// # Errors
    /// A failed write ([`RecordError::Io`]).
    pub fn new(sink: impl Sink + 'w, shard: &Shard<'_>) -> Result<Self, RecordError> {
        Self::begin(Box::new(sink), shard)
    }

    fn begin(sink: Box<dyn Sink + 'w>, shard: &Shard<'_>) -> Result<Self, RecordError> {
        let mut log = Log::new(sink, CHUNK_BYTES)?;
        log.attach(shard.mechanism_name, "application/toml", START, shard.mechanism)?;
        log.metadata("run", &shard.run)?;
        log.metadata("shard", &shard.shard)?;
        let fields = [Field::number("start"), Field::numbers("lengths")];
        let topic = log.topic_of(RUNS_TOPIC, RUNS_SCHEMA, &joints::descriptor("Runs", &fields))?;
        Ok(Self { log, topic, messages: 0, open: [0; 2], lengths: Vec::new() })
    }

    /// Adds the poses with numbers from `from` up to, not including, `to`. They have to come behind all poses
    /// before, and to be at least one.
    ///
    /// # Errors
    /// [`RecordError::Run`] for a run that is empty or out of order, or a failed write.
    pub fn push(&mut self, from: u64, to: u64) -> Result<(), RecordError> {
        let [_, end] = self.open;
        if from < end || to <= from {
            self.log.give_up();
            return Err(RecordError::Run { from, to, end });
        }
        if self.lengths.is_empty() {
            self.open = [from; 2];
        }
        joints::varint(&mut self.lengths, from - self.open[1]);
        joints::varint(&mut self.lengths, to - from);
        self.open[1] = to;
        if self.lengths.len() >= MESSAGE_BYTES { self.write() } else { Ok(()) }
    }

    /// Completes the file, which only now gets its name. `result` is the last metadata record, with
    /// `complete = "true"` added.
    ///
    /// # Errors
    /// A failed write.
    pub fn finish(mut self, result: &Metadata) -> Result<(), RecordError> {
        if !self.lengths.is_empty() {
            self.write()?;
        }
        let mut result = result.clone();
        result.insert("complete".into(), "true".into());
        self.log.metadata("result", &result)?;
        self.log.finish()
    }

    fn write(&mut self) -> Result<(), RecordError> {
        let mut message = vec![START_KEY];
        joints::varint(&mut message, self.open[0]);
        message.push(LENGTHS_KEY);
        joints::varint(&mut message, self.lengths.len() as u64);
        message.append(&mut self.lengths);
        let time = START + self.messages * STEP;
        self.messages += 1;
        self.log.message(&mut self.topic, time, &message)
    }
}

/// The runs in an encoded message, `[from, to)`; the error says what is wrong with it.
pub(crate) fn decode(message: &[u8]) -> Result<Vec<[u64; 2]>, &'static str> {
    let mut rest = message;
    let mut key = |expected| match rest.split_off_first() {
        Some(&key) if key == expected => varint(&mut rest),
        _ => None,
    };
    let fields = key(START_KEY).zip(key(LENGTHS_KEY));
    let (mut end, length) = fields.ok_or("not a start and lengths")?;
    if length != rest.len() as u64 {
        return Err("the lengths are not all there");
    }
    let mut runs = Vec::new();
    while !rest.is_empty() {
        let mut next = || varint(&mut rest).and_then(|length| end.checked_add(length));
        let from = next().ok_or("a gap is not a number")?;
        end = from;
        let mut next = || varint(&mut rest).and_then(|length| end.checked_add(length));
        let to = next().filter(|&to| to > from).ok_or("a run is not a number, or is empty")?;
        end = to;
        runs.push([from, to]);
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn recorder(bytes: &mut Vec<u8>) -> ShardRecorder<'_> {
        let (run, shard) = (Metadata::new(), Metadata::new());
        let shard = Shard { mechanism_name: "m.toml", mechanism: b"", run, shard };
        ShardRecorder::new(Cursor::new(bytes), &shard).unwrap()
    }

    #[test]
    fn runs_come_in_order() {
        for wrong in [[4, 6], [5, 5], [7, 6]] {
            let mut bytes = Vec::new();
            let mut recorder = recorder(&mut bytes);
            recorder.push(0, 5).unwrap();
            let error = recorder.push(wrong[0], wrong[1]).unwrap_err();
            assert!(matches!(error, RecordError::Run { end: 5, .. }), "{error}");
            assert!(recorder.finish(&Metadata::new()).is_err(), "an error is final");
        }
    }

    /// `Runs(start=300, lengths=[2, 5, 1000, 1])`, as protobuf for Python encodes it.
    #[test]
    fn a_message_is_what_protobuf_makes_of_it() {
        let message = b"\x08\xac\x02\x12\x05\x02\x05\xe8\x07\x01";
        assert_eq!(decode(message).unwrap(), [[302, 307], [1307, 1308]]);
        for length in 0..message.len() {
            assert!(decode(&message[..length]).is_err(), "{length}");
        }
        // A run of no poses; a length beyond all numbers.
        assert!(decode(b"\x08\x00\x12\x02\x02\x00").is_err());
        let beyond = [&b"\x08\x05\x12\x0b"[..], &[0xff; 9], b"\x01\x01"].concat();
        assert!(decode(&beyond).is_err());
    }
}
