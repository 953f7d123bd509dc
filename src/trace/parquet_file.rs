//! Traces as Parquet: columns `trace`, `x` and `y`, one row a point.

use std::borrow::Cow;
use std::fs::File;
use std::ops::Range;

use arrow_array::RecordBatch;
use glam::DVec2;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderOptions, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};

use super::gather::{ANCHOR, Gatherer, STEP};
use super::parquet_columns::{check_compression, coordinates, find, moves_anchor, whole};
use crate::caught::caught;
use crate::read_error::{Fault, Place};

/// Rows that are decoded at a time: few enough that their memory is used again and stays in the cache.
const BATCH: usize = 1 << 13;

/// The rows of a file under way.
pub(super) struct ParquetRows {
    batches: ParquetRecordBatchReader,
    moves_anchor: bool,
    rows: u64,
    read: u64,
}

impl ParquetRows {
    /// Reads the schema of `file`.
    pub(super) fn open(file: File) -> Result<Self, Fault> {
        let open = || {
            // Programs add their own types, such as categories. What Parquet itself says of the columns is enough.
            let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
            let builder = ParquetRecordBatchReaderBuilder::try_new_with_options(file, options)
                .map_err(|e| damaged(Place::default(), e))?;
            let columns = find(builder.schema()).map_err(|what| Fault::new(Place::default(), what))?;
            let moves_anchor = moves_anchor(builder.schema());
            check_compression(builder.metadata(), moves_anchor).map_err(|what| Fault::new(Place::default(), what))?;
            let mask = ProjectionMask::roots(builder.parquet_schema(), columns);
            let rows = builder.metadata().file_metadata().num_rows().try_into().unwrap_or(0);
            let builder = builder.with_projection(mask).with_batch_size(BATCH);
            let batches = builder.build().map_err(|e| damaged(Place::default(), e))?;
            Ok(ParquetRows { batches, moves_anchor, rows, read: 0 })
        };
        caught(open).unwrap_or_else(|panic| Err(damaged(Place::default(), panic)))
    }

    /// Whether the rows say where the anchor is.
    pub(super) fn moves_anchor(&self) -> bool {
        self.moves_anchor
    }

