//! Steps as the columns of a Parquet file.

use std::mem::take;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, UInt32Array, UInt64Array};
use arrow_schema::{DataType, Field};
use parquet::basic::Encoding;
use parquet::file::properties::WriterPropertiesBuilder;

use super::Extras;
use super::step_text::{STRAIN, strain, winding};
use super::tables::Columns;
use crate::rope::StepColumns;

/// How many rows a row group has: few groups, since the footer, which is held until the end, grows with them.
const GROUP: usize = 1 << 20;

/// Steps that are to be written, and what windings are about.
pub(super) struct StepArrays {
    columns: StepColumns,
    windings: Vec<String>,
    /// Whether the anchor moves.
    both_move: bool,
    /// Whether there is friction.
    strained: bool,
}

impl StepArrays {
    pub(super) fn new(extras: &Extras, both_move: bool) -> Self {
        StepArrays::of(StepColumns::new(extras.centres.len()), extras, both_move)
    }

    pub(super) fn of(columns: StepColumns, extras: &Extras, both_move: bool) -> Self {
        let windings = extras.centres.iter().map(winding).collect();
        StepArrays { columns, windings, both_move, strained: extras.friction.is_some() }
    }
}

impl Columns for StepArrays {
    fn fields(&self) -> Vec<Field> {
        let places = ["x", "y", "bx", "by"].into_iter().take(if self.both_move { 4 } else { 2 });
        let numbers = [("trace", DataType::UInt64, false), ("step", DataType::UInt64, false)];
        let fields = [
            ("length", DataType::Float64, false),
            ("contacts", DataType::UInt32, false),
            ("turns", DataType::UInt32, false),
            ("pull_x", DataType::Float64, true),
            ("pull_y", DataType::Float64, true),
        ];
        let places = places.map(|name| (name, DataType::Float64, false));
        let strain = STRAIN.iter().filter(|_| self.strained);
        let strain = strain.map(|name| (*name, DataType::Float64, name.starts_with("anchor_pull")));
        let fields = numbers.into_iter().chain(places).chain(fields).chain(strain);
        let fields = fields.map(|(name, of, nullable)| Field::new(name, of, nullable));
        fields.chain(self.windings.iter().map(|name| Field::new(name, DataType::Int64, false))).collect()
    }

    fn len(&self) -> usize {
        self.columns.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let c = take(&mut self.columns);
        self.columns = StepColumns::new(self.windings.len());
        // Without a single rope of no length there is nothing to say of nulls.
        let pulls = (!c.pulls.iter().all(|&pulls| pulls)).then(|| c.pulls.into());
        let mut columns: Vec<ArrayRef> =
            vec![Arc::new(UInt64Array::from(c.trace)), Arc::new(UInt64Array::from(c.step))];
        let places = [c.x, c.y, c.bx, c.by].into_iter().take(if self.both_move { 4 } else { 2 });
        columns.extend(places.map(|column| Arc::new(Float64Array::from(column)) as ArrayRef));
        let rest: [ArrayRef; 5] = [
            Arc::new(Float64Array::from(c.length)),
            Arc::new(UInt32Array::from(c.contacts)),
            Arc::new(UInt32Array::from(c.turns)),
            Arc::new(Float64Array::new(c.pull_x.into(), pulls.clone())),
            Arc::new(Float64Array::new(c.pull_y.into(), pulls.clone())),
        ];
        // The pull of the anchor is null where that of the free end is.
        let strain =
            strain(c.strain).into_iter().filter(|_| self.strained).enumerate().map(|(i, column)| {
                Arc::new(Float64Array::new(column.into(), pulls.clone().filter(|_| i < 2))) as ArrayRef
            });
        let windings = c.windings.into_iter().map(|windings| Arc::new(Int64Array::from(windings)) as ArrayRef);
        columns.into_iter().chain(rest).chain(strain).chain(windings).collect()
    }

    /// Numbers of steps grow by one, and hardly a float is there twice: dictionaries of them are work for nothing.
    fn properties(&self, builder: WriterPropertiesBuilder) -> WriterPropertiesBuilder {
        let builder = ["x", "y", "bx", "by", "length", "pull_x", "pull_y"]
            .into_iter()
            .chain(STRAIN)
            .fold(builder, |builder, name| builder.set_column_dictionary_enabled(name.into(), false));
        builder
            .set_column_dictionary_enabled("step".into(), false)
            .set_column_encoding("step".into(), Encoding::DELTA_BINARY_PACKED)
            .set_max_row_group_row_count(Some(GROUP))
    }
}
