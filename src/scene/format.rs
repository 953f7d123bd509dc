//! What there is to know of a format of scene files.

use std::path::Path;

use super::{Scene, SceneOptions};
use crate::read_error::ReadError;

/// A format in which scenes are read.
pub struct SceneFormat {
    pub(super) extensions: &'static [&'static str],
    pub(super) files: &'static str,
    pub(super) anchor: &'static str,
    pub(super) read: fn(&Path, &SceneOptions) -> Result<Scene, ReadError>,
}

impl SceneFormat {
    /// The extensions of its files, each with its dot and in lower case.
    pub fn extensions(&self) -> &'static [&'static str] {
        self.extensions
    }

    /// What its files are called in a list of all formats: `.wkt`, `a MovingAI .map`.
    pub fn files(&self) -> &'static str {
        self.files
    }

    /// What someone has to do with a file so that it marks the anchor: `put one POINT into the file`; empty if no file
    /// of this format can.
    pub fn anchor(&self) -> &'static str {
        self.anchor
    }
}

/// Names of which one is to be chosen, as they stand in a sentence.
///
/// ```
/// assert_eq!(tautline::scene::alternatives(&[".geojson", ".json", ".wkt"]), ".geojson, .json or .wkt");
/// ```
pub fn alternatives(names: &[&str]) -> String {
    match names {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => names.concat(),
    }
}
