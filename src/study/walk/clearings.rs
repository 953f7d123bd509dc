//! Boxes that no wall meets: every step within one is open, which is seen at once.

use std::ops::ControlFlow::{Break, Continue};
use std::ops::Range;

use glam::DVec2;

use super::room::Room;
use crate::geometry::{higher, lower, orient, same_side};
use crate::scene::WallIndex;

/// A box within a room that no wall meets, its border included.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearing {
    low: DVec2,
    high: DVec2,
}

impl Clearing {
    /// A box that holds nothing.
    pub(super) const NONE: Clearing = Clearing { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };

    #[inline]
    pub(super) fn holds(&self, p: DVec2) -> bool {
        (p.x >= self.low.x) & (p.x <= self.high.x) & (p.y >= self.low.y) & (p.y <= self.high.y)
    }
}

/// The clearings of a room: square cells, each with how many rings of cells around it no wall meets.
///
/// A clearing is made of whole cells that share their corners' very coordinates, so that it is free however roundly the
/// cell of a point is found: who asks looks whether it holds what it should.
pub(super) struct Clearings {
    low: DVec2,
    high: DVec2,
    /// How wide and high a cell is.
    side: f64,
    columns: usize,
    rows: usize,
    /// For each cell, row by row and with a border of further ones: 0 if a wall meets it, else 1 and the number of
    /// rings of cells around it that none meets.
    clear: Vec<u8>,
}

/// About how many cells there are at most.
const MOST: f64 = (1 << 20) as f64;

/// How many cells a step is long where there may be that many.
const CELLS_PER_STEP: f64 = 2.0;

impl Clearings {
    /// The clearings of a room that has an area, for steps of about that length. O(cells + walls near each).
    pub(super) fn new(room: &Room, step: f64) -> Self {
        let size = room.high - room.low;
        let least = (size.x * size.y / MOST).sqrt().max(size.max_element() / MOST);
        let side = least.max(step / CELLS_PER_STEP);
        let [columns, rows] = [size.x, size.y].map(|size| ((size / side).ceil() as usize).max(1));
        let clear = vec![u8::MAX; (columns + 2) * (rows + 2)];
        let mut clearings = Clearings { low: room.low, high: room.high, side, columns, rows, clear };
        clearings.find_walls(room.model.index(), 0..columns, 0..rows);
        let (width, mut clear) = (columns + 2, std::mem::take(&mut clearings.clear));
        let cells = |row: usize| row * width + 1..=row * width + columns;
        // How far it is to the next cell that is not free, by columns or by rows, whichever is more: in one pass over
        // the cells from those before, in another from those behind (Rosenfeld and Pfaltz, "Sequential operations in
        // digital picture processing", J. ACM 13, 1966).
        let mut look = |cell: usize, [a, b, c, d]: [usize; 4]| {
            let nearest = clear[a].min(clear[b]).min(clear[c]).min(clear[d]);
            clear[cell] = clear[cell].min(nearest.saturating_add(1));
        };
        (1..=rows).flat_map(cells).for_each(|i| look(i, [i - 1, i - width - 1, i - width, i - width + 1]));
        (1..=rows).flat_map(cells).rev().for_each(|i| look(i, [i + 1, i + width + 1, i + width, i + width - 1]));
        clearings.clear = clear;
        clearings
    }

    /// Notes which cells of a block walls meet: all at once, or half by half.
    fn find_walls(&mut self, index: &WallIndex, columns: Range<usize>, rows: Range<usize>) {
        if is_free(index, self.corner(columns.start, rows.start), self.corner(columns.end, rows.end)) {
            return;
        }
        let (wide, high) = (columns.len(), rows.len());
        if wide > 1 && wide >= high {
            let middle = columns.start + wide / 2;
            self.find_walls(index, columns.start..middle, rows.clone());
            self.find_walls(index, middle..columns.end, rows);
        } else if high > 1 {
            let middle = rows.start + high / 2;
            self.find_walls(index, columns.clone(), rows.start..middle);
            self.find_walls(index, columns, middle..rows.end);
        } else {
            let cell = self.cell(columns.start, rows.start);
            self.clear[cell] = 0;
        }
    }

