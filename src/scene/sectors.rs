//! The walls at one point: their directions, the sectors between them, and which of these are solid.

use std::cmp::Ordering;

use glam::DVec2;

use super::{Inside, Scene, WallIndex};
use crate::geometry::{Hair, TracePoint, Turn, between, left_of, orient};

/// The directions of the walls at one point, as points towards which they go, sorted counter-clockwise. Sector i is
/// what lies between direction i and the next, counter-clockwise.
#[derive(Debug, Clone)]
pub(crate) struct Sectors {
    pub(crate) at: DVec2,
    pub(crate) towards: Vec<DVec2>,
}

impl Sectors {
    /// Those of the walls that end at `at` or pass through it.
    pub(crate) fn new(scene: &Scene, index: &WallIndex, at: DVec2) -> Sectors {
        let mut towards = Vec::new();
        for wall in walls_at(scene, index, at) {
            towards.extend(scene.ends(wall).into_iter().filter(|&end| end != at));
        }
        towards.sort_by(|&p, &q| by_angle(at, p, q));
        towards.dedup_by(|p, q| by_angle(at, *p, *q).is_eq());
        // Thousands of walls may lie on each other here, and at thousands of other vertices that a step passes.
        towards.shrink_to_fit();
        Sectors { at, towards }
    }

    /// The direction in which `p` lies, or else the sector.
    pub(crate) fn find(&self, p: DVec2) -> Result<usize, usize> {
        let count = self.towards.len();
        self.towards.binary_search_by(|&d| by_angle(self.at, d, p)).map_err(|i| (i + count - 1) % count)
    }

    /// Which sectors lie inside of a solid whose walls meet here. O(walls of these solids) for each sector.
    pub(crate) fn solid(&self, scene: &Scene, index: &WallIndex) -> Vec<bool> {
        let count = self.towards.len();
        let walls: Vec<usize> = walls_at(scene, index, self.at).collect();
        let mut solid = vec![false; count];
        let mut outlined: Vec<usize> = Vec::new();
        for &wall in &walls {
            match scene.objects()[scene.object_of(wall)].inside {
                Inside::Free => {}
                Inside::EvenOdd | Inside::NonZero => outlined.push(scene.object_of(wall)),
                Inside::Right => {
                    let [u, v] = scene.outline(wall);
                    // Looking towards its second end, a wall's right is the sector before its direction, clockwise.
                    if let Some(Ok(i)) = (v != self.at).then(|| self.find(v)) {
                        solid[(i + count - 1) % count] = true;
                    }
                    if let Some(Ok(i)) = (u != self.at).then(|| self.find(u)) {
                        solid[i] = true;
                    }
                }
            }
        }
        outlined.sort_unstable();
        outlined.dedup();
        for (solid, &witness) in solid.iter_mut().zip(&self.towards) {
            let hair = Some(Hair { witness, away: false, turn: Turn::Left });
            let point = TracePoint { at: self.at, hair };
            *solid |= outlined.iter().any(|&object| holds(scene, object, point));
        }
        solid
    }
}

/// The walls that end at `at` or pass through it. O(log walls + walls near it).
pub(super) fn walls_at(scene: &Scene, index: &WallIndex, at: DVec2) -> impl Iterator<Item = usize> {
    index.near(at, at).map(|wall| wall as usize).filter(move |&wall| {
        let [u, v] = scene.ends(wall);
        at == u || at == v || (orient(u, v, at) == 0.0 && between(u, v, at))
    })
}

/// Whether `point`, which has a hair, lies inside of an object with closed outlines: by how often they go round it
/// (Sunday's winding number, "Inclusion of a point in a polygon", 2001), with exact signs.
fn holds(scene: &Scene, object: usize, point: TracePoint) -> bool {
    // Whether `p` lies on the height of the point or below: the point's hair is never level.
    let is_below = |p: DVec2| {
        let o = point.at;
        // Some point at the same height, to the east.
        let east = DVec2::new(o.x + o.x.abs().max(1.0), o.y);
        p.y < o.y || (p.y == o.y && left_of(o, east, point))
    };
    let mut winding = 0i64;
    for wall in (0..scene.walls().len()).filter(|&wall| scene.object_of(wall) == object) {
        let [u, v] = scene.outline(wall);
        match (is_below(u), is_below(v)) {
            (true, false) if left_of(u, v, point) => winding += 1,
            (false, true) if !left_of(u, v, point) => winding -= 1,
            _ => {}
        }
    }
    match scene.objects()[object].inside {
        Inside::EvenOdd => winding % 2 != 0,
        _ => winding != 0,
    }
}

/// Compares the directions from `at` to `p` and to `q` by their angle in [0, 360) degrees, exactly.
pub(crate) fn by_angle(at: DVec2, p: DVec2, q: DVec2) -> Ordering {
    let lower_half = |p: DVec2| p.y < at.y || (p.y == at.y && p.x < at.x);
    (lower_half(p).cmp(&lower_half(q))).then_with(|| {
        let side = orient(at, p, q);
        if side > 0.0 {
            Ordering::Less
        } else if side < 0.0 {
            Ordering::Greater
        } else {
            Ordering::Equal
        }
    })
}
