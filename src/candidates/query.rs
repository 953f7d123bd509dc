//! Queries: the triangle that the rope's last leg sweeps in a window of legs, as three half-planes.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::{DevicePlace, Frame};

/// By how much a swept triangle is grown, in the frame's unit: 2^-18, about 3.8e-6.
///
/// To be shown: where a vertex P lies in the closed triangle that the rope's last leg sweeps about the pivot O on one
/// of the query's legs, exactly, the three values n . p + c that f32 gives are 0 or above. All lengths are in the
/// frame's unit.
///
/// 1. *What is assumed of f32*, which is less than WGSL promises: a product or sum is one of the two f32 nearest to
///    what is exact, and so off by less than the distance between these two. A product and a sum may be fused, which
///    rounds once instead of twice, and sums may be put in another order. Subnormal numbers, those that go in too, may
///    be taken for 0. A minimum is one of its arguments. x >= 0 holds for 0 and above. Devices are asked whether they
///    keep to that (`src/gpu/probe.rs`). The loops on the CPU (`simd.rs`) fuse, reorder and flush nothing and
///    round to the nearest, which is one of the two; NaN, by which they fill up lists, compares as false, and no device
///    is given it.
/// 2. *The frame.* [`Frame::place`] rounds the subtraction of the centre and nothing else, so each coordinate is good
///    to 2^-53 for vertices and pivots, which lie in [-1, 1]^2. So P is at most 2 sqrt(2) < 2.83 from O. [`Frame::way`]
///    is good to 2^-53 of each coordinate.
/// 3. *A wedge holds what is swept.* Its slopes are good to 20 x 2^-53 (`CERTAIN` in `window.rs` says why). Triangles
///    of which the corners other than O lie between two slopes, all before O, lie between them. A slope that is off by
///    s moves the line by at most 2.83 s at P: 57 x 2^-53. No point of a triangle is further from O than its furthest
///    corner, and `ahead`, whose length is at most 1 + middle^2 / 2, measures no distance as more than that times
///    itself. Where the first leg starts on its way, the first slope is that of the start.
/// 4. *A wedge in f64.* A unit vector is good to 4, a normal to 10 x 2^-53 of 1.81; at P that is 52 x 2^-53. An offset
///    of at most 6.6 (beyond, step 6 holds) is good to 10 x 2^-53 of itself, 66; the product with the pivot and the two
///    last sums add 28, the places of pivot and vertex 6. With step 3 that is 209 x 2^-53, less than 2^-45.
/// 5. *A leg in f64.* Rounding can swap left and right only if both ends lie within an angle of 4 x 2^-53 of one line
///    through O. If they lie on the same side of O, P is that close to both sides of the triangle. If they lie on
///    opposite sides, the triangle is flat: no point of it is further from the sides than 4 x 2^-53 of 2.83 and of the
///    shorter way. Beyond a right angle a way has at most `LONGEST` sqrt(2) = 2^20.5, so that is less than 2^-30.4. The
///    far side is put behind both ends, whatever its direction, so all of the triangle lies before it. Each end's
///    distance is good to 4 x 2^-53 of its way: 2^-30.5 beyond a right angle; below one, the way is at most sqrt(2)
///    times an offset of 6.6 or less, or step 6 holds. Together less than 2^-30.
/// 6. *The offset is clamped* to `FAR` = 4. A normal's length is at most sqrt(1 + 1.5^2) < 1.81 ([`LONGEST_NORMAL`]),
///    so |n . p| is at most 1.81 sqrt(2) < 2.56. Where it was more than 4, the value is still above 4 - 2.56 less all
///    errors; where it was less than -4, P could not be inside.
/// 7. *Rounding to f32*, to the nearest: each coordinate of p, at most 1, by 2^-25, together with |n| at most 1.81
///    sqrt(2) 2^-25 = 7.7e-8. Each of n, below 2, by 2^-24, together with |p.x| + |p.y| at most 2 x 2^-24 = 1.2e-7. The
///    offset, at most 4, by 2^-23 = 1.2e-7.
/// 8. *Products and sums*, by step 1: two products of at most 1.81, where neighbours are 2^-23 apart, 2 x 2^-23 =
///    2.4e-7. Two sums, of which the one is at most 1.81 + 4 and the other at most 2.56 + 4, in whatever order, where
///    neighbours are 2^-21 apart: 2 x 2^-21 = 9.6e-7. That is [`ARITHMETIC`]. Five inputs and four results taken for 0
///    add 9 x 1.81 x 2^-126.
///
/// Steps 4 or 5, 7 and 8 come to less than 1.6e-6. Without any error the value is at least the margin, so it stays
/// above 2.2e-6: the margin is more than twice what is needed.
pub const MARGIN: f64 = 1.0 / (1 << 18) as f64;

/// What of the [`MARGIN`] is for the device: by how much the value of a half-plane may be off because of rounded
/// products and sums, 2 x 2^-23 + 2 x 2^-21, step 8 there (those that are flushed add nothing to speak of).
pub const ARITHMETIC: f64 = 2.0 / (1 << 23) as f64 + 2.0 / (1 << 21) as f64;

/// No half-plane's normal is longer.
pub const LONGEST_NORMAL: f64 = 1.81;

/// The longest way from the pivot, in the frame's unit, for which a leg that spreads wide gets a triangle: 2^20. The
/// far side's offset, and even the way in which the triangle turns, are rounded in proportion to the ways.
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
    /// Where the vertices to be tried begin.
    pub first: DevicePlace,
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
    /// The triangle with its apex at `pivot` between the slopes `low` and `high`, both at most 1.5 in magnitude, off
    /// `axis`, cut off behind all that is no further than `reach` from the pivot.
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
