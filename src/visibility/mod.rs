//! What a pivot sees: the vertices that the rope can wrap round next.
//!
//! While a trace keeps to the rules, the rope's last leg is free of walls. So the next contact is visible from the
//! pivot and tangent there. Both are exact signs of input points; where walls cannot be triangulated (they cross at a
//! point that no f64 names), a vertex too many is listed, never one too few.

mod crossings;
mod expand;
mod mesh;
mod places;
mod required;

use glam::DVec2;

use self::mesh::{Mesh, MeshVertex};
use crate::geometry::{opposite, orient};
use crate::scene::{Model, Pivot};

pub use self::expand::Scratch;

/// A constrained triangulation of a model's walls, from which to look.
pub struct Visibility {
    mesh: Mesh,
    /// The far ends of the walls that meet at each vertex of the mesh, and where each vertex's begin.
    ends: Vec<MeshVertex>,
    first_end: Vec<u32>,
    /// The box out of which no free end goes, if there is one.
    reach: Option<(DVec2, DVec2)>,
}

impl Visibility {
    /// Triangulates the model; `None` where the triangulation cannot take its coordinates (they span more than 140
    /// binary orders of magnitude). O(n log n) for walls that do not cross.
    pub fn new(model: &Model) -> Option<Self> {
        Self::of(model, model.bounds(), None)
    }

    /// Triangulates only the walls near the box between `reach`'s lowest and highest x and y, for looks inside it: what
    /// they see there is all that there is to be seen there, since no line of sight leaves the box between. `reach`
    /// holds the anchor.
    ///
    /// A taut rope never leaves the smallest box around its trace and the anchor.
    pub fn within(model: &Model, reach: (DVec2, DVec2)) -> Option<Self> {
        Self::of(model, reach, Some(reach))
    }

    fn of(model: &Model, near: (DVec2, DVec2), reach: Option<(DVec2, DVec2)>) -> Option<Self> {
        let mesh = Mesh::new(model, near)?;
        let n = mesh.len();
        let mut first_end = vec![0; n + 1];
        for &v in mesh.walls().iter().flatten() {
            first_end[v.index() + 1] += 1;
        }
        for v in 0..n {
            first_end[v + 1] += first_end[v];
        }
        let mut ends = vec![MeshVertex::default(); first_end[n] as usize];
        let mut next = first_end.clone();
        for &[u, v] in mesh.walls() {
            for (here, there) in [(u, v), (v, u)] {
                ends[next[here.index()] as usize] = there;
                next[here.index()] += 1;
            }
        }
        Some(Visibility { mesh, ends, first_end, reach })
    }

    /// Writes the vertices that the rope can wrap round next from `pivot` into `seen`, each once: those that are
    /// visible from it, in the closed sense, and tangent there.
    ///
    /// A vertex exactly behind another on one line may be left out: the nearer one is met first, and then sees it.
    /// O(triangles seen through), by triangular expansion (Bungiu et al., "Efficient computation of visibility
    /// polygons", EuroCG 2014). Nothing if the pivot lies out of reach.
    ///
    /// # Panics
    ///
    /// If `pivot` is one of a model with more vertices.
    pub fn look(&self, pivot: Pivot, scratch: &mut Scratch, seen: &mut Vec<u32>) {
        self.look_into(pivot, |_| 0, usize::MAX, scratch, seen);
    }

    /// Writes those of them that lie inside all lines of some kind into `seen`, each once, and returns how many
    /// triangles were looked at; `None`, and nothing in `seen`, if it gave up because they were more than `most`, or
    /// the pivot lies out of reach.
    ///
    /// `outside` has a bit for each line outside which a point lies; `pivot` must lie inside all. Looks no further than
    /// that: for pivots that are not worth a list. O(triangles of the mesh inside).
    ///
    /// # Panics
    ///
    /// If `pivot` is one of a model with more vertices.
    #[inline]
    pub fn look_into(
        &self,
        pivot: Pivot,
        outside: impl Fn(DVec2) -> u8,
        most: usize,
        scratch: &mut Scratch,
        seen: &mut Vec<u32>,
    ) -> Option<usize> {
        seen.clear();
        let o = self.mesh.vertex(pivot)?;
        let [triangles, listed] = self.mesh.expand(o, scratch, outside, most)?;
        self.name_tangent(self.mesh.at(o), scratch.seen(listed), seen);
        Some(triangles)
    }

    /// Writes the model's numbers of those of `vertices` into `seen` that are tangent as seen from `o`.
    #[inline]
    fn name_tangent(&self, o: DVec2, vertices: &[MeshVertex], seen: &mut Vec<u32>) {
        let name = |&v: &MeshVertex| self.mesh.name(v).filter(|_| self.is_tangent(o, v));
        seen.extend(vertices.iter().filter_map(name));
    }

    /// Whether the walls that meet at `v` leave one side of the line from `o` to it free.
    fn is_tangent(&self, o: DVec2, v: MeshVertex) -> bool {
        let (first, last) = (self.first_end[v.index()] as usize, self.first_end[v.index() + 1] as usize);
        if last - first == 1 {
            return true;
        }
        let p = self.mesh.at(v);
        let mut side = 0.0;
        for &end in &self.ends[first..last] {
            let here = orient(o, p, self.mesh.at(end));
            if opposite(side, here) {
                return false;
            }
            if here != 0.0 {
                side = here;
            }
        }
        true
    }
}
