//! A scene made ready to be evaluated: what never changes while traces come and go.

use std::collections::HashMap;
use std::ops::ControlFlow::{Break, Continue};
use std::sync::Arc;

use glam::DVec2;

use super::{Scene, Sectors, WallIndex, sectors};
use crate::geometry::{CoordinateFault, between, check_point, forwards, higher, lower, orient, same_side};

/// Why a rope cannot be tied where the anchor is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnchorError {
    /// The scene marks no anchor and none was given.
    #[error("no anchor")]
    Missing,
    /// Its coordinates cannot be computed with.
    #[error("the anchor: {0}")]
    Coordinate(#[from] CoordinateFault),
}

/// A scene, its anchor, and the index of its walls.
pub struct Model {
    walls: Arc<Walls>,
    anchor: DVec2,
    /// Where the anchor stands on walls: the sectors between them, and which are solid.
    border: Option<(Sectors, Vec<bool>)>,
}

/// What models with other anchors have in common.
struct Walls {
    scene: Scene,
    index: WallIndex,
    /// Vertex numbers by the bits of their coordinates.
    numbers: HashMap<[u64; 2], u32>,
}

impl Model {
    /// Ties a rope at `anchor`, or where the scene marks its anchor; builds the index in O(n log n).
    ///
    /// # Errors
    ///
    /// A missing anchor, and one that exact arithmetic cannot take.
    pub fn new(scene: Scene, anchor: Option<DVec2>) -> Result<Self, AnchorError> {
        let anchor = anchor.or(scene.anchor()).ok_or(AnchorError::Missing)?;
        let index = WallIndex::new(&scene);
        let numbers = scene.vertices().iter().zip(0..).map(|(p, v)| (p.to_array().map(f64::to_bits), v)).collect();
        Model { walls: Arc::new(Walls { scene, index, numbers }), anchor, border: None }.tied(anchor)
    }

    /// The same with the rope tied at `anchor`; scene and index are shared. O(log walls + walls near it), and the walls
    /// of the solids on whose border it stands.
    ///
    /// # Errors
    ///
    /// An anchor that exact arithmetic cannot take.
    pub fn tied(&self, anchor: DVec2) -> Result<Self, AnchorError> {
        let anchor = check_point(anchor)?;
        let border = self.is_on_wall(anchor).then(|| {
            let sectors = Sectors::new(self.scene(), self.index(), anchor);
            let solid = sectors.solid(self.scene(), self.index());
            (sectors, solid)
        });
        Ok(Model { walls: Arc::clone(&self.walls), anchor, border })
    }

    /// The walls and their ends.
    pub fn scene(&self) -> &Scene {
        &self.walls.scene
    }

    /// The fixed end `B` of every rope.
    pub fn anchor(&self) -> DVec2 {
        self.anchor
    }

    /// The walls by place.
    pub fn index(&self) -> &WallIndex {
        &self.walls.index
    }

    /// The vertices, that is [`Scene::vertices`].
    pub fn vertices(&self) -> &[DVec2] {
        self.scene().vertices()
    }

    /// Whether the segment from `a` to `b` touches no wall at all, its ends included: [`touched`](Self::touched) finds
    /// none.
    #[inline]
    pub fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        self.touched(a, b).is_none()
    }

    /// A wall that the segment from `a` to `b` touches, its ends included. A wall that ends at `a` is none in the way
    /// unless the segment runs along it, so that one can leave a wall's end; nor is one on which the anchor stands, if
    /// that is `a`, unless the segment leads into what is solid behind it. O(1) where no wall is near, else O(log
    /// walls + walls near it).
    pub fn touched(&self, a: DVec2, b: DVec2) -> Option<u32> {
        let is_tied = a == self.anchor && self.border.is_some();
        if is_tied && self.leads_into_solid(b) {
            return self.wall_at(a);
        }
        let touches = |u: DVec2, v: DVec2| {
            if is_tied && a != u && a != v && orient(u, v, a) == 0.0 && between(u, v, a) {
                return orient(u, v, b) == 0.0;
            }
            if let Some(end) = [(u, v), (v, u)].iter().find(|e| e.0 == a).map(|e| e.1) {
                return orient(a, end, b) == 0.0 && !forwards(end, a, b);
            }
            // All on one line: the boxes meet, so the segments do.
            !same_side(orient(u, v, a), orient(u, v, b)) && !same_side(orient(a, b, u), orient(a, b, v))
        };
        let visit = |wall, [u, v]: [DVec2; 2]| if touches(u, v) { Break(wall) } else { Continue(()) };
        self.index().visit(lower(a, b), higher(a, b), visit).break_value()
    }

    /// Whether `p` stands on a wall: at one of its ends or between them. O(log walls + walls near it).
    pub fn is_on_wall(&self, p: DVec2) -> bool {
        self.wall_at(p).is_some()
    }

    /// The first wall that ends at `p` or on which it stands.
    pub(crate) fn wall_at(&self, p: DVec2) -> Option<u32> {
        self.walls_at(p).map(|wall| wall as u32).min()
    }

    /// The walls that end at `p` or on which it stands, in any order.
    pub(crate) fn walls_at(&self, p: DVec2) -> impl Iterator<Item = usize> {
        sectors::walls_at(self.scene(), self.index(), p)
    }

    /// Which sectors between the walls on which the anchor stands are solid; `None` if it stands on none.
    pub(crate) fn border(&self) -> Option<(&Sectors, &[bool])> {
        self.border.as_ref().map(|(sectors, solid)| (sectors, solid.as_slice()))
    }

    /// Whether the way from the anchor towards `b`, which is not along a wall, leads into a solid on whose border it
    /// stands.
    fn leads_into_solid(&self, b: DVec2) -> bool {
        let Some((sectors, solid)) = &self.border else { return false };
        b != self.anchor && sectors.find(b).is_err_and(|sector| solid[sector])
    }

    /// The lowest and highest x and y of all vertices and the anchor.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let start = (self.anchor, self.anchor);
        self.vertices().iter().fold(start, |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// The vertex that stands exactly at `p`, if there is one.
    pub fn vertex_at(&self, p: DVec2) -> Option<u32> {
        // Adding zero turns a negative zero into the positive one that is in the map.
        self.walls.numbers.get(&(p + DVec2::ZERO).to_array().map(f64::to_bits)).copied()
    }
}
