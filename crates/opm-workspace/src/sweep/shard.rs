//! Shards: the parts into which a sweep is divided among processes or machines.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of several parts of a sweep, which follow each other in the order of the grid. As a text
/// `3/8`: the third of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shard {
    number: u64,
    of: u64,
}

/// What is no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shard {0:?}, expected I/N: number I, from 1 on, of N")]
pub struct ShardError(String);

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard number `number`, from 1 on, of so many.
    ///
    /// # Errors
    /// A number that is not among them.
    pub fn new(number: u64, of: u64) -> Result<Self, ShardError> {
        match number {
            1.. if number <= of => Ok(Self { number, of }),
            _ => Err(ShardError(format!("{number}/{of}"))),
        }
    }

    /// Its number, from 1 on.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// How many shards there are.
    pub fn count(&self) -> u64 {
        self.of
    }

    /// Its part of the numbers below `all`.
    pub(crate) fn of(&self, all: u64) -> Range<u64> {
        let end = |number: u64| (u128::from(all) * u128::from(number) / u128::from(self.of)) as u64;
        end(self.number - 1)..end(self.number)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let wrong = || ShardError(text.to_owned());
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let parse = |text: &str| text.parse().map_err(|_| wrong());
        Self::new(parse(number)?, parse(of)?).map_err(|_| wrong())
    }
}
