//! The vertices that a pivot sees, in the order in which the rope's last leg meets their rays when it turns.

use std::cmp::Ordering;

use glam::DVec2;

use crate::geometry::{CERTAIN, forwards, orient};
use crate::scene::Model;

/// The vertex of a ray that belongs to none.
pub const NO_VERTEX: u32 = u32::MAX;

/// By how much the keys of two ways must differ for their order to be that of the ways. A key is a quotient of numbers
/// that are good to 2^-52, at most 1, with up to 3 added.
const TELLS: f64 = 1.0 / (1u64 << 48) as f64;

/// The rays of the vertices that a pivot sees, counter-clockwise, and rays along the axes, which belong to no vertex,
/// where none lies on them: so two neighbours are never more than a right angle apart.
///
/// Of vertices on one ray only the nearest is there: where a leg can meet others, it meets that one first.
///
/// A leg that turns about the pivot meets one ray after the other. So the vertices that it can meet next are always
/// two: those of the rays on both sides of where it points.
#[derive(Debug)]
pub struct Fan {
    /// The way to each vertex from the pivot, in the scene's unit.
    ways: Box<[DVec2]>,
    /// The vertex of each ray.
    vertices: Box<[u32]>,
    /// The angle of each, as [`key`] has it, rounded.
    keys: Box<[f32]>,
    /// How near the nearest vertex is.
    nearest: f64,
}

impl Fan {
    /// The fan of `pivot` and the vertices of these numbers; those that stand on the pivot itself have no ray.
    /// O(vertices log vertices).
    pub fn new(model: &Model, pivot: DVec2, vertices: impl Iterator<Item = u32>) -> Self {
        const AXES: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
        struct Ray {
            key: f64,
            way: DVec2,
            vertex: u32,
        }
        let at = |vertex: u32| model.vertices()[vertex as usize];
        let seen = vertices.filter(|&v| at(v) != pivot).map(|vertex| (at(vertex) - pivot, vertex));
        let all = AXES.into_iter().map(|way| (way, NO_VERTEX)).chain(seen);
        let mut rays: Vec<Ray> = all.map(|(way, vertex)| Ray { key: key(way), way, vertex }).collect();
        // A product with an axis is exact.
        let turn = |p: &Ray, q: &Ray| match (p.vertex, q.vertex) {
            (NO_VERTEX, _) | (_, NO_VERTEX) => p.way.perp_dot(q.way),
            (a, b) => orient(pivot, at(a), at(b)),
        };
        rays.sort_unstable_by(|p, q| {
            if (p.key - q.key).abs() > TELLS {
                return p.key.total_cmp(&q.key);
            }
            let nearer = || match (p.vertex, q.vertex) {
                (NO_VERTEX, _) | (_, NO_VERTEX) => p.vertex.cmp(&q.vertex),
                (a, b) if forwards(pivot, at(a), at(b)) => Ordering::Less,
                (a, b) => {
                    if a == b {
                        Ordering::Equal
                    } else {
                        Ordering::Greater
                    }
                }
            };
            0.0.partial_cmp(&turn(p, q)).unwrap_or(Ordering::Equal).then_with(nearer)
        });
        rays.dedup_by(|further, nearer| (further.key - nearer.key).abs() <= TELLS && turn(nearer, further) == 0.0);
        let lengths = rays.iter().filter(|ray| ray.vertex != NO_VERTEX).map(|ray| ray.way.length());
        Fan {
            nearest: lengths.fold(f64::INFINITY, f64::min),
            ways: rays.iter().map(|ray| ray.way).collect(),
            vertices: rays.iter().map(|ray| ray.vertex).collect(),
            keys: rays.iter().map(|ray| ray.key as f32).collect(),
        }
    }

    /// How many rays it has, at least 4.
    #[inline]
    pub fn rays(&self) -> usize {
        self.ways.len()
    }

    /// The distance of the nearest vertex from the pivot, in the scene's unit; infinite if there is none.
    #[inline]
    pub fn nearest(&self) -> f64 {
        self.nearest
    }

    /// The way from the pivot along ray `i`, in the scene's unit.
    #[inline]
    pub fn way(&self, i: usize) -> DVec2 {
        self.ways[i]
    }

    /// The vertex of ray `i`, or [`NO_VERTEX`].
    #[inline]
    pub fn vertex(&self, i: usize) -> u32 {
        self.vertices[i]
    }

