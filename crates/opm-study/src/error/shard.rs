//! Errors in the files of shards.

use opm_workspace::Shard;
use std::collections::BTreeSet;
use std::fmt;
use std::path::PathBuf;

/// A file that is not the expected shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct ShardError {
    /// The file.
    pub file: String,
    /// The problem.
    pub problem: ShardProblem,
}

/// A problem with the file of a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShardProblem {
    /// It is a recording of another kind.
    #[error("not a shard of a workspace")]
    NoShard,
    /// It ends before its description.
    #[error("cut short before it says which shard it is: sweep that shard again")]
    CutShortEarly,
    /// It is incomplete.
    #[error("cut short: sweep this shard again")]
    CutShort,
    /// It lacks data that every shard has.
    #[error("not a shard of this program: it lacks data that every shard has")]
    UnknownShard,
    /// Its description does not fit its mechanism.
    #[error("the description of its run does not fit its mechanism")]
    UnknownRun,
    /// Another version of the program wrote it, and may have other counts.
    #[error("written by {by}, but this is {this}")]
    Program {
        /// The program.
        by: String,
        /// This program.
        this: &'static str,
    },
    /// Its poses are out of order.
    #[error("pose {pose} comes after {end}")]
    Order {
        /// The pose.
        pose: u64,
        /// The end of the poses before it.
        end: u64,
    },
    /// It does not contain its mechanism.
    #[error("no mechanism file is attached")]
    NoMechanism,
    /// It is another part.
    #[error("shard {found}, expected {expected}")]
    OtherShard {
        /// The part that it is.
        found: Shard,
        /// The part that it should be.
        expected: Shard,
    },
    /// It is a part of another workspace.
    #[error("a shard of another run: {}", difference(key, found.as_deref(), expected.as_deref()))]
    OtherRun {
        /// The property in which the workspaces differ.
        key: String,
        /// The value in the file.
        found: Option<String>,
        /// The expected value.
        expected: Option<String>,
    },
    /// It is a part of a workspace of another mechanism.
    #[error("a shard of another run: its mechanism file differs")]
    OtherMechanism,
    /// It has an invalid range of an imaginary joint.
    #[error("the range of an imaginary joint is {text:?}, expected MIN:MAX")]
    Range {
        /// The range.
        text: String,
    },
    /// Its conditioning index does not belong to its poses.
    #[error("its conditioning index is not that of its poses")]
    Conditioning,
    /// Its poses do not agree with its description.
    #[error("its poses do not agree with its description")]
    Poses,
    /// Its total number of parts differs from that of the first file.
    #[error("shard {shard}, but {} is {first}", file.display())]
    OtherNumber {
        /// The part.
        shard: Shard,
        /// The file before it.
        file: PathBuf,
        /// Its part.
        first: Shard,
    },
    /// Another file is the same part.
    #[error("shard {shard} a second time, after {}", file.display())]
    Repeated {
        /// The part.
        shard: Shard,
        /// The other file.
        file: PathBuf,
    },
}

fn difference(key: &str, found: Option<&str>, expected: Option<&str>) -> String {
    match (found, expected) {
        (Some(found), Some(expected)) => format!("{key} is {found:?}, not {expected:?}"),
        (Some(found), None) => format!("it has {key}, {found:?}"),
        (None, _) => format!("it has no {key}"),
    }
}

/// Shards whose files are missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingShards {
    /// Their numbers, as ranges with both ends.
    pub ranges: Vec<[u64; 2]>,
    /// The total number of shards.
    pub of: u64,
}

impl std::error::Error for MissingShards {}

impl MissingShards {
    /// The numbers that are not among those from 1 to `of`.
    pub(crate) fn new(there: &BTreeSet<u64>, of: u64) -> Self {
        let mut ranges = Vec::new();
        let mut next = 1;
        for &number in there.iter().chain([&(of + 1)]) {
            if next < number {
                ranges.push([next, number - 1]);
            }
            next = number + 1;
        }
        Self { ranges, of }
    }

    /// The number of missing shards.
    pub fn count(&self) -> u64 {
        self.ranges.iter().map(|[from, to]| to - from + 1).sum()
    }

    /// Their numbers.
    pub fn numbers(&self) -> impl Iterator<Item = u64> + '_ {
        self.ranges.iter().flat_map(|&[from, to]| from..=to)
    }
}

impl fmt::Display for MissingShards {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = |&[from, to]: &[u64; 2]| match from == to {
            true => from.to_string(),
            false => format!("{from}-{to}"),
        };
        let ranges: Vec<String> = self.ranges.iter().map(range).collect();
        let (number, of) = (self.count(), self.of);
        let verb = if number == 1 { "is" } else { "are" };
        write!(f, "{number} of {of} shards {verb} missing: {}", ranges.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_what_is_not_there() {
        let missing =
            |numbers: &[u64], of| MissingShards::new(&numbers.iter().copied().collect(), of).ranges;
        assert_eq!(missing(&[2, 3, 7], 8), [[1, 1], [4, 6], [8, 8]]);
        assert_eq!(missing(&[1], 1_000_000), [[2, 1_000_000]]);
        assert_eq!(missing(&[1, 2], 2), [[0; 2]; 0]);
        let message = MissingShards::new(&[2, 3, 7].into(), 8).to_string();
        assert_eq!(message, "5 of 8 shards are missing: 1,4-6,8");
    }
}
