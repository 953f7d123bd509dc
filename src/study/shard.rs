//! Parts of a study that is shared out.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which part of a study's blocks is done where it is shared out: of those in a range, every `of`-th from the one with
/// place `number` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "(u32, u32, u64, u64)", into = "(u32, u32, u64, u64)")]
#[schemars(with = "(u32, u32, u64, u64)")]
pub struct Shard {
    pub(super) number: u32,
    pub(super) of: u32,
    /// The range begins with this block, and ends before the other or with the study's last.
    first: u64,
    end: u64,
}

impl Shard {
    /// The whole.
    pub const WHOLE: Shard = Shard { number: 0, of: 1, first: 0, end: u64::MAX };

    /// Part `number`, counted from 0, of so many; `None` if there is no such part.
    pub fn new(number: u32, of: u32) -> Option<Shard> {
        (number < of).then_some(Shard { number, of, ..Shard::WHOLE })
    }

    /// The same part of these blocks alone; `None` if there are none.
    ///
    /// ```
    /// use tautline::study::Shard;
    /// let part = Shard::new(1, 2).unwrap().within(10..15).unwrap();
    /// assert_eq!((part.count(100), part.block(0), part.block(1)), (2, 11, 13));
    /// ```
    pub fn within(self, blocks: Range<u64>) -> Option<Shard> {
        (!blocks.is_empty()).then_some(Shard { first: blocks.start, end: blocks.end, ..self })
    }

    /// How many parts there are.
    pub fn of(self) -> u32 {
        self.of
    }

    /// Whether it is a part of the whole study, and not of some of its blocks.
    pub(super) fn is_of_all(self) -> bool {
        Shard { number: 0, of: 1, ..self } == Shard::WHOLE
    }

    /// Its block number `index`, counted from 0.
    pub fn block(self, index: u64) -> u64 {
        self.first + u64::from(self.number) + index * u64::from(self.of)
    }

    /// How many of `blocks` blocks are its own.
    pub fn count(self, blocks: u64) -> u64 {
        let first = self.first.saturating_add(self.number.into());
        self.end.min(blocks).saturating_sub(first).div_ceil(self.of.into())
    }
}

/// What stands between a part and the blocks of which it is one.
const OF_BLOCKS: &str = " of blocks ";

/// Reads A..B.
fn blocks(text: &str) -> Option<Range<u64>> {
    let (first, end) = text.split_once("..")?;
    Some(first.parse().ok()?..end.parse().ok()?)
}

impl FromStr for Shard {
    type Err = String;

    /// Reads K/N, or K@A-B for task K of those that are numbered from A to B; and what is [written](fmt::Display) of a
    /// part.
    ///
    /// ```
    /// use tautline::study::Shard;
    /// assert_eq!("6@1-6".parse::<Shard>(), "5/6".parse());
    /// assert!("6/6".parse::<Shard>().is_err() && "0@1-6".parse::<Shard>().is_err());
    /// ```
    fn from_str(text: &str) -> Result<Shard, String> {
        let wrong = || {
            "give K/N with K from 0 to N - 1, such as 0/4, or K@A-B for task K of those numbered from A to B, such as \
             6@1-6"
                .to_owned()
        };
        let (part, range) = match text.split_once(OF_BLOCKS) {
            Some((part, range)) => (part, Some(blocks(range).ok_or_else(wrong)?)),
            None => (text, None),
        };
        let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
        let part = match (part.split_once('/'), part.split_once('@')) {
            (Some((k, of)), _) => Shard::new(number(k)?, number(of)?),
            (_, Some((k, tasks))) => {
                let (first, last) = tasks.split_once('-').ok_or_else(wrong)?;
                let [k, first, last] = [number(k)?, number(first)?, number(last)?];
                let of = last.checked_sub(first).and_then(|others| others.checked_add(1));
                k.checked_sub(first).zip(of).and_then(|(k, of)| Shard::new(k, of))
            }
            _ => None,
        };
        let part = part.ok_or_else(wrong)?;
        range.map_or(Some(part), |range| part.within(range)).ok_or_else(wrong)
    }
}