    /// The ray after ray `i`, counter-clockwise.
    #[inline]
    pub fn after(&self, i: usize) -> usize {
        if i + 1 < self.rays() { i + 1 } else { 0 }
    }

    /// The ray before ray `i`.
    #[inline]
    pub fn before(&self, i: usize) -> usize {
        if i > 0 { i - 1 } else { self.rays() - 1 }
    }

    /// The last ray that certainly lies clockwise of `way`, with the next certainly counter-clockwise of it; `None` if
    /// that is not certain. O(log rays).
    pub fn locate(&self, way: DVec2) -> Option<usize> {
        let key = key(way) as f32;
        let mut next = self.keys.partition_point(|&k| k < key) % self.rays();
        // Rounded keys may be out of order; a few rays are tried.
        for _ in 0..4 {
            let last = self.before(next);
            if certain_turn(self.ways[next], way) > 0.0 {
                next = self.after(next);
            } else if certain_turn(self.ways[last], way) < 0.0 {
                next = last;
            } else {
                let is_between = certain_turn(self.ways[last], way) > 0.0 && certain_turn(self.ways[next], way) < 0.0;
                return is_between.then_some(last);
            }
        }
        None
    }

    /// Where the way from the point `from` to the pivot, drawn further, goes on: the last ray that does not lie
    /// counter-clockwise of it, and whether it lies on that ray. Exact. O(log rays), and one step a ray that lies
    /// along nearly the same line.
    pub fn goes_on(&self, model: &Model, from: DVec2, pivot: DVec2) -> (usize, bool) {
        let way = pivot - from;
        // A product with an axis is exact.
        let turn_from = |i: usize| match self.vertices[i] {
            NO_VERTEX => self.ways[i].perp_dot(way),
            vertex => -orient(from, pivot, model.vertices()[vertex as usize]),
        };
        let key = key(way) as f32;
        let mut next = self.keys.partition_point(|&k| k < key) % self.rays();
        // Rounded keys may be out of order.
        while turn_from(next) >= 0.0 {
            next = self.after(next);
        }
        while turn_from(self.before(next)) < 0.0 {
            next = self.before(next);
        }
        let last = self.before(next);
        (last, turn_from(last) == 0.0)
    }

    /// The ray of the vertex to which exactly this way leads; `None` if there is none. O(log rays), and one step a ray
    /// that lies along nearly the same line.
    pub fn ray_along(&self, way: DVec2) -> Option<usize> {
        let key = key(way) as f32;
        let from = self.keys.partition_point(|&k| k < key);
        (from..self.rays()).take_while(|&i| self.keys[i] <= key).find(|&i| self.ways[i] == way)
    }

    /// The memory that it takes for each vertex, in bytes.
    pub const BYTES: usize = size_of::<DVec2>() + size_of::<u32>() + size_of::<f32>();
}

/// A number with the sign of the turn from `u` to `v`, which are differences of points rounded once; 0 if it is not
/// certain.
#[inline]
pub fn certain_turn(u: DVec2, v: DVec2) -> f64 {
    let (left, right) = (u.x * v.y, u.y * v.x);
    let turn = left - right;
    if turn.abs() > CERTAIN * (left.abs() + right.abs()) { turn } else { 0.0 }
}

/// A number that grows with the angle of `way` from the x axis, counter-clockwise: from 0 to 4, a unit a quadrant.
#[inline]
fn key(way: DVec2) -> f64 {
    // Ways from the pivot are good to 2^-53 in each coordinate, so each quotient is good to 2^-51.
    let (x, y) = (way.x.abs(), way.y.abs());
    let share = |part: f64, other: f64| part / (part + other);
    match (way.x > 0.0, way.y > 0.0) {
        (true, false) if way.y == 0.0 => 0.0,
        (true, true) => share(y, x),
        (false, true) => 1.0 + share(x, y),
        (false, false) if way.x < 0.0 => 2.0 + share(y, x),
        (false, false) => 3.0,
        (true, false) => 3.0 + share(x, y),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_grow_with_the_angle() {
        let mut last = -1.0;
        for i in 0..720 {
            let (sin, cos) = f64::sin_cos(f64::from(i) * std::f64::consts::TAU / 720.0);
            let way = DVec2::new(if i % 360 == 180 { 0.0 } else { cos }, if i % 360 == 0 { 0.0 } else { sin });
            assert!(key(way) > last, "{i}");
            last = key(way);
        }
        assert!(last < 4.0);
    }
}
