//! Rows in memory: what the Parquet files hold, as batches of Arrow.

use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{Schema, SchemaRef};
use rayon::prelude::*;

use super::Extras;
use super::class_columns::{ChangeRows, ClassRows, shown};
use super::columns::{EventColumns, ResultColumns};
use super::events::row;
use super::labels::Labels;
use super::step_arrays::StepArrays;
use super::tables::Columns;
use crate::homotopy::Classes;
use crate::rope::{StepColumns, Steps, TraceRecord};
use crate::scene::{Model, Scene};
use crate::trace::SettledTrace;

/// How many rows or list elements a batch has, about: offsets of lists are numbers of 32 bits.
const BATCH: usize = 1 << 20;

/// How many steps a batch of them has, about: enough that batches cost nothing, and few enough for all threads.
const STEPS: usize = 1 << 16;

/// Results as tables in memory, one row a trace: the columns, and the rows in batches, none if there are no records.
/// They are those of [`write_results`](super::write_results) to a Parquet file. O(records and their wraps).
///
/// ```
/// use std::sync::Arc;
/// use tautline::engine::{Cpu, Engine, Job};
/// use tautline::example::{Walker, floor_plan, settled_walks};
/// use tautline::output::result_batches;
/// use tautline::scene::Model;
///
/// let model = Arc::new(Model::new(floor_plan(), None)?);
/// let walks = settled_walks(&model, Walker { step: 0.3, steps: 50, seed: 1 }, 3);
/// let records = Cpu::new(model.clone()).evaluate(&walks, &Job::new())?;
/// let (schema, batches) = result_batches(model.scene(), &records);
/// assert_eq!((schema.field(3).name().as_str(), batches[0].num_rows()), ("length", 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn result_batches(scene: &Scene, records: &[TraceRecord]) -> (SchemaRef, Vec<RecordBatch>) {
    let (y_down, labels) = (scene.y_down(), &Labels::of(scene));
    batches(ResultColumns::new(labels, false), records.iter(), |columns, record| {
        columns.push(y_down, record, labels, None)
    })
}

/// Events as tables in memory, one row an event: the columns, and the rows in batches, none if there are no events.
/// They are those of [`write_events`](super::write_events) to a Parquet file. O(events).
///
/// # Panics
///
/// If an event names a vertex that is not there.
pub fn event_batches(scene: &Scene, records: &[TraceRecord]) -> (SchemaRef, Vec<RecordBatch>) {
    let labels = &Labels::of(scene);
    let events = records.iter().flat_map(|record| record.events.iter().map(|event| (record.trace, event)));
    batches(EventColumns::new(labels, false), events, |columns, (trace, event)| {
        columns.push(&row(scene, labels, trace, event))
    })
}

/// The classes of ropes as tables in memory, one row a trace: `trace`, `class` and `windings`, a list of structs of
/// `obstacle` and `turns`; both null where the trace crosses a wall. They are as a picture shows them. O(events), and
/// as [`Classes::of`] for each, on all threads.
///
/// # Panics
///
/// As [`Classes::of_record`], if a record is not that of its trace.
///
/// ```
/// use std::sync::Arc;
/// use tautline::engine::{Cpu, Engine, Job};
/// use tautline::example::{Walker, floor_plan, settled_walks};
/// use tautline::homotopy::Classes;
/// use tautline::output::class_batches;
/// use tautline::scene::Model;
///
/// let model = Arc::new(Model::new(floor_plan(), None)?);
/// let walks = settled_walks(&model, Walker { step: 0.3, steps: 50, seed: 1 }, 3);
/// let records = Cpu::new(model.clone()).evaluate(&walks, &Job::new())?;
/// let (schema, batches) = class_batches(&Classes::new(&model), &walks, &records);
/// assert_eq!((schema.field(1).name().as_str(), batches[0].num_rows()), ("class", 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn class_batches(
    classes: &Classes,
    traces: &[SettledTrace],
    records: &[TraceRecord],
) -> (SchemaRef, Vec<RecordBatch>) {
    let all = shown(classes, traces, records);
    let rows = records.iter().zip(&all);
    batches(ClassRows::default(), rows, |columns, (record, class)| columns.push(record.trace, class.as_ref()))
}

/// How the classes of ropes change as tables in memory: `trace`, `step`, and the `class` and `windings` of the rope
/// after that step as [`class_batches`] has them, one row for the first step of a trace and one for each after which
/// the class is another. Traces that cross walls have no rows. As [`Classes::changes`] for each, on all threads.
///
/// # Panics
///
/// As [`Classes::of_record`], if a record is not that of its trace.
pub fn class_change_batches(
    classes: &Classes,
    traces: &[SettledTrace],
    records: &[TraceRecord],
) -> (SchemaRef, Vec<RecordBatch>) {
    let y_down = classes.model().scene().y_down();
    let all: Vec<_> = traces.par_iter().zip(records).map(|(trace, record)| classes.changes(trace, record)).collect();
    let rows = records
        .iter()
        .zip(all)
        .flat_map(|(record, changes)| changes.unwrap_or_default().into_iter().map(|change| (record.trace, change)));
    batches(ChangeRows::default(), rows, |columns, (trace, change)| {
        columns.push(trace, change.step, &change.class.shown(y_down));
    })
}

