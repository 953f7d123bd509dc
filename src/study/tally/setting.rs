//! What the tallies of all blocks have in common.

use std::sync::Arc;

use glam::DVec2;

use super::winding::Obstacles;
use crate::scene::Model;
use crate::study::plan::Plan;

/// At how many steps survival curves are given.
const TIMES: u64 = 100;

/// The map's cells: squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cells {
    pub low: DVec2,
    pub high: DVec2,
    pub cell: f64,
    pub columns: u32,
    pub rows: u32,
}

impl Cells {
    /// `most` cells along the longer side of a box.
    fn new((low, high): (DVec2, DVec2), most: u32) -> Self {
        let size = high - low;
        let longer = size.max_element();
        let cell = if longer > 0.0 { longer / f64::from(most) } else { 1.0 };
        let [columns, rows] = [size.x, size.y].map(|side| ((side / cell).ceil() as u32).clamp(1, most));
        // A box that is not as high as its cells still has all that lies in them.
        let high = high.max(low + cell * DVec2::new(f64::from(columns), f64::from(rows)));
        Cells { low, high, cell, columns, rows }
    }

    /// The number of the cell of `p`; `None` outside of the map.
    pub(super) fn of(&self, p: DVec2) -> Option<u32> {
        if !(p.cmpge(self.low).all() && p.cmple(self.high).all()) {
            return None;
        }
        let at = (p - self.low) / self.cell;
        // What lies on the upper border belongs to the last cells.
        let [column, row] = [(at.x, self.columns), (at.y, self.rows)].map(|(c, most)| (c as u32).min(most - 1));
        Some(column + self.columns * row)
    }
}

/// What the tallies of all blocks have in common.
pub(crate) struct Setting {
    /// The scene with each of its anchors; trace i has anchor i modulo their number.
    pub models: Vec<Arc<Model>>,
    pub limits: Vec<f64>,
    /// The steps at which survival curves are given, ascending.
    pub times: Vec<u64>,
    /// The width of a histogram's bins.
    pub bin: f64,
    /// Lengths are summed in whole numbers of this.
    pub unit: f64,
    pub cells: Option<Cells>,
    /// After how many steps the map looks again.
    pub every: u64,
    pub obstacles: Obstacles,
    /// The label of each wall end; empty if there are none.
    pub labels: Vec<Option<String>>,
}

impl Setting {
    /// For ropes in `models`, and traces between `low` and `high`.
    pub(crate) fn new(plan: &Plan, models: Vec<Arc<Model>>, (low, high): (DVec2, DVec2)) -> Self {
        let extent = power_of_two((high - low).max_element());
        let tallies = &plan.tallies;
        let mut limits = tallies.limits.clone();
        limits.sort_by(f64::total_cmp);
        let times = match plan.walk.steps() {
            Some(steps) => {
                (0..=TIMES).map(|i| (u128::from(steps) * u128::from(i) / u128::from(TIMES)) as u64).collect()
            }
            // Nobody knows yet how long given traces are.
            None => (0..4).chain((8..128).map(|i| (4 + i % 4) << (i / 4 - 2))).collect(),
        };
        let mut times: Vec<u64> = times;
        times.dedup();
        Setting {
            limits,
            times,
            bin: if tallies.bin > 0.0 { tallies.bin } else { extent / 64.0 },
            unit: extent / f64::from(1 << 20),
            cells: (tallies.map > 0).then(|| Cells::new((low, high), tallies.map)),
            every: u64::from(tallies.map_every.max(1)),
            obstacles: Obstacles::new(&models[0]),
            labels: models[0].scene().labels().into_iter().map(|label| label.map(str::to_owned)).collect(),
            models,
        }
    }

    pub(crate) fn model(&self, trace: u64) -> &Arc<Model> {
        &self.models[self.anchor(trace)]
    }

    /// The number of the trace's anchor.
    pub(crate) fn anchor(&self, trace: u64) -> usize {
        (trace % self.models.len() as u64) as usize
    }
}

/// The greatest power of two that is not above `size`; 1 for 0.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 { f64::from_bits(size.to_bits() & (0x7ff << 52)) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_box() {
        let cells = Cells::new((DVec2::new(-1.0, 2.0), DVec2::new(3.0, 3.0)), 8);
        assert_eq!((cells.cell, cells.columns, cells.rows), (0.5, 8, 2));
        assert_eq!(cells.of(DVec2::new(-1.0, 2.0)), Some(0));
        assert_eq!(cells.of(DVec2::new(3.0, 3.0)), Some(15));
        assert_eq!(cells.of(DVec2::new(-0.4, 2.6)), Some(9));
        assert_eq!(cells.of(DVec2::new(3.1, 3.0)), None);
        // 1 divided by a 49th is more than 49.
        let cells = Cells::new((DVec2::ZERO, DVec2::ONE), 49);
        assert_eq!(cells.of(DVec2::ONE), Some(49 * 49 - 1));
        assert_eq!(Cells::new((DVec2::ZERO, DVec2::ZERO), 8).of(DVec2::ZERO), Some(0));
        assert_eq!([0.0, 1.0, 1.5, 0.3, 5.0].map(power_of_two), [1.0, 1.0, 1.0, 0.25, 4.0]);
    }
}
