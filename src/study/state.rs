//! How far a study is, in memory and as a file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::moments::Moments;
use super::opened::Study;
use super::shard::Shard;
use super::state_error::{StateError, StateFault};
use super::tally::{Block, Counts, Merge};
use crate::output::{WholeFile, WriteError};

/// What a state file begins with, before the hash of its layout.
const MAGIC: &str = "tautline study state ";

/// The first line of a state file. It tells what the fields of a state are and of which types, so that none is read
/// that has others: not their numbers, which [`ANSWERS`](super::opened::ANSWERS) stands for.
static FIRST_LINE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let hash = blake3::hash(layout::<State>().to_string().as_bytes()).to_hex();
    format!("{MAGIC}{}\n", &hash[..8]).into_bytes()
});

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
    /// What was counted of the block after those, of which only some traces are evaluated; of one that has ended, of
    /// the last of those if that is smaller than others: the study may be given more traces.
    pub(super) open: Option<Block>,
    pub(super) stopped: Stopped,
    /// How long that took, in seconds.
    pub(super) seconds: f64,
    /// The blocks that are done, each with the moments of its greatest lengths, by which a study may end.
    pub(super) blocks: BTreeMap<u64, Moments>,
    /// What was counted of all those together that are neither open nor apart.
    pub(super) counts: Counts,
    /// What was counted of each of those that may turn out to lie behind the study's end.
    pub(super) apart: BTreeMap<u64, Counts>,
    /// Whether it was put together from some parts of the study, so that it cannot be gone on with.
    pub(super) is_partial: bool,
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
            blocks: BTreeMap::new(),
            counts: Counts::default(),
            apart: BTreeMap::new(),
            is_partial: false,
        }
    }

    /// Whether the study may end before blocks that this part of it counts.
    pub(super) fn may_count_too_many(&self, study: &Study) -> bool {
        study.plan().until.relative_error.is_some() && self.shard != Shard::WHOLE
    }

    /// The last block of the study, if that is smaller than others and done here.
    pub(super) fn short(&self) -> Option<&Block> {
        self.open.as_ref().filter(|_| self.stopped != Stopped::Unfinished || self.is_partial)
    }

    /// What was counted of all blocks that are done.
    pub(super) fn counted(&self, study: &Study) -> Cow<'_, Counts> {
        let mut counts = Cow::Borrowed(&self.counts);
        self.apart.values().for_each(|block| counts.to_mut().merge_with(block.clone()));
        if let (Some(block), Some((&number, _))) = (self.short(), self.blocks.last_key_value()) {
            counts.to_mut().merge_with(block.clone().finish(&study.tallies, number));
        }
        counts
    }

    /// Whether it was put together from some parts of the study only, so that nothing can go on with it.
    pub fn is_partial(&self) -> bool {
        self.is_partial
    }

    /// The study's blocks that are done here.
    pub fn blocks(&self) -> impl Iterator<Item = u64> + use<'_> {
        self.blocks.keys().copied()
    }

    /// The identity of its study.
    pub fn identity(&self) -> &str {
        &self.identity
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
        let open = self.open.as_ref().filter(|_| self.short().is_none()).map_or(0, Block::traces);
        whole.saturating_add(open)
    }

    /// How many traces the blocks have that are done.
    pub fn traces(&self) -> u64 {
        self.blocks.values().map(|longest| longest.count).sum()
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
        write(&FIRST_LINE)?;
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
        State::parse(path)
            .and_then(|state| match () {
                () if state.identity != study.identity() => Err(StateFault::Foreign),
                () if !state.is_sound(study) => Err(StateFault::Excess),
                () => Ok(state),
            })
            .map_err(|fault| StateError { path: path.to_owned(), fault })
    }

    /// Whether it counts traces that there are.
    fn is_sound(&self, study: &Study) -> bool {
        let size = |block: u64| study.block(block).count() as u64;
        let (blocks, all) = (study.plan().blocks(), self.shard.count(study.plan().blocks()));
        let own = (0..self.done.min(all)).map(|index| self.shard.block(index));
        let is_open = self.stopped == Stopped::Unfinished && self.place(study) < study.places(self.shard);
        let is_short = |open: &Block| {
            let last = self.blocks.last_key_value().filter(|(block, _)| **block + 1 == blocks);
            self.short().is_some() && last.is_some_and(|(&block, _)| size(block) == open.traces())
        };
        self.done <= all
            && self.blocks.iter().all(|(&block, longest)| block < blocks && longest.count == size(block))
            && (self.is_partial || self.blocks().eq(own))
            && self.open.as_ref().is_none_or(|open| is_open || is_short(open))
    }

    /// Reads the state of the same study with fewer traces, `traces` of them, and has it go on: what is done stays
    /// done.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn load_raised(path: &Path, study: &Study, traces: u64) -> Result<Self, StateError> {
        State::raised(path, study, traces).map_err(|fault| StateError { path: path.to_owned(), fault })
    }

    fn raised(path: &Path, study: &Study, traces: u64) -> Result<Self, StateFault> {
        let mut state = State::parse(path)?;
        if !study.identity_with(traces).is_ok_and(|before| before == state.identity) {
            return Err(StateFault::Foreign);
        }
        state.identity = study.identity().to_owned();
        if state.short().is_some() && !state.is_partial {
            // It is no whole block any more.
            state.done = state.done.saturating_sub(1);
            state.blocks.pop_last();
            state.stopped = Stopped::Unfinished;
        } else if state.stopped == Stopped::Complete && state.done < state.shard.count(study.plan().blocks()) {
            state.stopped = Stopped::Unfinished;
        }
        if state.is_partial || !state.is_sound(study) {
            return Err(StateFault::Merged);
        }
        Ok(state)
    }

    /// Reads a state of whatever study and checks that it is as it was written.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load), but for those about the study.
    pub fn read(path: &Path) -> Result<Self, StateError> {
        State::parse(path).map_err(|fault| StateError { path: path.to_owned(), fault })
    }

    fn parse(path: &Path) -> Result<Self, StateFault> {
        let bytes = fs::read(path)?;
        let Some(rest) = bytes.strip_prefix(FIRST_LINE.as_slice()) else {
            let is_kin = bytes.starts_with(MAGIC.as_bytes());
            return Err(if is_kin { StateFault::OtherVersion } else { StateFault::NoState });
        };
        let (hash, payload) = rest.split_at_checked(blake3::OUT_LEN).ok_or(StateFault::Short)?;
        if blake3::hash(payload).as_bytes() != hash {
            return Err(StateFault::CheckSum);
        }
        Ok(postcard::from_bytes(payload)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(dead_code, reason = "of these types there are layouts, no values")]
    fn a_layout_is_what_fields_there_are_in_which_order() {
        /// A state.
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        struct Old {
            /// Before.
            first: u64,
            second: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        struct Reworded {
            first: u64,
            second: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        struct Turned {
            second: u64,
            first: u64,
            counts: Vec<Inner<u64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "S")]
        struct Retyped {
            first: u64,
            second: u64,
            counts: Vec<Inner<f64>>,
        }
        #[derive(JsonSchema)]
        #[schemars(rename = "I")]
        struct Inner<T> {
            count: T,
        }
        let old = layout::<Old>();
        assert_eq!(old, layout::<Reworded>());
        assert!(old != layout::<Turned>() && old != layout::<Retyped>());
    }
}
