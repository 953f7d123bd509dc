//! Results: one row a trace.

use std::path::Path;

use super::class_columns::{NAMES, shown};
use super::columns::ResultColumns;
use super::labels::Labels;
use super::rows::Rows;
use super::{CHUNK, WholeFile, WriteError, text};
use crate::homotopy::{Class, Classes};
use crate::rope::TraceRecord;
use crate::scene::Scene;
use crate::trace::SettledTrace;

/// Writes results one by one to a file that appears when it is finished.
///
/// - `.jsonl`: one object a line: `trace`, `status`, `steps`, `length`, `max_length`, `depth`, `max_depth`, `events`
///   (how many), `wraps` (positions `[x,y]` from the anchor), `sides`, `pull` (`[x,y]` or null).
/// - `.csv`: the same columns, `wraps` as `1.0 2.0;3.5 -1.25`, `sides` as `left;right`, the pull as `pull_x` and
///   `pull_y`, both empty for a rope of no length.
/// - `.parquet`: `wraps` as a list of structs of `x` and `y`, `pull` as such a struct or null. Parquet itself has
///   structs but no lists of fixed size, so this reads alike in pandas, polars and DuckDB.
///
/// Where the scene's wall ends have labels, `labels` follows: for each of the `wraps` its label or null; in `.csv` that
/// list as JSON.
///
/// Lengths are in the scene's unit. `sides` are `left` and `right` as a picture of the scene shows them, so where y
/// points down ([`Scene::y_down`]) they are not those of the records, which count as if it pointed up. Memory is
/// bounded; it does not grow with the number of results.
pub struct ResultWriter {
    rows: Rows<ResultColumns>,
    labels: Labels,
}

impl ResultWriter {
    /// Starts the file at `path`, in the format that its extension names, for ropes in `scene`. O(walls).
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create(path: &Path, scene: &Scene) -> Result<Self, WriteError> {
        Self::with(path, scene, false)
    }

    /// The same with two more columns at the end, to which [`write_classes`](Self::write_classes) adds rows: `class`,
    /// the rope's [`Class`] as text, and `windings`, how often it winds about each obstacle, where that is not 0. In
    /// `.jsonl` these are objects of `obstacle` and `turns`, in `.csv` they look like `4 1;17 -2`, in `.parquet` they
    /// are a list of structs. Both are null, in `.csv` empty, where the trace crosses a wall, and as a picture shows
    /// them.
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create_with_classes(path: &Path, scene: &Scene) -> Result<Self, WriteError> {
        Self::with(path, scene, true)
    }

    fn with(path: &Path, scene: &Scene, with_classes: bool) -> Result<Self, WriteError> {
        let labels = Labels::of(scene);
        let more = (!labels.is_empty()).then_some("labels").into_iter();
        let more = more.chain(NAMES.into_iter().filter(|_| with_classes));
        let header = more.fold(text::RESULT_HEADER.to_owned(), |header, name| format!("{header},{name}"));
        let columns = ResultColumns::new(&labels, with_classes);
        Ok(ResultWriter { rows: Rows::create(path, &header, columns)?, labels })
    }

    /// Adds one result in that scene.
    ///
    /// # Errors
    ///
    /// What the operating system says; the file cannot be finished after that.
    pub fn write(&mut self, scene: &Scene, record: &TraceRecord) -> Result<(), WriteError> {
        self.write_all(scene, std::slice::from_ref(record))
    }

    /// Adds results; the bytes are the same as one by one. Text is made on all cores and held until it is written.
    ///
    /// # Errors
    ///
    /// Those of [`write`](Self::write).
    pub fn write_all(&mut self, scene: &Scene, records: &[TraceRecord]) -> Result<(), WriteError> {
        let (y_down, labels) = (scene.y_down(), &self.labels);
        self.rows.write_all(
            records,
            |text, record| text::result_json(text, y_down, record, labels, None),
            |text, record| text::result_csv(text, y_down, record, labels, None),
            |table, record| {
                table.columns.push(y_down, record, labels, None);
                table.flush_if_full()
            },
        )
    }

    /// Adds results to a file [with classes](Self::create_with_classes), each with its trace, in the scene of the
    /// model of `classes`. O(events), and as [`Classes::of`] for each, on all threads.
    ///
    /// # Errors
    ///
    /// Those of [`write`](Self::write).
    ///
    /// # Panics
    ///
    /// As [`Classes::of_record`], if a record is not that of its trace.
    pub fn write_classes(
        &mut self,
        classes: &Classes,
        traces: &[SettledTrace],
        records: &[TraceRecord],
    ) -> Result<(), WriteError> {
        let (y_down, labels) = (classes.model().scene().y_down(), &self.labels);
        let all = shown(classes, traces, records);
        let rows: Vec<(&TraceRecord, Option<&Class>)> = records.iter().zip(all.iter().map(Option::as_ref)).collect();
        self.rows.write_all(
            &rows,
            |text, &(record, class)| text::result_json(text, y_down, record, labels, Some(class)),
            |text, &(record, class)| text::result_csv(text, y_down, record, labels, Some(class)),
            |table, &(record, class)| {
                table.columns.push(y_down, record, labels, class);
                table.flush_if_full()
            },
        )
    }

