//! One triangle of the mesh, and its three doors.

use glam::DVec2;

use crate::geometry::orient;

/// The corner, or edge, after each of a triangle's three.
pub(super) const NEXT: [usize; 3] = [1, 2, 0];

/// The bit of [`Triangle::behind`] that says that a point lies too close to an edge to tell its side by rounded
/// numbers.
pub(super) const DOUBT: usize = 8;

/// An edge as seen from inside one of the two triangles that it parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Door(u32);

impl Door {
    /// Behind the edges of the frame there is none.
    pub(super) const NONE: Door = Door(u32::MAX);

    pub(super) fn new(triangle: u32, edge: usize) -> Door {
        Door(triangle * 4 + edge as u32)
    }

    /// The triangle from inside which it is seen.
    #[inline]
    pub(super) fn triangle(self) -> u32 {
        self.0 / 4
    }

    /// Which of that triangle's edges it is.
    #[inline]
    pub(super) fn edge(self) -> usize {
        (self.0 % 4) as usize
    }
}

/// A triangle with all that following a trace needs, in one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Triangle {
    /// Its corners, counter-clockwise.
    pub corners: [DVec2; 3],
    /// The edge from corner i to corner i + 1 as seen from behind it.
    pub beyond: [Door; 3],
}

impl Triangle {
    /// A number with the exact sign of the side on which `a` lies of an edge: above 0 inside.
    #[inline]
    pub(super) fn side(&self, edge: usize, a: DVec2) -> f64 {
        orient(self.corners[edge], self.corners[NEXT[edge]], a)
    }

    /// Whether the closed triangle holds `a`.
    pub(super) fn touches(&self, a: DVec2) -> bool {
        (0..3).all(|edge| self.side(edge, a) >= 0.0)
    }

    /// The edges behind which `a` lies, edge i as bit i, and [`DOUBT`] where rounding could matter.
    ///
    /// With u = 2^-53, let x and y be the two computed products of an edge, and X and Y the true ones. Each is off by
    /// the rounding of two differences and a product, less than 3.1 u of it. The point is surely inside of the edge,
    /// X > Y, in either of two cases. Where x and y have different signs (or one is 0), X and Y have them too, since
    /// rounded differences and products keep their signs, and x > y is enough. Else |x| + |y| = |x + y|, and x - y >
    /// 3.2 u |x + y| is enough. The test asks for x - y > 4 u |x + y| with both sides rounded, which is more: their
    /// roundings change them by a few u of themselves. Behind the edge it is the same with x and y exchanged. Within
    /// the limits of coordinates nothing over- or underflows.
    #[inline]
    pub(super) fn behind(&self, a: DVec2) -> usize {
        const BOUND: f64 = 4.0 / (1u64 << 53) as f64;
        let [p, q, r] = self.corners.map(|c| c - a);
        // No branches: where a leg leads is what no processor can guess.
        let side = |p: DVec2, q: DVec2| {
            let (x, y) = (p.x * q.y, p.y * q.x);
            let bound = BOUND * (x + y).abs();
            let (behind, inside) = (x - y < -bound, x - y > bound);
            (usize::from(behind), usize::from(!(behind | inside)))
        };
        let sides = [side(p, q), side(q, r), side(r, p)];
        let doubt = sides[0].1 | sides[1].1 | sides[2].1;
        sides[0].0 | (sides[1].0 << 1) | (sides[2].0 << 2) | (doubt * DOUBT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_edges_and_corners_are_in_doubt() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let triangle = Triangle { corners: [p(0.1, 0.1), p(0.7, 0.3), p(0.2, 0.9)], beyond: [Door::NONE; 3] };
        assert_eq!([p(0.3, 0.4), p(0.5, 0.1), p(0.0, 0.0)].map(|a| triangle.behind(a)), [0b000, 0b001, 0b101]);
        for (i, next) in NEXT.into_iter().enumerate() {
            let (u, v) = (triangle.corners[i], triangle.corners[next]);
            assert!(triangle.touches(u) && triangle.behind(u) & DOUBT != 0);
            for k in 0..64 {
                let a = u.lerp(v, f64::from(k) / 64.0);
                let behind = triangle.behind(a);
                assert!(behind & DOUBT != 0 || (triangle.side(i, a) < 0.0) == (behind >> i & 1 == 1));
            }
        }
    }
}