    /// The place of a cell in `clear`.
    fn cell(&self, column: usize, row: usize) -> usize {
        (row + 1) * (self.columns + 2) + column + 1
    }

    /// The lowest corner of a cell. Those of the next column or row are its others.
    fn corner(&self, column: usize, row: usize) -> DVec2 {
        self.low + self.side * DVec2::new(column as f64, row as f64)
    }

    /// The widest clearing about the cell of `p`; it need not hold `p`, and holds nothing where a wall is too near.
    pub(super) fn around(&self, p: DVec2) -> Clearing {
        let place = (p - self.low) / self.side;
        let [column, row] = [(place.x, self.columns), (place.y, self.rows)].map(|(c, n)| (c as usize).min(n - 1));
        match usize::from(self.clear[self.cell(column, row)]) {
            0 => Clearing::NONE,
            rings => Clearing {
                low: self.corner((column + 1).saturating_sub(rings), (row + 1).saturating_sub(rings)),
                high: lower(self.corner((column + rings).min(self.columns), (row + rings).min(self.rows)), self.high),
            },
        }
    }
}

/// Whether no wall meets the closed box from `low` to `high`.
fn is_free(index: &WallIndex, low: DVec2, high: DVec2) -> bool {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    index
        .visit(low, high, |_, [u, v]| {
            let beside = higher(u, v).cmplt(low).any() || lower(u, v).cmpgt(high).any();
            let [first, others @ ..] = corners.map(|corner| orient(u, v, corner));
            let is_apart = beside || others.iter().all(|&other| same_side(first, other));
            if is_apart { Continue(()) } else { Break(()) }
        })
        .is_continue()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::example::BuiltIn;
    use crate::scene::{Model, Scene};
    use crate::study::random::{Purpose, Random};

    /// Whether a wall has a point in the closed box: an end, or one in which it crosses or touches a side.
    fn meets([u, v]: [DVec2; 2], low: DVec2, high: DVec2) -> bool {
        let within = |p: DVec2| p.cmpge(low).all() && p.cmple(high).all();
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let apart = |[a, b]: [DVec2; 2], p: DVec2, q: DVec2| same_side(orient(a, b, p), orient(a, b, q));
        within(u)
            || within(v)
            || (0..4).any(|i| {
                let side = [corners[i], corners[(i + 1) % 4]];
                let boxes = lower(u, v).cmple(higher(side[0], side[1])).all()
                    && lower(side[0], side[1]).cmple(higher(u, v)).all();
                boxes && !apart([u, v], side[0], side[1]) && !apart(side, u, v)
            })
    }

    fn model(walls: &[[[f64; 2]; 2]], scale: f64, anchor: [f64; 2]) -> Arc<Model> {
        let walls = walls.iter().map(|wall| wall.map(|end| scale * DVec2::from(end)));
        Arc::new(Model::new(Scene::new(walls).unwrap(), Some(scale * DVec2::from(anchor))).unwrap())
    }

    #[test]
    fn clearings_are_as_wide_as_walls_let_them_and_meet_none() {
        let built_in = [BuiltIn::Rooms, BuiltIn::Random(150), BuiltIn::Random(1), BuiltIn::Lattice(60)];
        let mut scenes: Vec<(Arc<Model>, f64)> =
            built_in.map(|s| (Arc::new(Model::new(s.scene(3), None).unwrap()), 4.0 * s.step())).to_vec();
        // Walls on the box's border, through cells' corners and along their sides, and one that slants.
        let ring =
            [[[0.0, 0.0], [7.0, 0.0]], [[7.0, 0.0], [7.0, 7.0]], [[7.0, 7.0], [0.0, 7.0]], [[0.0, 7.0], [0.0, 0.0]]];
        let inner = [[[1.0, 1.0], [3.0, 3.0]], [[4.0, 2.0], [4.0, 3.0]], [[1.0, 5.0], [6.0, 5.1]]];
        let walls = [&ring[..], &inner[..]].concat();
        for scale in [1.0, 0.1, 1e149, 1e-130] {
            scenes.push((model(&walls, scale, [2.5, 0.5]), scale));
        }
        // Far from the origin, where a step is a few of its coordinates' last bits, and a box that is long and low.
        let far = [[[1e15, 1e15], [1e15 + 64.0, 1e15]], [[1e15, 1e15 + 32.0], [1e15 + 9.0, 1e15 + 40.0]]];
        scenes.push((model(&far, 1.0, [1e15 + 3.0, 1e15 + 3.0]), 0.3));
        scenes.push((model(&[[[0.0, 0.0], [1e6, 1.0]], [[5.0, 1.0], [5.0, 0.5]]], 1.0, [9.0, 0.5]), 0.5));
        for (model, step) in scenes {
            let room = Room::new(model.clone());
            let clearings = Clearings::new(&room, step);
            assert!((clearings.clear.len() as f64) < 4.0 * MOST);
            let ends: Vec<[DVec2; 2]> = (0..model.scene().walls().len()).map(|wall| model.scene().ends(wall)).collect();
            let is_met = |low, high| ends.iter().any(|&wall| meets(wall, low, high));
            let mut random = Random::new(1, Purpose::Walk, 0);
            let size = room.high - room.low;
            let corners = [room.low, room.high, model.anchor(), model.vertices()[0]];
            let (mut held, mut near) = (0, 0);
            for i in 0..400 {
                // Also beyond the borders, and on them.
                let p = match corners.get(i) {
                    Some(&corner) => corner,
                    None => room.low + size * (DVec2::new(random.unit(), random.unit()) * 1.25 - 0.125),
                };
                let clearing = clearings.around(p);
                if clearing.low.x > clearing.high.x {
                    near += usize::from(room.holds(p));
                    continue;
                }
                assert!(room.holds(clearing.low) && room.holds(clearing.high), "{p}: {clearing:?}");
                assert!(!is_met(clearing.low, clearing.high), "{p}: {clearing:?}");
                held += usize::from(clearing.holds(p));
                // A ring more would meet a wall, but where there is no more room, or none can be counted.
                let rounding = 4.0 * f64::EPSILON * room.low.abs().max(room.high.abs()).max_element();
                let wider = 1.0001 * clearings.side + rounding;
                let (low, high) = (clearing.low - wider, clearing.high + wider);
                let most = 254.0 * clearings.side;
                let is_all = low.cmplt(room.low).any() || high.cmpgt(room.high).any();
                assert!(is_all || is_met(low, high) || high.x - low.x > most, "{p}: {clearing:?}");
            }
            assert!(held > 80 || near > 240, "{held} {near}");
        }
    }

    #[test]
    fn a_wall_along_the_highest_border_is_met() {
        // Widths that no whole number of cells fits.
        for i in 1..300 {
            let (width, height) = (1.0 + f64::from(i) / 7.0, 1.0 + f64::from(i) / 11.0);
            let ring = [[[0.0, height], [width, height]], [[width, 0.0], [width, height]], [[0.0; 2], [0.1, 0.1]]];
            let room = Room::new(model(&ring, 1.0, [0.0, 0.0]));
            let clearings = Clearings::new(&room, 0.3);
            for p in [DVec2::new(width, 0.5), DVec2::new(0.5, height), room.high, room.high - 0.31] {
                let clearing = clearings.around(p);
                assert!(!(clearing.high.x >= width || clearing.high.y >= height) || clearing.low.x > clearing.high.x);
            }
        }
    }
}
