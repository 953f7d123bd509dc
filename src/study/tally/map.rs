//! The plane, cell by cell.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::batches::{Batches, Sizes};
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// The most cells that a side of the map can have.
const MOST: u32 = 4096;

/// The map's cells: squares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Grid {
    low: DVec2,
    high: DVec2,
    cell: f64,
    columns: u32,
    rows: u32,
}

impl Grid {
    /// `most` cells along the longer side of a box.
    fn new(low: DVec2, high: DVec2, most: u32) -> Self {
        let size = high - low;
        let longer = size.max_element();
        let cell = if longer > 0.0 { longer / f64::from(most) } else { 1.0 };
        let [columns, rows] = [size.x, size.y].map(|side| ((side / cell).ceil() as u32).clamp(1, most));
        // A box that is not as high as its cells still has all that lies in them.
        let high = high.max(low + cell * DVec2::new(f64::from(columns), f64::from(rows)));
        Grid { low, high, cell, columns, rows }
    }

    /// The number of the cell of `p`; `None` outside of the map.
    fn of(&self, p: DVec2) -> Option<u32> {
        if !(p.cmpge(self.low).all() && p.cmple(self.high).all()) {
            return None;
        }
        let at = (p - self.low) / self.cell;
        // What lies on the upper border belongs to the last cells.
        let [column, row] = [(at.x, self.columns), (at.y, self.rows)].map(|(c, most)| (c as u32).min(most - 1));
        Some(column + self.columns * row)
    }

    /// What it comes to that free ends were seen in these cells.
    fn visited(&self, seen: BTreeSet<u32>) -> Visited {
        let near = |at: u32, most: u32| at.saturating_sub(1)..=(at + 1).min(most - 1);
        let is_inner = |cell: &&u32| {
            let (column, row) = (**cell % self.columns, **cell / self.columns);
            near(row, self.rows).all(|r| near(column, self.columns).all(|c| seen.contains(&(c + self.columns * r))))
        };
        let area = |cells: usize| cells as f64 * self.cell * self.cell;
        Visited { area: area(seen.len()), inner: area(seen.iter().filter(is_inner).count()) }
    }
}

/// What is counted of a cell in a block.
#[derive(Clone, Copy, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Seen {
    /// How often a free end was seen there.
    visits: u64,
    /// The lengths of the ropes then.
    lengths: u64,
    /// The steps with a contact there.
    contacts: u64,
}

/// What is counted of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct CellCounts {
    /// How often a free end was seen there.
    visits: Sizes,
    /// The lengths of the ropes then, over blocks as large as they have visits.
    lengths: Batches,
    /// Steps with a contact there, over blocks as large as they have steps.
    contacts: Batches,
}

impl Merge for CellCounts {
    fn merge_with(&mut self, other: CellCounts) {
        self.visits.merge_with(other.visits);
        self.lengths.merge_with(other.lengths);
        self.contacts.merge_with(other.contacts);
    }
}

/// The tally of the map's cells.
pub(crate) struct Cells {
    /// None if there is no map.
    grid: Option<Grid>,
    /// After how many steps the map looks again.
    every: usize,
    /// Lengths are summed in whole numbers of this.
    unit: f64,
}

impl Tally for Cells {
    type Part = HashMap<u32, Seen>;
    type Counts = BTreeMap<u32, CellCounts>;
    type Answer = Option<Map>;

