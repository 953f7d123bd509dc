//! Classes of ropes as columns: the word, and how often the rope winds about each obstacle.

use std::io::{self, Write};
use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_array::builder::{
    ArrayBuilder, Int64Builder, ListBuilder, StringBuilder, StructBuilder, UInt32Builder, UInt64Builder,
};
use arrow_schema::{DataType, Field, Fields};
use rayon::prelude::*;
use serde::Serialize;

use super::tables::Columns;
use crate::homotopy::{Class, Classes};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// What the columns are called.
pub(super) const NAMES: [&str; 2] = ["class", "windings"];

/// How often a rope winds about an obstacle.
#[derive(Serialize)]
pub(super) struct Winding {
    obstacle: u32,
    turns: i64,
}

/// The windings of a class that is as a picture shows it.
pub(super) fn windings(class: &Class) -> Vec<Winding> {
    class.windings().map(|(obstacle, turns)| Winding { obstacle, turns }).collect()
}

/// The two fields of CSV; both empty for a rope without a class.
pub(super) fn csv(out: &mut impl Write, class: Option<&Class>) -> io::Result<()> {
    let Some(class) = class else { return out.write_all(b",,") };
    write!(out, ",{class},")?;
    for (i, Winding { obstacle, turns }) in windings(class).into_iter().enumerate() {
        write!(out, "{}{obstacle} {turns}", if i == 0 { "" } else { ";" })?;
    }
    Ok(())
}

fn winding_fields() -> Fields {
    Fields::from(vec![Field::new("obstacle", DataType::UInt32, false), Field::new("turns", DataType::Int64, false)])
}

fn element() -> Field {
    Field::new("element", DataType::Struct(winding_fields()), false)
}

/// Both columns, with nulls for ropes without a class.
pub(super) struct ClassColumns {
    class: StringBuilder,
    windings: ListBuilder<StructBuilder>,
}

impl Default for ClassColumns {
    fn default() -> Self {
        let parts: Vec<Box<dyn ArrayBuilder>> = vec![Box::new(UInt32Builder::new()), Box::new(Int64Builder::new())];
        let windings = StructBuilder::new(winding_fields(), parts);
        ClassColumns { class: StringBuilder::new(), windings: ListBuilder::new(windings).with_field(element()) }
    }
}

impl ClassColumns {
    /// Adds a class that is as a picture shows it.
    pub(super) fn push(&mut self, class: Option<&Class>) {
        self.class.append_option(class.map(Class::to_string));
        for (obstacle, turns) in class.into_iter().flat_map(Class::windings) {
            let winding = self.windings.values();
            winding.field_builder::<UInt32Builder>(0).expect("it is built so").append_value(obstacle);
            winding.field_builder::<Int64Builder>(1).expect("it is built so").append_value(turns);
            winding.append(true);
        }
        self.windings.append(class.is_some());
    }

    pub(super) fn fields(&self) -> [Field; 2] {
        let windings = DataType::List(Arc::new(element()));
        [Field::new(NAMES[0], DataType::Utf8, true), Field::new(NAMES[1], windings, true)]
    }

    pub(super) fn take(&mut self) -> [ArrayRef; 2] {
        [Arc::new(self.class.finish()), Arc::new(self.windings.finish())]
    }

    fn len(&self) -> usize {
        self.class.len().max(self.windings.values_ref().len())
    }
}

/// Classes with the numbers of their traces.
#[derive(Default)]
pub(super) struct ClassRows {
    trace: UInt64Builder,
    classes: ClassColumns,
}

impl ClassRows {
    /// Adds the class, as a picture shows it, of the rope of that trace.
    pub(super) fn push(&mut self, trace: u64, class: Option<&Class>) {
        self.trace.append_value(trace);
        self.classes.push(class);
    }
}

impl Columns for ClassRows {
    fn fields(&self) -> Vec<Field> {
        [Field::new("trace", DataType::UInt64, false)].into_iter().chain(self.classes.fields()).collect()
    }

    fn len(&self) -> usize {
        self.classes.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        [Arc::new(self.trace.finish()) as ArrayRef].into_iter().chain(self.classes.take()).collect()
    }
}

/// Classes with the numbers of their traces, and of the steps from which on they are so.
#[derive(Default)]
pub(super) struct ChangeRows {
    trace: UInt64Builder,
    step: UInt64Builder,
    classes: ClassColumns,
}

impl ChangeRows {
    /// Adds a change of the class, as a picture shows it, of the rope of that trace.
    pub(super) fn push(&mut self, trace: u64, step: u64, class: &Class) {
        self.trace.append_value(trace);
        self.step.append_value(step);
        self.classes.push(Some(class));
    }
}

impl Columns for ChangeRows {
    fn fields(&self) -> Vec<Field> {
        let numbers = ["trace", "step"].map(|name| Field::new(name, DataType::UInt64, false));
        numbers.into_iter().chain(self.classes.fields()).collect()
    }

    fn len(&self) -> usize {
        self.classes.len()
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        let numbers: [ArrayRef; 2] = [Arc::new(self.trace.finish()), Arc::new(self.step.finish())];
        numbers.into_iter().chain(self.classes.take()).collect()
    }
}

/// The classes of ropes as a picture shows them, on all threads.
pub(super) fn shown(classes: &Classes, traces: &[SettledTrace], records: &[TraceRecord]) -> Vec<Option<Class>> {
    let y_down = classes.model().scene().y_down();
    let class = |(trace, record)| classes.of_record(trace, record).map(|class| class.shown(y_down));
    traces.par_iter().zip(records).map(class).collect()
}
