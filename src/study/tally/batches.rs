//! Sums over blocks, from which ratios of correlated quantities get their errors.

use serde::{Deserialize, Serialize};

/// Over the blocks: the sums of how much of something a block has (`sum`), of its square, and of its product with the
/// block's size. All are whole numbers, so that the order of the blocks does not matter.
///
/// Steps of one trace say nearly the same, blocks say nothing of each other: so the error of a ratio of sums comes from how
/// it differs from block to block (batch means).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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

    pub(crate) fn merge(&mut self, other: &Batches) {
        self.sum += other.sum;
        self.squares += other.squares;
        self.products += other.products;
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
        let (squares, products, sizes_squared) = (self.squares as f64, self.products as f64, sizes.squares as f64);
        let rest = squares - 2.0 * ratio * products + ratio * ratio * sizes_squared;
        let blocks = sizes.blocks as f64;
        (ratio, Some((rest.max(0.0) * blocks / (blocks - 1.0)).sqrt() / size))
    }
}

/// The sizes of the blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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

    pub(crate) fn merge(&mut self, other: &Sizes) {
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
}
