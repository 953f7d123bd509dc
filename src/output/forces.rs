//! Forces: one row for each turn of the ropes at the end.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_array::builder::{ArrayBuilder, Float64Builder, StringBuilder, UInt32Builder, UInt64Builder};
use arrow_schema::{DataType, Field};
use glam::DVec2;

use super::labels::{Labels, field};
use super::rows::Rows;
use super::tables::Columns;
use super::text::number;
use super::{WholeFile, WriteError};
use crate::rope::{EndsRecord, Force, Friction, Slip, Status, TraceRecord, forces};
use crate::scene::Model;
use crate::trace::{End, SettledEnds, SettledTrace};

/// A number of a force.
type Number = fn(&Force) -> f64;

/// The names of the columns of numbers, and what they hold.
const NUMBERS: [(&str, Number); 7] = [
    ("x", |f| f.at.x),
    ("y", |f| f.at.y),
    ("angle", |f| f.angle),
    ("before", |f| f.before),
    ("beyond", |f| f.beyond),
    ("force_x", |f| f.force.x),
    ("force_y", |f| f.force.y),
];

/// Writes the forces of ropes on what they bend round at the end to a file that appears when it is finished: one row a
/// turn, from the anchor on. Traces that cross walls have none: their ropes mean nothing.
///
/// `.jsonl`, `.csv` and `.parquet` have the same columns: `trace`, `vertex`, and what [`Force`] says, for a rope that
/// is hauled at the free end and has a tension of 1 at the anchor: `x`, `y`, `angle`, `before`, `beyond`, `force_x`,
/// `force_y`. Where the scene's wall ends have labels, `label` follows: empty or null for one without. What is infinite
/// is `inf` in `.csv` and null in `.jsonl`. Memory is bounded; it does not grow with the number of ropes.
pub struct ForceWriter {
    rows: Rows<ForceColumns>,
    labels: Labels,
    model: Arc<Model>,
    friction: Friction,
}

/// The rope of a trace at its end: where the anchor and the free end are, and the turns.
struct Last<'a> {
    record: &'a TraceRecord,
    ends: [DVec2; 2],
}

/// A row.
struct Row<'a> {
    trace: u64,
    vertex: u32,
    force: Force,
    label: Option<&'a str>,
}

impl ForceWriter {
    /// Starts the file at `path`, in the format that its extension names, for ropes in `model` with that friction.
    /// O(walls).
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create(path: &Path, model: &Arc<Model>, friction: Friction) -> Result<Self, WriteError> {
        let labels = Labels::of(model.scene());
        let names: Vec<&str> = NUMBERS.iter().map(|(name, _)| *name).collect();
        let header = format!("trace,vertex,{}{}", names.join(","), if labels.is_empty() { "" } else { ",label" });
        let rows = Rows::create(path, &header, ForceColumns::new(!labels.is_empty()))?;
        Ok(ForceWriter { rows, labels, model: model.clone(), friction })
    }

    /// Adds the ropes of traces, each with what became of it. O(turns).
    ///
    /// # Errors
    ///
    /// What the operating system says; the file cannot be finished after that.
    pub fn write_all(&mut self, traces: &[SettledTrace], records: &[TraceRecord]) -> Result<(), WriteError> {
        let anchor = self.model.anchor();
        let last = |(trace, record): (&SettledTrace, _)| Last {
            record,
            ends: [anchor, trace.points().last().copied().unwrap_or(anchor)],
        };
        self.write(&traces.iter().zip(records).map(last).collect::<Vec<_>>())
    }

    /// The same for ropes whose ends both move.
    ///
    /// # Errors
    ///
    /// As those of [`write_all`](Self::write_all).
    pub fn write_ends(&mut self, traces: &[SettledEnds], records: &[EndsRecord]) -> Result<(), WriteError> {
        let last = |trace: &SettledEnds| {
            let end = |end| trace.path(end).points().last().copied().unwrap_or(trace.start());
            [end(End::Anchor), end(End::Free)]
        };
        let all = traces.iter().zip(records);
        self.write(&all.map(|both| Last { record: &both.1.record, ends: last(both.0) }).collect::<Vec<_>>())
    }

