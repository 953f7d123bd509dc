//! Reads traces from a file, in the format that its extension names.

use std::fs::File;
use std::path::Path;

use glam::DVec2;

use super::{Trace, csv_file, parquet_file};
use crate::geometry::check_point;
use crate::read_error::{ReadError, extension};

/// Reads the traces in `path`: columns `trace` (a whole number from 0), `x` and `y`, as `.csv` or `.parquet`.
///
/// Columns may stand in any order and among others. The rows of one trace follow each other, and the numbers of traces
/// increase; they may leave gaps. A file without rows has no traces.
///
/// # Errors
///
/// A file that cannot be opened, an extension of another format, and contents that are not traces, with their line
/// (from 1) or row (from 0).
pub fn read_traces(path: &Path) -> Result<Vec<Trace>, ReadError> {
    let parse = match extension(path).as_str() {
        "csv" => csv_file::parse,
        "parquet" => parquet_file::parse,
        _ => {
            let extensions = &[".csv", ".parquet"];
            return Err(ReadError::Extension { path: path.into(), what: "traces", extensions });
        }
    };
    let file = File::open(path).map_err(|cause| ReadError::io(path, cause))?;
    // A folder opens like a file and fails later, where a decoder would take it for damage.
    if path.is_dir() {
        return Err(ReadError::io(path, std::io::ErrorKind::IsADirectory.into()));
    }
    parse(file, path)
}

/// Gathers rows into traces.
#[derive(Default)]
pub(super) struct Gatherer {
    traces: Vec<Trace>,
}

impl Gatherer {
    /// Adds the point of the next row.
    pub(super) fn push(&mut self, id: u64, x: f64, y: f64) -> Result<(), String> {
        let point = check_point(DVec2::new(x, y)).map_err(|fault| {
            // The fault tells the number; which of the two columns holds it must be said here.
            let column = if check_point(DVec2::new(x, 0.0)).is_err() { "x" } else { "y" };
            format!("column {column}: {fault}")
        })?;
        let capacity = match self.traces.last_mut() {
            Some(last) if last.id == id => {
                last.points.push(point);
                return Ok(());
            }
            Some(last) if last.id > id => {
                let rule = "the rows of one trace must follow each other, and the numbers increase";
                return Err(format!("trace {id} after trace {}; {rule}", last.id));
            }
            // Traces of one file tend to be equally long.
            Some(last) => last.points.len(),
            None => 0,
        };
        let mut points = Vec::with_capacity(capacity);
        points.push(point);
        self.traces.push(Trace { id, points });
        Ok(())
    }

    pub(super) fn finish(self) -> Vec<Trace> {
        self.traces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_gathered_by_number() {
        let mut gatherer = Gatherer::default();
        for (id, x) in [(0, 1.0), (0, -0.0), (7, 3.0)] {
            gatherer.push(id, x, 0.5).unwrap();
        }
        let e = gatherer.push(0, 1.0, 1.0).unwrap_err();
        assert_eq!(e, "trace 0 after trace 7; the rows of one trace must follow each other, and the numbers increase");
        assert_eq!(gatherer.push(7, 1.0, f64::NAN).unwrap_err(), "column y: NaN is not a finite number");
        assert_eq!(gatherer.push(7, f64::NAN, 1.0).unwrap_err(), "column x: NaN is not a finite number");
        let traces = gatherer.finish();
        assert_eq!(traces.iter().map(|t| (t.id, t.points.len())).collect::<Vec<_>>(), [(0, 2), (7, 1)]);
        assert_eq!(traces[0].points[1].x.to_bits(), 0);
    }

    #[test]
    fn other_extensions_are_told_what_is_read() {
        let e = read_traces(Path::new("t.txt")).unwrap_err().to_string();
        assert_eq!(e, "t.txt: the extension does not name a format; traces are read from .csv, .parquet");
        let e = read_traces(Path::new("/nowhere/t.csv")).unwrap_err().to_string();
        assert_eq!(e, "cannot read /nowhere/t.csv: No such file or directory (os error 2)");
        let folder = tempfile::Builder::new().suffix(".parquet").tempdir().unwrap();
        let e = read_traces(folder.path()).unwrap_err().to_string();
        assert_eq!(e, format!("cannot read {}: is a directory", folder.path().display()));
    }
}
