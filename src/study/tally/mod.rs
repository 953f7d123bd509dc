//! What is counted of every trace, block by block.
//!
//! All but the moments are whole numbers, so that blocks may be put together in any order; the moments are kept for each
//! block and put together in the order of the blocks.

mod batches;
mod block;
mod counts;
mod lengths;
mod moments;
mod ropes;
mod setting;
mod winding;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub(super) use batches::{Batches, Sizes};
pub(super) use block::{Block, Traced};
pub(super) use counts::{CellCounts, Counts, Touched, Wound};
pub(super) use lengths::of_rank;
pub(crate) use moments::Moments;
pub(super) use setting::Setting;

/// The numbers of which every trace has one.
pub(super) const SCALARS: [&str; 6] = ["length", "max_length", "depth", "max_depth", "wraps", "unwraps"];

/// What some blocks of a study have counted.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Tallies {
    /// The moments of each block's scalars.
    pub moments: BTreeMap<u64, [Moments; SCALARS.len()]>,
    pub counts: Counts,
}

impl Tallies {
    /// Adds a block. Its number must be new.
    pub(super) fn add(&mut self, block: u64, moments: [Moments; SCALARS.len()], counts: Counts) {
        let known = self.moments.insert(block, moments);
        debug_assert!(known.is_none(), "a block is added once");
        self.counts.merge(counts);
    }

    /// Adds another part of the study, none of whose blocks is here.
    pub(super) fn merge(&mut self, other: Tallies) {
        self.moments.extend(other.moments);
        self.counts.merge(other.counts);
    }

    /// The moments over all blocks, in their order.
    pub(super) fn scalars(&self) -> [Moments; SCALARS.len()] {
        let mut all = [Moments::default(); SCALARS.len()];
        for block in self.moments.values() {
            all.iter_mut().zip(block).for_each(|(all, block)| all.merge(block));
        }
        all
    }
}