/// The rope after every step of traces as tables in memory: the columns, and the rows in batches of whole traces, none
/// if there are no traces. They are those of a [`StepWriter`](super::StepWriter) of a Parquet file. `extras`
/// says what is told beside the ropes. O(points and events), on all threads.
///
/// # Panics
///
/// As [`Steps::new`] and [`Steps::next`], if a record is not that of its trace.
pub fn step_batches(
    model: &Model,
    traces: &[SettledTrace],
    records: &[TraceRecord],
    extras: &Extras,
) -> (SchemaRef, Vec<RecordBatch>) {
    let mut parts = Vec::new();
    let (mut first, mut rows) = (0, 0);
    for (place, trace) in traces.iter().enumerate() {
        rows += trace.points().len();
        if rows >= STEPS || place + 1 == traces.len() {
            parts.push(first..place + 1);
            (first, rows) = (place + 1, 0);
        }
    }
    let part = |part: std::ops::Range<usize>| {
        let mut columns = StepColumns::new(extras.centres.len());
        for (trace, record) in traces[part.clone()].iter().zip(&records[part]) {
            let steps = Steps::new(model, trace, record, &extras.centres);
            columns.take(record.trace, &mut steps.with_friction(extras.friction), usize::MAX);
        }
        whole(StepArrays::of(columns, extras, false)).1
    };
    let (schema, _) = whole(StepArrays::new(extras, false));
    (schema, parts.into_par_iter().flat_map_iter(part).collect())
}

/// Columns that are there, in one batch.
pub(super) fn whole<C: Columns>(mut columns: C) -> (SchemaRef, Vec<RecordBatch>) {
    let schema = Arc::new(Schema::new(columns.fields()));
    let batch = RecordBatch::try_new(schema.clone(), columns.take()).expect("columns fit their fields");
    (schema, vec![batch])
}

fn batches<C: Columns, R>(
    mut columns: C,
    rows: impl Iterator<Item = R>,
    push: impl Fn(&mut C, R),
) -> (SchemaRef, Vec<RecordBatch>) {
    let schema = Arc::new(Schema::new(columns.fields()));
    let batch =
        |columns: &mut C| RecordBatch::try_new(schema.clone(), columns.take()).expect("columns fit their fields");
    let mut batches = Vec::new();
    for row in rows {
        push(&mut columns, row);
        if columns.len() >= BATCH {
            batches.push(batch(&mut columns));
        }
    }
    if columns.len() > 0 {
        batches.push(batch(&mut columns));
    }
    (schema, batches)
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;
    use crate::engine::{Cpu, Engine, Job};
    use crate::example::{Walker, floor_plan, settled_walks};
    use crate::output::{StepWriter, write_events, write_results};
    use crate::rope::Friction;
    use crate::scene::{Model, Object, Wall};

    /// Holds the rows in memory to those of the file that `write` writes.
    fn compare((schema, batches): (SchemaRef, Vec<RecordBatch>), write: impl Fn(&std::path::Path)) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rows.parquet");
        write(&file);
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&file).unwrap()).unwrap();
        assert_eq!(reader.schema().fields(), schema.fields());
        let written: Vec<RecordBatch> = reader.with_batch_size(1 << 30).build().unwrap().map(Result::unwrap).collect();
        assert_eq!(batches, written);
        assert_eq!(batches.len(), 1);
    }

    #[test]
    fn rows_in_memory_are_those_of_the_files() {
        let plan = floor_plan();
        let wall = |i: usize| Wall { ends: plan.ends(i), object: (i % 2) as u32, reversed: false };
        let objects = vec![Object { label: Some("door, left".to_owned()), ..Object::default() }, Object::default()];
        let named = Scene::of(objects, (0..plan.walls().len()).map(wall)).unwrap();
        for scene in [plan.clone(), named.with_anchor(plan.anchor().unwrap()).with_y_down()] {
            let model = Arc::new(Model::new(scene, None).unwrap());
            let walks = settled_walks(&model, Walker { step: 0.3, steps: 100, seed: 1 }, 20);
            let records = Cpu::new(model.clone()).evaluate(&walks, &Job::new()).unwrap();
            assert!(records.iter().any(|record| record.wraps.len() > 1));
            let scene = model.scene();
            compare(result_batches(scene, &records), |file| write_results(file, scene, &records).unwrap());
            compare(event_batches(scene, &records), |file| write_events(file, scene, &records).unwrap());
            for friction in [None, Some(Friction::new(0.3).unwrap())] {
                let extras = Extras { centres: scene.labelled(), friction };
                compare(step_batches(&model, &walks, &records, &extras), |file| {
                    let mut steps = StepWriter::create(file, &model, &extras).unwrap();
                    steps.write_all(&walks, &records).unwrap();
                    steps.finish().unwrap();
                });
            }
        }
        let model = Model::new(floor_plan(), None).unwrap();
        assert!(step_batches(&model, &[], &[], &Extras::default()).1.is_empty());
        let (schema, none) = result_batches(&floor_plan(), &[]);
        assert_eq!((schema.fields().len(), none), (11, Vec::new()));
    }
}
