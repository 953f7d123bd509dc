//! What is chosen by the adapter: how many queries a round carries and how many lanes a workgroup has.

use super::adapter::AdapterKind;

/// Choices that make one adapter fast and change no result.
///
/// What decides them:
///
/// - *Fixed cost of a round.* Submitting, waiting and mapping cost 60 to 250 us on lavapipe and tens of microseconds
///   over PCI Express, however few queries there are; and every page of lists that a round touches is a dispatch of its
///   own, at 5 to 20 us on lavapipe and about 2 us on GPUs. A round must carry enough queries that this is small for
///   each.
/// - *Occupancy.* A query is one lane with a loop of some 40 to 120 tests. A discrete GPU has 50,000 to 200,000 lanes
///   in flight and hides the latency of its loads only when they are filled; an integrated one has a tenth of that.
/// - *Caches.* A query and its answer are 112 bytes and a trace's state some 500; on the CPU side a batch should stay
///   near the last-level cache, which bounds it from above, the more so where the CPU is also the GPU.
/// - *Wave width.* Waves are 8 lanes on lavapipe with AVX2, 32 on NVIDIA, 32 or 64 on AMD, 8 to 32 on Intel. Queries
///   are sorted by list, so a wave mostly runs one loop; a workgroup is a small multiple of every wave width.
/// - *Overlap.* Two half-batches: one is on the GPU while the other is on the CPU. More would hide no more, since the
///   CPU's part of a round is as long as the GPU's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// How many queries a round of one half-batch carries.
    pub queries: usize,
    /// How many lanes a workgroup has.
    pub workgroup: u32,
}

impl Tuning {
    /// The choice for an adapter of this kind with waves of at most `wave` lanes.
    pub fn of(kind: AdapterKind, wave: u32) -> Self {
        let queries = match kind {
            AdapterKind::Discrete | AdapterKind::Virtual => 1 << 16,
            AdapterKind::Integrated | AdapterKind::Other => 1 << 15,
            AdapterKind::Software => 1 << 13,
        };
        Tuning { queries, workgroup: wave.next_power_of_two().clamp(64, 256) }
    }

    /// How many bytes of an adapter of this kind an engine takes at most unless told otherwise: room for as many traces
    /// as [`of`](Self::of) has them, with some hundred points each.
    pub fn memory(kind: AdapterKind) -> usize {
        match kind {
            AdapterKind::Discrete | AdapterKind::Virtual => 2 << 30,
            AdapterKind::Integrated | AdapterKind::Other => 1 << 30,
            AdapterKind::Software => 256 << 20,
        }
    }
}
