//! The constrained triangulation of a scene's walls, laid out for walking through it.

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::crossings::crossings;
use crate::geometry::{between, higher, lower, orient};
use crate::scene::{Model, Pivot};

/// Into how many pieces walls may be cut by vertices that lie on them, on average, before the rest stays out, which is
/// safe: thousands of walls that lie on each other would be cut into millions.
const PIECES: usize = 16;

/// Marks an edge through which one cannot see: a wall, or the mesh's outer border.
pub(super) const CLOSED: u32 = u32::MAX;

/// A vertex of the mesh, by its number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[repr(transparent)]
pub(super) struct MeshVertex(u32);

impl MeshVertex {
    /// That of a pivot that is not in the mesh.
    const ABSENT: MeshVertex = MeshVertex(u32::MAX);

    #[inline]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// An edge of a triangle as seen from inside it. Half-edges 4t, 4t + 1 and 4t + 2 are those of triangle t,
/// counter-clockwise; 4t + 3 is none.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfEdge {
    /// The vertex at which it starts.
    pub origin: MeshVertex,
    /// The same edge as seen from the triangle on its other side, or [`CLOSED`].
    pub twin: u32,
}

/// A triangle's half-edges, in one line of the cache.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
struct Triangle([HalfEdge; 4]);

/// The triangulation. Its vertices are the model's, the anchor, crossings of walls, and four corners far outside,
/// numbered along a curve that fills the plane, and so are its triangles: what lies near each other does so in memory.
pub(super) struct Mesh {
    vertices: Vec<DVec2>,
    walls: Vec<[MeshVertex; 2]>,
    /// The walls along which not every edge is closed.
    loose: Vec<u32>,
    /// The model's number of each vertex, or [`NAMELESS`].
    names: Vec<u32>,
    /// The vertex of each pivot, or [`MeshVertex::ABSENT`].
    pivots: Vec<MeshVertex>,
    anchor: Pivot,
    triangles: Vec<Triangle>,
    /// The half-edges that start at each vertex, in triangles in which looks start, and where each vertex's begin.
    fans: Vec<u32>,
    first_fan: Vec<u32>,
}

/// The name of a vertex that is none of the model's.
const NAMELESS: u32 = u32::MAX;

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

impl Mesh {
    /// The part that looks inside the box of `reach` can see. `None` where the triangulation cannot take the
    /// coordinates.
    pub(super) fn new(model: &Model, (low, high): (DVec2, DVec2)) -> Option<Mesh> {
        let real = model.vertices().len();
        let is_near = |&wall: &u32| {
            let [a, b] = model.scene().ends(wall as usize);
            lower(a, b).cmple(high).all() && higher(a, b).cmpge(low).all()
        };
        let near: Vec<u32> = (0..model.scene().walls().len() as u32).filter(is_near).collect();
        let ends = || near.iter().map(|&wall| model.scene().walls()[wall as usize]);

        let mut places = Vec::new();
        let mut names = Vec::new();
        let mut pivots = vec![MeshVertex::ABSENT; real + 1];
        for v in ends().flatten() {
            if pivots[v as usize] == MeshVertex::ABSENT {
                pivots[v as usize] = MeshVertex(0);
                places.push(model.vertices()[v as usize]);
                names.push(v);
            }
        }
        let anchor = model.vertex_at(model.anchor());
        if anchor.is_none_or(|v| pivots[v as usize] == MeshVertex::ABSENT) {
            places.push(model.anchor());
            names.push(anchor.unwrap_or(real as u32));
        }
        places.extend(crossings(model, &near));
        let bounds = places.iter().fold((places[0], places[0]), |(l, h), &p| (lower(l, p), higher(h, p)));
        places.extend(corners(bounds));
        names.resize(places.len(), NAMELESS);

        let order = along_curve(&places, bounds);
        let vertices: Vec<DVec2> = order.iter().map(|&place| places[place as usize]).collect();
        let mut names: Vec<u32> = order.iter().map(|&place| names[place as usize]).collect();
        for (here, name) in (0..).map(MeshVertex).zip(&mut names).filter(|(_, name)| **name != NAMELESS) {
            pivots[*name as usize] = here;
            if *name == real as u32 {
                *name = NAMELESS;
            }
        }
        if let Some(anchor) = anchor {
            pivots[real] = pivots[anchor as usize];
        }

        let walls: Vec<[MeshVertex; 2]> = ends().map(|wall| wall.map(|v| pivots[v as usize])).collect();
        let mut cdt = triangulate(&vertices)?;
        let (mut added, mut room) = (0, PIECES * walls.len());
        while added < walls.len() && room > 0 {
            // A wall that crosses another where no vertex is stays out: it then hides nothing, which is safe.
            let [u, v] = walls[added].map(handle);
            room = room.saturating_sub(cdt.try_add_constraint(u, v).len());
            added += 1;
        }
        let mut mesh = Mesh {
            vertices,
            walls,
            loose: vec![],
            names,
            pivots,
            anchor: model.pivot(None),
            triangles: vec![],
            fans: vec![],
            first_fan: vec![],
        };
        mesh.take_triangles(&cdt);
        mesh.close(&cdt, added);
        mesh.leave_solids(model);
        Some(mesh)
    }

