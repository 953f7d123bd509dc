//! What the rope's last leg turns about.

use glam::DVec2;

use super::Model;

/// A vertex or the anchor, as what the rope's last leg turns about. Numbered by vertex; the anchor comes after all of
/// them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Pivot(u32);

impl Pivot {
    /// The vertex of this number.
    #[inline]
    pub fn at_vertex(vertex: u32) -> Pivot {
        Pivot(vertex)
    }

    /// Its index among all pivots of its model.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Model {
    /// The pivot of a rope whose last contact is `vertex`; the anchor if it has none.
    #[inline]
    pub fn pivot(&self, vertex: Option<u32>) -> Pivot {
        Pivot(vertex.unwrap_or(self.vertices().len() as u32))
    }

    /// All pivots: the vertices, then the anchor.
    pub fn pivots(&self) -> impl Iterator<Item = Pivot> {
        (0..=self.vertices().len() as u32).map(Pivot)
    }

    /// Where a pivot stands.
    #[inline]
    pub fn position(&self, pivot: Pivot) -> DVec2 {
        self.vertices().get(pivot.index()).copied().unwrap_or(self.anchor())
    }
}
