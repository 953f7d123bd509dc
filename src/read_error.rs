//! Why a file cannot be read, and where in it the fault lies. Shared by scenes and traces.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::escape::{escaped, escaped_path};
use crate::geometry::CoordinateFault;

/// Where in a file: numbered parts from the outermost to the innermost, such as `feature 3, ring 0, position 12`.
///
/// Lines and columns count from 1 (columns in bytes), as editors do; everything else counts from 0. An empty place is
/// the file as a whole.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place(Vec<(&'static str, u64)>);

impl Place {
    /// The numbered parts, from the outermost to the innermost.
    pub fn parts(&self) -> &[(&'static str, u64)] {
        &self.0
    }

    /// Line `line`, counted from 1.
    pub(crate) fn line(line: u64) -> Self {
        Place(vec![("line", line)])
    }

    /// Row `row`, counted from 0.
    pub(crate) fn row(row: u64) -> Self {
        Place(vec![("row", row)])
    }

    /// Part `number` of this place.
    #[must_use]
    pub(crate) fn then(&self, part: &'static str, number: impl TryInto<u64>) -> Self {
        let mut parts = self.0.clone();
        parts.push((part, number.try_into().unwrap_or(u64::MAX)));
        Place(parts)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (part, number)) in self.0.iter().enumerate() {
            write!(f, "{}{part} {number}", if i == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}

/// Why a scene or a file of traces cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refuses.
    #[error("cannot read {}: {cause}", escaped_path(path))]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: std::io::Error,
    },
    /// The extension names no format that is read here.
    #[error(
        "{}: the extension does not name a format; {what} are read from {}",
        escaped_path(path),
        extensions.join(", ")
    )]
    Extension {
        /// Which file.
        path: PathBuf,
        /// `scenes` or `traces`.
        what: &'static str,
        /// The extensions that are read, each with its dot.
        extensions: Vec<&'static str>,
    },
    /// The file holds something that it may not hold.
    #[error("{}: {place}{}{}", escaped_path(path), if place.parts().is_empty() { "" } else { ": " }, escaped(fault))]
    Content {
        /// Which file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong there and what would be right.
        fault: String,
    },
}

impl ReadError {
    pub(crate) fn io(path: &Path, cause: std::io::Error) -> Self {
        ReadError::Io { path: path.into(), cause }
    }
}

/// What is wrong in a file whose name is known elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub(crate) place: Place,
    pub(crate) what: String,
}

impl Fault {
    pub(crate) fn new(place: Place, what: impl Into<String>) -> Self {
        Fault { place, what: what.into() }
    }

    pub(crate) fn in_file(self, path: &Path) -> ReadError {
        ReadError::Content { path: path.into(), place: self.place, fault: self.what }
    }
}

/// A fault of the file as a whole.
impl From<CoordinateFault> for Fault {
    fn from(fault: CoordinateFault) -> Self {
        Fault::new(Place::default(), fault.to_string())
    }
}

/// The extension of `path` in lower case, without its dot; empty if there is none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_file_place_and_fault() {
        let place = Place::default().then("feature", 3).then("ring", 0usize).then("position", 12);
        let fault = Fault::new(place, CoordinateFault::NotFinite(f64::NAN).to_string());
        let shown = fault.in_file(Path::new("aegean.geojson")).to_string();
        assert_eq!(shown, "aegean.geojson: feature 3, ring 0, position 12: NaN is not a finite number");
        let whole = Fault::from(CoordinateFault::NotFinite(f64::INFINITY)).in_file(Path::new("a.map"));
        assert_eq!(whole.to_string(), "a.map: inf is not a finite number");
    }

    #[test]
    fn extensions_are_read_in_either_case() {
        assert_eq!(extension(Path::new("a/b.GeoJSON")), "geojson");
        assert_eq!(extension(Path::new("a.d/b")), "");
    }
}
