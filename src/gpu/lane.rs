//! What the kernel that takes traces along is given, and what it gives back.

use bytemuck::{Pod, Zeroable};

use super::pass::HALVES;

/// How many contacts of a trace the device knows at most, the last ones.
pub const STACK: usize = 32;

/// How many events a lane notes in a round at most.
pub const NOTES: usize = 32;

/// What a lane does; the shader's constants of these names.
pub const RUNS: u32 = 0;
/// It stands at its last point.
pub const DONE: u32 = 1;
/// It met what it is not certain of.
pub const STOPPED: u32 = 2;

/// The event of an unwrap; the shader's `UNWRAP`.
pub const UNWRAPPED: u32 = u32::MAX;

/// What stands for a number that is not known; the shader's constant of this name.
pub const UNKNOWN: u32 = u32::MAX;

/// The bit of a contact's vertex that says that it lies right of the rope.
pub const RIGHT: u32 = 1 << 31;

/// A trace on the device; the shader's `Lane`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Lane {
    /// Where the point at which it stands lies.
    pub point: u32,
    /// The last one to which it goes.
    pub last: u32,
    /// What its rope turns about.
    pub pivot: u32,
    /// The last ray of the pivot's fan clockwise of where it points.
    pub low: u32,
    /// How many of its contacts are in its stack.
    pub depth: u32,
    /// How many more it has.
    pub deeper: u32,
    /// [`RUNS`], [`DONE`] or [`STOPPED`].
    pub does: u32,
    /// How many events it has noted.
    pub events: u32,
    /// The way to the pivot from the contact before, in units of the grid.
    pub way: [f32; 2],
    /// Which way the rope turns when it leaves the pivot; 0 for the anchor.
    pub back: f32,
    /// The square of the greatest distance from the pivot since the last event, in units of the grid.
    pub farthest: f32,
    /// Whose stack is its.
    pub number: u32,
    /// The ray of the pivot's fan after which the leg meets the line of `way` when it turns back, or [`UNKNOWN`].
    pub way_low: u32,
    /// Fills 16 bytes.
    pub unused: [u32; 2],
}

/// An event; the shader's `notes`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Note {
    /// The point from which its leg goes.
    pub point: u32,
    /// The vertex that is wrapped, or [`UNWRAPPED`].
    pub vertex: u32,
    /// The square of the greatest distance from the pivot before, in units of the grid.
    pub farthest: f32,
    /// Whether the rope turned clockwise.
    pub clockwise: u32,
}

/// A contact as the device knows it; the shader's `stacks`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Stacked {
    /// The vertex, and [`RIGHT`].
    pub vertex: u32,
    /// The ray of the prior's fan on which it lies.
    pub ray: u32,
    /// The way to it from the prior, in units of the grid.
    pub way: [f32; 2],
}

/// A ray of a fan, but for its way; the shader's `rays`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Its vertex.
    pub vertex: u32,
    /// Where it goes on in the fan of that, if both fans are on the device, else [`UNKNOWN`]: twice the last ray that
    /// does not lie counter-clockwise of it, and one more if it lies on that.
    pub goes_on: u32,
}

/// The room that a pass has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Room {
    /// How many lanes each half has.
    pub lanes: usize,
    /// How many points each half has.
    pub points: usize,
    /// How many rays all fans have.
    pub rays: usize,
}

impl Room {
    /// How many bytes a lane takes, its stack and its notes, and what is read of it.
    pub(super) const LANE: usize = 2 * size_of::<Lane>() + STACK * size_of::<Stacked>() + 2 * NOTES * size_of::<Note>();
    /// How many bytes a point takes, and what it is written to first.
    pub(super) const POINT: usize = 2 * size_of::<[i32; 2]>();
    /// How many bytes a ray takes.
    pub(super) const RAY: usize = size_of::<[f32; 2]>() + size_of::<Ray>();

    /// How many bytes a pass with this room takes of a device, but for the pivots, 16 bytes each.
    pub fn bytes(&self) -> usize {
        HALVES * (self.lanes * Self::LANE + self.points * Self::POINT) + self.rays * Self::RAY
    }
}

/// The shader's `Job`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Job {
    pub lanes: u32,
    pub turns: u32,
    pub looks: u32,
    pub anchor: u32,
}

/// Where a pivot's fan lies, and the pivot; the shader's `pivots`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Head {
    /// Where its fan begins.
    pub(super) first: u32,
    /// How many rays that has, 0 if it is not on the device.
    pub(super) rays: u32,
    /// The pivot's place on the grid.
    pub(super) place: [i32; 2],
}

impl Head {
    /// Whether the fan is on the device.
    #[inline]
    pub fn has_fan(&self) -> bool {
        self.rays > 0
    }
}
