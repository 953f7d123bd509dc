//! Reads traces from a file, in the format that its extension names: in batches as they come, or all at once.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::csv_file::CsvRows;
use super::gather::Gatherer;
use super::parquet_file::ParquetRows;
use super::{EndsTrace, Trace};
use crate::read_error::{Fault, Place, ReadError, extension};
use crate::read_file::{open, special};

/// Reads the traces in `path`: columns `trace` (a whole number from 0), `x` and `y`, as `.csv` or `.parquet`.
///
/// Columns may stand in any order and among others. The rows of one trace follow each other, and the numbers of traces
/// increase; they may leave gaps. Where there is a column `step` of whole numbers from 0, these increase within each
/// trace. A file without rows has no traces. In Parquet, whole numbers may have any width, and coordinates may be
/// floats or whole numbers: each is taken exactly. Columns `bx` and `by` together say where the anchor is; such traces
/// are refused here, see [`TraceReader::next_ends`]. A pipe is read too, as CSV; devices are not.
///
/// # Errors
///
/// A file that cannot be opened, an extension of another format, and contents that are not traces, with their line
/// (from 1) or row (from 0).
pub fn read_traces(path: &Path) -> Result<Vec<Trace>, ReadError> {
    let mut reader = TraceReader::open(path)?;
    Ok(reader.next_batch(usize::MAX, usize::MAX)?.unwrap_or_default())
}

/// Reads a file of traces batch by batch, so that it need not fit into memory. What files hold is said at
/// [`read_traces`].
///
/// ```no_run
/// use tautline::trace::TraceReader;
/// let mut reader = TraceReader::open("drags.parquet".as_ref())?;
/// while let Some(traces) = reader.next_batch(1000, 1_000_000)? {
///     println!("{} traces", traces.len());
/// }
/// # Ok::<(), tautline::ReadError>(())
/// ```
pub struct TraceReader {
    path: PathBuf,
    rows: Rows,
    gatherer: Gatherer,
    ended: bool,
}

/// A file of rows, by its format.
enum Rows {
    Csv(Box<CsvRows<File>>),
    Parquet(ParquetRows),
}

impl TraceReader {
    /// Opens the file at `path`. Parquet is read as far as its schema, CSV not at all.
    ///
    /// # Errors
    ///
    /// A file that cannot be opened, an extension of another format, and columns that do not fit.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let mut format = extension(path);
        if format.is_empty() && is_pipe(path) {
            format = "csv".into();
        }
        if !["csv", "parquet"].contains(&format.as_str()) {
            let extensions = vec![".csv", ".parquet"];
            return Err(ReadError::Extension { path: path.into(), what: "traces", extensions });
        }
        let file = open(path, format == "csv")?;
        let rows = if format == "csv" {
            let size = file.metadata().map_or(0, |m| m.len());
            Rows::Csv(Box::new(CsvRows::new(file, size, path)))
        } else {
            Rows::Parquet(ParquetRows::open(file).map_err(|fault| fault.in_file(path))?)
        };
        Ok(TraceReader { path: path.into(), rows, gatherer: Gatherer::default(), ended: false })
    }

    /// The next whole traces, at least one: at most `traces`, with at most `points` points together unless the first
    /// has more by itself. `None` when there are no more, and after an error.
    ///
    /// Memory is bounded by the batch, its longest trace and some megabytes.
    ///
    /// # Errors
    ///
    /// Contents that are not traces, with their line or row, and what the operating system says.
    pub fn next_batch(&mut self, traces: usize, points: usize) -> Result<Option<Vec<Trace>>, ReadError> {
        self.fill(traces, points)?;
        if self.moves_anchor()? {
            self.ended = true;
            self.gatherer = Gatherer::default();
            let what = "it has columns bx and by, so the rope's anchor moves, and only eval and draw take such traces, \
                        as --traces; leave these columns out for a rope that is tied, or for the way of anchors";
            return Err(Fault::new(Place::default(), what).in_file(&self.path));
        }
        Ok(self.gatherer.take(traces, points, self.ended))
    }

    /// Whether the rows say where the anchor is, in columns `bx` and `by`: then [`next_ends`](Self::next_ends) reads
    /// them. Looks as far as the header.
    ///
    /// # Errors
    ///
    /// What the operating system says.
    pub fn moves_anchor(&mut self) -> Result<bool, ReadError> {
        match &mut self.rows {
            Rows::Csv(rows) => rows.moves_anchor(),
            Rows::Parquet(rows) => Ok(rows.moves_anchor()),
        }
    }

    /// The same as [`next_batch`](Self::next_batch) where the anchor moves: each trace with the points of its anchor,
    /// as many as it has itself. `None` where the rows do not say where the anchor is.
    ///
    /// # Errors
    ///
    /// Those of [`next_batch`](Self::next_batch).
    pub fn next_ends(&mut self, traces: usize, points: usize) -> Result<Option<Vec<EndsTrace>>, ReadError> {
        self.fill(traces, points)?;
        Ok(self.gatherer.take_both(traces, points, self.ended))
    }

    /// Reads until a batch is full.
    fn fill(&mut self, traces: usize, points: usize) -> Result<(), ReadError> {
        while !self.ended && !self.gatherer.is_full(traces, points) {
            self.read()?;
        }
        Ok(())
    }

    /// Reads the next rows.
    fn read(&mut self) -> Result<(), ReadError> {
        let more = match &mut self.rows {
            Rows::Csv(rows) => rows.read(&mut self.gatherer),
            Rows::Parquet(rows) => rows.read(&mut self.gatherer).map_err(|fault| fault.in_file(&self.path)),
        };
        if more.is_err() {
            self.gatherer = Gatherer::default();
        }
        self.ended = !matches!(more, Ok(true));
        more.map(drop)
    }

    /// How large the file is: rows for Parquet, bytes for CSV (0 for a pipe).
    pub fn size(&self) -> u64 {
        match &self.rows {
            Rows::Csv(rows) => rows.size(),
            Rows::Parquet(rows) => rows.size(),
        }
    }

    /// How much of the [size](Self::size) has been read.
    pub fn position(&self) -> u64 {
        match &self.rows {
            Rows::Csv(rows) => rows.position(),
            Rows::Parquet(rows) => rows.position(),
        }
    }
}