    fn take_triangles(&mut self, cdt: &Cdt) {
        let n = self.vertices.len();
        // Of each of the library's triangles: its vertices, its edges, and the same edges as seen from outside.
        let faces: Vec<([MeshVertex; 3], [[u32; 3]; 2])> = cdt
            .inner_faces()
            .map(|face| {
                let edges = face.adjacent_edges();
                let of = |number: &dyn Fn(_) -> usize| edges.map(|edge| number(edge) as u32);
                let [inner, outer] = [of(&|edge| edge.index()), of(&|edge| edge.rev().index())];
                (of(&|edge| edge.from().index()).map(MeshVertex), [inner, outer])
            })
            .collect();
        // They are numbered in the order of their lowest vertices.
        let lowest = |vertices: &[MeshVertex; 3]| vertices.iter().min().expect("a triangle has vertices").index();
        let mut next = vec![0; n + 1];
        for (vertices, _) in &faces {
            next[lowest(vertices) + 1] += 4;
        }
        for v in 0..n {
            next[v + 1] += next[v];
        }
        // The number here of each of the library's edges that has a triangle on its left.
        let mut numbers = vec![CLOSED; cdt.num_directed_edges()];
        self.triangles = vec![Triangle([HalfEdge { origin: MeshVertex(0), twin: CLOSED }; 4]); faces.len()];
        self.first_fan = vec![0; n + 1];
        for (vertices, [inner, outer]) in &faces {
            let first = &mut next[lowest(vertices)];
            for i in 0..3 {
                // Replaced below by the number of the same edge.
                self.triangles[*first as usize / 4].0[i] = HalfEdge { origin: vertices[i], twin: outer[i] };
                self.first_fan[vertices[i].index() + 1] += 1;
                numbers[inner[i] as usize] = *first + i as u32;
            }
            *first += 4;
        }
        for Triangle(triangle) in &mut self.triangles {
            for edge in &mut triangle[..3] {
                edge.twin = numbers[edge.twin as usize];
            }
        }
        for v in 0..n {
            self.first_fan[v + 1] += self.first_fan[v];
        }
        self.fans = vec![0; self.first_fan[n] as usize];
        let mut next = self.first_fan.clone();
        for (Triangle(triangle), first) in self.triangles.iter().zip((0..).step_by(4)) {
            for (edge, number) in triangle[..3].iter().zip(first..) {
                let slot = &mut next[edge.origin.index()];
                self.fans[*slot as usize] = number;
                *slot += 1;
            }
        }
    }

