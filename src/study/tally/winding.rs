//! How often ropes go about islands: walls that hang together by common ends.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::rope::Side;
use crate::scene::{Island, Model, all_islands};

/// The islands of a scene, from left to right.
#[derive(Debug)]
pub(crate) struct Islands(Vec<Island>);

impl Islands {
    /// O(walls log walls).
    pub(crate) fn new(model: &Model) -> Self {
        let mut islands = all_islands(model.scene());
        islands.sort_by(|a, b| a.middle.x.total_cmp(&b.middle.x).then(a.vertex.cmp(&b.vertex)));
        Islands(islands)
    }

    /// The island of that wall end.
    pub(crate) fn get(&self, vertex: u32) -> Option<&Island> {
        self.0.iter().find(|o| o.vertex == vertex)
    }

    /// Calls `each` with the islands about which the rope from `anchor` round `wraps` to `end` goes at least once all
    /// the way, and how often, counter-clockwise counting as positive.
    pub(crate) fn wound(&self, anchor: DVec2, wraps: &[(DVec2, Side)], end: DVec2, mut each: impl FnMut(u32, i64)) {
        // A straight line sees less than half a turn, so three of them are needed for a whole one.
        if wraps.len() < 2 {
            return;
        }
        let (low, high) = wraps.iter().fold((anchor.min(end), anchor.max(end)), |(l, h), w| (l.min(w.0), h.max(w.0)));
        let first = self.0.partition_point(|o| o.middle.x < low.x);
        for island in self.0[first..].iter().take_while(|o| o.middle.x <= high.x) {
            if island.middle.y < low.y || island.middle.y > high.y {
                continue;
            }
            let turns = turns(island.middle, anchor, wraps, end);
            if turns != 0 {
                each(island.vertex, turns);
            }
        }
    }
}

/// How often the rope goes all the way about `o`.
fn turns(o: DVec2, anchor: DVec2, wraps: &[(DVec2, Side)], end: DVec2) -> i64 {
    let mut angle = 0.0;
    let mut from = (anchor, None);
    let points = wraps.iter().map(|&(at, side)| (at, Some(side))).chain([(end, None)]);
    for to in points {
        angle += seen(o, from, to);
        from = to;
    }
    // A whole turn must not be missed for the roundings of its parts.
    (angle / TAU * (1.0 + 1e-9)) as i64
}

/// The angle under which `o` sees a piece of rope, counter-clockwise counting as positive.
fn seen(o: DVec2, (a, from): (DVec2, Option<Side>), (b, to): (DVec2, Option<Side>)) -> f64 {
    let (p, q) = (a - o, b - o);
    let (across, along) = (p.perp_dot(q), p.dot(q));
    // A rope that lies along the wall passes on the side that its contacts say, not through its middle.
    if along < 0.0
        && across.abs() <= 1e-12 * -along
        && let Some(side) = from.or(to)
    {
        return if side == Side::Left { PI } else { -PI };
    }
    libm::atan2(across, along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn a_rope_about_a_wall_counts_its_turns() {
        let walls = [[p(0.0, 0.0), p(1.0, 0.0)], [p(1.0, 0.0), p(1.0, 1.0)], [p(5.0, 5.0), p(6.0, 5.0)]];
        let model = Model::new(Scene::new(walls).unwrap(), Some(p(-3.0, -1.0))).unwrap();
        let islands = Islands::new(&model);
        assert_eq!(islands.0.iter().map(|o| (o.vertex, o.walls)).collect::<Vec<_>>(), [(0, 2), (3, 1)]);
        let turns = |wraps: &[(DVec2, Side)], end| {
            let mut found = vec![];
            islands.wound(model.anchor(), wraps, end, |o, turns| found.push((o, turns)));
            found
        };
        // Counter-clockwise about both ends of the lower wall, with the wall on the left, along the wall twice.
        let (west, east) = ((p(0.0, 0.0), Side::Left), (p(1.0, 0.0), Side::Left));
        let top = (p(1.0, 1.0), Side::Left);
        assert_eq!(turns(&[east, top], p(-3.0, 0.9)), []);
        assert_eq!(turns(&[east, top, west], p(-3.0, -0.9)), []);
        assert_eq!(turns(&[east, top, west], p(-3.0, -1.1)), [(0, 1)]);
        assert_eq!(turns(&[east, top, west], p(2.0, -1.1)), [(0, 1)]);
        assert_eq!(turns(&[east, top, west, east, top], p(2.0, 9.0)), [(0, 1)]);
        assert_eq!(turns(&[east, top, west, east, top, west, east], p(2.0, 0.5)), [(0, 2)]);
        // Clockwise round a lone wall, along it.
        let model = Model::new(Scene::new([[p(0.0, 0.0), p(1.0, 0.0)]]).unwrap(), Some(p(-3.0, -1.0))).unwrap();
        let islands = Islands::new(&model);
        let (west, east) = ((p(0.0, 0.0), Side::Right), (p(1.0, 0.0), Side::Right));
        let mut found = vec![];
        islands.wound(model.anchor(), &[west, east, west, east], p(0.5, -1.0), |o, turns| found.push((o, turns)));
        assert_eq!(found, [(0, -1)]);
    }
}
