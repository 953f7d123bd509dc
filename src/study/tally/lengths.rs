//! Classes of lengths, fine enough for quantiles.
//!
//! A class has the lengths with the same first 8 bits and the same power of two, so nothing is rounded, and no scale is
//! better than another. (Like the log-linear buckets of HdrHistogram; sketches with logarithms depend on the
//! machine's.)

/// How many of a number's last bits are left out: with 7 bits after the first, a class is at most 2^-7 of its numbers
/// wide.
const SHIFT: u32 = 52 - 7;

/// The number of a length's class. Longer lengths have no lower one.
pub(super) fn class(length: f64) -> u64 {
    length.to_bits() >> SHIFT
}

/// The least length of a class, and the least of the next.
pub(super) fn ends(class: u64) -> [f64; 2] {
    if class == 0 { [0.0; 2] } else { [0, 1].map(|next| f64::from_bits((class + next) << SHIFT)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_all_sizes_are_told_closely() {
        for scale in [1e-130, 1e-9, 1.0, 1e140] {
            let lengths: Vec<f64> = (1..=1000).map(|i| scale * f64::from(i * i)).collect();
            assert!(lengths.iter().map(|&x| class(x)).is_sorted());
            for truth in lengths {
                let [low, high] = ends(class(truth));
                assert!(low <= truth && truth <= high && high - low <= truth / 128.0, "{low} to {high} for {truth}");
            }
        }
        assert_eq!(ends(class(0.0)), [0.0; 2]);
    }
}
