//! How far a study is, in memory and as a file.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::opened::Study;
use super::shard::Shard;
use super::state_error::{StateError, StateFault};
use super::tally::{Block, Counts, Merge};
use crate::output::{WholeFile, WriteError};

/// What a state file begins with, before the hash of its layout.
const MAGIC: &str = "tautline study state ";

/// The first line of a state file. It tells what the fields of a state are and of which types, so that none is read
/// that has others: not their numbers, which [`ANSWERS`](super::opened::ANSWERS) stands for.
fn first_line() -> Vec<u8> {
    let hash = blake3::hash(layout::<State>().to_string().as_bytes()).to_hex();
    format!("{MAGIC}{}\n", &hash[..8]).into_bytes()
}

/// The names of all fields, in their order, and their types.
fn layout<T: JsonSchema>() -> serde_json::Value {
    fn without_words(schema: &mut serde_json::Value) {
        if let Some(fields) = schema.as_object_mut() {
            fields.retain(|name, value| name != "description" || !value.is_string());
        }
        schema.as_object_mut().into_iter().flat_map(|fields| fields.values_mut()).for_each(without_words);
        schema.as_array_mut().into_iter().flatten().for_each(without_words);
    }
    let mut schema = schemars::schema_for!(T).to_value();
    without_words(&mut schema);
    schema
}

/// Why a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// All traces are done; of a shard, all its own.
    Complete,
    /// The mean is as certain as was asked for.
    RelativeError,
    /// The time was over.
    Seconds,
    /// It has not ended.
    Unfinished,
}

/// How far a study, or a shard of one, is.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
pub struct State {
    pub(super) identity: String,
    pub(super) shard: Shard,
    /// How many of the shard's blocks are done: the first ones.
    pub(super) done: u64,
    /// What was counted of the block after those, of which only some traces are evaluated.
    pub(super) open: Option<Block>,
    pub(super) stopped: Stopped,
    /// How long that took, in seconds.
    pub(super) seconds: f64,
    pub(super) counts: Counts,
    /// What is kept beside the state, so that it is known again.
    pub kept: Kept,
}

/// A check sum: BLAKE3.
pub type Check = [u8; blake3::OUT_LEN];

/// What is kept beside a state, with check sums by which it is known again.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Kept {
    /// Files of rows, in the order of their traces.
    pub parts: Vec<Part>,
    /// Other files, by their names.
    pub files: BTreeMap<String, Check>,
}

/// A file of rows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Part {
    /// Of which traces it has rows: their [places](Study::places) in the shard.
    pub places: Range<u64>,
    /// What it holds.
    pub check: Check,
}

impl State {
    /// Nothing is done.
    pub fn new(study: &Study, shard: Shard) -> Self {
        // There may be more parts than blocks.
        let nothing_to_do = shard.count(study.plan().blocks()) == 0;
        State {
            identity: study.identity().to_owned(),
            shard,
            done: 0,
            open: None,
            kept: Kept::default(),
            stopped: if nothing_to_do { Stopped::Complete } else { Stopped::Unfinished },
            seconds: 0.0,
            counts: Counts::default(),
        }
    }

    /// Which part of the study it is.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// How many of its blocks are done.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// How many of the shard's traces are evaluated: the first ones, those of a block that is not done included.
    pub fn place(&self, study: &Study) -> u64 {
        let whole = self.done.saturating_mul(study.plan().run.block.into()).min(study.places(self.shard));
        whole.saturating_add(self.open.as_ref().map_or(0, Block::traces))
    }

    /// How many traces the blocks have that are done.
    pub fn traces(&self) -> u64 {
        self.counts.totals.traces.sum
    }

    /// Whether there is nothing left to do, and why.
    pub fn stopped(&self) -> Stopped {
        self.stopped
    }

    /// How long it has taken so far, in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Saves the state at `path`, in place of what stands there: whole or not at all, whatever happens meanwhile.
    ///
    /// # Errors
    ///
    /// What the operating system says.
    pub fn save(&self, path: &Path) -> Result<(), WriteError> {
        let bytes = postcard::to_stdvec(self).expect("a state can be written");
        let mut file = WholeFile::create(path)?;
        let mut write =
            |bytes: &[u8]| file.write_all(bytes).map_err(|cause| WriteError::Io { path: path.into(), cause });
        write(&first_line())?;
        write(blake3::hash(&bytes).as_bytes())?;
        write(&bytes)?;
        file.finish_durably()
    }

    /// Reads a state and checks that it is whole and of this study.
    ///
    /// # Errors
    ///
    /// A file that is no state, was written by another version, is damaged, or belongs to another study.
    pub fn load(path: &Path, study: &Study) -> Result<Self, StateError> {
        State::parse(path, study).map_err(|fault| StateError { path: path.to_owned(), fault })
    }

