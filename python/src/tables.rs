//! Results and events as tables, with the columns that the program writes to files.

use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_array::builder::{Float64Builder, ListBuilder, StringBuilder, StructBuilder, UInt32Builder, UInt64Builder};
use arrow_schema::{DataType, Field, Fields};
use glam::DVec2;
use tautline::rope::TraceRecord;
use tautline::scene::Model;

use crate::fault::Fault;
use crate::table::Table;

/// How many rows or list elements a batch has, about: offsets of lists are numbers of 32 bits.
const BATCH: usize = 1 << 20;

fn point() -> Fields {
    Fields::from(vec![Field::new("x", DataType::Float64, false), Field::new("y", DataType::Float64, false)])
}

fn element(of: DataType, nullable: bool) -> Arc<Field> {
    Arc::new(Field::new("element", of, nullable))
}

fn points() -> StructBuilder {
    StructBuilder::new(point(), vec![Box::new(Float64Builder::new()), Box::new(Float64Builder::new())])
}

/// Adds a point, or null; the coordinates of a null point are zeros.
fn push_point(builder: &mut StructBuilder, at: Option<DVec2>) {
    for (field, value) in at.unwrap_or(DVec2::ZERO).to_array().into_iter().enumerate() {
        if let Some(column) = builder.field_builder::<Float64Builder>(field) {
            column.append_value(value);
        }
    }
    builder.append(at.is_some());
}

/// One row a trace.
pub(crate) fn results(model: &Model, records: &[TraceRecord]) -> Result<Table, Fault> {
    let scene = model.scene();
    let labels = scene.labels();
    let mut fields = vec![
        Field::new("trace", DataType::UInt64, false),
        Field::new("status", DataType::Utf8, false),
        Field::new("steps", DataType::UInt64, false),
        Field::new("length", DataType::Float64, false),
        Field::new("max_length", DataType::Float64, false),
        Field::new("depth", DataType::UInt32, false),
        Field::new("max_depth", DataType::UInt32, false),
        Field::new("events", DataType::UInt64, false),
        Field::new("wraps", DataType::List(element(DataType::Struct(point()), false)), false),
        Field::new("sides", DataType::List(element(DataType::Utf8, false)), false),
        Field::new("pull", DataType::Struct(point()), true),
    ];
    if !labels.is_empty() {
        fields.push(Field::new("labels", DataType::List(element(DataType::Utf8, true)), false));
    }
    let mut table = Table::new(fields);
    for records in groups(records, |record| record.wraps.len() + 1) {
        let list = |nullable| ListBuilder::new(StringBuilder::new()).with_field(element(DataType::Utf8, nullable));
        let mut wraps = ListBuilder::new(points()).with_field(element(DataType::Struct(point()), false));
        let (mut sides, mut names, mut pull) = (list(false), list(true), points());
        let mut status = StringBuilder::new();
        for record in records {
            status.append_value(record.status.name());
            for (at, side) in &record.wraps {
                push_point(wraps.values(), Some(*at));
                sides.values().append_value(side.shown(scene.y_down()).name());
                let label = model.vertex_at(*at).and_then(|vertex| *labels.get(vertex as usize)?);
                names.values().append_option(label);
            }
            wraps.append(true);
            sides.append(true);
            names.append(true);
            push_point(&mut pull, record.pull);
        }
        let mut columns: Vec<ArrayRef> = vec![
            wide(records, |r| r.trace),
            Arc::new(status.finish()),
            wide(records, |r| r.steps),
            floats(records, |r| r.length),
            floats(records, |r| r.max_length),
            narrow(records, |r| r.depth),
            narrow(records, |r| r.max_depth),
            wide(records, |r| r.events.len() as u64),
            Arc::new(wraps.finish()),
            Arc::new(sides.finish()),
            Arc::new(pull.finish()),
        ];
        if !labels.is_empty() {
            columns.push(Arc::new(names.finish()));
        }
        table.push(columns)?;
    }
    Ok(table)
}

fn wide(records: &[TraceRecord], of: impl Fn(&TraceRecord) -> u64) -> ArrayRef {
    Arc::new(arrow_array::UInt64Array::from_iter_values(records.iter().map(of)))
}

fn narrow(records: &[TraceRecord], of: impl Fn(&TraceRecord) -> u32) -> ArrayRef {
    Arc::new(arrow_array::UInt32Array::from_iter_values(records.iter().map(of)))
}

fn floats(records: &[TraceRecord], of: impl Fn(&TraceRecord) -> f64) -> ArrayRef {
    Arc::new(arrow_array::Float64Array::from_iter_values(records.iter().map(of)))
}

/// One row an event.
pub(crate) fn events(model: &Model, records: &[TraceRecord]) -> Result<Table, Fault> {
    let scene = model.scene();
    let labels = scene.labels();
    let mut fields = vec![
        Field::new("trace", DataType::UInt64, false),
        Field::new("step", DataType::UInt64, false),
        Field::new("kind", DataType::Utf8, false),
        Field::new("vertex", DataType::UInt32, false),
        Field::new("x", DataType::Float64, false),
        Field::new("y", DataType::Float64, false),
        Field::new("side", DataType::Utf8, false),
    ];
    if !labels.is_empty() {
        fields.push(Field::new("label", DataType::Utf8, true));
    }
    let mut table = Table::new(fields);
    for records in groups(records, |record| record.events.len()) {
        let (mut trace, mut step) = (UInt64Builder::new(), UInt64Builder::new());
        let (mut kind, mut side, mut label) = (StringBuilder::new(), StringBuilder::new(), StringBuilder::new());
        let mut vertex = UInt32Builder::new();
        let (mut x, mut y) = (Float64Builder::new(), Float64Builder::new());
        for (number, event) in records.iter().flat_map(|r| r.events.iter().map(move |event| (r.trace, event))) {
            let at = scene.vertices()[event.vertex as usize];
            trace.append_value(number);
            step.append_value(u64::from(event.step));
            kind.append_value(event.kind.name());
            vertex.append_value(event.vertex);
            x.append_value(at.x);
            y.append_value(at.y);
            side.append_value(event.side.shown(scene.y_down()).name());
            label.append_option(labels.get(event.vertex as usize).copied().flatten());
        }
        let mut columns: Vec<ArrayRef> = vec![
            Arc::new(trace.finish()),
            Arc::new(step.finish()),
            Arc::new(kind.finish()),
            Arc::new(vertex.finish()),
            Arc::new(x.finish()),
            Arc::new(y.finish()),
            Arc::new(side.finish()),
        ];
        if !labels.is_empty() {
            columns.push(Arc::new(label.finish()));
        }
        table.push(columns)?;
    }
    Ok(table)
}

/// The records in groups of about as much as a batch holds.
fn groups(records: &[TraceRecord], size: impl Fn(&TraceRecord) -> usize) -> impl Iterator<Item = &[TraceRecord]> {
    let mut rest = records;
    std::iter::from_fn(move || {
        let mut sum = 0;
        let fits = |record: &&TraceRecord| {
            sum += size(record);
            sum <= BATCH
        };
        let count = rest.iter().take_while(fits).count().max(1).min(rest.len());
        let (first, others) = rest.split_at(count);
        rest = others;
        (!first.is_empty()).then_some(first)
    })
}
