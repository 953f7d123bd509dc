//! Events: one row a push or pop.

use std::path::Path;

use super::columns::EventColumns;
use super::labels::Labels;
use super::rows::Rows;
use super::text::Row;
use super::{CHUNK, WholeFile, WriteError, text};
use crate::rope::{EndsRecord, Event, TraceRecord};
use crate::scene::Scene;
use crate::trace::End;

/// Writes the events of traces to a file that appears when it is finished.
///
/// `.jsonl`, `.csv` and `.parquet` have the same columns: `trace`, `step`, `kind` (`wrap` or `unwrap`), `vertex` (the
/// scene's number of it), `x`, `y` (where it stands), `side` (`left` or `right`, as a picture of the scene shows it,
/// also where y points down: [`Side::shown`](crate::rope::Side::shown)). Memory is bounded; it does not grow with the
/// number of events. Where the scene's wall ends have labels, `label` follows: empty or null for one without.
pub struct EventWriter {
    rows: Rows<EventColumns>,
    labels: Labels,
}

impl EventWriter {
    /// Starts the file at `path`, in the format that its extension names, for ropes in `scene`. O(walls).
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create(path: &Path, scene: &Scene) -> Result<Self, WriteError> {
        Self::with(path, scene, false)
    }

    /// The same for ropes whose ends both move: a column `end` follows the side, `free` or `anchor`, and
    /// [`write_ends`](Self::write_ends) adds the events.
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn of_ends(path: &Path, scene: &Scene) -> Result<Self, WriteError> {
        Self::with(path, scene, true)
    }

    fn with(path: &Path, scene: &Scene, both_move: bool) -> Result<Self, WriteError> {
        let labels = Labels::of(scene);
        let end = if both_move { ",end" } else { "" };
        let label = if labels.is_empty() { "" } else { ",label" };
        let header = format!("{}{end}{label}", text::EVENT_HEADER);
        Ok(EventWriter { rows: Rows::create(path, &header, EventColumns::new(&labels, both_move))?, labels })
    }

    /// Adds the events of one trace in that scene.
    ///
    /// # Errors
    ///
    /// What the operating system says; the file cannot be finished after that.
    ///
    /// # Panics
    ///
    /// If an event names a vertex that is not there.
    pub fn write(&mut self, scene: &Scene, record: &TraceRecord) -> Result<(), WriteError> {
        self.write_all(scene, std::slice::from_ref(record))
    }

    /// Adds the events of traces; the bytes are the same as one by one. Text is made on all cores and held until it is
    /// written.
    ///
    /// # Errors
    ///
    /// Those of [`write`](Self::write).
    ///
    /// # Panics
    ///
    /// If an event names a vertex that is not there.
    pub fn write_all(&mut self, scene: &Scene, records: &[TraceRecord]) -> Result<(), WriteError> {
        let labels = &self.labels;
        self.rows.write_all(
            records,
            |text, r| r.events.iter().try_for_each(|e| text::event_json(text, &row(scene, labels, r.trace, e))),
            |text, r| r.events.iter().try_for_each(|e| text::event_csv(text, &row(scene, labels, r.trace, e))),
            |table, r| {
                r.events.iter().try_for_each(|e| {
                    table.columns.push(&row(scene, labels, r.trace, e));
                    table.flush_if_full()
                })
            },
        )
    }

    /// Adds the events of traces of ropes whose ends both move, to a file [of such](Self::of_ends).
    ///
    /// # Errors
    ///
    /// Those of [`write`](Self::write).
    ///
    /// # Panics
    ///
    /// If an event names a vertex that is not there.
    pub fn write_ends(&mut self, scene: &Scene, records: &[EndsRecord]) -> Result<(), WriteError> {
        let labels = &self.labels;
        self.rows.write_all(
            records,
            |text, r| r.events().try_for_each(|e| text::event_json(text, &row_of(scene, labels, r, e))),
            |text, r| r.events().try_for_each(|e| text::event_csv(text, &row_of(scene, labels, r, e))),
            |table, r| {
                r.events().try_for_each(|e| {
                    table.columns.push(&row_of(scene, labels, r, e));
                    table.flush_if_full()
                })
            },
        )
    }

    /// Notes something about the events, where they come from say, in the metadata of a Parquet file; the other formats
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

/// An event of a trace as rows have it.
pub(super) fn row<'e>(scene: &Scene, labels: &'e Labels, trace: u64, event: &'e Event) -> Row<'e> {
    let label = (!labels.is_empty()).then(|| labels.get(event.vertex));
    let at = scene.vertices()[event.vertex as usize];
    Row { trace, event, end: None, at, y_down: scene.y_down(), label }
}

/// An event at an end of a rope whose ends both move.
fn row_of<'e>(scene: &Scene, labels: &'e Labels, r: &'e EndsRecord, (event, end): (&'e Event, End)) -> Row<'e> {
    Row { end: Some(end), ..row(scene, labels, r.record.trace, event) }
}

