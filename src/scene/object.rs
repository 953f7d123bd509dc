//! What a file draws as one thing: its name, its layers, and whether it is solid.

use glam::DVec2;

/// What a file draws as one thing: a feature, a shape, an entity; of several polygons in one feature each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Object {
    /// What the file calls it: a label that people read, not a number that a program made up.
    pub label: Option<String>,
    /// The layers or groups in which it lies, the outermost first.
    pub layers: Vec<String>,
    /// What of it is solid.
    pub inside: Inside,
}

/// Where an object is solid, told by its walls. A wall's own direction is that of its outline: from its first end to
/// its second, unless it is [reversed](Wall::reversed).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Inside {
    /// Nowhere: its walls are thin and free on both sides.
    #[default]
    Free,
    /// Where a ray to far away crosses its walls an odd number of times: polygons with holes.
    EvenOdd,
    /// Round what its walls go a number of times that is not 0.
    NonZero,
    /// On the right of each of its walls: where outlines are not closed, as at the edge of a map of cells.
    Right,
}

/// The member of a GeoJSON feature that holds what GeoJSON has no place for.
pub(crate) const MEMBER: &str = "tautline";

impl Inside {
    /// How files of our own name it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Inside::Free => "free",
            Inside::EvenOdd => "even-odd",
            Inside::NonZero => "nonzero",
            Inside::Right => "right",
        }
    }

    /// What files of our own name so.
    pub(crate) fn named(name: &str) -> Option<Self> {
        [Inside::Free, Inside::EvenOdd, Inside::NonZero, Inside::Right].into_iter().find(|inside| inside.name() == name)
    }
}

/// A wall as readers find it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// Its ends.
    pub ends: [DVec2; 2],
    /// The number of its object.
    pub object: u32,
    /// Whether its outline goes from its second end to its first.
    pub reversed: bool,
}
