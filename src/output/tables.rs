//! Rows as Parquet, batch by batch.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch};
use arrow_schema::{Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::ArrowWriterOptions;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};

use super::{WholeFile, WriteError};

/// Rows, or wraps in rows, after which a batch is written as a row group: the bound on memory.
const BATCH: usize = 1 << 16;

/// Columns that gather rows.
pub(super) trait Columns {
    /// Name, type and whether null is allowed, for every column.
    fn fields(&self) -> Vec<Field>;
    /// How many values the longest column holds.
    fn len(&self) -> usize;
    /// The columns, in the order of the fields; what is left is empty.
    fn take(&mut self) -> Vec<ArrayRef>;
    /// How they are encoded, other than all are.
    fn properties(&self, builder: WriterPropertiesBuilder) -> WriterPropertiesBuilder {
        builder
    }
}

/// A Parquet file under way.
pub(super) struct Table<C> {
    pub(super) columns: C,
    schema: SchemaRef,
    writer: ArrowWriter<WholeFile>,
    path: PathBuf,
}

impl<C: Columns> Table<C> {
    pub(super) fn new(path: &Path, file: WholeFile, columns: C) -> Result<Self, WriteError> {
        let schema = Arc::new(Schema::new(columns.fields()));
        let properties =
            WriterProperties::builder().set_compression(Compression::SNAPPY).set_max_row_group_row_count(Some(BATCH));
        let properties = columns.properties(properties).build();
        // All types are Parquet's own, so readers need no copy of the Arrow schema.
        let options = ArrowWriterOptions::new().with_properties(properties).with_skip_arrow_metadata(true);
        let writer = ArrowWriter::try_new_with_options(file, schema.clone(), options).map_err(|e| error(path, e))?;
        Ok(Table { columns, schema, writer, path: path.to_owned() })
    }

    /// Notes something about the file in its footer.
    pub(super) fn note(&mut self, key: &str, value: &str) {
        self.writer.append_key_value_metadata(KeyValue::new(key.to_owned(), value.to_owned()));
    }

    /// The columns.
    pub(super) fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }

    /// Whether `schema` has the same columns.
    pub(super) fn has_columns(&self, schema: &Schema) -> bool {
        let columns = |schema: &Schema| {
            schema.fields().iter().map(|f| (f.name().clone(), f.data_type().clone())).collect::<Vec<_>>()
        };
        columns(schema) == columns(&self.schema)
    }

    /// Writes rows that are there already.
    pub(super) fn write(&mut self, rows: &RecordBatch) -> Result<(), WriteError> {
        self.writer.write(rows).map_err(|e| error(&self.path, e))
    }

    /// Writes the rows of these columns, which are like its own; row groups are as large as their properties say.
    pub(super) fn write_columns(&mut self, mut columns: C) -> Result<(), WriteError> {
        let rows = RecordBatch::try_new(self.schema(), columns.take()).map_err(|e| error(&self.path, e.into()))?;
        self.write(&rows)
    }

    pub(super) fn flush_if_full(&mut self) -> Result<(), WriteError> {
        if self.columns.len() < BATCH { Ok(()) } else { self.flush() }
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        let batch =
            RecordBatch::try_new(self.schema.clone(), self.columns.take()).map_err(|e| error(&self.path, e.into()))?;
        self.writer.write(&batch).and_then(|()| self.writer.flush()).map_err(|e| error(&self.path, e))
    }

    pub(super) fn complete(mut self) -> Result<WholeFile, WriteError> {
        if self.columns.len() > 0 {
            self.flush()?;
        }
        self.writer.into_inner().map_err(|e| error(&self.path, e))?.complete()
    }
}

