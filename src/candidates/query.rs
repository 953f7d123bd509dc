//! Queries: the triangle that the rope's last leg sweeps in a window of legs, as three half-planes.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::Frame;

/// By how much a swept triangle is grown, in the frame's unit: 2^-18, about 3.8e-6.
///
/// A vertex inside the exact triangle passes the f32 test dot(normal, p) + offset >= 0 because all errors together stay
/// below the margin. With |p.x|, |p.y| <= 1 and a normal of length 1 to 1.81 (see [`Query::wedge`]), in the frame's unit:
///
/// | error | bound |
/// |---|---|
/// | p rounded to f32 | 1.81 sqrt(2) 2^-25 |
/// | the normal rounded to f32 | 2 x 2^-24 |
/// | the offset, at most 4 in magnitude, rounded to f32 | 2^-23 |
/// | two products of at most 1.81, each to one of the two nearest f32 (WGSL names no rounding mode) or fused | 2 x 2^-23 |
/// | two sums of at most 6.6 in magnitude, likewise, in any order | 2 x 2^-21 |
/// | products and sums flushed to zero | 5 x 2^-126 |
/// | the pivot, the directions and the normals computed in f64, for ways of up to 2^20 | below 2^-30 |
///
/// which is 1.6e-6 in all. Fusing and reassociating change which sums round, not how many.
const MARGIN: f64 = 1.0 / (1 << 18) as f64;

/// What of the margin is for the device: by how much the value of a half-plane may be off because of rounded products and
/// sums, 2 x 2^-23 + 2 x 2^-21 (those that are flushed add nothing to speak of).
pub const ARITHMETIC: f64 = 2.0 / (1 << 23) as f64 + 2.0 / (1 << 21) as f64;

/// No half-plane's normal is longer.
pub const LONGEST_NORMAL: f64 = 1.81;

/// The longest way from the pivot, in the frame's unit, for which a leg that spreads wide gets a triangle: 2^20. The far
/// side's offset, and even the way in which the triangle turns, are rounded in proportion to the ways.
const LONGEST: f64 = (1 << 20) as f64;

/// The largest offset: beyond it a half-plane holds every vertex (|dot(normal, p)| <= 1.81 sqrt(2)), or none.
const FAR: f64 = 4.0;

/// A swept triangle; the shader's `Query`. Each half-plane is its inward normal and its offset, in the frame's unit:
/// `p` is inside where dot(normal, p) + offset >= 0 in all three.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Query {
    /// The half-plane left of the triangle's right side.
    pub right: [f32; 3],
    /// Where the vertices to be tried begin, in whatever holds them on the device.
    pub first: u32,
    /// The half-plane right of its left side.
    pub left: [f32; 3],
    /// How many vertices are to be tried.
    pub count: u32,
    /// The half-plane on the pivot's side of its far side.
    pub far: [f32; 3],
    /// Fills 16 bytes.
    pub unused: u32,
}

impl Query {
    /// The triangle with its apex at `pivot` between the slopes `low` and `high`, both at most 1.5 in magnitude, off `axis`, cut
    /// off behind all that is no further than `reach` from the pivot.
    ///
    /// The normals are left as long as they come, at most sqrt(1 + 1.5^2) = 1.81: that saves most of the square roots.
    #[inline]
    pub fn wedge(frame: &Frame, pivot: DVec2, axis: DVec2, (low, high): (f64, f64), reach: f64) -> Query {
        let origin = frame.place(pivot);
        let axis = unit(axis);
        let at = |slope: f64| axis + slope * axis.perp();
        let middle = (low + high) / 2.0;
        // Its length is at most 1 + middle^2 / 2.
        let ahead = at(middle);
        Query {
            right: half_plane(at(low).perp(), origin, 0.0),
            left: half_plane(-at(high).perp(), origin, 0.0),
            far: half_plane(-ahead, origin, frame.scaled(reach) * (1.0 + middle * middle / 2.0)),
            ..Query::default()
        }
    }

    /// The triangle of `pivot` and the leg from `a` to `b`. A leg that spreads a right angle or more and starts or ends
    /// absurdly far away is covered by the whole plane.
    pub fn leg(frame: &Frame, pivot: DVec2, a: DVec2, b: DVec2) -> Query {
        let (a, b) = (frame.way(pivot, a), frame.way(pivot, b));
        let reach = a.abs().max(b.abs()).max_element();
        let (ta, tb) = (tamed(a), tamed(b));
        // A free end on the pivot has no direction: the other end's is all that is swept.
        let (ta, tb) = if a == DVec2::ZERO {
            (tb, tb)
        } else if b == DVec2::ZERO {
            (ta, ta)
        } else {
            (ta, tb)
        };
        if reach == 0.0 {
            return Query::everywhere(-1.0);
        }
        let ((right, left), (r, l)) = if ta.perp_dot(tb) >= 0.0 { ((ta, tb), (a, b)) } else { ((tb, ta), (b, a)) };
        let (right, left) = (unit(right), unit(left));
        let origin = frame.place(pivot);
        let far = if right.dot(left) > 0.0 {
            let ahead = unit(right + left);
            half_plane(-ahead, origin, ahead.dot(l).max(ahead.dot(r)))
        } else if reach > LONGEST {
            return Query::everywhere(1.0);
        } else {
            let normal = unit(tamed(l - r)).perp();
            half_plane(normal, origin, -normal.dot(l).min(normal.dot(r)))
        };
        Query {
            right: half_plane(right.perp(), origin, 0.0),
            left: half_plane(-left.perp(), origin, 0.0),
            far,
            ..Query::default()
        }
    }

    /// The whole plane for a positive offset, nothing for a negative one.
    fn everywhere(offset: f32) -> Query {
        let plane = [0.0, 0.0, offset];
        Query { right: plane, left: plane, far: plane, ..Query::default() }
    }
}

/// The half-plane dot(normal, p - origin) + offset >= 0, grown by the margin.
#[inline]
fn half_plane(normal: DVec2, origin: DVec2, offset: f64) -> [f32; 3] {
    let offset = (offset - normal.dot(origin) + MARGIN).clamp(-FAR, FAR);
    [normal.x as f32, normal.y as f32, offset as f32]
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

#[inline]
fn unit(way: DVec2) -> DVec2 {
    way * (1.0 / way.length())
}
