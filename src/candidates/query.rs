//! Queries: the triangle that the rope's last leg sweeps in a window of legs, as three half-planes.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::Frame;

/// By how much a swept triangle is grown, in the frame's unit: 2^-19, about 1.9e-6.
///
/// A vertex inside the exact triangle passes the f32 test dot(normal, p) + offset >= 0 because all errors together stay
/// below the margin. With |p.x|, |p.y| <= 1 and a unit normal, in the frame's unit:
///
/// | error | bound |
/// |---|---|
/// | p rounded to f32 | sqrt(2) 2^-25 |
/// | the normal rounded to f32 | 2 x 2^-25 |
/// | the offset, at most 2 in magnitude, rounded to f32 | 2^-24 |
/// | two products of at most 1, each to one of the two nearest f32 (WGSL names no rounding mode) or fused | 2 x 2^-24 |
/// | two sums of at most 3.5 in magnitude, likewise, in any order | 2 x 2^-22 |
/// | products and sums flushed to zero | 5 x 2^-126 |
/// | the pivot, the directions and the normals computed in f64, for ways of up to 2^20 | below 2^-30 |
///
/// which is 7.6e-7 in all. Fusing and reassociating change which sums round, not how many.
const MARGIN: f64 = 1.0 / (1 << 19) as f64;

/// The longest way from the pivot, in the frame's unit, for which a single leg gets a triangle: 2^20. The far side's
/// offset, and even the way in which the triangle turns, are rounded in proportion to the ways.
const LONGEST: f64 = (1 << 20) as f64;

/// The largest offset: beyond it a half-plane holds every vertex (|dot(normal, p)| <= sqrt(2)), or none.
const FAR: f64 = 2.0;

/// A swept triangle; the shader's `Query`. Each half-plane is its inward unit normal, its offset, and an unused number,
/// in the frame's unit: `p` is inside where dot(normal, p) + offset >= 0 in all three.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Query {
    /// The half-plane left of the triangle's right side.
    pub right: [f32; 4],
    /// The half-plane right of its left side.
    pub left: [f32; 4],
    /// The half-plane on the pivot's side of its far side.
    pub far: [f32; 4],
}

/// A query and how much of the trace it covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swept {
    /// The triangle.
    pub query: Query,
    /// How many legs lie inside it, at least 1.
    pub legs: usize,
}

/// The triangle with its apex at `pivot` that covers as many as possible of the legs between neighbours in `points`.
///
/// `points` are at least two; their first is where the free end stands. A window of several legs ends before the
/// directions from the pivot spread to a right angle; a single leg may spread to anything below a half turn. A single leg
/// that spreads and starts or ends absurdly far away is covered by the whole plane.
/// O(legs covered).
///
/// Convexity makes a window outlive its events: after a wrap the pivot lies inside the triangle, so everything that the
/// remaining legs can sweep about it does too.
pub fn swept(frame: &Frame, pivot: DVec2, points: &[DVec2]) -> Swept {
    let mut cone = Cone::default();
    cone.widen(frame.way(pivot, points[0]));
    let mut legs = 0;
    while legs + 1 < points.len() && cone.widen(frame.way(pivot, points[legs + 1])) {
        legs += 1;
    }
    let origin = frame.place(pivot);
    if legs > 0 {
        let far = points[..=legs].iter().map(|&p| frame.way(pivot, p));
        return Swept { query: cone.query(origin, far), legs };
    }
    Swept { query: triangle(origin, frame.way(pivot, points[0]), frame.way(pivot, points[1])), legs: 1 }
}

/// The directions from the pivot to the points of a window: all lie between `right` and `left`, less than a right angle
/// apart. Zero while no point off the pivot was seen.
#[derive(Default)]
struct Cone {
    right: DVec2,
    left: DVec2,
}

impl Cone {
    /// Takes the direction of `way` in, if that keeps the cone below a right angle.
    #[inline]
    fn widen(&mut self, way: DVec2) -> bool {
        if way == DVec2::ZERO {
            return true;
        }
        let way = tamed(way);
        if self.right == DVec2::ZERO {
            (self.right, self.left) = (way, way);
            return true;
        }
        if self.right.dot(way) <= 0.0 || self.left.dot(way) <= 0.0 {
            return false;
        }
        if self.right.perp_dot(way) < 0.0 {
            self.right = way;
        } else if self.left.perp_dot(way) > 0.0 {
            self.left = way;
        }
        true
    }

    /// The cone about `origin`, cut off beyond the furthest of `ways`.
    fn query(&self, origin: DVec2, ways: impl Iterator<Item = DVec2>) -> Query {
        if self.right == DVec2::ZERO {
            // The free end stays on the pivot: nothing is swept.
            let nowhere = [0.0, 0.0, -1.0, 0.0];
            return Query { right: nowhere, left: nowhere, far: nowhere };
        }
        let (right, left) = (unit(self.right), unit(self.left));
        let ahead = unit(right + left);
        let reach = ways.fold(0.0, |reach: f64, way| reach.max(ahead.dot(way)));
        Query {
            right: half_plane(right.perp(), origin, 0.0),
            left: half_plane(-left.perp(), origin, 0.0),
            far: half_plane(-ahead, origin, reach),
        }
    }
}

/// The triangle of `origin` and the points at `a` and `b` from it, whose directions are a right angle or more apart.
fn triangle(origin: DVec2, a: DVec2, b: DVec2) -> Query {
    if a.abs().max(b.abs()).max_element() > LONGEST {
        let everywhere = [0.0, 0.0, 1.0, 0.0];
        return Query { right: everywhere, left: everywhere, far: everywhere };
    }
    let (ta, tb) = (tamed(a), tamed(b));
    let ((right, left), (r, l)) = if ta.perp_dot(tb) >= 0.0 { ((ta, tb), (a, b)) } else { ((tb, ta), (b, a)) };
    let far = unit(tamed(l - r)).perp();
    Query {
        right: half_plane(unit(right).perp(), origin, 0.0),
        left: half_plane(-unit(left).perp(), origin, 0.0),
        far: half_plane(far, origin, -far.dot(l).min(far.dot(r))),
    }
}

/// The half-plane dot(normal, p - origin) + offset >= 0, grown by the margin.
fn half_plane(normal: DVec2, origin: DVec2, offset: f64) -> [f32; 4] {
    let offset = (offset - normal.dot(origin) + MARGIN).clamp(-FAR, FAR);
    [normal.x as f32, normal.y as f32, offset as f32, 0.0]
}

/// The same direction, with a length whose square neither over- nor underflows.
#[inline]
fn tamed(way: DVec2) -> DVec2 {
    const HUGE: f64 = f64::from_bits((1023 + 300) << 52);
    let size = way.abs().max_element();
    if size > HUGE {
        way / size
    } else if size < 1.0 / HUGE {
        // Twice: a subnormal size has no finite reciprocal.
        way * HUGE * HUGE
    } else {
        way
    }
}

fn unit(way: DVec2) -> DVec2 {
    way / way.length()
}
