//! Windows: the legs that one query covers, seen from the pivot.
//!
//! Everything is measured against an axis, the first direction of the window: a point's *slope* is the tangent of its
//! angle from the axis. The legs' slopes span the wedge that the rope's last leg sweeps; and the slope of a line
//! through the pivot tells on which legs the rope can cross it, without any exact test.

use glam::DVec2;

use super::slopes::{BLOCK, Extent, Line, Slopes};
use super::{Frame, Query, Simd};

/// The largest slope in a window: beyond it (56 degrees from the axis) the next window begins. The wedge stays well
/// below a half turn.
const STEEPEST: f64 = 1.5;

/// By how much two slopes must differ for their order to be certain: 2^-45.
///
/// With u = 2^-53: a way from the pivot is good to u in each coordinate, so its products with the axis (which is taken
/// as it is, rounded) are good to 4u times both lengths, and the slope s to 4u (1 + |s|) sqrt(1 + s^2) + u |s|. That is
/// 20u for points of the window, whose slopes are at most [`STEEPEST`], and 90u for lines, whose slopes are at most
/// [`FLAT`].
const CERTAIN: f64 = 1.0 / (1u64 << 45) as f64;

/// By what share squared distances must differ for their order to be certain: each is good to 6u, with u = 2^-53.
const SURELY: f64 = 1.0 / (1u64 << 45) as f64;

/// Lines of a greater slope do not pass through the window.
const FLAT: f64 = 4.0;

/// A window of legs about one pivot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// How many legs it has, at least 1.
    pub legs: usize,
    /// The direction from which slopes are measured; not a unit vector.
    pub axis: DVec2,
    /// The least and the greatest slope.
    pub low: f64,
    /// See [`low`](Self::low).
    pub high: f64,
    /// The square of the greatest distance from the pivot.
    pub squared: f64,
}

impl Window {
    /// The longest window about `pivot` that starts with the first of `points` and whose directions do not spread too
    /// far; `None` if not even one leg fits. `start` is the direction in which the rope's last leg points at the start
    /// if that is not at the first point, but somewhere on the first leg.
    ///
    /// Fills `slopes` for the points of the window; that of the first means nothing if there is a `start`.
    /// O(legs), 4 points at a time.
    pub fn fold(
        simd: Simd,
        pivot: DVec2,
        start: Option<DVec2>,
        points: &[DVec2],
        slopes: &mut Slopes,
    ) -> Option<Window> {
        let first = points[0] - pivot;
        let axis = start.unwrap_or(first);
        if axis == DVec2::ZERO {
            return None;
        }
        let size = points.len() + 2 * BLOCK;
        if slopes.slope.len() < size {
            slopes.slope.resize(size, 0.0);
            slopes.squared.resize(size, 0.0);
        }
        (slopes.slope[0], slopes.squared[0]) = (0.0, first.length_squared());
        let (legs, Extent { low, high, squared }) = simd.fold(pivot, axis, STEEPEST, &points[1..], slopes);
        (legs > 0).then_some(Window { legs, axis, low, high, squared })
    }

    /// The triangle that holds all that the rope's last leg sweeps.
    pub fn query(&self, frame: &Frame, pivot: DVec2) -> Query {
        Query::wedge(frame, pivot, self.axis, (self.low, self.high), self.squared.sqrt())
    }

    /// The line through the pivot along which the rope turns back, if it can pass through the window; `way` leads to
    /// the pivot from the prior.
    pub fn unwrapping(&self, way: DVec2) -> Option<Line> {
        self.line(way, 0.0)
    }

    /// The line through the pivot and the vertex at `way` from it, if the free end can pass it beyond the vertex.
    #[inline]
    pub fn wrapping(&self, way: DVec2) -> Option<Line> {
        let beyond = way.length_squared() * (1.0 - SURELY);
        if beyond > self.squared { None } else { self.line(way, beyond) }
    }

    #[inline]
    fn line(&self, way: DVec2, beyond: f64) -> Option<Line> {
        let slope = self.axis.perp_dot(way) / self.axis.dot(way);
        // Not a number, for a way of no length, is kept: no slope is then certain.
        let passes_by = slope.abs() > FLAT || slope > self.high + CERTAIN || slope < self.low - CERTAIN;
        (!passes_by).then_some(Line { low: slope - CERTAIN, high: slope + CERTAIN, beyond })
    }
}
