//! Shards: the parts into which a sweep is divided for several processes or machines.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of several parts of a sweep, which follow each other in the order of the grid. Its text is, for
/// instance, `3/8`: the third of eight.
///
/// ```
/// use opm_workspace::Shard;
///
/// let shard: Shard = "3/8".parse()?;
/// assert_eq!((shard.number(), shard.count()), (3, 8));
/// assert_eq!(shard.to_string(), "3/8");
/// assert!("9/8".parse::<Shard>().is_err());
/// # Ok::<(), opm_workspace::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shard {
    number: u64,
    of: u64,
}

/// A text or two numbers that do not name a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shard {0:?}, expected I/N: number I, from 1 on, of N")]
pub struct ShardError(String);

impl Shard {
    /// The whole sweep as one shard.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard number `number`, from 1 on, of `of` shards.
    ///
    /// # Errors
    /// [`ShardError`] if `number` is not from 1 to `of`.
    pub fn new(number: u64, of: u64) -> Result<Self, ShardError> {
        match number {
            1.. if number <= of => Ok(Self { number, of }),
            _ => Err(ShardError(format!("{number}/{of}"))),
        }
    }

    /// The number of the shard, from 1 on.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The number of shards that the sweep is divided into.
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
