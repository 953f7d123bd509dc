//! Triangular expansion: looking through the triangles of the mesh from one of its vertices.

use glam::DVec2;

use super::mesh::{CLOSED, HalfEdge, Mesh, MeshVertex, next};
use crate::geometry::orient;

/// Memory that looks share, one after the other.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The look in which each vertex of the mesh was seen last.
    seen_in: Vec<u32>,
    look: u32,
    /// The views of the current look, those already looked at included, and room for two more.
    views: Vec<View>,
    /// The vertices seen, and room for one more.
    seen: Vec<MeshVertex>,
}

impl Scratch {
    /// Starts a look at a mesh of `vertices` vertices.
    fn start(&mut self, vertices: usize) {
        if self.look == u32::MAX || self.seen_in.len() != vertices {
            self.seen_in.clear();
            self.seen_in.resize(vertices, 0);
            self.look = 0;
        }
        self.look += 1;
    }

    /// Makes room where `views` views and `seen` vertices are.
    #[inline]
    fn make_room(&mut self, views: usize, seen: usize) {
        if views + 2 > self.views.len() {
            self.views.resize(2 * views + 64, View::default());
        }
        if seen + 1 > self.seen.len() {
            self.seen.resize(2 * seen + 64, MeshVertex::default());
        }
    }

    /// What the last look has seen, if that is so much.
    #[inline]
    pub(super) fn seen(&self, listed: usize) -> &[MeshVertex] {
        &self.seen[..listed]
    }
}

/// What is still to be looked at: the triangle behind an edge, between two rays.
#[derive(Debug, Clone, Copy, Default)]
struct View {
    /// The edge as seen from inside the triangle to be looked at.
    edge: u32,
    /// The vertices that bound the view.
    right: MeshVertex,
    left: MeshVertex,
    /// Outside which lines they lie, in the lowest two bytes, and the edge's right and left end, in the highest.
    outside: [u8; 4],
}

impl View {
    /// Whether there is anything to be seen.
    #[inline]
    fn is_open(&self) -> bool {
        let [right, left, first, last] = self.outside;
        (self.edge != CLOSED) & (right & left | first & last == 0)
    }
}

impl Mesh {
    /// Leaves all vertices that are visible from `o`, in the closed sense, in `scratch`, the model's each once; returns
    /// how many triangles were looked at, and [how many vertices were seen](Scratch::seen). `None` if it gave up
    /// because the triangles were more than `most`.
    ///
    /// A view is an open cone between two vertices seen before; what lies in it or on its bounding rays is listed. So a
    /// vertex that a line of sight grazes is listed, and what can be left out lies exactly behind another.
    ///
    /// Only vertices are listed that lie inside all lines of some kind: `outside` has a bit for each line outside which
    /// a point lies. `o` must lie inside all. Then what lies outside a line stays there when it is moved straight away
    /// from `o`, and so does all that lies between two such points: no view is followed whose two bounding vertices, or
    /// whose edge's two ends, lie outside one line.
    #[inline]
    pub(super) fn expand(
        &self,
        o: MeshVertex,
        scratch: &mut Scratch,
        outside: impl Fn(DVec2) -> u8,
        most: usize,
    ) -> Option<[usize; 2]> {
        scratch.start(self.len());
        let at = self.at(o);
        let (mut views, mut listed) = (0, 0);
        // Whether a view is followed and a vertex new is as good as random, so both are written down in any case and
        // then kept or not: a branch would cost more than the rest. Views are taken in the order in which they were
        // found, so that the next ones do not wait for the current one's.
        for &spoke in self.fan(o) {
            scratch.make_room(views, listed + 1);
            let across = next(spoke);
            let ends = [self.edge(across).origin, self.edge(next(across)).origin];
            let [right, left] = ends.map(|vertex| outside(self.at(vertex)));
            for (vertex, outside) in ends.into_iter().zip([right, left]) {
                listed += self.see(vertex, outside == 0, listed, scratch);
            }
            let edge = self.edge(across).twin;
            let view = View { edge, right: ends[0], left: ends[1], outside: [right, left, right, left] };
            scratch.views[views] = view;
            views += usize::from(view.is_open());
        }
        self.follow(at, self.fan(o).len(), [views, listed], scratch, outside, most)
    }

