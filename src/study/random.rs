//! Random numbers that are the same on every machine, and that any trace finds without those before it.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011) makes numbers
//! by encrypting a counter: nothing is carried from one number to the next. The key is a study's seed; the counter
//! names the trace, what the numbers are for, and the block of four words.

use glam::DVec2;
use pulp::{Arch, Simd, WithSimd};

/// How many blocks are made at once, so that several are made in one instruction. The order of the words depends on it,
/// and so do all traces.
pub(in crate::study) const BLOCKS: usize = 8;

/// The low half of a word.
const LOW: u64 = u32::MAX as u64;

/// What random numbers are for: streams of different purposes are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(in crate::study) enum Purpose {
    /// The steps of a trace.
    Walk = 0,
    /// Where a trace starts.
    Start = 1,
    /// Where the rope is tied.
    Anchor = 2,
    /// Where a trace goes next.
    Goal = 3,
}

/// The random numbers of one trace for one purpose.
///
/// There are 2^56 blocks of them, four words each, which none of 2^31 points uses up. The counter's second word holds
/// the purpose in its low byte and in the others what does not fit into the first, so no stream runs into another's.
pub(in crate::study) struct Random {
    key: [u64; 2],
    purpose: Purpose,
    trace: u64,
    /// The number of the next block to be made.
    block: u64,
    words: [u32; 4 * BLOCKS],
    /// The first of `words` that was not drawn yet.
    next: usize,
}

impl Random {
    pub(in crate::study) fn new(seed: u64, purpose: Purpose, trace: u64) -> Self {
        Random { key: halves(seed), purpose, trace, block: 0, words: [0; 4 * BLOCKS], next: 4 * BLOCKS }
    }

    #[inline]
    fn word(&mut self) -> u32 {
        if self.next == self.words.len() {
            self.refill();
        }
        self.next += 1;
        self.words[self.next - 1]
    }

    #[inline(never)]
    fn refill(&mut self) {
        // With the widest vectors that the processor has.
        Arch::new().dispatch(Fill(self));
        self.block += BLOCKS as u64;
        self.next = 0;
    }

    #[inline(always)]
    fn fill(&mut self) {
        let [low, high] = halves(self.trace);
        let blocks: [u64; BLOCKS] = std::array::from_fn(|i| self.block + i as u64);
        // What the first word of a counter cannot hold goes above the purpose.
        let carried = blocks.map(|block| block >> 32 << 8 | self.purpose as u64);
        let made = philox([blocks.map(|block| block & LOW), carried, [low; BLOCKS], [high; BLOCKS]], self.key);
        for (words, made) in self.words.chunks_exact_mut(BLOCKS).zip(&made) {
            for (word, &made) in words.iter_mut().zip(made) {
                *word = made as u32;
            }
        }
    }

    /// From 0 up to 1, 1 left out: a multiple of 2^-53.
    #[inline]
    pub(in crate::study) fn unit(&mut self) -> f64 {
        let bits = u64::from(self.word()) << 32 | u64::from(self.word());
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between -1 and 1: an odd multiple of 2^-32.
    #[inline]
    pub(in crate::study) fn either_way(&mut self) -> f64 {
        // The words as whole numbers with a sign, moved by a half to lie evenly about 0.
        (f64::from(self.word() as i32) + 0.5) / (1u64 << 31) as f64
    }

    /// A direction, as a vector one long. Made without angles: sines and cosines are not the same on every machine.
    #[inline]
    pub(in crate::study) fn direction(&mut self) -> DVec2 {
        let (DVec2 { x, y }, square) = self.in_disc();
        // Twice the angle of a point of the disc is as uniform as the angle itself (von Neumann, 1951), and needs no
        // root.
        DVec2::new(x * x - y * y, 2.0 * x * y) / square
    }

    /// Two independent normal numbers of mean 0 and variance 1, by the polar method (Marsaglia and Bray, "A convenient
    /// method for generating normal variables", SIAM Rev. 6, 1964).
    #[inline]
    pub(in crate::study) fn normal(&mut self) -> DVec2 {
        let (p, square) = self.in_disc();
        p * (-2.0 * libm::log(square) / square).sqrt()
    }

    /// A uniform point of the unit disc, its centre left out, and the square of its distance from there.
    #[inline]
    fn in_disc(&mut self) -> (DVec2, f64) {
        loop {
            let p = DVec2::new(self.either_way(), self.either_way());
            let square = p.length_squared();
            if square < 1.0 {
                return (p, square);
            }
        }
    }
}

/// Makes the next blocks. Not a closure, which would be compiled for the narrowest vectors.
struct Fill<'r>(&'r mut Random);

