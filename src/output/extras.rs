//! What is told of each step beside the rope, where it is asked for.

use crate::rope::Friction;
use crate::scene::Centre;

/// What is told of each step beside the rope, where it is asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Extras {
    /// About what turns are counted; no two have the same name.
    pub centres: Vec<Centre>,
    /// What [`Strain`](crate::rope::Strain) says, for this friction.
    pub friction: Option<Friction>,
}

impl From<Vec<Centre>> for Extras {
    fn from(centres: Vec<Centre>) -> Self {
        Extras { centres, friction: None }
    }
}
