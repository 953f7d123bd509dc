//! Blocks as they are read, and which of their inserts are clipped.

use std::collections::{HashMap, HashSet};

use glam::DVec2;

use super::entity::Entity;
use crate::read_error::Fault;

/// A part of a drawing that is inserted by its name.
pub(super) struct Block<'a> {
    pub(super) base: DVec2,
    pub(super) entities: Vec<Entity<'a>>,
    /// The file in which it lies, if it is another one.
    pub(super) file: Option<&'a str>,
}

/// Which inserts are clipped: an insert names a dictionary, that one by `ACAD_FILTER` another one, and that one by
/// `SPATIAL` the clip. All these come after the entities.
#[derive(Default)]
pub(super) struct Clips<'a> {
    /// The dictionaries of what was inserted, and how often.
    inserted: HashMap<&'a str, usize>,
    /// By dictionary, what it names so.
    named: HashMap<&'a str, &'a str>,
    /// Clips that are switched on.
    on: HashSet<&'a str>,
}

impl<'a> Clips<'a> {
    /// Takes an insert.
    pub(super) fn inserted(&mut self, insert: &Entity<'a>) {
        let mut pairs = insert.groups.windows(2);
        if let Some([_, (360, dictionary)]) = pairs.find(|pair| pair[0] == (102, "{ACAD_XDICTIONARY")) {
            *self.inserted.entry(dictionary).or_default() += 1;
        }
    }

    /// Takes a dictionary or a clip.
    pub(super) fn object(&mut self, object: &Entity<'a>) -> Result<(), Fault> {
        let Some(handle) = object.text(5) else { return Ok(()) };
        match object.kind {
            "DICTIONARY" => {
                for pair in object.groups.windows(2) {
                    if let [(3, "ACAD_FILTER" | "SPATIAL"), (350 | 360, named)] = pair {
                        self.named.insert(handle, named);
                    }
                }
            }
            "SPATIAL_FILTER" if object.text(71).is_none_or(|on| on != "0") => _ = self.on.insert(handle),
            _ => {}
        }
        Ok(())
    }

    /// How many inserts are clipped.
    pub(super) fn count(&self) -> usize {
        let clipped = |dictionary: &&str| {
            let clip = self.named.get(*dictionary).and_then(|filters| self.named.get(filters));
            clip.is_some_and(|clip| self.on.contains(clip))
        };
        self.inserted.iter().filter(|(dictionary, _)| clipped(dictionary)).map(|(_, count)| count).sum()
    }
}