    /// Reads the next rows; false when there are no more. Not to be called after an error.
    pub(super) fn read(&mut self, gatherer: &mut Gatherer) -> Result<bool, Fault> {
        let first = self.read;
        let mut read = || {
            let Some(batch) = self.batches.next() else { return Ok(0) };
            let batch = batch.map_err(|e| damaged(Place::row(first), e))?;
            rows(&batch, self.moves_anchor, gatherer)
                .map_err(|(row, what)| Fault::new(Place::row(first + row as u64), what))?;
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

/// Adds a batch's rows; a fault comes with its row in the batch.
fn rows(batch: &RecordBatch, moves_anchor: bool, gatherer: &mut Gatherer) -> Result<(), (usize, String)> {
    let ids = whole(batch, "trace")?.ok_or_else(|| (0, "no column trace".to_owned()))?;
    let steps = whole(batch, STEP)?;
    let read = |[x, y]: [&str; 2]| Ok([coordinates(batch, x)?, coordinates(batch, y)?]);
    let free = read(["x", "y"])?;
    if !moves_anchor {
        return gatherer.extend(&ids, steps.as_deref(), |rows| points(&free, rows));
    }
    let anchors = read(ANCHOR)?;
    gatherer.extend_both(&ids, steps.as_deref(), |rows| points(&free, rows), |rows| points(&anchors, rows))
}

/// The points in some rows of two columns.
fn points<'a>([x, y]: &'a [Cow<'a, [f64]>; 2], rows: Range<usize>) -> impl Iterator<Item = DVec2> + 'a {
    x[rows.clone()].iter().zip(&y[rows]).map(|(&x, &y)| DVec2::new(x, y))
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use arrow_array::types::{Int8Type, Int64Type};
    use arrow_array::{
        ArrayRef, Decimal128Array, DictionaryArray, FixedSizeBinaryArray, Float32Array, Float64Array, Int8Array,
        Int16Array, Int32Array, Int64Array, StringArray, UInt8Array, UInt16Array, UInt32Array, UInt64Array,
    };
    use arrow_schema::{DataType, Field, Schema};
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

    #[test]
    fn columns_of_the_anchor_in_other_letters_are_named() {
        let ids = || Arc::new(UInt64Array::from(vec![0])) as ArrayRef;
        let of = |bx, by| {
            read(&bytes(vec![
                ("trace", ids()),
                ("x", f64s(&[1.0])),
                ("y", f64s(&[1.0])),
                (bx, f64s(&[0.0])),
                (by, f64s(&[0.0])),
            ]))
        };
        for [bx, by] in [["BX", "BY"], ["bx", "By"]] {
            let told = of(bx, by).unwrap_err();
            assert!(told.contains(&format!("the columns {bx} and {by}: write bx and by")), "{told}");
        }
        assert!(of("BX", "b").is_ok());
    }

    fn f64s(values: &[f64]) -> ArrayRef {
        Arc::new(Float64Array::from(values.to_vec()))
    }

    fn fault(columns: Vec<(&str, ArrayRef)>) -> String {
        read(&bytes(columns)).unwrap_err()
    }

    #[test]
    fn columns_are_found_by_name_and_ids_widened() {
        let categories = Int64Array::from(vec![9, 0]);
        let ids: [ArrayRef; 10] = [
            Arc::new(Int8Array::from(vec![0, 0, 9])),
            Arc::new(Int16Array::from(vec![0, 0, 9])),
            Arc::new(UInt8Array::from(vec![0, 0, 9])),
            Arc::new(UInt16Array::from(vec![0, 0, 9])),
            Arc::new(DictionaryArray::<Int8Type>::new(vec![1, 1, 0].into(), Arc::new(categories.clone()))),
            Arc::new(DictionaryArray::<Int64Type>::new(vec![1, 1, 0].into(), Arc::new(categories))),
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
        let decimal =
            || -> ArrayRef { Arc::new(Decimal128Array::from(vec![0]).with_precision_and_scale(38, 0).unwrap()) };
        let wide: ArrayRef = Arc::new(FixedSizeBinaryArray::try_from_iter([[0u8; 16]].iter()).unwrap());
        let text = || -> ArrayRef { Arc::new(StringArray::from(vec!["0"])) };
        for (columns, expected) in [
            (vec![("trace", ids()), ("x", x())], "no column y among trace, x; trace, x and y are needed"),
            (
                vec![("trace", x()), ("x", x()), ("y", x())],
                "column trace is Float64, as DuckDB writes HUGEINT; write it as a whole number of 64 bits, \
                 CAST(trace AS BIGINT)",
            ),
            (
                vec![("trace", decimal()), ("x", x()), ("y", x())],
                "column trace is Decimal128(38, 0); write it as a number of 64 bits, CAST(trace AS BIGINT)",
            ),
            (
                vec![("trace", ids()), ("x", x()), ("y", decimal())],
                "column y is Decimal128(38, 0); write it as a number of 64 bits, CAST(y AS DOUBLE)",
            ),
            (
                vec![("trace", wide), ("x", x()), ("y", x())],
                "column trace is FixedSizeBinary(16), as Polars writes Int128; write it as a whole number of 64 bits, \
                 cast(pl.Int64)",
            ),
            (
                vec![("trace", text()), ("x", x()), ("y", x())],
                "column trace is Utf8; write it as a whole number, best UInt64",
            ),
            (
                vec![("trace", ids()), ("x", text()), ("y", x())],
                "column x is Utf8; write it as Float64, so that results are exact",
            ),
            (
                vec![("trace", ids()), ("x", x()), ("y", x()), ("step", x())],
                "column step is Float64, as DuckDB writes HUGEINT; write it as a whole number of 64 bits, \
                 CAST(step AS BIGINT)",
            ),
        ] {
            assert_eq!(fault(columns), format!("t.parquet: {expected}"));
        }
        let both = Schema::new(vec![
            Field::new("trace", DataType::UInt64, false),
            Field::new("x", DataType::Float64, false),
            Field::new("x", DataType::Float64, false),
            Field::new("y", DataType::Float64, false),
        ]);
        assert_eq!(find(&both).unwrap_err(), "two columns x; there must be one");
    }

    #[test]
    fn coordinates_are_taken_exactly_as_they_stand() {
        let ids = || -> ArrayRef { Arc::new(UInt64Array::from(vec![0; 3])) };
        let read = |x: ArrayRef| read(&bytes(vec![("trace", ids()), ("x", x), ("y", f64s(&[0.0; 3]))]));
        let xs = |x: ArrayRef| read(x).unwrap()[0].points.iter().map(|p| p.x).collect::<Vec<_>>();
        assert_eq!(
            xs(Arc::new(Float32Array::from(vec![0.1, -0.0, 3e-39]))),
            [f64::from(0.1f32), 0.0, f64::from(3e-39f32)]
        );
        assert_eq!(xs(Arc::new(Int8Array::from(vec![-128, 0, 7]))), [-128.0, 0.0, 7.0]);
        assert_eq!(xs(Arc::new(UInt32Array::from(vec![u32::MAX, 0, 7]))), [f64::from(u32::MAX), 0.0, 7.0]);
        let most = 1i64 << 53;
        assert_eq!(
            xs(Arc::new(Int64Array::from(vec![most, -most, most + 2]))),
            [most as f64, -most as f64, (most + 2) as f64]
        );
        let e = read(Arc::new(Int64Array::from(vec![0, most, most + 1]))).unwrap_err();
        assert_eq!(e, "t.parquet: row 2: column x: 9007199254740993 has more digits than Float64; write it as Float64");
        assert!(read(Arc::new(UInt64Array::from(vec![0, 0, u64::MAX]))).unwrap_err().contains("row 2: column x"));
    }

    #[test]
    fn steps_are_looked_at_where_there_are_any() {
        let ids = || -> ArrayRef { Arc::new(UInt8Array::from(vec![0, 0, 1])) };
        let x = || f64s(&[0.0, 1.0, 2.0]);
        let with = |steps: ArrayRef| {
            read(&bytes(vec![("step", steps), ("trace", ids()), ("x", x()), ("y", x())])).map(|traces| traces.len())
        };
        assert_eq!(with(Arc::new(Int16Array::from(vec![3, 5, 0]))), Ok(2));
        let rule = "the rows of one trace must stand in the order of their steps, each once";
        let e = with(Arc::new(UInt64Array::from(vec![5, 3, 0]))).unwrap_err();
        assert_eq!(e, format!("t.parquet: row 1: trace 0: step 3 after step 5; {rule}"));
        let e = with(Arc::new(Int64Array::from(vec![0, 1, -1]))).unwrap_err();
        assert_eq!(e, "t.parquet: row 2: column step: -1 is not a whole number from 0");
        let e = with(Arc::new(Int64Array::from(vec![Some(0), None, Some(1)]))).unwrap_err();
        assert_eq!(e, "t.parquet: row 1: column step: null; every row needs a number");
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
