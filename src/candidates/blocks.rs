//! Which blocks of a list hold candidates: what a kernel answers that only tries.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::places::VERTICES;

/// How many vertices a block has, or a multiple of that in lists of more than [`BLOCK`] times [`BLOCKS`] vertices.
pub const BLOCK: usize = VERTICES;

/// How many blocks a list has at most: the bits of an answer.
pub const BLOCKS: usize = 512;

/// How many bits a word has.
const BITS: usize = u32::BITS as usize;

/// Which blocks of a list hold a vertex that is inside a query's triangle; the shader's `Blocks`. A block has 16
/// vertices, or a multiple of that in lists of more than 8,192.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Blocks {
    /// Bit i of word j stands for block 32 j + i. Words without blocks mean nothing.
    pub words: [u32; BLOCKS / BITS],
}

impl Default for Blocks {
    fn default() -> Self {
        Blocks { words: [0; BLOCKS / BITS] }
    }
}

impl Blocks {
    /// The ranks of the blocks that are named, in order, in a list of `len` vertices. A rank beyond the list is left to
    /// whoever looks there.
    pub fn ranks(&self, len: usize) -> impl Iterator<Item = Range<usize>> {
        let size = Self::size(len);
        let words = len.div_ceil(size * BITS);
        self.words.into_iter().take(words).enumerate().flat_map(move |(word, bits)| {
            let first = word * BITS;
            ones(bits).map(move |bit| (first + bit) * size..((first + bit + 1) * size).min(len))
        })
    }

    /// How many vertices a block has in a list of `len`.
    fn size(len: usize) -> usize {
        BLOCK * len.div_ceil(BLOCK * BLOCKS).max(1)
    }
}

/// The numbers of the bits that are set.
fn ones(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_stand_for_the_vertices_of_their_blocks() {
        let mut blocks = Blocks::default();
        let ranks = |blocks: &Blocks, len| blocks.ranks(len).collect::<Vec<_>>();
        assert!(ranks(&blocks, 1000).is_empty());
        (blocks.words[0], blocks.words[1]) = (1 << 31 | 1, 1 << 2);
        assert_eq!(ranks(&blocks, 1000), [0..16, 496..512, 544..560]);
        // The last block ends with the list, and words behind it mean nothing.
        assert_eq!(ranks(&blocks, 550), [0..16, 496..512, 544..550]);
        assert_eq!(ranks(&blocks, 512), [0..16, 496..512]);
        assert!(ranks(&blocks, 0).is_empty());
        // Longer lists have longer blocks.
        blocks.words[15] = 1 << 31;
        assert_eq!(ranks(&blocks, 8192).last(), Some(&(8176..8192)));
        assert_eq!(ranks(&blocks, 8193)[..2], [0..32, 992..1024]);
        assert_eq!(ranks(&blocks, 3 * 8192).last(), Some(&(24528..24576)));
    }
}
