//! Parts of a study that is shared out.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which part of a study's blocks is done where it is shared out: those whose number leaves `number` when divided by
/// `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "(u32, u32)")]
#[schemars(with = "(u32, u32)")]
pub struct Shard {
    pub(super) number: u32,
    pub(super) of: u32,
}

impl Shard {
    /// The whole.
    pub const WHOLE: Shard = Shard { number: 0, of: 1 };

    /// Part `number`, counted from 0, of so many; `None` if there is no such part.
    pub fn new(number: u32, of: u32) -> Option<Shard> {
        (number < of).then_some(Shard { number, of })
    }

    /// How many parts there are.
    pub fn of(self) -> u32 {
        self.of
    }

    /// Its block number `index`, counted from 0.
    pub fn block(self, index: u64) -> u64 {
        u64::from(self.number) + index * u64::from(self.of)
    }

    /// How many of `blocks` blocks are its own.
    pub fn count(self, blocks: u64) -> u64 {
        (blocks + u64::from(self.of) - 1).saturating_sub(u64::from(self.number)) / u64::from(self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    /// Reads K/N.
    fn from_str(text: &str) -> Result<Shard, String> {
        let wrong = || "give K/N with K from 0 to N - 1, such as 0/4".to_owned();
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let [number, of] = [number, of].map(|n| n.parse::<u32>().map_err(|_| wrong()));
        Shard::new(number?, of?).ok_or_else(wrong)
    }
}

impl TryFrom<(u32, u32)> for Shard {
    type Error = String;

    fn try_from((number, of): (u32, u32)) -> Result<Shard, String> {
        Shard::new(number, of).ok_or_else(|| format!("there is no shard {number}/{of}"))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}