impl TryFrom<(u32, u32, u64, u64)> for Shard {
    type Error = String;

    fn try_from((number, of, first, end): (u32, u32, u64, u64)) -> Result<Shard, String> {
        let part = Shard::new(number, of).and_then(|part| part.within(first..end));
        part.ok_or_else(|| format!("there is no shard {number}/{of}{OF_BLOCKS}{first}..{end}"))
    }
}

impl From<Shard> for (u32, u32, u64, u64) {
    fn from(part: Shard) -> Self {
        (part.number, part.of, part.first, part.end)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)?;
        if self.is_of_all() { Ok(()) } else { write!(f, "{OF_BLOCKS}{}..{}", self.first, self.end) }
    }
}

/// Reads blocks as A..B: those from A on, counted from 0, up to that before B.
///
/// # Errors
///
/// What would be right.
pub fn read_blocks(text: &str) -> Result<Range<u64>, String> {
    let wrong = || "give A..B for the blocks from A on, counted from 0, up to that before B, such as 0..100".to_owned();
    blocks(text).filter(|blocks| !blocks.is_empty()).ok_or_else(wrong)
}

/// Numbers, in their order, as ranges A..B that may be read again: the first of them, if there are very many.
pub(crate) fn as_ranges(numbers: impl IntoIterator<Item = u64>) -> String {
    const MOST: usize = 100;
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for number in numbers {
        let count = ranges.len();
        match ranges.last_mut().filter(|last| last.end == number) {
            Some(last) => last.end += 1,
            None if count > MOST => break,
            None => ranges.push(number..number + 1),
        }
    }
    let more = if ranges.len() > MOST { ", ..." } else { "" };
    let texts: Vec<String> = ranges.iter().take(MOST).map(|r| format!("{}..{}", r.start, r.end)).collect();
    texts.join(", ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_that_cannot_be_is_not_read() {
        let read = |shard: (u32, u32, u64, u64)| postcard::from_bytes::<Shard>(&postcard::to_stdvec(&shard).unwrap());
        let shard = Shard::new(1, 3).unwrap().within(2..9).unwrap();
        assert_eq!(read(shard.into()), Ok(shard));
        for nowhere in [(0, 0, 0, 9), (3, 3, 0, 9), (0, 1, 4, 4), (0, 1, 5, 4)] {
            assert!(read(nowhere).is_err());
        }
    }

    #[test]
    fn a_shard_is_read_as_it_is_written() {
        for shard in ["0/1", "5/6", "5/6 of blocks 3..900"] {
            assert_eq!(shard.parse::<Shard>().unwrap().to_string(), shard);
        }
        for (tasks, shard) in [("1@1-6", "0/6"), ("6@1-6", "5/6"), ("0@0-0", "0/1"), ("9@7-9", "2/3")] {
            assert_eq!(tasks.parse::<Shard>(), shard.parse());
        }
        for wrong in ["6/6", "0@1-6", "7@1-6", "1@6-1", "1@6", "1", "", "1/2 of blocks 3..3", "-1/2", "1/2@1-2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert_eq!((read_blocks("3..9"), read_blocks("9..3").is_err()), (Ok(3..9), true));
        assert_eq!(as_ranges([0, 1, 2, 7, 9, 10]), "0..3, 7..8, 9..11");
        assert!(as_ranges((0..500).map(|i| 2 * i)).ends_with("198..199, ..."));
    }

    #[test]
    fn shards_share_out_all_blocks() {
        for of in 1..6 {
            for blocks in 0..20 {
                let shards = (0..of).map(|number| Shard::new(number, of).unwrap());
                let ranges = [0..7, 7..8, 8..u64::MAX];
                let parts = shards.flat_map(|s| ranges.clone().map(|range| s.within(range).unwrap()));
                let mut all: Vec<u64> = parts.flat_map(|s| (0..s.count(blocks)).map(move |i| s.block(i))).collect();
                all.sort_unstable();
                assert_eq!(all, (0..blocks).collect::<Vec<_>>());
            }
        }
    }
}