impl WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.fill();
    }
}

/// The low and the high half.
fn halves(word: u64) -> [u64; 2] {
    [word & LOW, word >> 32]
}

/// Philox4x32-10 of `N` counters, each a column; the words are below 2^32.
#[inline(always)]
fn philox<const N: usize>(counters: [[u64; N]; 4], mut key: [u64; 2]) -> [[u64; N]; 4] {
    let [mut a, mut b, mut c, mut d] = counters;
    for _ in 0..10 {
        // Each of these is one instruction for several counters.
        for i in 0..N {
            let (first, second) = ((a[i] & LOW) * 0xD251_1F53, (c[i] & LOW) * 0xCD9E_8D57);
            (a[i], b[i]) = (second >> 32 ^ b[i] ^ key[0], second & LOW);
            (c[i], d[i]) = (first >> 32 ^ d[i] ^ key[1], first & LOW);
        }
        key = [(key[0] + 0x9E37_79B9) & LOW, (key[1] + 0xBB67_AE85) & LOW];
    }
    [a, b, c, d]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn philox_of(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
        philox(counter.map(|word| [u64::from(word)]), key.map(u64::from)).map(|[word]| u32::try_from(word).unwrap())
    }

    /// The known answers that are published with Random123 (`kat_vectors`).
    #[test]
    fn philox_gives_the_published_answers() {
        let known = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, answer) in known {
            assert_eq!(philox_of(counter, key), answer);
        }
    }

    #[test]
    fn words_are_those_of_their_counters_and_never_come_again() {
        let (seed, trace) = (0x0123_4567_89ab_cdef, 0xfedc_ba98_7654_3210);
        let mut random = Random::new(seed, Purpose::Goal, trace);
        // The last blocks before the first word of the counter is used up, and the first after.
        random.block = (1 << 32) - BLOCKS as u64;
        let words: Vec<u32> = (0..8 * BLOCKS).map(|_| random.word()).collect();
        for block in 0..2 * BLOCKS {
            let number = (1u64 << 32) - BLOCKS as u64 + block as u64;
            let counter = [number as u32, 3 | ((number >> 32) as u32) << 8, 0x7654_3210, 0xfedc_ba98];
            // First the first words of all blocks that are made at once, then the second ones.
            let first = block / BLOCKS * 4 * BLOCKS + block % BLOCKS;
            let found = [0, 1, 2, 3].map(|i| words[first + i * BLOCKS]);
            assert_eq!(found, philox_of(counter, [0x89ab_cdef, 0x0123_4567]));
        }
        let mut purposes = vec![];
        for purpose in [Purpose::Walk, Purpose::Start, Purpose::Anchor, Purpose::Goal] {
            purposes.push(Random::new(seed, purpose, trace).word());
        }
        purposes.sort_unstable();
        purposes.dedup();
        assert_eq!(purposes.len(), 4);
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let mut random = Random::new(2, Purpose::Walk, 0);
        let n = 200_000;
        let error = |variance: f64| 5.0 * (variance / f64::from(n)).sqrt();
        let mean = |random: &mut Random, draw: &dyn Fn(&mut Random) -> f64| {
            (0..n).map(|_| draw(random)).sum::<f64>() / f64::from(n)
        };
        let unit = mean(&mut random, &|r| r.unit());
        assert!((unit - 0.5).abs() < error(1.0 / 12.0), "{unit}");
        for power in 1..=4 {
            let [x, y] = [0, 1].map(|i| mean(&mut random, &|r| r.normal()[i].powi(power)));
            // The moments of a normal number, and their own variances: of x^4, 105 - 9.
            let (moment, variance) = [(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)][power as usize - 1];
            assert!((x - moment).abs() < error(variance) && (y - moment).abs() < error(variance), "{power}: {x} {y}");
        }
        for m in 1..=4 {
            // The m-th power of a uniform direction, as a complex number, is a uniform direction.
            let powered = |r: &mut Random| {
                let d = r.direction();
                assert!((d.length() - 1.0).abs() < 1e-15);
                (1..m).fold(d, |p, _| p.rotate(d)).x
            };
            let x = mean(&mut random, &powered);
            assert!(x.abs() < error(0.5), "{m}: {x}");
        }
    }
}