/// Whether a shell's `<(...)` or a named pipe stands at `path`.
fn is_pipe(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|metadata| special(&metadata) == Some("a pipe"))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt64Array};
    use parquet::arrow::ArrowWriter;

    use super::*;

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

    /// 100,000 traces of 1 to 9 points, as CSV (with a quote in the middle of it, if asked for) and as Parquet.
    fn traces(folder: &Path, quoted: bool) -> [PathBuf; 2] {
        let ids: Vec<u64> = (0..100_000).flat_map(|id| std::iter::repeat_n(2 * id, 1 + id as usize % 9)).collect();
        let mut text = "trace,x,y\n".to_owned();
        for (row, id) in ids.iter().enumerate() {
            let quote = if quoted && row == ids.len() / 2 { "\"" } else { "" };
            text += &format!("{quote}{id}{quote},0.5,1\n");
        }
        let paths = ["t.csv", "t.parquet"].map(|name| folder.join(name));
        std::fs::write(&paths[0], text).unwrap();
        let rows = ids.len();
        let columns: [(&str, ArrayRef); 3] = [
            ("trace", Arc::new(UInt64Array::from(ids))),
            ("x", Arc::new(Float64Array::from(vec![0.5; rows]))),
            ("y", Arc::new(Float64Array::from(vec![1.0; rows]))),
        ];
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let mut writer = ArrowWriter::try_new(File::create(&paths[1]).unwrap(), batch.schema(), None).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        paths
    }

    #[test]
    fn traces_stream_through_and_are_not_held() {
        let folder = tempfile::tempdir().unwrap();
        for quoted in [false, true] {
            for path in traces(folder.path(), quoted) {
                let mut reader = TraceReader::open(&path).unwrap();
                if let Rows::Csv(rows) = reader.rows {
                    reader.rows = Rows::Csv(Box::new(rows.in_blocks(1 << 16)));
                }
                let (mut next, mut batches) = (0, 0);
                while let Some(batch) = reader.next_batch(1000, 3000).unwrap() {
                    for trace in &batch {
                        assert_eq!((trace.id, trace.points.len() as u64), (2 * next, 1 + next % 9));
                        next += 1;
                    }
                    batches += 1;
                    assert!(batch.len() <= 1000 && batch.iter().map(|t| t.points.len()).sum::<usize>() <= 3000);
                    // No more than is read at a time: 2^16 rows of Parquet, fewer of CSV.
                    assert!(reader.gatherer.held() <= 3000 + (1 << 16), "{}", reader.gatherer.held());
                }
                assert_eq!((next, reader.position()), (100_000, reader.size()));
                assert!(batches > 150 && reader.next_batch(1, 1).unwrap().is_none());
                assert_eq!(read_traces(&path).unwrap().len(), 100_000);
            }
        }
    }

    #[test]
    fn what_comes_before_a_fault_is_read_and_nothing_after() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "trace,x,y\n0,0,0\n1,0,0\n2,0,0\n2,0,0\n1,0,0\n3,0,0\n").unwrap();
        let mut reader = TraceReader::open(&path).unwrap();
        if let Rows::Csv(rows) = reader.rows {
            reader.rows = Rows::Csv(Box::new(rows.in_blocks(1)));
        }
        assert_eq!(reader.next_batch(1, 9).unwrap().unwrap()[0].id, 0);
        assert_eq!(reader.next_batch(1, 9).unwrap().unwrap()[0].id, 1);
        let e = reader.next_batch(1, 9).unwrap_err().to_string();
        assert!(e.contains("line 6: trace 1 after trace 2"), "{e}");
        assert!(reader.next_batch(1, 9).unwrap().is_none());
    }
}
