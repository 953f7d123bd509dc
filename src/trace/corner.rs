//! The walls that meet where a trace touches: the sectors between them, and the hair by which the trace passes.

use std::cmp::Ordering;

use glam::DVec2;

use crate::geometry::{Hair, Turn, orient};
use crate::scene::{Model, Sectors, by_angle};

/// The sectors between the walls at one point.
#[derive(Debug, Clone)]
pub(super) struct Corner {
    sectors: Sectors,
    /// Which of them are solid: of the anchor, from where a trace starts. Whoever comes from elsewhere comes from what
    /// is free.
    solid: Vec<bool>,
}

/// The way along which a trace comes to a corner or leaves it, as seen from the corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// A point in that direction.
    pub towards: DVec2,
    /// In which sector it lies: the one counter-clockwise of direction `sector`.
    sector: usize,
    place: Place,
}

/// Where in its sector a way lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// Along the wall at which the sector starts.
    Start,
    /// Strictly between the walls.
    Inside,
    /// Along the wall at which the sector ends.
    End,
}

impl Corner {
    /// The walls that end at `at` or pass through it; found through the model's index.
    pub(super) fn new(model: &Model, at: DVec2) -> Corner {
        match model.border() {
            Some((sectors, solid)) if at == model.anchor() => {
                Corner { sectors: sectors.clone(), solid: solid.to_vec() }
            }
            _ => Corner { sectors: Sectors::new(model.scene(), model.index(), at), solid: Vec::new() },
        }
    }

    /// Whether a wall goes from here towards `p`.
    pub(super) fn has_wall_towards(&self, p: DVec2) -> bool {
        self.sectors.find(p).is_ok()
    }

    /// The way towards `p`. Where a wall goes that way, `side` says on which side of it (as seen from here) the way
    /// lies.
    pub(super) fn way(&self, p: DVec2, side: Turn) -> Way {
        let count = self.sectors.towards.len();
        match self.sectors.find(p) {
            Ok(i) if side == Turn::Left => Way { towards: p, sector: i, place: Place::Start },
            Ok(i) => Way { towards: p, sector: (i + count - 1) % count, place: Place::End },
            Err(sector) => Way { towards: p, sector, place: Place::Inside },
        }
    }

    /// Whether a trace that starts here along `way` starts into a solid.
    pub(super) fn is_solid(&self, way: Way) -> bool {
        self.solid.get(way.sector).is_some_and(|&solid| solid)
    }

    /// Some way, if there is one into what is free: left along the first wall that has it there.
    pub(super) fn any_way(&self) -> Way {
        let sector = self.solid.iter().position(|&solid| !solid).unwrap_or(0);
        Way { towards: self.sectors.towards[sector], sector, place: Place::Start }
    }

    /// Whether one can pass from `from` to `to` without crossing a wall that meets here.
    pub(super) fn connects(&self, from: Way, to: Way) -> bool {
        from.sector == to.sector
    }

    /// Whether passing from `from` to `to` goes all the way round the end of a lone wall, from one of its sides to the
    /// other.
    pub(super) fn rounds_tip(&self, from: Way, to: Way) -> bool {
        self.sectors.towards.len() == 1
            && matches!((from.place, to.place), (Place::Start, Place::End) | (Place::End, Place::Start))
    }

    /// The hairs by which a trace passes from `from` to `to` a hair off the walls: one, or two round a wall's tip.
    ///
    /// If walls lie between, they are passed as if they were not there, on the left.
    pub(super) fn hairs(&self, from: Way, to: Way) -> Vec<Hair> {
        let connected = self.connects(from, to);
        // Whether `to` follows `from` counter-clockwise through the sector.
        let ccw = connected && self.precedes(from, to);
        let (first, second) = if ccw { (from, to) } else { (to, from) };
        let toward = if ccw { Turn::Left } else { Turn::Right };
        let area = orient(self.sectors.at, first.towards, second.towards);
        let same_way = area == 0.0 && by_angle(self.sectors.at, from.towards, to.towards).is_eq();
        let hair = |away, turn| Hair { witness: from.towards, away, turn };
        if connected && self.rounds_tip(from, to) {
            vec![hair(true, toward.reversed()), hair(true, toward)]
        } else if same_way {
            // Back the same way, on the same side.
            vec![hair(false, if from.place == Place::End { Turn::Right } else { Turn::Left })]
        } else if area > 0.0 {
            vec![hair(false, toward)]
        } else {
            vec![hair(true, toward.reversed())]
        }
    }

    /// Whether `p` comes before `q` when their common sector is passed counter-clockwise.
    fn precedes(&self, p: Way, q: Way) -> bool {
        match p.place.cmp(&q.place) {
            Ordering::Equal if p.place == Place::Inside => {
                let start = self.sectors.towards[p.sector];
                // Angles from the sector's start, in (0, 360) degrees: first those of less than a half turn.
                let half = |w: DVec2| {
                    let side = orient(self.sectors.at, start, w);
                    if side > 0.0 { 0 } else { 1 + u8::from(side < 0.0) }
                };
                (half(p.towards).cmp(&half(q.towards)))
                    .then_with(|| 0.0f64.total_cmp(&(orient(self.sectors.at, p.towards, q.towards) + 0.0)))
                    .is_lt()
            }
            order => order.is_lt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn walls_on_each_other_take_no_more_room_than_one() {
        let at = DVec2::ZERO;
        let walls = (1..=1000).map(|k| [at, DVec2::new(f64::from(k), 0.0)]);
        let model = Model::new(Scene::new(walls).unwrap(), Some(DVec2::new(0.0, -1.0))).unwrap();
        let corner = Corner::new(&model, at);
        assert_eq!((corner.sectors.towards.len(), corner.sectors.towards.capacity()), (1, 1));
    }
}
