//! Exact signs of input points. Nothing here constructs a point, so nothing here rounds.

use glam::DVec2;
use robust::Coord;

/// Of which share of its two products an area must be to have the right sign: Shewchuk's bound `ccwerrboundA`.
pub(crate) const CERTAIN: f64 = (3.0 + 8.0 * f64::EPSILON) * (f64::EPSILON / 2.0);

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

/// A number with the exact sign of the signed area of the triangle `p`, `q`, `r`: above 0 when `r` lies left of
/// `p -> q`, below 0 when right of it, 0 when the three lie on one line.
///
/// Only the sign means anything. Exact for points within the limits of [`check_point`](super::check_point), between
/// which nothing here under- or overflows (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
/// geometric predicates", Discrete Comput. Geom. 18, 1997).
///
/// ```
/// use tautline::geometry::orient;
/// assert!(orient([0.0, 0.0].into(), [1.0, 0.0].into(), [0.5, 1e-30].into()) > 0.0);
/// ```
#[inline]
pub fn orient(p: DVec2, q: DVec2, r: DVec2) -> f64 {
    // The library's own first test asks for the sign before it knows that it is certain: where signs are random, a
    // branch that nothing predicts.
    let (left, right) = ((p.x - r.x) * (q.y - r.y), (p.y - r.y) * (q.x - r.x));
    let area = left - right;
    if area.abs() >= CERTAIN * (left.abs() + right.abs()) { area } else { uncertain(p, q, r) }
}

#[cold]
fn uncertain(p: DVec2, q: DVec2, r: DVec2) -> f64 {
    robust::orient2d(coord(p), coord(q), coord(r))
}

/// Whether two areas have the same sign, neither being zero: the points lie strictly on the same side.
///
/// Not their product's sign: tiny areas have a product of zero.
#[inline]
pub fn same_side(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

/// Whether two areas have opposite signs, neither being zero: the points lie strictly on different sides.
#[inline]
pub fn opposite(a: f64, b: f64) -> bool {
    same_side(a, -b)
}

/// For three points on one line: whether the way `o -> p -> q` goes on forwards, with `q` strictly beyond `p`.
///
/// Rounded differences keep their sign, so comparing coordinates is exact. False when `o` equals `p`, or `p` equals
/// `q`.
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
    fn sides_of_tiny_areas() {
        assert!(same_side(1e-200, 1e-200) && !same_side(1e-200, -1e-200) && !same_side(0.0, 1.0));
        assert!(opposite(-1e-200, 1e-200) && !opposite(0.0, -1.0) && !opposite(-1.0, -2.0));
    }
}
