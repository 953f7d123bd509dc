//! Traces as Parquet: columns `trace`, `x` and `y`, one row a point.

use std::borrow::Cow;
use std::fs::File;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int32Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, PrimitiveArray, RecordBatch};
use arrow_schema::{DataType, Schema};
use glam::DVec2;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};

use super::gather::Gatherer;
use crate::caught::caught;
use crate::read_error::{Fault, Place};

/// Rows that are decoded at a time: few enough that their memory is used again and stays in the cache.
const BATCH: usize = 1 << 13;

const COLUMNS: [&str; 3] = ["trace", "x", "y"];

/// The rows of a file under way.
pub(super) struct ParquetRows {
    batches: ParquetRecordBatchReader,
    rows: u64,
    read: u64,
}

impl ParquetRows {
    /// Reads the schema of `file`.
    pub(super) fn open(file: File) -> Result<Self, Fault> {
        let open = || {
            let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|e| damaged(Place::default(), e))?;
            let columns = columns(builder.schema()).map_err(|what| Fault::new(Place::default(), what))?;
            let mask = ProjectionMask::roots(builder.parquet_schema(), columns);
            let rows = builder.metadata().file_metadata().num_rows().try_into().unwrap_or(0);
            let builder = builder.with_projection(mask).with_batch_size(BATCH);
            let batches = builder.build().map_err(|e| damaged(Place::default(), e))?;
            Ok(ParquetRows { batches, rows, read: 0 })
        };
        caught(open).unwrap_or_else(|panic| Err(damaged(Place::default(), panic)))
    }

    /// Reads the next rows; false when there are no more. Not to be called after an error.
    pub(super) fn read(&mut self, gatherer: &mut Gatherer) -> Result<bool, Fault> {
        let first = self.read;
        let mut read = || {
            let Some(batch) = self.batches.next() else { return Ok(0) };
            let batch = batch.map_err(|e| damaged(Place::row(first), e))?;
            rows(&batch, gatherer).map_err(|(row, what)| Fault::new(Place::row(first + row as u64), what))?;
            Ok(batch.num_rows())
        };
        let count = caught(&mut read).unwrap_or_else(|panic| Err(damaged(Place::default(), panic)))?;
        self.read += count as u64;
        Ok(count > 0)
    }

    /// How many rows the file has, as it says.
    pub(super) fn size(&self) -> u64 {
        self.rows
    }

    /// How many rows have been read.
    pub(super) fn position(&self) -> u64 {
        self.read
    }
}

fn damaged(place: Place, e: impl std::fmt::Display) -> Fault {
    Fault::new(place, format!("not Parquet, or damaged: {e}"))
}

/// The numbers of the columns trace, x and y in a schema, whose types must fit.
fn columns(schema: &Schema) -> Result<[usize; 3], String> {
    let mut columns = [0; 3];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        let Some((number, field)) = schema.column_with_name(name) else {
            let found: Vec<_> = schema.fields().iter().map(|f| f.name().as_str()).collect();
            return Err(format!("no column {name} among {}; trace, x and y are needed", found.join(", ")));
        };
        *column = number;
        let (fits, right) = match name {
            "trace" => (
                matches!(field.data_type(), DataType::UInt64 | DataType::UInt32 | DataType::Int64 | DataType::Int32),
                "a whole number, best UInt64",
            ),
            _ => (field.data_type() == &DataType::Float64, "Float64, so that results are exact"),
        };
        if !fits {
            return Err(format!("column {name} is {}; write it as {right}", field.data_type()));
        }
    }
    Ok(columns)
}

/// Adds a batch's rows; a fault comes with its row in the batch.
fn rows(batch: &RecordBatch, gatherer: &mut Gatherer) -> Result<(), (usize, String)> {
    let column = |name: &str| batch.column_by_name(name).ok_or_else(|| (0, format!("no column {name}")));
    let ids = ids(column("trace")?)?;
    let [x, y] = [column("x")?, column("y")?].map(|array| array.as_primitive::<Float64Type>());
    let first_null = |name: &str, array: &dyn Array| {
        let row = (0..array.len()).find(|&row| array.is_null(row));
        row.map_or(Ok(()), |row| Err((row, format!("column {name}: null; every row needs a number"))))
    };
    for (name, array) in [("x", x), ("y", y)] {
        if array.null_count() > 0 {
            first_null(name, array)?;
        }
    }
    let array = column("trace")?;
    if array.null_count() > 0 {
        first_null("trace", array)?;
    }
    let (x, y) = (x.values(), y.values());
    gatherer.extend(&ids, |rows| x[rows.clone()].iter().zip(&y[rows]).map(|(&x, &y)| DVec2::new(x, y)))
}

