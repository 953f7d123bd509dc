//! What the wall ends of a scene are called.

use std::collections::HashMap;
use std::io::{self, Write};

use glam::DVec2;

use crate::scene::Scene;

/// The labels of a scene's wall ends, by their numbers and by their places. Without any, rows have no room for labels.
pub(super) struct Labels {
    labels: Vec<Option<String>>,
    places: HashMap<[u64; 2], u32>,
}

impl Labels {
    /// O(walls).
    pub(super) fn of(scene: &Scene) -> Self {
        let labels: Vec<Option<String>> = scene.labels().into_iter().map(|label| label.map(str::to_owned)).collect();
        let labelled = scene.vertices().iter().zip(0..).take(labels.len());
        let places = labelled.map(|(p, v)| (p.to_array().map(f64::to_bits), v)).collect();
        Labels { labels, places }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// The label of a wall end.
    pub(super) fn get(&self, vertex: u32) -> Option<&str> {
        self.labels.get(vertex as usize)?.as_deref()
    }

    /// The label of the wall end that stands there.
    pub(super) fn at(&self, place: DVec2) -> Option<&str> {
        self.get(*self.places.get(&place.to_array().map(f64::to_bits))?)
    }
}

/// A field of CSV, in quotes where it needs them.
pub(super) fn field(out: &mut impl Write, text: &str) -> io::Result<()> {
    if text.contains(['"', ',', '\n', '\r']) {
        return write!(out, "\"{}\"", text.replace('"', "\"\""));
    }
    out.write_all(text.as_bytes())
}