/// The operating system's error out of the encoder's, where that is what it holds.
fn error(path: &Path, e: ParquetError) -> WriteError {
    let cause = match e {
        ParquetError::External(cause) => match cause.downcast::<std::io::Error>() {
            Ok(cause) => *cause,
            Err(cause) => std::io::Error::other(cause),
        },
        e => std::io::Error::other(e),
    };
    WriteError::io(path, cause)
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};

    use arrow_array::Array;
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, UInt32Type, UInt64Type};
    use arrow_schema::DataType;
    use glam::DVec2;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;
    use crate::output::columns::{EventColumns, ResultColumns};
    use crate::output::labels::Labels;
    use crate::output::text::Row;
    use crate::output::{write_events, write_results};
    use crate::rope::{Event, EventKind, Side, Status, TraceRecord};
    use crate::scene::Scene;

    fn record(trace: u64) -> TraceRecord {
        let odd = trace % 2 == 1;
        let side = if odd { Side::Left } else { Side::Right };
        let wraps = (0..trace % 4).map(|i| (DVec2::new(i as f64 + 0.1, -1e-7), side)).collect();
        let kind = if odd { EventKind::Wrap } else { EventKind::Unwrap };
        TraceRecord {
            trace,
            status: if odd { Status::Violation } else { Status::Ok },
            steps: 1 << 40,
            length: 5e-324,
            max_length: f64::MAX,
            depth: (trace % 4) as u32,
            max_depth: u32::MAX,
            wraps,
            pull: odd.then_some(DVec2::new(0.6, -0.8)),
            events: vec![Event { step: 7, kind, vertex: odd.into(), side }; 2],
        }
    }

    fn read(path: &Path) -> Vec<RecordBatch> {
        let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
        builder.with_batch_size(usize::MAX >> 1).build().unwrap().map(Result::unwrap).collect()
    }

    fn in_folder(name: &str, write: impl Fn(&Path)) -> (RecordBatch, Vec<u8>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        write(&path);
        let batches = read(&path);
        assert_eq!(batches.len(), 1);
        (batches[0].clone(), fs::read(&path).unwrap())
    }

    #[test]
    fn results_come_back_across_batches() {
        let count = BATCH + 10;
        let records: Vec<_> = (0..count as u64).map(record).collect();
        let scene = Scene::new([]).unwrap();
        let (batch, bytes) = in_folder("r.parquet", |path| write_results(path, &scene, &records).unwrap());
        assert_eq!(batch.num_rows(), count);
        assert_eq!(
            batch.schema().fields().iter().map(|f| f.name().as_str()).collect::<Vec<_>>(),
            [
                "trace",
                "status",
                "steps",
                "length",
                "max_length",
                "depth",
                "max_depth",
                "events",
                "wraps",
                "sides",
                "pull"
            ]
        );
        let column = |name: &str| batch.column_by_name(name).unwrap();
        assert_eq!(
            column("trace").as_primitive::<UInt64Type>().values().to_vec(),
            (0..count as u64).collect::<Vec<_>>()
        );
        for row in [0, 1, 2, 3, count / 2, count - 1] {
            let r = &records[row];
            assert_eq!(column("status").as_string::<i32>().value(row), r.status.name());
            assert_eq!(column("steps").as_primitive::<UInt64Type>().value(row), r.steps);
            assert_eq!(column("length").as_primitive::<Float64Type>().value(row), r.length);
            assert_eq!(column("max_length").as_primitive::<Float64Type>().value(row), r.max_length);
            assert_eq!(column("depth").as_primitive::<UInt32Type>().value(row), r.depth);
            assert_eq!(column("max_depth").as_primitive::<UInt32Type>().value(row), r.max_depth);
            assert_eq!(column("events").as_primitive::<UInt64Type>().value(row), 2);
            let wraps = column("wraps").as_list::<i32>().value(row);
            let [x, y] = [0, 1].map(|i| wraps.as_struct().column(i).as_primitive::<Float64Type>().clone());
            let sides = column("sides").as_list::<i32>().value(row);
            let sides = sides.as_string::<i32>();
            let found: Vec<_> = (0..x.len()).map(|i| (DVec2::new(x.value(i), y.value(i)), sides.value(i))).collect();
            assert_eq!(found, r.wraps.iter().map(|(at, side)| (*at, side.name())).collect::<Vec<_>>());
            let pull = column("pull").as_struct();
            let [x, y] = [0, 1].map(|i| pull.column(i).as_primitive::<Float64Type>().value(row));
            assert_eq!(pull.is_valid(row).then_some(DVec2::new(x, y)), r.pull);
        }
        let (_, again) = in_folder("r.parquet", |path| write_results(path, &scene, &records).unwrap());
        assert!(bytes == again, "the bytes depend on more than the records");
        // Where y points down, sides are those that a picture shows.
        let down = Scene::new([]).unwrap().with_y_down();
        let (batch, _) = in_folder("r.parquet", |path| write_results(path, &down, &records).unwrap());
        for row in 0..4 {
            let sides = batch.column_by_name("sides").unwrap().as_list::<i32>().value(row);
            let found: Vec<_> = sides.as_string::<i32>().iter().map(Option::unwrap).collect();
            assert_eq!(found, vec![if row % 2 == 1 { "right" } else { "left" }; row % 4]);
        }
    }

    #[test]
    fn events_come_back() {
        let scene = Scene::new([[DVec2::new(0.1, 0.2), DVec2::new(-3e100, 4.0)]]).unwrap();
        let records: Vec<_> = (0..3).map(record).collect();
        let (batch, _) = in_folder("e.parquet", |path| write_events(path, &scene, &records).unwrap());
        let column = |name: &str| batch.column_by_name(name).unwrap();
        assert_eq!(column("trace").as_primitive::<UInt64Type>().values().to_vec(), [0, 0, 1, 1, 2, 2]);
        assert_eq!(column("step").as_primitive::<UInt64Type>().values().to_vec(), [7; 6]);
        assert_eq!(column("vertex").as_primitive::<UInt32Type>().values().to_vec(), [0, 0, 1, 1, 0, 0]);
        assert_eq!(column("x").as_primitive::<Float64Type>().values()[1..3], [0.1, -3e100]);
        assert_eq!(column("y").as_primitive::<Float64Type>().values()[1..3], [0.2, 4.0]);
        let names =
            |name| column(name).as_string::<i32>().iter().map(Option::unwrap).skip(1).take(2).collect::<Vec<_>>();
        assert_eq!((names("kind"), names("side")), (vec!["unwrap", "wrap"], vec!["right", "left"]));
        let down = scene.clone().with_y_down();
        let (batch, _) = in_folder("e.parquet", |path| write_events(path, &down, &records).unwrap());
        let sides: Vec<_> =
            batch.column_by_name("side").unwrap().as_string::<i32>().iter().map(Option::unwrap).collect();
        assert_eq!(sides, ["left", "left", "right", "right", "left", "left"]);
    }

    #[test]
    fn a_file_without_rows_has_its_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.parquet");
        write_results(&path, &Scene::new([]).unwrap(), &[]).unwrap();
        let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(&path).unwrap()).unwrap();
        assert_eq!(builder.schema().fields().len(), 11);
        assert_eq!(builder.schema().field(0).data_type(), &DataType::UInt64);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_reported_and_leaves_the_target() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        fs::write(&path, "old").unwrap();
        let onto_full = || WholeFile::onto(&path, File::options().write(true).open("/dev/full").unwrap());
        let expected = format!("cannot write {}: No space left on device (os error 28)", path.display());

        let few =
            Table::new(&path, onto_full(), ResultColumns::new(&Labels::of(&Scene::new([]).unwrap()), false)).unwrap();
        assert_eq!(few.complete().unwrap_err().to_string(), expected);

        let mut many = Table::new(&path, onto_full(), EventColumns::default()).unwrap();
        let event = record(1).events[0];
        let failed = (0..1_000_000u64).find_map(|i| {
            let at = DVec2::new(i as f64, 0.0);
            many.columns.push(&Row { trace: i, event: &event, end: None, at, y_down: false, label: None });
            many.flush_if_full().err()
        });
        assert_eq!(failed.unwrap().to_string(), expected);
        assert!(many.complete().is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
