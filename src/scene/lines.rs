//! Line strings and polygons as walls, shared by the formats that have them.

use glam::DVec2;

use super::{Inside, Object, Scene, Wall};
use crate::geometry::{CoordinateFault, Shown};
use crate::read_error::{Fault, Place};

/// The objects and walls found so far.
#[derive(Default)]
pub(super) struct Lines {
    objects: Vec<Object>,
    walls: Vec<Wall>,
    /// The object to which walls are added, and whether its outline goes against them.
    current: (u32, bool),
}

impl Lines {
    /// Begins an object: walls that are pushed from now on are its own.
    pub(super) fn begin(&mut self, object: Object) {
        self.objects.push(object);
        self.current = (self.objects.len() as u32 - 1, false);
    }

    /// Goes on with the object that was begun as number `object`, whose outline goes against the walls to come if they
    /// are `reversed`.
    pub(super) fn resume(&mut self, object: u32, reversed: bool) {
        self.current = (object, reversed);
    }

    /// The number of the object that is under way.
    pub(super) fn object(&self) -> u32 {
        self.current.0
    }

    /// Adds the walls of one line string or ring: one for each pair of consecutive positions.
    ///
    /// # Errors
    ///
    /// A single position, and the first one that is an error itself, with its number.
    pub(super) fn push_line(
        &mut self,
        positions: impl ExactSizeIterator<Item = Result<DVec2, String>>,
        place: &Place,
    ) -> Result<(), Fault> {
        if positions.len() == 1 {
            return Err(Fault::new(place.clone(), "one position only; a line needs two or more"));
        }
        let (object, reversed) = self.current;
        let mut last = None;
        for (i, position) in positions.enumerate() {
            // Building the place for every position would take longer than reading the position.
            let p = position.map_err(|what| Fault::new(place.then("position", i), what))?;
            if let Some(last) = last {
                self.walls.push(Wall { ends: [last, p], object, reversed });
            }
            last = Some(p);
        }
        Ok(())
    }

    /// [`push_line`](Self::push_line) for a ring, which must end where it starts.
    pub(super) fn push_ring(
        &mut self,
        positions: impl ExactSizeIterator<Item = Result<DVec2, String>>,
        place: &Place,
    ) -> Result<(), Fault> {
        let from = self.walls.len();
        self.push_line(positions, place)?;
        let ends = |wall: &Wall| wall.ends;
        match (self.walls[from..].first().map(ends), self.walls.last().map(ends)) {
            (Some([first, _]), Some([_, last])) if first != last => {
                let what = format!("the ring is open: it starts at {} and ends at {}", Shown(first), Shown(last));
                Err(Fault::new(place.clone(), format!("{what}; the last position must repeat the first")))
            }
            _ => Ok(()),
        }
    }

    /// Begins an object that is solid within the rings to come, but for its holes.
    pub(super) fn begin_polygon(&mut self, object: &Object) {
        self.begin(Object { inside: Inside::EvenOdd, ..object.clone() });
    }

    pub(super) fn scene(self) -> Result<Scene, CoordinateFault> {
        Scene::of(self.objects, self.walls)
    }
}
