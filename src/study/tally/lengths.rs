//! How many lengths are about how long: for quantiles.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// How many of a number's last bits are left out: with 7 bits after the first, a class is at most 2^-7 of its numbers wide.
const SHIFT: u32 = 52 - 7;

/// Counts of lengths by class. A class has the lengths with the same first 8 bits and the same power of two, so nothing is
/// rounded, no scale is better than another, and parts may be put together in any order.
///
/// (Like the log-linear buckets of HdrHistogram; sketches with logarithms depend on the machine's.)
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Lengths(BTreeMap<u32, u64>);

impl Lengths {
    pub(super) fn add(&mut self, length: f64) {
        *self.0.entry((length.to_bits() >> SHIFT) as u32).or_default() += 1;
    }

    pub(super) fn merge(&mut self, other: Lengths) {
        other.0.into_iter().for_each(|(class, count)| *self.0.entry(class).or_default() += count);
    }

    /// The least and the greatest length of the class in which that of this rank lies, ranks counted from 1.
    pub(crate) fn of_rank(&self, rank: u64) -> [f64; 2] {
        let ends = |class: u32| [0, 1].map(|next| f64::from_bits(u64::from(class + next) << SHIFT));
        of_rank(&self.0, rank).map_or([0.0; 2], |class| if class == 0 { [0.0; 2] } else { ends(class) })
    }
}

/// The key under which the number of that rank is counted; the last one for ranks beyond all.
pub(crate) fn of_rank<K: Copy>(counts: &BTreeMap<K, u64>, rank: u64) -> Option<K> {
    let mut below = 0;
    let reached = counts.iter().find(|&(_, &count)| {
        below += count;
        below >= rank
    });
    reached.or(counts.iter().next_back()).map(|(&key, _)| key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_all_sizes_are_told_closely_in_any_order() {
        for scale in [1e-130, 1e-9, 1.0, 1e140] {
            let mut all: Vec<f64> = (1..=1000).map(|i| scale * f64::from(i * i)).collect();
            let [mut some, mut others] = [Lengths::default(), Lengths::default()];
            all.iter().for_each(|&x| if ((x / scale) as u32).is_multiple_of(3) { some.add(x) } else { others.add(x) });
            let (mut one, mut two) = (some.clone(), others.clone());
            one.merge(others);
            two.merge(some);
            assert_eq!(one, two);
            all.sort_by(f64::total_cmp);
            for rank in [1, 10, 500, 999, 1000] {
                let ([low, high], truth) = (one.of_rank(rank), all[rank as usize - 1]);
                assert!(low <= truth && truth <= high && high - low <= truth / 128.0, "{low} to {high} for {truth}");
            }
        }
        let mut none = Lengths::default();
        assert_eq!(none.of_rank(1), [0.0; 2]);
        none.add(0.0);
        assert_eq!(none.of_rank(1), [0.0; 2]);
    }
}
