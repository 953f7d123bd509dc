//! What each block of a study says, for comparisons block by block.

use std::collections::BTreeMap;

use super::opened::Study;
use super::state::State;

/// What the traces of one block say.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BlockMeans {
    /// How many there are.
    pub traces: u64,
    /// The means of all scalars, in the order of the summary.
    pub scalars: Vec<f64>,
    /// For each limit, ascending: how many ropes became longer.
    pub longer: Vec<u64>,
    /// Where there is friction, the means of what it makes: empty without.
    pub friction: Vec<f64>,
}

impl State {
    /// What each block that is done says. O(blocks).
    pub(super) fn by_block(&self, study: &Study) -> BTreeMap<u64, BlockMeans> {
        let counts = self.counted(study);
        let limits = study.tallies.survival.limits().len();
        let of = |(block, scalars): (u64, [f64; _])| {
            let longer = (0..limits).map(|limit| counts.survival.longer(block, limit)).collect();
            let traces = study.block(block).count() as u64;
            let friction = counts.friction.means(block).into_iter().flatten().collect();
            (block, BlockMeans { traces, scalars: scalars.to_vec(), longer, friction })
        };
        counts.scalars.means().map(of).collect()
    }
}
