//! Putting the counts of different blocks together.

use std::collections::BTreeMap;

/// Counts of some blocks, with which those of others can be put together: in any order, to the same sums.
pub(crate) trait Merge {
    /// Adds the counts of other blocks.
    fn merge_with(&mut self, other: Self);
}

impl Merge for u64 {
    fn merge_with(&mut self, other: u64) {
        *self += other;
    }
}

impl<K: Ord, V: Merge + Default> Merge for BTreeMap<K, V> {
    fn merge_with(&mut self, other: Self) {
        other.into_iter().for_each(|(key, counts)| self.entry(key).or_default().merge_with(counts));
    }
}

impl<T: Merge, const N: usize> Merge for [T; N] {
    fn merge_with(&mut self, other: Self) {
        self.iter_mut().zip(other).for_each(|(to, from)| to.merge_with(from));
    }
}

/// One after the other; those that are not there yet begin with nothing.
impl<T: Merge + Default> Merge for Vec<T> {
    fn merge_with(&mut self, other: Self) {
        self.resize_with(self.len().max(other.len()), T::default);
        self.iter_mut().zip(other).for_each(|(to, from)| to.merge_with(from));
    }
}