    /// Notes something about the results, where they come from say, in the metadata of a Parquet file; the other
    /// formats have no place for it.
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

/// Writes all `records` in `scene` to `path`, as [`ResultWriter`] does.
///
/// # Errors
///
/// Those of [`check_output`](super::check_output), and what the operating system says.
pub fn write_results(path: &Path, scene: &Scene, records: &[TraceRecord]) -> Result<(), WriteError> {
    let mut writer = ResultWriter::create(path, scene)?;
    records.chunks(CHUNK).try_for_each(|records| writer.write_all(scene, records))?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use arrow_array::cast::AsArray;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;
    use crate::rope::{Event, EventKind, Side, Status};
    use crate::scene::{Object, Wall};

    fn records() -> Vec<TraceRecord> {
        let event = Event { step: 1, kind: EventKind::Wrap, vertex: 0, side: Side::Left };
        let full = TraceRecord {
            trace: 0,
            status: Status::Ok,
            steps: 400,
            length: 12.375,
            max_length: 14.5,
            depth: 3,
            max_depth: 5,
            wraps: vec![([1.0, 2.0].into(), Side::Left), ([3.5, -1.25].into(), Side::Right)],
            pull: Some([0.6, 0.8].into()),
            events: vec![event; 17],
        };
        let empty = TraceRecord {
            trace: u64::MAX,
            status: Status::Violation,
            length: 5e-324,
            max_length: f64::MAX,
            wraps: Vec::new(),
            pull: None,
            events: Vec::new(),
            ..full
        };
        vec![full, empty]
    }

    fn written(name: &str, records: &[TraceRecord]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        write_results(&path, &Scene::new([]).unwrap(), records).unwrap();
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn json_lines_have_the_documented_form() {
        let full = concat!(
            r#"{"trace":0,"status":"ok","steps":400,"length":12.375,"max_length":14.5,"depth":3,"max_depth":5,"#,
            r#""events":17,"wraps":[[1.0,2.0],[3.5,-1.25]],"sides":["left","right"],"pull":[0.6,0.8]}"#,
        );
        let empty = concat!(
            r#"{"trace":18446744073709551615,"status":"violation","steps":400,"length":5e-324,"#,
            r#""max_length":1.7976931348623157e+308,"depth":3,"max_depth":5,"events":0,"#,
            r#""wraps":[],"sides":[],"pull":null}"#,
        );
        let text = written("r.jsonl", &records());
        assert_eq!(text, format!("{full}\n{empty}\n"));
        assert_eq!(written("r.jsonl", &[]), "");
    }

    #[test]
    fn csv_has_the_documented_form() {
        let rows = written("r.csv", &records());
        let full = "0,ok,400,12.375,14.5,3,5,17,1.0 2.0;3.5 -1.25,left;right,0.6,0.8";
        let empty = "18446744073709551615,violation,400,5e-324,1.7976931348623157e+308,3,5,0,,,,";
        assert_eq!(rows, format!("{}\n{full}\n{empty}\n", text::RESULT_HEADER));
        assert_eq!(written("r.csv", &[]), format!("{}\n", text::RESULT_HEADER));
    }

    #[test]
    fn a_writer_that_is_not_finished_leaves_nothing() {
        let (folder, scene) = (tempfile::tempdir().unwrap(), Scene::new([]).unwrap());
        for name in ["r.csv", "r.jsonl", "r.parquet"] {
            let mut writer = ResultWriter::create(&folder.path().join(name), &scene).unwrap();
            writer.write(&scene, &records()[0]).unwrap();
            drop(writer);
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }

    #[test]
    fn wall_ends_that_have_names_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let object = |label: Option<&str>| Object { label: label.map(str::to_owned), ..Object::default() };
        let wall = |from: [f64; 2], object| Wall { ends: [from.into(), [9.0, 9.0].into()], object, reversed: false };
        let objects = vec![object(Some("a \"b\", c")), object(None)];
        let scene = Scene::of(objects, [wall([1.0, 2.0], 0), wall([3.5, -1.25], 1)]).unwrap();
        let written = |name: &str| {
            let path = folder.path().join(name);
            let mut writer = ResultWriter::create(&path, &scene).unwrap();
            writer.write_all(&scene, &records()).unwrap();
            writer.finish().unwrap();
            std::fs::read(path).unwrap()
        };
        let text = |name: &str| String::from_utf8(written(name)).unwrap();
        let json = text("r.jsonl");
        let ends: Vec<&str> = json.lines().map(|line| line.split_once("\"pull\":").unwrap().1).collect();
        assert_eq!(ends, [r#"[0.6,0.8],"labels":["a \"b\", c",null]}"#, r#"null,"labels":[]}"#]);
        let csv = text("r.csv");
        let mut lines = csv.lines();
        assert!(lines.next().unwrap().ends_with(",pull_x,pull_y,labels"));
        assert!(lines.next().unwrap().ends_with(r#",0.6,0.8,"[""a \""b\"", c"",null]""#), "{csv}");
        assert!(lines.next().unwrap().ends_with(",,,[]"), "{csv}");
        written("r.parquet");
        let file = std::fs::File::open(folder.path().join("r.parquet")).unwrap();
        let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
        let batch = reader.build().unwrap().next().unwrap().unwrap();
        let labels = batch.column_by_name("labels").unwrap().as_list::<i32>().value(0);
        let labels: Vec<_> = labels.as_string::<i32>().iter().map(|label| label.map(str::to_owned)).collect();
        assert_eq!(labels, [Some("a \"b\", c".to_owned()), None]);
    }
}
