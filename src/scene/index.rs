//! Which walls are near a box: a grid for small boxes among few walls, an R-tree for the others.

use std::ops::ControlFlow;

use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

use super::Scene;
use super::grid::Grid;
use crate::geometry::{higher, lower};

/// How many walls the grid's cells may list where they are looked through one by one. With more, as in the one cell
/// that holds all of a town on a map of the world, the tree is faster.
const FEW: u32 = 48;

/// How many rows of the grid may be looked through one by one.
const LOW: usize = 16;

struct Entry {
    wall: u32,
    low: DVec2,
    high: DVec2,
}

impl RTreeObject for Entry {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

/// An index of a scene's walls by place.
pub struct WallIndex {
    tree: RTree<Entry>,
    grid: Grid,
    /// The walls' ends, so that they are found with one look.
    ends: Vec<[DVec2; 2]>,
}

impl WallIndex {
    /// Builds the index; O(n log n) in time, O(n) in memory.
    pub fn new(scene: &Scene) -> Self {
        let ends: Vec<[DVec2; 2]> = (0..scene.walls().len()).map(|wall| scene.ends(wall)).collect();
        let entry = |(&[u, v], wall): (&[DVec2; 2], u32)| Entry { wall, low: u.min(v), high: u.max(v) };
        let tree = RTree::bulk_load(ends.iter().zip(0..).map(entry).collect());
        WallIndex { tree, grid: Grid::new(&ends), ends }
    }

    /// The walls whose bounding box meets the closed box from `low` to `high`, in no particular order.
    pub fn near(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = u32> {
        self.tree.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array())).map(|e| e.wall)
    }

    /// Whether it is plain that no wall meets the closed box from `low` to `high`: never true of a box that one meets,
    /// and nearly always of one that is further from all walls than these are long. O(1).
    #[inline]
    pub fn is_free(&self, low: DVec2, high: DVec2) -> bool {
        self.grid.listed(self.grid.cells(low, high)) == 0
    }

    /// Visits walls with their ends until a visit breaks off: all that meet the closed box from `low` to `high`, and
    /// perhaps some that only their bounding box makes meet it. A wall may be visited several times. O(1) where none is
    /// near, else O(log walls + walls near the box).
    #[inline]
    pub fn visit<B>(
        &self,
        low: DVec2,
        high: DVec2,
        mut visit: impl FnMut(u32, [DVec2; 2]) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let cells = self.grid.cells(low, high);
        match self.grid.listed(cells) {
            0 => ControlFlow::Continue(()),
            listed if listed <= FEW && cells.height() <= LOW => {
                for wall in self.grid.walls(cells) {
                    let [u, v] = self.ends[wall as usize];
                    if lower(u, v).cmple(high).all() && higher(u, v).cmpge(low).all() {
                        visit(wall, [u, v])?;
                    }
                }
                ControlFlow::Continue(())
            }
            _ => self.near(low, high).try_for_each(|wall| visit(wall, self.ends[wall as usize])),
        }
    }
}
