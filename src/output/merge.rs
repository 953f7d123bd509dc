//! Puts files of results together, in the order of their traces.

use std::fs::File;
use std::path::{Path, PathBuf};

use arrow_array::cast::AsArray;
use arrow_array::types::UInt64Type;
use arrow_array::{Array, RecordBatch};
use arrow_select::coalesce::BatchCoalescer;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};

use super::columns::ResultColumns;
use super::labels::Labels;
use super::tables::Table;
use super::{WholeFile, WriteError};
use crate::caught::caught;
use crate::scene::Scene;
use crate::words::plainly;

/// How many rows of each file are held, and written, at a time.
const ROWS: usize = 1 << 13;

/// Writes the rows of the Parquet files at `from`, each as [`ResultWriter`](super::ResultWriter) writes it and in the
/// order of its traces, to one such file at `to`, in the order of all traces, all in `scene`; `notes` go into its
/// metadata. The same rows give the same bytes, however they are shared out. O(rows) in time for few files; in memory a
/// few thousand rows of those whose traces overlap. Of each file no more than so many of the first rows are taken as
/// are named with it. Where the study ended early, `rows` are the first of those in the files, and what lies behind
/// them `is_cut`.
///
/// # Errors
///
/// A file that cannot be read or whose columns are others, a trace that is there twice, fewer `rows` than are wanted
/// or, if nothing is cut, more; and those of [`check_output`](super::check_output).
pub fn merge_results(
    from: &[(PathBuf, u64)],
    to: &Path,
    scene: &Scene,
    notes: &[(&str, String)],
    rows: u64,
    is_cut: bool,
) -> Result<(), WriteError> {
    let columns = ResultColumns::new(&Labels::of(scene), false);
    let mut table = Table::new(to, WholeFile::create(to)?, columns)?;
    notes.iter().for_each(|(key, value)| table.note(key, value));
    // Files are opened when it is their turn, so that there may be more of them than can be open at a time.
    let mut waiting = Vec::new();
    for (path, most) in from {
        waiting.extend(Source::open(path, *most, &table, 1)?.map(|source| (source.next(), path, *most)));
    }
    waiting.sort_unstable_by(|a, b| b.cmp(a));
    let mut open: Vec<Source> = Vec::new();
    // Rows are written so many at a time, so that the bytes do not depend on where one file ends and the next begins.
    let mut chunks = BatchCoalescer::new(table.schema(), ROWS);
    let failed = |e| WriteError::io(to, std::io::Error::other(e));
    let mut written = 0;
    while !(is_cut && written == rows) {
        // The source whose next trace is the first, and how far it goes before it is another's turn.
        let first = (0..open.len()).min_by_key(|&i| open[i].next());
        if let Some(&(next, path, most)) = waiting.last()
            && first.is_none_or(|first| next <= open[first].next())
        {
            open.extend(Source::open(path, most, &table, ROWS)?);
            waiting.pop();
            continue;
        }
        let Some(first) = first else { break };
        let others = (0..open.len()).filter(|&i| i != first).map(|i| open[i].next());
        let others = others.chain(waiting.last().map(|w| w.0)).min();
        let source = &mut open[first];
        if others == Some(source.next()) {
            return Err(WriteError::source(&source.path, format!("trace {} is in another file too", source.next())));
        }
        let traces = &traces(&source.rows)[source.at..];
        let count = others.map_or(traces.len(), |next| traces.partition_point(|&trace| trace < next));
        let count = if is_cut { count.min((rows - written) as usize) } else { count };
        chunks.push_batch(source.rows.slice(source.at, count)).map_err(failed)?;
        while let Some(rows) = chunks.next_completed_batch() {
            table.write(&rows)?;
        }
        source.at += count;
        written += count as u64;
        if !source.refill()? {
            open.swap_remove(first);
        }
    }
    if written != rows {
        return Err(WriteError::source(
            to,
            format!("its parts have {} instead of {rows}", plainly(written, "row", "rows")),
        ));
    }
    chunks.finish_buffered_batch().map_err(failed)?;
    while let Some(rows) = chunks.next_completed_batch() {
        table.write(&rows)?;
    }
    table.complete()?.finish_durably()
}

