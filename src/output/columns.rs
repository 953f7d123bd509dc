//! The columns of results and events in memory, until they go to a [`Table`](super::tables::Table).

use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_array::builder::{
    ArrayBuilder, Float64Builder, ListBuilder, StringBuilder, StructBuilder, UInt32Builder, UInt64Builder,
};
use arrow_schema::{DataType, Field, Fields};
use glam::DVec2;

use super::class_columns::ClassColumns;
use super::labels::Labels;
use super::tables::Columns;
use super::text::Row;
use crate::homotopy::Class;
use crate::rope::{Event, TraceRecord};
use crate::trace::End;

fn point_fields() -> Fields {
    Fields::from(vec![Field::new("x", DataType::Float64, false), Field::new("y", DataType::Float64, false)])
}

/// Parquet calls a list's elements so.
fn element(of: DataType) -> Field {
    Field::new("element", of, false)
}

fn point_builder() -> StructBuilder {
    StructBuilder::new(point_fields(), vec![Box::new(Float64Builder::new()), Box::new(Float64Builder::new())])
}

/// Adds a point, or null. The fields of a null point hold zeros, as they may not be null themselves.
fn push_point(builder: &mut StructBuilder, point: Option<DVec2>) {
    for (field, value) in point.unwrap_or(DVec2::ZERO).to_array().into_iter().enumerate() {
        let column: &mut Float64Builder = builder.field_builder(field).expect("both fields are built as f64");
        column.append_value(value);
    }
    builder.append(point.is_some());
}

/// A list of labels; a wall end may have none.
fn label_element() -> Field {
    Field::new("element", DataType::Utf8, true)
}

/// One row a trace.
pub(super) struct ResultColumns {
    trace: UInt64Builder,
    status: StringBuilder,
    steps: UInt64Builder,
    length: Float64Builder,
    max_length: Float64Builder,
    depth: UInt32Builder,
    max_depth: UInt32Builder,
    events: UInt64Builder,
    wraps: ListBuilder<StructBuilder>,
    sides: ListBuilder<StringBuilder>,
    pull: StructBuilder,
    /// Where wall ends have labels.
    labels: Option<ListBuilder<StringBuilder>>,
    /// Where classes are told.
    classes: Option<ClassColumns>,
}

impl ResultColumns {
    /// With room for labels, if there are some, and for classes, if they are told.
    pub(super) fn new(labels: &Labels, with_classes: bool) -> Self {
        let list = || ListBuilder::new(StringBuilder::new()).with_field(label_element());
        ResultColumns {
            trace: UInt64Builder::new(),
            status: StringBuilder::new(),
            steps: UInt64Builder::new(),
            length: Float64Builder::new(),
            max_length: Float64Builder::new(),
            depth: UInt32Builder::new(),
            max_depth: UInt32Builder::new(),
            events: UInt64Builder::new(),
            wraps: ListBuilder::new(point_builder()).with_field(element(DataType::Struct(point_fields()))),
            sides: ListBuilder::new(StringBuilder::new()).with_field(element(DataType::Utf8)),
            pull: point_builder(),
            labels: (!labels.is_empty()).then(list),
            classes: with_classes.then(ClassColumns::default),
        }
    }

    /// Adds a row; sides and the class, which may be left out where none are told, are those that a picture shows.
    pub(super) fn push(&mut self, y_down: bool, r: &TraceRecord, labels: &Labels, class: Option<&Class>) {
        self.trace.append_value(r.trace);
        self.status.append_value(r.status.name());
        self.steps.append_value(r.steps);
        self.length.append_value(r.length);
        self.max_length.append_value(r.max_length);
        self.depth.append_value(r.depth);
        self.max_depth.append_value(r.max_depth);
        self.events.append_value(r.events.len() as u64);
        for (at, side) in &r.wraps {
            push_point(self.wraps.values(), Some(*at));
            self.sides.values().append_value(side.shown(y_down).name());
        }
        self.wraps.append(true);
        self.sides.append(true);
        push_point(&mut self.pull, r.pull);
        if let Some(column) = &mut self.labels {
            r.wraps.iter().for_each(|(at, _)| column.values().append_option(labels.at(*at)));
            column.append(true);
        }
        if let Some(columns) = &mut self.classes {
            columns.push(class);
        }
    }
}