    /// The same for a point inside a triangle or on its border, but not on a vertex; nothing bounds the look. Returns
    /// how many vertices were seen.
    pub(super) fn expand_from(&self, at: DVec2, triangle: u32, scratch: &mut Scratch) -> usize {
        scratch.start(self.len());
        let (mut views, mut listed) = (0, 0);
        scratch.make_room(3, 3);
        for edge in 4 * triangle..4 * triangle + 3 {
            let [right, left] = [edge, next(edge)].map(|edge| self.edge(edge).origin);
            listed += self.see(right, true, listed, scratch);
            scratch.views[views] = View { edge: self.edge(edge).twin, right, left, outside: [0; 4] };
            views += usize::from(scratch.views[views].is_open());
        }
        let [_, listed] = self.follow(at, 1, [views, listed], scratch, |_| 0, usize::MAX).expect("nothing bounds it");
        listed
    }

    /// The triangles that meet what is visible from mesh vertex `o`, each once, ascending.
    pub(super) fn triangles_seen(&self, o: MeshVertex, scratch: &mut Scratch) -> Vec<u32> {
        let [looked_at, _] = self.expand(o, scratch, |_| 0, usize::MAX).expect("nothing bounds it");
        let followed = looked_at - self.fan(o).len();
        let edges = self.fan(o).iter().copied().chain(scratch.views[..followed].iter().map(|view| view.edge));
        let mut triangles: Vec<u32> = edges.map(|edge| edge / 4).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }

    /// Follows the first `views` views of `scratch`, of which `listed` vertices were seen and for which `before`
    /// triangles were looked at.
    #[inline(always)]
    fn follow(
        &self,
        at: DVec2,
        before: usize,
        [mut views, mut listed]: [usize; 2],
        scratch: &mut Scratch,
        outside: impl Fn(DVec2) -> u8,
        most: usize,
    ) -> Option<[usize; 2]> {
        let mut done = 0;
        while done < views {
            if before + done >= most {
                return None;
            }
            scratch.make_room(views, listed);
            let View { edge, right, left, outside: [right_out, left_out, first_out, last_out] } = scratch.views[done];
            done += 1;
            // The triangle behind the edge: from the edge's right end to the apex, and from the apex to its left end.
            let [to_apex, HalfEdge { origin: apex, twin: from_apex }] = self.beyond(edge);
            let p = self.at(apex);
            let out = outside(p);
            let from_right = orient(at, self.at(right), p);
            let from_left = orient(at, self.at(left), p);
            let is_inside = (from_right >= 0.0) & (from_left <= 0.0) & (out == 0);
            listed += self.see(apex, is_inside, listed, scratch);

            let (nearer, nearer_out) = if from_left < 0.0 { (apex, out) } else { (left, left_out) };
            let view =
                View { edge: to_apex.twin, right, left: nearer, outside: [right_out, nearer_out, first_out, out] };
            scratch.views[views] = view;
            views += usize::from((from_right > 0.0) & view.is_open());

            let (nearer, nearer_out) = if from_right > 0.0 { (apex, out) } else { (right, right_out) };
            let view = View { edge: from_apex, right: nearer, left, outside: [nearer_out, left_out, out, last_out] };
            scratch.views[views] = view;
            views += usize::from((from_left < 0.0) & view.is_open());
        }
        Some([before + done, listed])
    }

    /// Writes `vertex` down as the one behind the `listed`, and returns 1 if it is to be kept: seen, and not before.
    #[inline]
    fn see(&self, vertex: MeshVertex, is_seen: bool, listed: usize, scratch: &mut Scratch) -> usize {
        let last = &mut scratch.seen_in[vertex.index()];
        let is_new = is_seen & (*last != scratch.look);
        *last = if is_seen { scratch.look } else { *last };
        scratch.seen[listed] = vertex;
        usize::from(is_new)
    }
}