    fn parse(path: &Path, study: &Study) -> Result<Self, StateFault> {
        let bytes = fs::read(path)?;
        let Some(rest) = bytes.strip_prefix(first_line().as_slice()) else {
            let is_kin = bytes.starts_with(MAGIC.as_bytes());
            return Err(if is_kin { StateFault::OtherVersion } else { StateFault::NoState });
        };
        let (hash, payload) = rest.split_at_checked(blake3::OUT_LEN).ok_or(StateFault::Short)?;
        if blake3::hash(payload).as_bytes() != hash {
            return Err(StateFault::CheckSum);
        }
        let state: State = postcard::from_bytes(payload)?;
        if state.identity != study.identity() {
            return Err(StateFault::Foreign);
        }
        let most = study.places(state.shard);
        let is_open = state.stopped == Stopped::Unfinished && state.place(study) < most;
        if state.place(study) > most || (state.open.is_some() && !is_open) {
            return Err(StateFault::Excess);
        }
        Ok(state)
    }
}

/// Puts the shards of one study together.
///
/// # Errors
///
/// Shards that belong to another study, are not all there, are there twice, or are not done; and none at all.
pub fn merge(study: &Study, mut shards: Vec<(PathBuf, State)>) -> Result<State, StateError> {
    shards.sort_by_key(|(_, state)| state.shard);
    let fault = |path: &Path, fault| Err(StateError { path: path.to_owned(), fault });
    let mut whole = State::new(study, Shard::WHOLE);
    let blocks = study.plan().blocks();
    let Some(of) = shards.first().map(|(_, state)| state.shard.of) else {
        return fault(Path::new(""), StateFault::NoShards);
    };
    if let [(_, state)] = shards.as_slice()
        && (of, state.stopped == Stopped::Unfinished, &state.identity) == (1, false, &whole.identity)
    {
        // A study that was not shared out, which may have stopped before its last block.
        return Ok(State { kept: Kept::default(), ..shards.remove(0).1 });
    }
    for (i, (path, state)) in shards.iter().enumerate() {
        let shard = state.shard;
        if state.identity != whole.identity {
            return fault(path, StateFault::Foreign);
        }
        if shard.of != of {
            return fault(path, StateFault::Parts { parts: shard.of, of });
        }
        if (shard.number as usize) < i {
            return fault(path, StateFault::Twice(shard));
        }
        if shard.number as usize > i {
            let missing = Shard { number: i as u32, of };
            return fault(path, StateFault::Missing { missing, found: Some(shard) });
        }
        let (done, all) = (state.done, shard.count(blocks));
        if done != all {
            return fault(path, StateFault::Undone { shard, done, all });
        }
    }
    if let Some((path, _)) = shards.last()
        && shards.len() < of as usize
    {
        return fault(path, StateFault::Missing { missing: Shard { number: shards.len() as u32, of }, found: None });
    }
    for (_, state) in shards {
        whole.seconds += state.seconds;
        whole.counts.merge_with(state.counts);
    }
    whole.done = blocks;
    whole.stopped = Stopped::Complete;
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_is_what_fields_there_are_in_which_order() {
        /// A state.
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        #[allow(dead_code)]
        struct Old {
            /// Before.
            first: u64,
            second: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        #[allow(dead_code)]
        struct Reworded {
            first: u64,
            second: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        #[allow(dead_code)]
        struct Turned {
            second: u64,
            first: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        #[allow(dead_code)]
        struct Retyped {
            first: u64,
            second: u64,
            counts: Vec<Inner<f64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "I")]
        #[allow(dead_code)]
        struct Inner<T> {
            count: T,
        }
        let old = layout::<Old>();
        assert_eq!(old, layout::<Reworded>());
        assert!(old != layout::<Turned>() && old != layout::<Retyped>());
    }

    #[test]
    fn a_shard_that_cannot_be_is_not_read() {
        let read = |bytes: [u8; 2]| postcard::from_bytes::<Shard>(&bytes);
        let shard = Shard { number: 1, of: 3 };
        assert_eq!((read([1, 3]).unwrap(), postcard::to_stdvec(&shard).unwrap()), (shard, vec![1, 3]));
        for nowhere in [[0, 0], [3, 3]] {
            assert!(read(nowhere).is_err());
        }
    }

    #[test]
    fn shards_share_out_all_blocks() {
        for of in 1..6 {
            for blocks in 0..20 {
                let shards = (0..of).map(|number| Shard { number, of });
                let mut all: Vec<u64> = shards.flat_map(|s| (0..s.count(blocks)).map(move |i| s.block(i))).collect();
                all.sort_unstable();
                assert_eq!(all, (0..blocks).collect::<Vec<_>>());
            }
        }
    }
}