    fn write(&mut self, ropes: &[Last<'_>]) -> Result<(), WriteError> {
        let Self { rows, labels, model, friction } = self;
        let of = |rope: &Last<'_>| -> Vec<Row<'_>> {
            if rope.record.status == Status::Violation {
                return Vec::new();
            }
            let turns = rope.record.wraps.iter().map(|(at, _)| *at);
            let corners: Vec<DVec2> = [rope.ends[0]].into_iter().chain(turns).chain([rope.ends[1]]).collect();
            let row = |force: Force| {
                let vertex = model.vertex_at(force.at).expect("ropes turn at wall ends");
                Row { trace: rope.record.trace, vertex, force, label: labels.get(vertex) }
            };
            forces(&corners, *friction, Slip::ToFreeEnd).into_iter().map(row).collect()
        };
        let labelled = !labels.is_empty();
        rows.write_all(
            ropes,
            |text, rope| of(rope).iter().try_for_each(|row| json(text, row, labelled)),
            |text, rope| of(rope).iter().try_for_each(|row| csv(text, row, labelled)),
            |table, rope| {
                of(rope).iter().try_for_each(|row| {
                    table.columns.push(row);
                    table.flush_if_full()
                })
            },
        )
    }

    /// Notes something about the forces, where they come from say, in the metadata of a Parquet file; the other formats
    /// have no place for it.
    pub fn note(&mut self, key: &str, value: &str) {
        self.rows.note(key, value);
    }

    /// Writes the rest and returns the whole file, to be put in its place by [`WholeFile::finish`]: for files that
    /// must appear together or not at all.
    ///
    /// # Errors
    ///
    /// What the operating system says, or that an earlier write failed.
    pub fn complete(self) -> Result<WholeFile, WriteError> {
        self.rows.complete()
    }
}

fn csv(out: &mut Vec<u8>, row: &Row<'_>, labelled: bool) -> io::Result<()> {
    write!(out, "{},{}", row.trace, row.vertex)?;
    for (_, of) in NUMBERS {
        out.push(b',');
        match of(&row.force) {
            x if x.is_finite() => number(out, x)?,
            x => write!(out, "{x}")?,
        }
    }
    if labelled {
        out.push(b',');
        field(out, row.label.unwrap_or_default())?;
    }
    out.push(b'\n');
    Ok(())
}

fn json(out: &mut Vec<u8>, row: &Row<'_>, labelled: bool) -> io::Result<()> {
    write!(out, "{{\"trace\":{},\"vertex\":{}", row.trace, row.vertex)?;
    for (name, of) in NUMBERS {
        write!(out, ",\"{name}\":")?;
        // JSON has no infinity, for which serde writes null.
        number(out, of(&row.force))?;
    }
    if labelled {
        out.extend_from_slice(b",\"label\":");
        serde_json::to_writer(&mut *out, &row.label)?;
    }
    out.extend_from_slice(b"}\n");
    Ok(())
}

/// Rows in memory.
struct ForceColumns {
    trace: UInt64Builder,
    vertex: UInt32Builder,
    numbers: [Float64Builder; NUMBERS.len()],
    /// Where wall ends have labels.
    label: Option<StringBuilder>,
}

impl ForceColumns {
    fn new(labelled: bool) -> Self {
        ForceColumns {
            trace: UInt64Builder::new(),
            vertex: UInt32Builder::new(),
            numbers: std::array::from_fn(|_| Float64Builder::new()),
            label: labelled.then(StringBuilder::new),
        }
    }

    fn push(&mut self, row: &Row<'_>) {
        self.trace.append_value(row.trace);
        self.vertex.append_value(row.vertex);
        self.numbers.iter_mut().zip(NUMBERS).for_each(|(column, (_, of))| column.append_value(of(&row.force)));
        self.label.iter_mut().for_each(|column| column.append_option(row.label));
    }
}

impl Columns for ForceColumns {
    fn fields(&self) -> Vec<Field> {
        let numbers = NUMBERS.iter().map(|(name, _)| Field::new(*name, DataType::Float64, false));
        let label = self.label.as_ref().map(|_| Field::new("label", DataType::Utf8, true));
        let first = [Field::new("trace", DataType::UInt64, false), Field::new("vertex", DataType::UInt32, false)];
        first.into_iter().chain(numbers).chain(label).collect()
    }

    fn len(&self) -> usize {
        self.trace.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let first: [ArrayRef; 2] = [Arc::new(self.trace.finish()), Arc::new(self.vertex.finish())];
        let numbers = self.numbers.iter_mut().map(|column| Arc::new(column.finish()) as ArrayRef);
        let label = self.label.as_mut().map(|label| Arc::new(label.finish()) as ArrayRef);
        first.into_iter().chain(numbers).chain(label).collect()
    }
}
