//! Exact signs of input points. Nothing here constructs a point, so nothing here rounds.

use glam::DVec2;
use robust::Coord;

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

/// A number with the exact sign of the signed area of the triangle `p`, `q`, `r`: above 0 when `r` lies left of
/// `p -> q`, below 0 when right of it, 0 when the three lie on one line.
///
/// Only the sign means anything. Exact for points within the limits of [`check_point`](super::check_point)
/// (Shewchuk's adaptive predicate).
///
/// ```
/// use tautline::geometry::orient;
/// assert!(orient([0.0, 0.0].into(), [1.0, 0.0].into(), [0.5, 1e-30].into()) > 0.0);
/// ```
#[inline]
pub fn orient(p: DVec2, q: DVec2, r: DVec2) -> f64 {
    robust::orient2d(coord(p), coord(q), coord(r))
}

/// Whether `r` lies left of `p -> q`, where on the line counts as left, once and for all.
#[inline]
pub fn left(p: DVec2, q: DVec2, r: DVec2) -> bool {
    orient(p, q, r) >= 0.0
}

/// For three points on one line: whether the way `o -> p -> q` goes on forwards, with `q` strictly beyond `p`.
///
/// Rounded differences keep their sign, so comparing coordinates is exact. False when `o` equals `p`, or `p` equals `q`.
#[inline]
pub fn forwards(o: DVec2, p: DVec2, q: DVec2) -> bool {
    let on = |o: f64, p: f64, q: f64| (o < p && p < q) || (o > p && p > q);
    if o.x != p.x { on(o.x, p.x, q.x) } else { on(o.y, p.y, q.y) }
}

/// For three points on one line: whether `p` lies strictly between `a` and `b`.
#[inline]
pub fn between(a: DVec2, b: DVec2, p: DVec2) -> bool {
    forwards(a, p, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forwards_on_every_axis() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        assert!(forwards(p(0.0, 0.0), p(0.0, 1.0), p(0.0, 2.0)));
        assert!(forwards(p(0.0, 0.0), p(-1.0, 1.0), p(-2.0, 2.0)));
        assert!(!forwards(p(0.0, 0.0), p(2.0, 0.0), p(1.0, 0.0)));
        assert!(!forwards(p(0.0, 0.0), p(1.0, 0.0), p(-1.0, 0.0)));
        assert!(!forwards(p(0.0, 0.0), p(1.0, 0.0), p(1.0, 0.0)));
    }

    #[test]
    fn left_takes_the_line_in() {
        assert!(left(DVec2::ZERO, DVec2::X, DVec2::X * 7.0));
        assert!(!left(DVec2::ZERO, DVec2::X, DVec2::new(0.5, -1e-300)));
    }
}
