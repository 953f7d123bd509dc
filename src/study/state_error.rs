//! Why a state file cannot be used.

use std::io;
use std::path::PathBuf;

use super::shard::Shard;

/// Why a state file cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", .path.display())]
pub struct StateError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub fault: StateFault,
}

/// What is wrong with a state file, or with one of the shards that are to be merged.
#[derive(Debug, thiserror::Error)]
pub enum StateFault {
    /// It could not even be read, so that nothing is known of it.
    #[error(transparent)]
    Unread(#[from] io::Error),
    /// It holds something else.
    #[error("not the state of a study")]
    NoState,
    /// Its layout is another one.
    #[error("the state of another version of tautline")]
    OtherVersion,
    /// It ends before its check sum does.
    #[error("damaged: it ends too early")]
    Short,
    /// It is not what was written.
    #[error("damaged: its check sum is wrong")]
    CheckSum,
    /// Its content cannot be understood.
    #[error("damaged: {0}")]
    Content(#[from] postcard::Error),
    /// It counts more than its study has.
    #[error("damaged: it counts more traces than there are")]
    Excess,
    /// Its study is another one.
    #[error("it belongs to another study: the plan, the scene or the traces are others")]
    Foreign,
    /// Parts with fewer traces were put together in it, so that it cannot go on.
    #[error("put together from parts with fewer traces: merge them again")]
    Merged,
    /// There is nothing to merge.
    #[error("no shards are given")]
    NoShards,
    /// The shard was given before.
    #[error("shard {0} is there twice")]
    Twice(Shard),
    /// Another part has a block that this one has.
    #[error("block {block} is in {} too", .other.display())]
    Shared {
        /// The block's number.
        block: u64,
        /// The other part.
        other: PathBuf,
    },
    /// A shard was not given.
    #[error("shard {number}/{of} is missing")]
    MissingShard {
        /// The number of the shard that is missing.
        number: u32,
        /// How many shards there are.
        of: u32,
    },
    /// Blocks are in no part.
    #[error("blocks {blocks} are missing, of {all}")]
    MissingBlocks {
        /// Their numbers, as ranges.
        blocks: String,
        /// How many blocks there are.
        all: u64,
    },
    /// The shard is not done.
    #[error("shard {shard} is not done: {done} of {all} blocks; resume it first")]
    Undone {
        /// The shard.
        shard: Shard,
        /// How many blocks are done.
        done: u64,
        /// How many it has.
        all: u64,
    },
}

impl StateError {
    /// Whether the state belongs to another study.
    pub fn is_foreign(&self) -> bool {
        matches!(self.fault, StateFault::Foreign)
    }

    /// Whether the file was read and is damaged or another's, so that nothing is lost with it.
    pub fn is_useless(&self) -> bool {
        !matches!(self.fault, StateFault::Unread(_) | StateFault::Foreign | StateFault::Merged)
    }
}