    /// Closes the edges that lie on the first `walls` walls. Only those that are found by following a wall from vertex
    /// to vertex are closed, so whatever else the triangulation holds as constraints hides nothing.
    fn close(&mut self, cdt: &Cdt, walls: usize) {
        for wall in 0..walls {
            let [u, v] = self.walls[wall];
            let (mut here, end) = (u, self.at(v));
            while here != v {
                let at = self.at(here);
                let along = cdt.vertex(handle(here)).out_edges().find(|edge| {
                    let to = MeshVertex(edge.to().fix().index() as u32);
                    let p = self.at(to);
                    edge.is_constraint_edge() && (to == v || orient(at, end, p) == 0.0 && between(at, end, p))
                });
                let Some(edge) = along else {
                    self.loose.push(wall as u32);
                    break;
                };
                let next = MeshVertex(edge.to().fix().index() as u32);
                self.close_edge(here, next);
                here = next;
            }
        }
        self.loose.extend(walls as u32..self.walls.len() as u32);
    }

    fn close_edge(&mut self, u: MeshVertex, v: MeshVertex) {
        for (from, to) in [(u, v), (v, u)] {
            let fan = self.first_fan[from.index()] as usize..self.first_fan[from.index() + 1] as usize;
            for &edge in &self.fans[fan] {
                if self.edge(next(edge)).origin == to {
                    self.triangles[edge as usize / 4].0[edge as usize % 4].twin = CLOSED;
                }
            }
        }
    }

    /// Leaves all triangles but those that `is_kept` marks out of all fans, so that looks never start into the others.
    pub(super) fn start_only_in(&mut self, is_kept: &[bool]) {
        self.keep_spokes(|_, triangle| is_kept[triangle as usize]);
    }

    /// Leaves out of the anchor's fan what lies inside of a solid on whose border it stands.
    fn leave_solids(&mut self, model: &Model) {
        let Some((sectors, solid)) = model.border() else { return };
        let anchor = self.pivots[self.anchor.index()];
        let fan: Vec<u32> = self.fan(anchor).to_vec();
        // A triangle lies to the left of the half-edge that starts at the anchor.
        let is_solid = |&&spoke: &&u32| match sectors.find(self.at(self.edge(next(spoke)).origin)) {
            Ok(sector) | Err(sector) => solid[sector],
        };
        let left_out: Vec<u32> = fan.iter().filter(is_solid).map(|spoke| spoke / 4).collect();
        self.keep_spokes(|vertex, triangle| vertex != anchor || !left_out.contains(&triangle));
    }

    /// Leaves half-edges out of all fans but those of which `is_kept` holds: it is given the vertex at which a
    /// half-edge starts, and its triangle.
    fn keep_spokes(&mut self, is_kept: impl Fn(MeshVertex, u32) -> bool) {
        let (mut kept, mut first) = (0, 0);
        for v in 0..self.vertices.len() {
            let end = self.first_fan[v + 1] as usize;
            self.first_fan[v] = kept as u32;
            for i in first..end {
                self.fans[kept] = self.fans[i];
                kept += usize::from(is_kept(MeshVertex(v as u32), self.fans[i] / 4));
            }
            first = end;
        }
        self.first_fan[self.vertices.len()] = kept as u32;
        self.fans.truncate(kept);
    }

    /// Makes a vertex one that is none of the model's, as far as looks tell.
    pub(super) fn forget_name(&mut self, vertex: MeshVertex) {
        self.names[vertex.index()] = NAMELESS;
    }

    #[inline]
    pub(super) fn at(&self, vertex: MeshVertex) -> DVec2 {
        self.vertices[vertex.index()]
    }

    /// The vertex of a pivot; `None` if it is not in the mesh.
    pub(super) fn vertex(&self, pivot: Pivot) -> Option<MeshVertex> {
        Some(self.pivots[pivot.index()]).filter(|&v| v != MeshVertex::ABSENT)
    }

    /// The anchor, which is in the mesh.
    pub(super) fn anchor(&self) -> Pivot {
        self.anchor
    }

    /// The walls in the mesh.
    pub(super) fn walls(&self) -> &[[MeshVertex; 2]] {
        &self.walls
    }

