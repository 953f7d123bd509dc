//! Sums over blocks, from which ratios of correlated quantities get their errors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::merge::Merge;

/// Over the blocks: the sums of how much of something a block has (`sum`), of its square, and of its product with the
/// block's size. All are whole numbers, so that the order of the blocks does not matter.
///
/// Steps of one trace say nearly the same, blocks say nothing of each other: so the error of a ratio of sums comes from
/// how it differs from block to block (batch means).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Batches {
    pub sum: u64,
    squares: u128,
    products: u128,
}

impl Batches {
    /// One block: of size `size`, with `sum`.
    pub(crate) fn add(&mut self, size: u64, sum: u64) {
        self.sum += sum;
        self.squares += u128::from(sum) * u128::from(sum);
        self.products += u128::from(sum) * u128::from(size);
    }

    /// The ratio of the sum to the sum of the sizes, and its standard error, which is `None` for fewer than two blocks.
    ///
    /// The error is that of a ratio estimator to first order (Cochran, "Sampling Techniques", 3rd ed., 2.11).
    pub(crate) fn ratio(&self, sizes: &Sizes) -> (f64, Option<f64>) {
        let (size, sum) = (sizes.sum as f64, self.sum as f64);
        let ratio = sum / size;
        if sizes.blocks < 2 {
            return (ratio, None);
        }
        // The sums of the squares of (sum - ratio * size). First with the whole part of the ratio, in whole numbers:
        // else what is left of large numbers that are nearly alike is rounding. The products may wrap on the way; what
        // they come to has room.
        let whole = u128::from(self.sum.checked_div(sizes.sum).unwrap_or(0));
        let part = (u128::from(self.sum) - whole * u128::from(sizes.sum)) as f64 / size;
        let products = self.products.wrapping_sub(whole.wrapping_mul(sizes.squares));
        let squares = self.squares.wrapping_sub(whole.wrapping_mul(self.products.wrapping_add(products)));
        let rest = squares as f64 - 2.0 * part * (products as i128) as f64 + part * part * sizes.squares as f64;
        let blocks = sizes.blocks as f64;
        (ratio, Some((rest.max(0.0) * blocks / (blocks - 1.0)).sqrt() / size))
    }
}

impl Merge for Batches {
    fn merge_with(&mut self, other: Batches) {
        self.sum += other.sum;
        self.squares += other.squares;
        self.products += other.products;
    }
}

/// The sizes of the blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Sizes {
    pub blocks: u64,
    pub sum: u64,
    squares: u128,
}

impl Sizes {
    pub(crate) fn add(&mut self, size: u64) {
        self.blocks += 1;
        self.sum += size;
        self.squares += u128::from(size) * u128::from(size);
    }
}

impl Merge for Sizes {
    fn merge_with(&mut self, other: Sizes) {
        self.blocks += other.blocks;
        self.sum += other.sum;
        self.squares += other.squares;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_blocks_have_the_error_of_their_means() {
        let sums = [3u64, 5, 4, 9, 2];
        let (mut batches, mut sizes) = (Batches::default(), Sizes::default());
        for sum in sums {
            batches.add(10, sum);
            sizes.add(10);
        }
        let means = sums.map(|s| s as f64 / 10.0);
        let mean = means.iter().sum::<f64>() / 5.0;
        let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 4.0 / 5.0).sqrt();
        let (ratio, estimated) = batches.ratio(&sizes);
        assert!((ratio - mean).abs() < 1e-15 && (estimated.unwrap() - error).abs() < 1e-15);
    }
    /// Sums of some 2^40 that are alike but for a unit: of their squares, the difference is beyond the digits of an
    /// f64.
    #[test]
    fn nearly_equal_blocks_have_nearly_no_error() {
        let of = |sums: &[(u64, u64)]| {
            let (mut batches, mut sizes) = (Batches::default(), Sizes::default());
            sums.iter().for_each(|&(size, sum)| (batches.add(size, sum), sizes.add(size)).1);
            batches.ratio(&sizes)
        };
        let large = (1 << 40) + 12345;
        assert_eq!(of(&[(1000, 1000 * large), (500, 500 * large), (1, large)]), (large as f64, Some(0.0)));
        // Means of x - 1, x and x + 1: a deviation of 1, over the root of 3.
        let (ratio, error) = of(&[(10, 10 * large - 10), (10, 10 * large), (10, 10 * large + 10)]);
        assert!(ratio == large as f64 && (error.unwrap() - 3f64.sqrt().recip()).abs() < 1e-15, "{error:?}");
    }
}