/// Writes the events of all `records` in `scene` to `path`, as [`EventWriter`] does.
///
/// # Errors
///
/// Those of [`check_output`](super::check_output), and what the operating system says.
///
/// # Panics
///
/// If an event names a vertex that is not there.
pub fn write_events(path: &Path, scene: &Scene, records: &[TraceRecord]) -> Result<(), WriteError> {
    let mut writer = EventWriter::create(path, scene)?;
    records.chunks(CHUNK).try_for_each(|records| writer.write_all(scene, records))?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use arrow_array::cast::AsArray;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;
    use crate::rope::{EventKind, Side, Status};
    use crate::scene::{Object, Wall};

    #[test]
    fn rows_have_the_documented_form() {
        let scene = Scene::new([[[0.1, -3e-7].into(), [1.0, 2.0].into()]]).unwrap();
        let wrap = Event { step: 12, kind: EventKind::Wrap, vertex: 1, side: Side::Left };
        let unwrap = Event { step: 40, kind: EventKind::Unwrap, vertex: 0, side: Side::Right };
        let record = TraceRecord {
            trace: 3,
            status: Status::Ok,
            steps: 40,
            length: 1.0,
            max_length: 1.0,
            depth: 0,
            max_depth: 0,
            wraps: Vec::new(),
            pull: None,
            events: vec![wrap, unwrap],
        };
        let folder = tempfile::tempdir().unwrap();
        let written = |name: &str, scene: &Scene| {
            let path = folder.path().join(name);
            write_events(&path, scene, std::slice::from_ref(&record)).unwrap();
            std::fs::read_to_string(path).unwrap()
        };
        let lines = concat!(
            r#"{"trace":3,"step":12,"kind":"wrap","vertex":1,"x":1.0,"y":2.0,"side":"left"}"#,
            "\n",
            r#"{"trace":3,"step":40,"kind":"unwrap","vertex":0,"x":0.1,"y":-3e-7,"side":"right"}"#,
            "\n",
        );
        assert_eq!(written("e.jsonl", &scene), lines);
        let rows = "3,12,wrap,1,1.0,2.0,left\n3,40,unwrap,0,0.1,-3e-7,right\n";
        assert_eq!(written("e.csv", &scene), format!("trace,step,kind,vertex,x,y,side\n{rows}"));
        let down = scene.with_y_down();
        let rows = "3,12,wrap,1,1.0,2.0,right\n3,40,unwrap,0,0.1,-3e-7,left\n";
        assert_eq!(written("d.csv", &down), format!("trace,step,kind,vertex,x,y,side\n{rows}"));
    }

    #[test]
    fn wall_ends_that_have_names_are_named() {
        let object = |label: &str| Object { label: Some(label.to_owned()), ..Object::default() };
        let wall = |x: f64, object| Wall { ends: [[x, 0.0].into(), [x, 1.0].into()], object, reversed: false };
        let objects = vec![object("door, left"), Object::default()];
        let scene = Scene::of(objects, [wall(0.0, 0), wall(1.0, 1)]).unwrap();
        let event = |vertex| Event { step: 1, kind: EventKind::Wrap, vertex, side: Side::Left };
        let record = TraceRecord {
            trace: 3,
            status: Status::Ok,
            steps: 1,
            length: 1.0,
            max_length: 1.0,
            depth: 0,
            max_depth: 0,
            wraps: Vec::new(),
            pull: None,
            events: vec![event(0), event(2)],
        };
        let folder = tempfile::tempdir().unwrap();
        let written = |name: &str| {
            let path = folder.path().join(name);
            let mut writer = EventWriter::create(&path, &scene).unwrap();
            writer.write(&scene, &record).unwrap();
            writer.finish().unwrap();
            std::fs::read_to_string(path).unwrap_or_default()
        };
        let rows = "3,1,wrap,0,0.0,0.0,left,\"door, left\"\n3,1,wrap,2,1.0,0.0,left,\n";
        assert_eq!(written("e.csv"), format!("trace,step,kind,vertex,x,y,side,label\n{rows}"));
        let json = written("e.jsonl");
        let ends: Vec<&str> = json.lines().map(|line| line.split_once("\"side\":").unwrap().1).collect();
        assert_eq!(ends, [r#""left","label":"door, left"}"#, r#""left","label":null}"#]);
        written("e.parquet");
        let file = std::fs::File::open(folder.path().join("e.parquet")).unwrap();
        let batch = ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap().next().unwrap().unwrap();
        let labels: Vec<_> = batch.column_by_name("label").unwrap().as_string::<i32>().iter().collect();
        assert_eq!(labels, [Some("door, left"), None]);
    }
}
