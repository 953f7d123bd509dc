//! The two ends of a rope.

/// An end of a rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum End {
    /// The end that is dragged, `A`.
    Free,
    /// The other one, `B`, from which ropes are looked along; it is tied, or moves too.
    Anchor,
}

impl End {
    /// `free` or `anchor`, as the event log names it.
    pub fn name(self) -> &'static str {
        match self {
            End::Free => "free",
            End::Anchor => "anchor",
        }
    }

    /// The other end.
    #[must_use]
    pub fn other(self) -> End {
        match self {
            End::Free => End::Anchor,
            End::Anchor => End::Free,
        }
    }
}