impl Columns for ResultColumns {
    fn fields(&self) -> Vec<Field> {
        let labels =
            self.labels.as_ref().map(|_| Field::new("labels", DataType::List(Arc::new(label_element())), false));
        let fields = vec![
            Field::new("trace", DataType::UInt64, false),
            Field::new("status", DataType::Utf8, false),
            Field::new("steps", DataType::UInt64, false),
            Field::new("length", DataType::Float64, false),
            Field::new("max_length", DataType::Float64, false),
            Field::new("depth", DataType::UInt32, false),
            Field::new("max_depth", DataType::UInt32, false),
            Field::new("events", DataType::UInt64, false),
            Field::new("wraps", DataType::List(Arc::new(element(DataType::Struct(point_fields())))), false),
            Field::new("sides", DataType::List(Arc::new(element(DataType::Utf8))), false),
            Field::new("pull", DataType::Struct(point_fields()), true),
        ];
        let classes = self.classes.iter().flat_map(ClassColumns::fields);
        fields.into_iter().chain(labels).chain(classes).collect()
    }

    fn len(&self) -> usize {
        self.trace.len().max(self.wraps.values_ref().len())
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let labels = self.labels.as_mut().map(|labels| Arc::new(labels.finish()) as ArrayRef);
        let classes: Vec<ArrayRef> = self.classes.iter_mut().flat_map(ClassColumns::take).collect();
        let columns: Vec<ArrayRef> = vec![
            Arc::new(self.trace.finish()),
            Arc::new(self.status.finish()),
            Arc::new(self.steps.finish()),
            Arc::new(self.length.finish()),
            Arc::new(self.max_length.finish()),
            Arc::new(self.depth.finish()),
            Arc::new(self.max_depth.finish()),
            Arc::new(self.events.finish()),
            Arc::new(self.wraps.finish()),
            Arc::new(self.sides.finish()),
            Arc::new(self.pull.finish()),
        ];
        columns.into_iter().chain(labels).chain(classes).collect()
    }
}

/// One row an event.
#[derive(Default)]
pub(super) struct EventColumns {
    trace: UInt64Builder,
    step: UInt64Builder,
    kind: StringBuilder,
    vertex: UInt32Builder,
    x: Float64Builder,
    y: Float64Builder,
    side: StringBuilder,
    /// Where both ends of ropes move.
    end: Option<StringBuilder>,
    /// Where wall ends have labels.
    label: Option<StringBuilder>,
}

impl EventColumns {
    /// With room for labels, if there are some, and for ends, if both move.
    pub(super) fn new(labels: &Labels, both_move: bool) -> Self {
        let end = both_move.then(StringBuilder::new);
        EventColumns { end, label: (!labels.is_empty()).then(StringBuilder::new), ..EventColumns::default() }
    }

    pub(super) fn push(&mut self, row: &Row<'_>) {
        let Row { trace, at, .. } = *row;
        let Event { step, kind, vertex, .. } = *row.event;
        self.trace.append_value(trace);
        self.step.append_value(u64::from(step));
        self.kind.append_value(kind.name());
        self.vertex.append_value(vertex);
        self.x.append_value(at.x);
        self.y.append_value(at.y);
        self.side.append_value(row.side());
        if let Some(column) = &mut self.end {
            column.append_option(row.end.map(End::name));
        }
        if let Some(column) = &mut self.label {
            column.append_option(row.label.flatten());
        }
    }
}

impl Columns for EventColumns {
    fn fields(&self) -> Vec<Field> {
        let end = self.end.as_ref().map(|_| Field::new("end", DataType::Utf8, false));
        let label = self.label.as_ref().map(|_| Field::new("label", DataType::Utf8, true));
        let fields = vec![
            Field::new("trace", DataType::UInt64, false),
            Field::new("step", DataType::UInt64, false),
            Field::new("kind", DataType::Utf8, false),
            Field::new("vertex", DataType::UInt32, false),
            Field::new("x", DataType::Float64, false),
            Field::new("y", DataType::Float64, false),
            Field::new("side", DataType::Utf8, false),
        ];
        fields.into_iter().chain(end).chain(label).collect()
    }

    fn len(&self) -> usize {
        self.trace.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let end = self.end.as_mut().map(|end| Arc::new(end.finish()) as ArrayRef);
        let label = self.label.as_mut().map(|label| Arc::new(label.finish()) as ArrayRef);
        let columns: Vec<ArrayRef> = vec![
            Arc::new(self.trace.finish()),
            Arc::new(self.step.finish()),
            Arc::new(self.kind.finish()),
            Arc::new(self.vertex.finish()),
            Arc::new(self.x.finish()),
            Arc::new(self.y.finish()),
            Arc::new(self.side.finish()),
        ];
        columns.into_iter().chain(end).chain(label).collect()
    }
}