/// The traces' numbers; what stands in null rows is of no matter.
fn ids(array: &ArrayRef) -> Result<Cow<'_, [u64]>, (usize, String)> {
    fn widen<T: ArrowPrimitiveType>(array: &PrimitiveArray<T>) -> Result<Cow<'_, [u64]>, (usize, String)>
    where
        T::Native: TryInto<u64> + Copy + std::fmt::Display,
    {
        let wide = |(row, &id): (usize, &T::Native)| match id.try_into() {
            Ok(id) => Ok(id),
            Err(_) => Err((row, format!("column trace: {id} is not a whole number from 0"))),
        };
        array.values().iter().enumerate().map(wide).collect::<Result<Vec<u64>, _>>().map(Cow::Owned)
    }
    match array.data_type() {
        DataType::UInt32 => widen(array.as_primitive::<UInt32Type>()),
        DataType::Int32 => widen(array.as_primitive::<Int32Type>()),
        DataType::Int64 => widen(array.as_primitive::<Int64Type>()),
        _ => Ok(Cow::Borrowed(array.as_primitive::<UInt64Type>().values())),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use arrow_array::{Float32Array, Float64Array, Int32Array, Int64Array, StringArray, UInt32Array, UInt64Array};
    use parquet::arrow::ArrowWriter;

    use super::*;
    use crate::trace::Trace;

    fn bytes(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), None).unwrap();
        writer.write(&batch).unwrap();
        writer.into_inner().unwrap()
    }

    fn read(bytes: &[u8]) -> Result<Vec<Trace>, String> {
        let mut file = tempfile::tempfile().unwrap();
        std::io::Write::write_all(&mut file, bytes).unwrap();
        let path = Path::new("t.parquet");
        let mut gatherer = Gatherer::default();
        let read = || {
            let mut rows = ParquetRows::open(file)?;
            while rows.read(&mut gatherer)? {}
            Ok(())
        };
        read().map_err(|fault: Fault| fault.in_file(path).to_string())?;
        Ok(gatherer.take(usize::MAX, usize::MAX, true).unwrap_or_default())
    }

    fn f64s(values: &[f64]) -> ArrayRef {
        Arc::new(Float64Array::from(values.to_vec()))
    }

    fn fault(columns: Vec<(&str, ArrayRef)>) -> String {
        read(&bytes(columns)).unwrap_err()
    }

    #[test]
    fn columns_are_found_by_name_and_ids_widened() {
        let ids: [ArrayRef; 4] = [
            Arc::new(UInt64Array::from(vec![0, 0, 9])),
            Arc::new(UInt32Array::from(vec![0, 0, 9])),
            Arc::new(Int64Array::from(vec![0, 0, 9])),
            Arc::new(Int32Array::from(vec![0, 0, 9])),
        ];
        for ids in ids {
            let [x, y] = [f64s(&[0.1, 1e23, -0.0]), f64s(&[1.0, 2.0, 3.0])];
            let notes: ArrayRef = Arc::new(StringArray::from(vec![Some("a"), None, None]));
            let traces = read(&bytes(vec![("y", y), ("note", notes), ("trace", ids), ("x", x)])).unwrap();
            assert_eq!(traces.len(), 2);
            assert_eq!((traces[0].id, traces[1].id), (0, 9));
            assert_eq!(traces[0].points, [DVec2::new(0.1, 1.0), DVec2::new(1e23, 2.0)]);
            assert_eq!(traces[1].points[0].x.to_bits(), 0);
        }
        let none: ArrayRef = Arc::new(UInt64Array::from(Vec::<u64>::new()));
        assert!(read(&bytes(vec![("trace", none), ("x", f64s(&[])), ("y", f64s(&[]))])).unwrap().is_empty());
    }

    #[test]
    fn columns_that_do_not_fit_are_named() {
        let ids = || -> ArrayRef { Arc::new(UInt64Array::from(vec![0])) };
        let x = || f64s(&[0.0]);
        let narrow: ArrayRef = Arc::new(Float32Array::from(vec![0.0]));
        for (columns, expected) in [
            (vec![("trace", ids()), ("x", x())], "no column y among trace, x; trace, x and y are needed"),
            (
                vec![("trace", ids()), ("x", narrow), ("y", x())],
                "column x is Float32; write it as Float64, so that results are exact",
            ),
            (
                vec![("trace", x()), ("x", x()), ("y", x())],
                "column trace is Float64; write it as a whole number, best UInt64",
            ),
        ] {
            assert_eq!(fault(columns), format!("t.parquet: {expected}"));
        }
    }

    #[test]
    fn faults_name_their_row() {
        let ids = |ids: &[i64]| -> ArrayRef { Arc::new(Int64Array::from(ids.to_vec())) };
        let x = || f64s(&[0.0, 1.0, 2.0]);
        let gap: ArrayRef = Arc::new(Float64Array::from(vec![Some(0.0), None, Some(1.0)]));
        let no_id: ArrayRef = Arc::new(UInt64Array::from(vec![Some(0), Some(0), None]));
        let order = "the rows of one trace must follow each other, and the numbers increase";
        for (columns, expected) in [
            (
                vec![("trace", ids(&[0, 1, 0])), ("x", x()), ("y", x())],
                format!("row 2: trace 0 after trace 1; {order}"),
            ),
            (
                vec![("trace", ids(&[0, -1, 0])), ("x", x()), ("y", x())],
                "row 1: column trace: -1 is not a whole number from 0".into(),
            ),
            (
                vec![("trace", ids(&[0, 0, 0])), ("x", x()), ("y", f64s(&[0.0, 0.0, f64::INFINITY]))],
                "row 2: column y: inf is not a finite number".into(),
            ),
            (
                vec![("trace", ids(&[0, 0, 0])), ("x", x()), ("y", gap)],
                "row 1: column y: null; every row needs a number".into(),
            ),
            (
                vec![("trace", no_id), ("x", x()), ("y", x())],
                "row 2: column trace: null; every row needs a number".into(),
            ),
        ] {
            assert_eq!(fault(columns), format!("t.parquet: {expected}"));
        }
    }

    #[test]
    fn rows_count_across_batches() {
        let n = BATCH + 5;
        let mut x = vec![0.5; n];
        x[n - 1] = f64::NAN;
        let ids: ArrayRef = Arc::new(UInt64Array::from(vec![0; n]));
        let e = fault(vec![("trace", ids), ("x", f64s(&x)), ("y", f64s(&vec![0.0; n]))]);
        assert_eq!(e, format!("t.parquet: row {}: column x: NaN is not a finite number", n - 1));
    }

    #[test]
    fn damaged_files_are_errors() {
        let ids: ArrayRef = Arc::new(UInt64Array::from(vec![0; 50]));
        let good = bytes(vec![("trace", ids), ("x", f64s(&[0.25; 50])), ("y", f64s(&[0.5; 50]))]);
        assert!(read(&good).is_ok());
        for bad in [&b""[..], b"trace,x,y\n0,0,0\n", b"PAR1PAR1", &good[..good.len() - 9], &good[9..]] {
            let e = read(bad).unwrap_err();
            assert!(e.starts_with("t.parquet: ") && e.contains("not Parquet, or damaged: "), "{e}");
        }
    }

    #[test]
    fn no_changed_byte_makes_a_panic() {
        let ids: ArrayRef = Arc::new(UInt64Array::from(vec![0; 50]));
        let good = bytes(vec![("trace", ids), ("x", f64s(&[0.25; 50])), ("y", f64s(&[0.5; 50]))]);
        let mut errors = 0;
        for i in 0..good.len() {
            for change in [0x01, 0x04, 0x10, 0x80, 0xff] {
                let mut bad = good.clone();
                bad[i] ^= change;
                errors += usize::from(read(&bad).is_err());
            }
        }
        assert!(errors > good.len());
    }
}