    fn check(options: &TallyPlan) -> Result<(), PlanError> {
        if options.map <= MOST {
            return Ok(());
        }
        Err(PlanError::new(format!("tallies.map: at most {MOST} cells side by side, not {}", options.map)))
    }

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        Ok(Cells {
            grid: (options.map > 0).then(|| Grid::new(setting.low, setting.high, options.map)),
            every: options.map_every.max(1) as usize,
            unit: setting.unit(),
        })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let Some(grid) = &self.grid else { return };
        for span in &traced.lasting.spans {
            let first = span.steps.start.next_multiple_of(self.every);
            for step in (first..span.steps.end).step_by(self.every) {
                let end = traced.ends[step];
                if let Some(cell) = grid.of(end) {
                    let seen = part.entry(cell).or_default();
                    seen.visits += 1;
                    seen.lengths += (span.leg.length(end) / self.unit + 0.5) as u64;
                }
            }
        }
        for contact in &traced.lasting.held {
            if let Some(cell) = grid.of(traced.model.vertices()[contact.vertex as usize]) {
                part.entry(cell).or_default().contacts += contact.steps;
            }
        }
    }

    fn finish(&self, part: Self::Part, block: &Size) -> Self::Counts {
        let cell = |seen: Seen| {
            let mut cell = CellCounts::default();
            if seen.visits > 0 {
                cell.visits.add(seen.visits);
                cell.lengths.add(seen.visits, seen.lengths);
            }
            cell.contacts.add(block.looks, seen.contacts);
            cell
        };
        part.into_iter().map(|(number, seen)| (number, cell(seen))).collect()
    }

    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Option<Map> {
        let (grid, confidence) = (self.grid?, &setting.confidence);
        let cell = |(&number, cell): (&u32, &CellCounts)| {
            let (contacts, contacts_error) = cell.contacts.ratio(&totals.looks);
            let length = (cell.visits.sum > 0).then(|| {
                let (mean, error) = cell.lengths.ratio(&cell.visits);
                let (mean, error) = (mean * self.unit, error.map(|e| e * self.unit));
                confidence.around(mean, error, cell.visits.blocks)
            });
            Cell {
                cell: u64::from(number),
                visits: cell.visits.sum,
                length,
                contacts: confidence.around(contacts, contacts_error, totals.looks.blocks),
            }
        };
        let seen = || counts.iter().filter(|(_, cell)| cell.visits.sum > 0).map(|(&number, _)| number);
        Some(Map {
            visited: setting.tether.map(|_| grid.visited(seen().collect())),
            low: grid.low.into(),
            cell: grid.cell,
            columns: grid.columns,
            rows: grid.rows,
            cells: counts.iter().map(cell).collect(),
        })
    }
}

/// The plane, cell by cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Map {
    /// The lowest x and y of the cells: the corner of cell 0.
    pub low: [f64; 2],
    /// How wide and high a cell is.
    pub cell: f64,
    /// How many there are side by side.
    pub columns: u32,
    /// How many one above the other.
    pub rows: u32,
    /// How much of the plane the walks came to, where a tether held them back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visited: Option<Visited>,
    /// The cells in which a free end was seen, or a rope touched a wall end, in the order of their numbers.
    pub cells: Vec<Cell>,
}

/// How much of the plane free ends were seen in, in the square of the scene's unit. That grows with the walks, and is
/// no estimate of what they could come to: it has no interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Visited {
    /// The area of the cells in which a free end was seen: of too much, by as much as cells lie across the border.
    pub area: f64,
    /// That of those whose neighbours, the eight around it as far as there are so many, were all seen too: of too
    /// little.
    pub inner: f64,
}

/// A cell of the map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cell {
    /// Its number: column + columns * row. Both count from 0, columns from the lowest x and rows from the lowest y,
    /// also where y points down. The cell holds the points from low + cell * (column, row) up to a cell further in x
    /// and in y; what lies on the highest x or y belongs to the last column or row.
    pub cell: u64,
    /// How often a free end was seen in it: it is looked at every `study.tallies.map_every` steps.
    pub visits: u64,
    /// The mean length of the rope then.
    pub length: Option<Estimate>,
    /// The number of wall ends in the cell with which the rope has a contact after a step, on average over all steps.
    pub contacts: Estimate,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_box() {
        let grid = Grid::new(DVec2::new(-1.0, 2.0), DVec2::new(3.0, 3.0), 8);
        assert_eq!((grid.cell, grid.columns, grid.rows), (0.5, 8, 2));
        assert_eq!(grid.of(DVec2::new(-1.0, 2.0)), Some(0));
        assert_eq!(grid.of(DVec2::new(3.0, 3.0)), Some(15));
        assert_eq!(grid.of(DVec2::new(-0.4, 2.6)), Some(9));
        assert_eq!(grid.of(DVec2::new(3.1, 3.0)), None);
        // 1 divided by a 49th is more than 49.
        let grid = Grid::new(DVec2::ZERO, DVec2::ONE, 49);
        assert_eq!(grid.of(DVec2::ONE), Some(49 * 49 - 1));
        assert_eq!(Grid::new(DVec2::ZERO, DVec2::ZERO, 8).of(DVec2::ZERO), Some(0));
    }

    #[test]
    fn cells_are_inner_whose_neighbours_were_all_seen() {
        // Four columns of half a unit, and three rows.
        let grid = Grid::new(DVec2::ZERO, DVec2::new(2.0, 1.5), 4);
        let visited = |cells: &[u32]| grid.visited(cells.iter().copied().collect());
        assert_eq!(visited(&[]), Visited { area: 0.0, inner: 0.0 });
        // All three rows of the first three columns: the cells of the first two have all that they can have.
        assert_eq!(visited(&[0, 1, 2, 4, 5, 6, 8, 9, 10]), Visited { area: 2.25, inner: 1.5 });
        // Without the one in the middle none has.
        assert_eq!(visited(&[0, 1, 2, 4, 6, 8, 9, 10]), Visited { area: 2.0, inner: 0.0 });
    }
}
