//! How common each taut rope is.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;
use serde::{Deserialize, Serialize};

/// How many different ropes of each block are counted at the most: the most common ones.
const ROPES_A_BLOCK: usize = 256;

/// A taut rope: its anchor's number, then for each contact twice the wall end's number, and one more if it lies right.
pub(crate) type Key = Vec<u32>;

/// Counts of ropes. In each block the most common ropes are counted and the others left out, so that memory grows slowly: by
/// no more than these a block, and in fact by those that were not common before. What may be missing from a count is known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Ropes {
    counts: BTreeMap<Key, u64>,
    /// By how much each count can be too low at the most: in each block, by as much as the least count that was kept.
    missing: u64,
}

impl Ropes {
    /// The ropes of one block, with how many traces ended with each.
    pub(super) fn of_block(counts: HashMap<Key, u64>) -> Self {
        if counts.len() <= ROPES_A_BLOCK {
            return Ropes { counts: counts.into_iter().collect(), missing: 0 };
        }
        let mut all: Vec<(Key, u64)> = counts.into_iter().collect();
        all.sort_unstable_by(|(k, n), (l, m)| m.cmp(n).then_with(|| k.cmp(l)));
        all.truncate(ROPES_A_BLOCK);
        let missing = all.last().map_or(0, |last| last.1);
        Ropes { counts: all.into_iter().collect(), missing }
    }

    pub(crate) fn merge(&mut self, other: Ropes) {
        for (key, count) in other.counts {
            *self.counts.entry(key).or_default() += count;
        }
        self.missing += other.missing;
    }

    /// The `most` most common ropes, the most common first, with their counts and what these are at the most.
    pub(crate) fn top(&self, most: usize) -> Vec<(&Key, u64, u64)> {
        let mut all: Vec<_> = self.counts.iter().map(|(key, &n)| (key, n, n + self.missing)).collect();
        all.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
        all.truncate(most);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_block(ropes: impl Iterator<Item = Key>) -> Ropes {
        let mut counts = HashMap::default();
        ropes.for_each(|key| *counts.entry(key).or_default() += 1);
        Ropes::of_block(counts)
    }

    #[test]
    fn what_is_left_out_is_known() {
        let block = |rare: u32| {
            // One rope is common; of 400 others some are seen twice.
            let others = (0..400).flat_map(move |i| vec![vec![rare, i]; if i < 300 { 2 } else { 1 }]);
            of_block(others.chain(vec![vec![7]; 50]))
        };
        let mut ropes = block(0);
        ropes.merge(block(1));
        ropes.merge(of_block([vec![7], vec![0, 5]].into_iter()));
        assert_eq!(ropes.top(1), [(&vec![7], 101, 105)]);
        assert_eq!(ropes.top(2)[1], (&vec![0, 5], 3, 7));
    }
}
