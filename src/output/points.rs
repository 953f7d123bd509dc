//! Points of traces: one row each, as `eval --traces` takes them.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, UInt64Array};
use arrow_schema::{DataType, Field};
use glam::DVec2;
use parquet::file::properties::WriterPropertiesBuilder;

use super::rows::Rows;
use super::tables::Columns;
use super::{WholeFile, WriteError};
use crate::geometry::number;

/// How many rows are written at a time, and how many a row group has.
const ROWS: usize = 1 << 16;
const GROUP: usize = 1 << 20;

/// Writes the points of traces to a file that appears when it is finished: `.csv`, `.parquet` or `.jsonl` with the
/// columns `trace`, `x` and `y`, which read back to the same f64. Memory does not grow with the number of points.
pub struct PointWriter {
    rows: Rows<PointArrays>,
}

/// Points that are to be written, all of one trace.
#[derive(Default)]
struct PointArrays {
    trace: u64,
    points: Vec<DVec2>,
}

impl Columns for PointArrays {
    fn fields(&self) -> Vec<Field> {
        let fields = [("trace", DataType::UInt64), ("x", DataType::Float64), ("y", DataType::Float64)];
        fields.into_iter().map(|(name, of)| Field::new(name, of, false)).collect()
    }

    fn len(&self) -> usize {
        self.points.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let points = std::mem::take(&mut self.points);
        vec![
            Arc::new(UInt64Array::from(vec![self.trace; points.len()])),
            Arc::new(Float64Array::from_iter_values(points.iter().map(|p| p.x))),
            Arc::new(Float64Array::from_iter_values(points.iter().map(|p| p.y))),
        ]
    }

    fn properties(&self, builder: WriterPropertiesBuilder) -> WriterPropertiesBuilder {
        let builder = builder.set_max_row_group_row_count(Some(GROUP));
        ["x", "y"].into_iter().fold(builder, |builder, name| builder.set_column_dictionary_enabled(name.into(), false))
    }
}

impl PointWriter {
    /// Starts the file at `path`, in the format that its extension names.
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        Ok(PointWriter { rows: Rows::create(path, "trace,x,y", PointArrays::default())? })
    }

    /// Adds the points of the trace of that number.
    ///
    /// # Errors
    ///
    /// What the operating system says; the file cannot be finished after that.
    pub fn write(&mut self, trace: u64, points: &[DVec2]) -> Result<(), WriteError> {
        points.chunks(ROWS).try_for_each(|points| match &mut self.rows {
            Rows::Parquet(table) => table.write_columns(PointArrays { trace, points: points.to_vec() }),
            text => text.write_all(
                points,
                |text, p| writeln!(text, "{{\"trace\":{trace},\"x\":{},\"y\":{}}}", number(p.x), number(p.y)),
                |text, p| writeln!(text, "{trace},{},{}", number(p.x), number(p.y)),
                |_, _| Ok(()),
            ),
        })
    }

    /// Notes something about the points, where they come from say, in the metadata of a Parquet file; the other formats
    /// have no place for it.
    pub fn note(&mut self, key: &str, value: &str) {
        self.rows.note(key, value);
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    ///
    /// What the operating system says, or that an earlier write failed.
    pub fn finish(self) -> Result<(), WriteError> {
        self.complete()?.finish()
    }

    /// Writes the rest and returns the whole file, to be put in its place by [`WholeFile::finish`].
    ///
    /// # Errors
    ///
    /// What the operating system says, or that an earlier write failed.
    pub fn complete(self) -> Result<WholeFile, WriteError> {
        self.rows.complete()
    }
}
