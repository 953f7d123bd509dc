//! A uniform grid over the walls: which cells no wall meets, and which walls meet a cell.
//!
//! The grid only has to be conservative: a wall that meets a box is listed in at least one of the box's cells.
//! The cell of a coordinate is a chain of operations that round to nearest and so never swap two coordinates, and it is
//! off by less than 2^-30 of a cell; a wall is listed in all cells that it meets when it is made [`SLACK`] cells wider
//! on all sides. Coordinates outside of the walls' bounding box fall into a border of cells, which are empty but for
//! walls right beside them.

use glam::DVec2;

/// How many cells there are for each wall: so many that most of them are empty, and so few that the sums of a large
/// scene still fit a processor's cache.
const CELLS_PER_WALL: usize = 8;

/// How many cells list a wall on average at most. Where long walls would be listed more often, cells are made larger.
const ENTRIES_PER_WALL: usize = 8;

/// By how many cells walls are made wider. Far more than the roundings: a place in the grid is off by less than its
/// value times 2^-51, and a wall's place in a row by less than the number of cells times 2^-50, so 2^-17 for 2^33
/// cells.
const SLACK: f64 = 1e-4;

/// A block of cells: columns and rows, from the first to the last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    columns: [usize; 2],
    rows: [usize; 2],
}

pub(super) struct Grid {
    low: DVec2,
    /// Cells per unit of length.
    scale: DVec2,
    columns: usize,
    rows: usize,
    /// Where each cell's walls start in `walls`, row by row, and where the last one's end.
    starts: Vec<u32>,
    walls: Vec<u32>,
    /// How many entries there are in the cells before each column and each row: (columns + 1) by (rows + 1).
    sums: Vec<u32>,
}

