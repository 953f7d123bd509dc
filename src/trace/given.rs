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

/// One trace of a rope whose ends both move.
#[derive(Debug, Clone, PartialEq)]
pub struct EndsTrace {
    /// The trace of the free end.
    pub free: Trace,
    /// Where the anchor is after each of its steps: as many points.
    pub anchor: Vec<DVec2>,
}
