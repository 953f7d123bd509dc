//! What comes out: results and events as files, each whole or not there at all.
//!
//! One row a trace ([`ResultWriter`]) or one row an event ([`EventWriter`]), in the format that the extension names:
//! `.jsonl`, `.csv` or `.parquet`. All formats hold the same values and give back the same f64. The bytes depend on the
//! records alone. [`result_batches`], [`event_batches`], [`step_batches`] and [`class_batches`] have the same rows in
//! memory.

mod batches;
mod class_columns;
mod columns;
mod events;
mod extras;
mod forces;
mod labels;
mod merge;
mod passing;
mod points;
mod results;
mod rows;
mod scene;
mod sheet;
mod step_arrays;
mod step_text;
mod steps;
mod tables;
mod target;
mod text;
mod whole_file;
mod write_error;

use std::io::Write;
use std::path::Path;

pub use batches::{class_batches, class_change_batches, event_batches, result_batches, step_batches};
pub use events::{EventWriter, write_events};
pub use extras::Extras;
pub use forces::ForceWriter;
pub use merge::merge_results;
pub use passing::{abandon, commit, remove_left_files};
pub use points::PointWriter;
pub use results::{ResultWriter, write_results};
pub use scene::{WrittenScene, write_scene};
pub use sheet::{Column, Sheet};
pub use steps::StepWriter;
pub use target::folder_of;
pub use whole_file::WholeFile;
pub use write_error::WriteError;

use crate::read_error::extension;

/// How many records are written at a time where all are there: enough for all cores.
const CHUNK: usize = 1024;

/// How rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Jsonl,
    Csv,
    Parquet,
}

impl Format {
    fn of(path: &Path) -> Result<Self, WriteError> {
        match extension(path).as_str() {
            "jsonl" => Ok(Format::Jsonl),
            "csv" => Ok(Format::Csv),
            "parquet" => Ok(Format::Parquet),
            _ => Err(WriteError::Extension { path: path.into() }),
        }
    }
}

/// Whether results or events can be written to `path`, to be asked before a long computation. Leaves nothing behind.
///
/// # Errors
///
/// An extension that names no format, and those of [`WholeFile::create`].
pub fn check_output(path: &Path) -> Result<(), WriteError> {
    check_place(path)?;
    Format::of(path)?;
    WholeFile::create(path).map(drop)
}

/// Whether a file could stand at `path`, whatever it holds: not in the place of a folder, a device, a pipe or an open
/// file such as `/dev/stdout`. O(1).
///
/// # Errors
///
/// What stands there.
pub fn check_place(path: &Path) -> Result<(), WriteError> {
    target::refuse_special(path)
}

/// Writes a file, whole or not at all.
///
/// # Errors
///
/// Those of [`WholeFile::create`], and a file that cannot be written.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.txt");
/// tautline::output::write_whole(&path, b"all of it")?;
/// assert_eq!(std::fs::read(&path)?, b"all of it");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes).map_err(|cause| WriteError::Io { path: path.to_owned(), cause })?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_is_checked_without_a_trace() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.jsonl", "a.CSV", "a.parquet"] {
            check_output(&folder.path().join(name)).unwrap();
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        for name in ["a.json", "a", "-"] {
            let e = check_output(Path::new(name)).unwrap_err().to_string();
            let rest =
                "the extension does not name a format; results and events are written as .jsonl, .csv or .parquet";
            assert_eq!(e, format!("{name}: {rest}"));
        }
        let e = check_output(Path::new("/nowhere/at/all.csv")).unwrap_err().to_string();
        assert_eq!(e, "cannot write /nowhere/at/all.csv: the folder /nowhere/at does not exist");
    }
}
