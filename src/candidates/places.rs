//! Vertices side by side, as the loops over them take them.

/// How many vertices the loops over vertices take at once.
pub(super) const VERTICES: usize = 16;

/// Coordinates of [`VERTICES`] vertices in the frame, and their numbers.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Places {
    pub x: [f32; VERTICES],
    pub y: [f32; VERTICES],
    pub numbers: [u32; VERTICES],
}