/// A file under way.
struct Source {
    path: PathBuf,
    batches: ParquetRecordBatchReader,
    rows: RecordBatch,
    /// The first row that was not written yet.
    at: usize,
    /// How many rows behind these are to be taken.
    left: u64,
}

impl Source {
    /// `None` for a file without rows. `most` of them are taken, and so many read at a time.
    fn open(path: &Path, most: u64, like: &Table<ResultColumns>, rows: usize) -> Result<Option<Self>, WriteError> {
        let fault = |e: &dyn std::fmt::Display| WriteError::source(path, e);
        let file = File::open(path).map_err(|e| fault(&e))?;
        let open = || {
            let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|e| fault(&e))?;
            if !like.has_columns(builder.schema()) {
                return Err(fault(&"its columns are not those of results"));
            }
            builder.with_batch_size(rows).build().map_err(|e| fault(&e))
        };
        let batches = caught(open).unwrap_or_else(|panic| Err(fault(&panic)))?;
        let rows = RecordBatch::new_empty(like.schema());
        let mut source = Source { path: path.to_owned(), batches, rows, at: 0, left: most };
        Ok(source.refill()?.then_some(source))
    }

    /// The number of the next trace.
    fn next(&self) -> u64 {
        traces(&self.rows)[self.at]
    }

    /// Reads on if all that was read is written; whether there is more.
    fn refill(&mut self) -> Result<bool, WriteError> {
        while self.at == self.rows.num_rows() {
            let last = self.at.checked_sub(1).map(|last| traces(&self.rows)[last]);
            let fault = |e: &dyn std::fmt::Display| WriteError::source(&self.path, e);
            if self.left == 0 {
                return Ok(false);
            }
            match caught(|| self.batches.next()).map_err(|panic| fault(&panic))? {
                None => return Ok(false),
                Some(rows) => self.rows = rows.map_err(|e| fault(&e))?,
            }
            let count = self.left.min(self.rows.num_rows() as u64);
            self.rows = self.rows.slice(0, count as usize);
            (self.at, self.left) = (0, self.left - count);
            let sorted = last.iter().chain(traces(&self.rows)).is_sorted_by(|a, b| a < b);
            if !sorted || self.rows.column(0).null_count() > 0 {
                return Err(WriteError::source(&self.path, "its rows are not in the order of their traces"));
            }
        }
        Ok(true)
    }
}

