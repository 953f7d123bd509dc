//! Only what the scene requires: leaving out what no rope ever meets.

use glam::DVec2;

use super::Visibility;
use super::mesh::{CLOSED, MeshVertex, next};
use crate::geometry::{higher, lower, orient};

impl Visibility {
    /// Leaves out of all looks what no rope from the anchor meets while its free end keeps to the rules within reach:
    /// what lies on the other side of walls that cannot be passed, and vertices that remain on this side but not as
    /// places where a rope can turn, such as the inner corners of rooms.
    ///
    /// Just before the rope's last leg passes a contact it is free of walls, and it turns about the pivot. So it has
    /// swept the open half disk about the contact, however small, on the side from which it comes: no wall lies in it,
    /// and the free end has come that way. What is required is therefore each vertex with a sector between two walls
    /// that spans at least half a turn and can be reached from the anchor. Exactly half a turn is enough: contacts
    /// passed straight count.
    ///
    /// Walls that are not in the mesh, because they are out of reach or cross others at a point that no f64 names, make
    /// sectors wider and let more be reached: a vertex too many may be kept, never one too few. Where the reach is
    /// known, free ends go through edges of triangles within it only, and no contact lies outside. O(triangles).
    #[must_use]
    pub fn only_required(mut self) -> Self {
        let mut is_reached = vec![false; self.mesh.triangles()];
        let ends = |edge: u32| [edge, next(edge)].map(|edge| self.mesh.at(self.mesh.edge(edge).origin));
        for triangle in self.reached_through(self.mesh.anchor(), |edge| self.is_within_reach(ends(edge))) {
            is_reached[triangle as usize] = true;
        }
        self.mesh.start_only_in(&is_reached);
        for v in self.mesh.vertices() {
            let at = self.mesh.at(v);
            if !self.is_within_reach([at, at]) || !self.has_room(v) {
                self.mesh.forget_name(v);
            }
        }
        self
    }

    /// The model's vertices that looks can list, ascending: those that are not left out. O(n log n).
    pub fn listed(&self) -> Vec<u32> {
        let mut listed: Vec<u32> = self.mesh.vertices().filter_map(|v| self.mesh.name(v)).collect();
        listed.sort_unstable();
        listed
    }

    /// Whether the box around two points meets that of the reach.
    fn is_within_reach(&self, [a, b]: [DVec2; 2]) -> bool {
        let meets = |(low, high): (DVec2, DVec2)| lower(a, b).cmple(high).all() && higher(a, b).cmpge(low).all();
        self.reach.is_none_or(meets)
    }

    /// Whether a sector at vertex `v` of the mesh, whose fan holds the triangles that are reached and no others, spans
    /// at least half a turn.
    fn has_room(&self, v: MeshVertex) -> bool {
        let fan = self.mesh.fan(v);
        let begins_sector = |spoke: &&u32| self.mesh.edge(**spoke).twin == CLOSED;
        let is_wide = |&spoke: &u32| {
            let right = self.mesh.edge(next(spoke)).origin;
            let left = self.end_of_sector(spoke);
            // One wall alone leaves a whole turn, two that lie opposite each other half of one.
            orient(self.mesh.at(v), self.mesh.at(right), self.mesh.at(left)) <= 0.0
        };
        // Where no wall begins a sector, there is none.
        let mut sectors = fan.iter().filter(begins_sector).peekable();
        !fan.is_empty() && (sectors.peek().is_none() || sectors.any(is_wide))
    }

    /// The far end of the wall that ends the sector begun by `spoke`, which is a wall.
    fn end_of_sector(&self, mut spoke: u32) -> MeshVertex {
        loop {
            let last = self.mesh.edge(next(next(spoke)));
            if last.twin == CLOSED {
                return last.origin;
            }
            spoke = last.twin;
        }
    }
}
