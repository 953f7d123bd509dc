//! Numbers of vertices in lists and on the device, each of a type of its own: docs/architecture.md compares them.

use bytemuck::{Pod, Zeroable};

/// Where a vertex stands in its list, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(transparent)]
pub struct Rank(pub u32);

/// Where a vertex lies on a device, counted through the pages of all lists there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Pod, Zeroable)]
#[repr(transparent)]
pub struct DevicePlace(pub u32);

impl DevicePlace {
    /// The place of the vertex of this rank in the list that begins here.
    #[inline]
    pub fn of(self, rank: Rank) -> DevicePlace {
        DevicePlace(self.0 + rank.0)
    }

    /// The rank of the vertex here in the list that begins at `first`; none of that list's if another lies here.
    #[inline]
    pub fn rank(self, first: DevicePlace) -> Rank {
        Rank(self.0.wrapping_sub(first.0))
    }
}

/// The number of a list among all of a model, those for any pivot included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(transparent)]
pub struct ListKey(pub u32);