/// The traces of rows, which are in the first column.
fn traces(rows: &RecordBatch) -> &[u64] {
    rows.column(0).as_primitive::<UInt64Type>().values()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{ResultWriter, write_results};
    use crate::rope::{Side, Status, TraceRecord};

    fn nothing() -> Scene {
        Scene::new([]).unwrap()
    }

    fn record(trace: u64) -> TraceRecord {
        let wraps = (0..trace % 4).map(|i| ([i as f64, 0.5].into(), Side::Left)).collect();
        TraceRecord {
            trace,
            status: Status::Ok,
            steps: trace,
            length: 0.1 * trace as f64,
            max_length: 1e9,
            depth: (trace % 4) as u32,
            max_depth: 4,
            wraps,
            pull: None,
            events: Vec::new(),
        }
    }

    fn written(path: &Path, traces: impl Iterator<Item = u64>) -> PathBuf {
        write_results(path, &nothing(), &traces.map(record).collect::<Vec<_>>()).unwrap();
        path.to_owned()
    }

    /// All rows of each.
    fn all_of<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Vec<(PathBuf, u64)> {
        paths.into_iter().map(|path| (path.clone(), u64::MAX)).collect()
    }

    fn rows(path: &Path) -> RecordBatch {
        let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
        let mut batches = builder.with_batch_size(1 << 30).build().unwrap();
        let rows = batches.next().unwrap().unwrap();
        assert!(batches.next().is_none());
        rows
    }

    #[test]
    fn parts_are_the_whole() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let whole = written(&at("whole.parquet"), 0..40_000);
        // By blocks of 500, three in turn; and one without rows.
        let block = |k: u64| move |trace: &u64| trace / 500 % 3 == k;
        let parts: Vec<PathBuf> =
            (0..3).map(|k| written(&at(&format!("{k}.parquet")), (0..40_000).filter(block(k)))).collect();
        let none = written(&at("none.parquet"), 0..0);
        let all = all_of([&parts[2], &none, &parts[0], &parts[1]]);
        merge_results(&all, &at("merged.parquet"), &nothing(), &[("a", "b".to_owned())], 40_000, false).unwrap();
        let short = merge_results(&all, &at("no.parquet"), &nothing(), &[], 40_001, true).unwrap_err().to_string();
        assert!(short.ends_with("its parts have 40000 rows instead of 40001"), "{short}");
        assert!(rows(&at("merged.parquet")) == rows(&whole));
        let notes = [("a", "b".to_owned())];
        merge_results(&all_of([&whole]), &at("again.parquet"), &nothing(), &notes, 40_000, false).unwrap();
        assert!(std::fs::read(at("merged.parquet")).unwrap() == std::fs::read(at("again.parquet")).unwrap());
        let first = written(&at("first.parquet"), 0..10_001);
        for (from, to) in [(&all, "cut.parquet"), (&all_of([&first]), "cut2.parquet")] {
            merge_results(from, &at(to), &nothing(), &[], 10_001, true).unwrap();
        }
        // Of the whole the first rows alone, though the next are in a part too.
        let some = [(whole.clone(), 500), (parts[1].clone(), 500)];
        merge_results(&some, &at("some.parquet"), &nothing(), &[], 1000, false).unwrap();
        assert!(rows(&at("some.parquet")) == rows(&whole).slice(0, 1000));
        assert!(std::fs::read(at("cut.parquet")).unwrap() == std::fs::read(at("cut2.parquet")).unwrap());
        let more = merge_results(&all, &at("no.parquet"), &nothing(), &[], 10_001, false).unwrap_err().to_string();
        assert!(more.ends_with("its parts have 40000 rows instead of 10001"), "{more}");
        let twice = merge_results(&all_of([&whole, &parts[1]]), &at("no.parquet"), &nothing(), &[], 0, false)
            .unwrap_err()
            .to_string();
        assert!(twice.ends_with("trace 500 is in another file too"), "{twice}");
        assert!(!at("no.parquet").exists());
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let fails = |path: &Path| {
            merge_results(&all_of([&path.to_owned()]), &at("no.parquet"), &nothing(), &[], 1, false)
                .unwrap_err()
                .to_string()
        };
        assert!(fails(&at("gone.parquet")).contains("gone.parquet: No such file"));
        std::fs::write(at("text.parquet"), "no table at all").unwrap();
        assert!(fails(&at("text.parquet")).starts_with(&format!("cannot read {}", at("text.parquet").display())));
        let mut writer = ResultWriter::create(&at("turned.parquet"), &nothing()).unwrap();
        writer.write_all(&nothing(), &[2, 1].map(record)).unwrap();
        writer.finish().unwrap();
        assert!(fails(&at("turned.parquet")).ends_with("its rows are not in the order of their traces"));
        crate::output::write_events(&at("events.parquet"), &nothing(), &[]).unwrap();
        assert!(fails(&at("events.parquet")).ends_with("its columns are not those of results"));
    }

    #[test]
    fn no_changed_byte_makes_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["from.parquet", "to.parquet"].map(|name| folder.path().join(name));
        let good = std::fs::read(written(&from, 0..9)).unwrap();
        let mut errors = 0;
        for i in 0..good.len() {
            for change in [0x01, 0x10, 0x80, 0xff] {
                let mut bad = good.clone();
                bad[i] ^= change;
                std::fs::write(&from, bad).unwrap();
                // One row more than there are: what is taken is not written out.
                let error = merge_results(&all_of([&from]), &to, &nothing(), &[], 10, false).unwrap_err().to_string();
                errors += usize::from(error.contains("from.parquet"));
            }
        }
        assert!(errors > good.len(), "{errors} of {}", 4 * good.len());
    }
}