    /// The ends of the walls along which one can see, or walk, from one side to the other somewhere: they cross others
    /// at points that no f64 names, or there were too many walls on each other.
    pub(super) fn loose(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.loose.iter().map(|&wall| self.walls[wall as usize].map(|v| self.at(v)))
    }

    /// The model's number of a vertex; `None` if it is none of the model's.
    #[inline]
    pub(super) fn name(&self, vertex: MeshVertex) -> Option<u32> {
        Some(self.names[vertex.index()]).filter(|&name| name != NAMELESS)
    }

    /// All vertices.
    pub(super) fn vertices(&self) -> impl Iterator<Item = MeshVertex> + use<> {
        (0..self.len() as u32).map(MeshVertex)
    }

    /// How many vertices it has.
    pub(super) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// How many triangles it has.
    pub(super) fn triangles(&self) -> usize {
        self.triangles.len()
    }

    #[inline]
    pub(super) fn edge(&self, edge: u32) -> HalfEdge {
        self.triangles[edge as usize / 4].0[edge as usize % 4]
    }

    /// The next and the last half-edge of the triangle of `edge`.
    #[inline]
    pub(super) fn beyond(&self, edge: u32) -> [HalfEdge; 2] {
        let Triangle(edges) = &self.triangles[edge as usize / 4];
        [edges[next(edge) as usize % 4], edges[next(next(edge)) as usize % 4]]
    }

    /// The half-edges that start at `vertex`, one in each triangle round it in which looks start.
    pub(super) fn fan(&self, vertex: MeshVertex) -> &[u32] {
        &self.fans[self.first_fan[vertex.index()] as usize..self.first_fan[vertex.index() + 1] as usize]
    }
}

/// The next half-edge of the same triangle.
#[inline]
pub(super) fn next(edge: u32) -> u32 {
    if edge % 4 == 2 { edge - 2 } else { edge + 1 }
}

/// The numbers of `points` in the order in which Morton's curve through the box of `bounds` passes them (Morton, "A
/// computer oriented geodetic data base", 1966).
fn along_curve(points: &[DVec2], (low, high): (DVec2, DVec2)) -> Vec<u32> {
    let scale = f64::from(u16::MAX) / (high - low).max_element();
    let key = |p: &DVec2| {
        // What lies outside, or in a box of no size, becomes 0 or the largest number.
        let [x, y] = ((p - low) * scale).to_array().map(|c| spread(c as u16));
        x | y << 1
    };
    let mut keyed: Vec<u64> =
        points.iter().zip(0..).map(|(p, v): (_, u32)| u64::from(key(p)) << 32 | u64::from(v)).collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|keyed| keyed as u32).collect()
}

/// A zero between any two bits.
fn spread(bits: u16) -> u32 {
    [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)]
        .into_iter()
        .fold(u32::from(bits), |bits, (by, mask)| (bits | bits << by) & mask)
}

fn handle(vertex: MeshVertex) -> spade::handles::FixedVertexHandle {
    spade::handles::FixedVertexHandle::from_index(vertex.index())
}

/// The corners of a square far outside, so that every vertex has triangles all round it.
fn corners((low, high): (DVec2, DVec2)) -> [DVec2; 4] {
    let centre = low / 2.0 + high / 2.0;
    let mut half = (high - low).max_element();
    if half == 0.0 {
        half = centre.abs().max_element().max(1.0);
    }
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| centre + 2.0 * half * DVec2::from(c))
}

fn triangulate(vertices: &[DVec2]) -> Option<Cdt> {
    // The library takes magnitudes from 2^-142 to 2^201: scaled by a power of two, which is exact.
    let size = vertices.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let scale = 2f64.powi(-(size.log2().floor() as i32));
    let scaled = vertices.iter().map(|p| Point2::new(p.x * scale, p.y * scale)).collect();
    let cdt = Cdt::bulk_load_cdt(scaled, Vec::new()).ok()?;
    (cdt.num_vertices() == vertices.len()).then_some(cdt)
}