impl Grid {
    /// A grid over walls with these ends; O(walls) in memory, O(walls log walls) in time.
    pub(super) fn new(walls: &[[DVec2; 2]]) -> Self {
        let bounds = walls.iter().flatten().fold(None, |bounds: Option<(DVec2, DVec2)>, &p| {
            Some(bounds.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
        });
        let (low, high) = bounds.unwrap_or_default();
        let mut cells = walls.len() * CELLS_PER_WALL + 1;
        loop {
            let mut grid = Grid::empty(low, high - low, cells);
            if grid.count(walls) || cells == 1 {
                grid.fill(walls);
                return grid;
            }
            cells = 1.max(cells / 4);
        }
    }

    /// About `cells` cells over a box.
    fn empty(low: DVec2, extent: DVec2, cells: usize) -> Self {
        // As square as they can be; where all walls lie in one line, that is along it.
        let side_by_side = (cells as f64 * (extent.x / extent.y)).sqrt();
        let columns = (side_by_side as usize).clamp(1, cells);
        let rows = 1.max(cells / columns);
        let scale = |count: usize, extent: f64| if extent > 0.0 { count as f64 / extent } else { 0.0 };
        let scale = DVec2::new(scale(columns, extent.x), scale(rows, extent.y));
        // With the border.
        let (columns, rows) = (columns + 2, rows + 2);
        let (starts, sums) = (vec![0; columns * rows + 1], vec![0; (columns + 1) * (rows + 1)]);
        Grid { low, scale, columns, rows, starts, walls: Vec::new(), sums }
    }

    /// Counts the entries of each cell, in `starts` one place further on; false if there are too many in all.
    fn count(&mut self, walls: &[[DVec2; 2]]) -> bool {
        let most = walls.len() * ENTRIES_PER_WALL;
        let (mut starts, mut entries) = (std::mem::take(&mut self.starts), 0);
        for wall in walls {
            self.each_row(wall, |row, first, last| {
                starts[row * self.columns + first + 1..=row * self.columns + last + 1].iter_mut().for_each(|n| *n += 1);
                entries += last - first + 1;
            });
            if entries > most {
                break;
            }
        }
        self.starts = starts;
        entries <= most
    }

    /// Lists the walls, given the counts.
    fn fill(&mut self, walls: &[[DVec2; 2]]) {
        let width = self.columns + 1;
        for row in 0..self.rows {
            let mut sum = 0u32;
            for column in 0..self.columns {
                sum = sum.wrapping_add(self.starts[row * self.columns + column + 1]);
                self.sums[(row + 1) * width + column + 1] = self.sums[row * width + column + 1].wrapping_add(sum);
            }
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        let mut entries = vec![0; self.starts[self.starts.len() - 1] as usize];
        for (wall, number) in walls.iter().zip(0..) {
            self.each_row(wall, |row, first, last| {
                for next in &mut next[row * self.columns + first..=row * self.columns + last] {
                    entries[*next as usize] = number;
                    *next += 1;
                }
            });
        }
        self.walls = entries;
    }

    /// Visits the rows that a wall meets, each with the first and last column.
    fn each_row(&self, &[u, v]: &[DVec2; 2], mut visit: impl FnMut(usize, usize, usize)) {
        let (p, q) = if u.y <= v.y { (self.place(u), self.place(v)) } else { (self.place(v), self.place(u)) };
        let rise = q.y - p.y;
        let column = |x: f64| clamped(x, self.columns);
        // Where the wall crosses the height `y`. A wall that rises little is listed in all its columns.
        let crosses = |y: f64| p.x + ((y - p.y) / rise).clamp(0.0, 1.0) * (q.x - p.x);
        for row in clamped(p.y - SLACK, self.rows)..=clamped(q.y + SLACK, self.rows) {
            let (a, b) = match row as f64 {
                _ if rise < 0.5 => (p.x, q.x),
                y => (crosses(y - SLACK), crosses(y + 1.0 + SLACK)),
            };
            visit(row, column(a.min(b) - SLACK), column(a.max(b) + SLACK));
        }
    }

    /// Where a point lies, in cells from the border's corner.
    #[inline]
    fn place(&self, p: DVec2) -> DVec2 {
        (p - self.low) * self.scale + 1.0
    }

    /// The cells that the closed box from `low` to `high` meets.
    #[inline]
    pub(super) fn cells(&self, low: DVec2, high: DVec2) -> Cells {
        let (low, high) = (self.place(low), self.place(high));
        Cells {
            columns: [clamped(low.x, self.columns), clamped(high.x, self.columns)],
            rows: [clamped(low.y, self.rows), clamped(high.y, self.rows)],
        }
    }

    /// How many walls are listed in some cells, one that is listed in several of them as often.
    #[inline]
    pub(super) fn listed(&self, cells: Cells) -> u32 {
        let sum = |column: usize, row: usize| self.sums[row * (self.columns + 1) + column];
        let [left, right] = [cells.columns[0], cells.columns[1] + 1];
        let [below, above] = [cells.rows[0], cells.rows[1] + 1];
        // Each may have wrapped; what is left has not.
        sum(right, above).wrapping_sub(sum(left, above)).wrapping_sub(sum(right, below)).wrapping_add(sum(left, below))
    }

    /// The walls listed in some cells, some of them perhaps several times. O(rows of the block + walls).
    #[inline]
    pub(super) fn walls(&self, cells: Cells) -> impl Iterator<Item = u32> {
        (cells.rows[0]..=cells.rows[1]).flat_map(move |row| {
            let [first, last] = cells.columns.map(|column| row * self.columns + column);
            self.walls[self.starts[first] as usize..self.starts[last + 1] as usize].iter().copied()
        })
    }
}

impl Cells {
    /// How many rows the block has.
    pub(super) fn height(&self) -> usize {
        self.rows[1] - self.rows[0] + 1
    }
}

/// The number of the cell at `place` among `count`, those at the ends taking all that lies beyond.
#[inline]
fn clamped(place: f64, count: usize) -> usize {
    // The order of the comparisons turns a NaN into 0.
    let place = if place > 0.0 { place } else { 0.0 };
    let last = (count - 1) as f64;
    (if place < last { place } else { last }) as usize
}
