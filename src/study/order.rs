//! Between which of the sorted numbers a quantile lies.

use super::student::normal;

/// Up to this variance the binomial distribution is summed, over some 20 standard deviations: 2,000,000 terms at the
/// most.
const SUMMED: f64 = 1e10;

/// Of `count` independent numbers, sorted and counted from 1, the ranks of the two that hold the quantile between them
/// of which a `share` of the distribution lies below. Each lies on the wrong side of it with a probability of at most
/// half of `outside`, whatever the distribution; `None` where even the least, or the greatest, is too likely to.
///
/// So many of the numbers lie below the quantile as the binomial distribution says (David and Nagaraja, "Order
/// Statistics", 3rd ed., 7.1). O(standard deviation of that number), at most some milliseconds.
pub(super) fn ranks(share: f64, count: u64, outside: f64) -> [Option<u64>; 2] {
    let low = lowest(share, count, outside);
    // Seen from above.
    let high = lowest(1.0 - share, count, outside).map(|rank| count + 1 - rank);
    [low, high]
}

/// The greatest rank that no more than half of `outside` puts above the quantile: below which lie fewer numbers than
/// that.
fn lowest(share: f64, count: u64, outside: f64) -> Option<u64> {
    let (n, variance) = (count as f64, count as f64 * share * (1.0 - share));
    let rank = if variance <= SUMMED { summed(share, n, 0.5 * outside) } else { expanded(share, n, variance, outside) };
    (rank >= 1.0).then_some(rank as u64)
}

/// How many of the probabilities of 0, 1, 2, ... successes among `n` come to at most `least` together.
fn summed(share: f64, n: f64, least: f64) -> f64 {
    let odds = share / (1.0 - share);
    let mode = ((n + 1.0) * share).floor().min(n);
    // All probabilities in units of the mode's. Those below 1e-30 add nothing to 2^-54 or more.
    const NOTHING: f64 = 1e-30;
    let (mut above, mut weight, mut k) = (0.0, 1.0, mode);
    while k < n && weight > NOTHING {
        weight *= (n - k) / (k + 1.0) * odds;
        k += 1.0;
        above += weight;
    }
    let (mut below, mut weight, mut k) = (1.0, 1.0, mode);
    while k > 0.0 && weight > NOTHING {
        weight *= k / ((n - k + 1.0) * odds);
        k -= 1.0;
        below += weight;
    }
    // From the smallest on, so that small sums keep their digits.
    let least = least * (above + below);
    let mut sum = weight;
    while sum <= least {
        weight *= (n - k) / (k + 1.0) * odds;
        k += 1.0;
        sum += weight;
    }
    k
}

/// The same by the expansion of Cornish and Fisher, which is off by less than one in a hundred thousand standard
/// deviations.
fn expanded(share: f64, n: f64, variance: f64, outside: f64) -> f64 {
    let z = normal(outside);
    let skewed = (1.0 - 2.0 * share) * (z * z - 1.0) / 6.0;
    (n * share - z * variance.sqrt() + skewed + 0.5).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares, counts and confidences with their ranks: from the binomial distribution's cumulative probabilities with
    /// mpmath 1.4.1 at 30 digits; the last three from SciPy 1.17.1's `stats.binom.ppf`.
    #[test]
    fn known_ranks() {
        let known = [
            (0.5, 1, 0.95, [None, None]),
            (0.5, 5, 0.95, [None, None]),
            (0.5, 6, 0.95, [Some(1), Some(6)]),
            (0.5, 100, 0.95, [Some(40), Some(61)]),
            (0.01, 100, 0.95, [None, Some(4)]),
            (0.01, 368, 0.95, [Some(1), Some(9)]),
            (0.99, 1000, 0.95, [Some(983), Some(997)]),
            (0.01, 10_000, 0.95, [Some(81), Some(121)]),
            (0.5, 10_000, 0.95, [Some(4902), Some(5099)]),
            (0.25, 10_000, 0.999999, [Some(2290), Some(2715)]),
            (0.05, 1000, 1.0 - 1e-12, [Some(9), Some(107)]),
            (0.5, 1000, 0.5, [Some(489), Some(512)]),
            (0.9, 1_000_000, 0.95, [Some(899_412), Some(900_589)]),
            (0.5, 1_000_000_000, 0.95, [Some(499_969_010), Some(500_030_991)]),
            (0.01, 1_000_000_000, 0.95, [Some(9_993_834), Some(10_006_168)]),
        ];
        for (share, count, confidence, expected) in known {
            assert_eq!(ranks(share, count, 1.0 - confidence), expected, "{share} of {count}, {confidence}");
        }
        assert_eq!(ranks(0.5, 0, 0.05), [None, None]);
    }

    /// The definition, with all probabilities of Pascal's triangle: each rank misses rarely enough, and the next would
    /// not.
    #[test]
    fn ranks_are_as_close_as_they_can_be() {
        for (share, outside) in [(0.01, 0.05), (0.25, 0.1), (0.5, 0.05), (0.9, 0.01), (0.99, 0.5)] {
            let mut probabilities: Vec<f64> = vec![1.0];
            for n in 1..=80 {
                let get = |i: usize| probabilities.get(i).copied().unwrap_or(0.0);
                probabilities =
                    (0..=n).map(|k| get(k) * (1.0 - share) + k.checked_sub(1).map_or(0.0, get) * share).collect();
                let [low, high] = ranks(share, n as u64, outside);
                let fewer = |rank: usize| probabilities[..rank].iter().sum::<f64>();
                let more = |rank: usize| probabilities[rank..].iter().sum::<f64>();
                let (low, high) = (low.unwrap_or(0) as usize, high.unwrap_or(n as u64 + 1) as usize);
                assert!(fewer(low) <= outside / 2.0 && fewer(low + 1) > outside / 2.0, "{share} of {n}: {low}");
                assert!(high > n || more(high) <= outside / 2.0, "{share} of {n}: {high}");
                assert!(more(high - 1) > outside / 2.0, "{share} of {n}: {high}");
            }
        }
    }

    #[test]
    fn the_expansion_goes_on_where_the_sum_ends() {
        for share in [0.01, 0.3, 0.5, 0.99] {
            for outside in [0.5, 0.05, 1e-6, 1e-12] {
                for n in [1e8, 1e9f64] {
                    let variance = n * share * (1.0 - share);
                    let found = [summed(share, n, 0.5 * outside), expanded(share, n, variance, outside)];
                    assert!((found[0] - found[1]).abs() <= 1.0, "{share} of {n}, {outside}: {found:?}");
                }
            }
        }
        let [low, high] = ranks(0.5, 1 << 50, 0.05).map(Option::unwrap);
        assert_eq!(low + high, (1 << 50) + 1);
        // 1.96 standard deviations of 2^24.
        assert!(((1u64 << 49) - low).abs_diff(32_882_739) < 10, "{low}");
    }
}
