//! A trace as it is given.

use glam::DVec2;

/// One trace: its number and its points, in the scene's frame and unit.
///
/// Point 0 is where the free end starts, visible from the anchor; step k moves it from point k-1 to point k.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// The number that results name it by.
    pub id: u64,
    /// The points; at least one. Each within the limits of [`check_point`](crate::geometry::check_point).
    pub points: Vec<DVec2>,
}
