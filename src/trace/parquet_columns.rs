//! The columns of Parquet files that hold traces: which types they may have, and their values as numbers.

use std::borrow::Cow;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_schema::{DataType, Schema};
use parquet::basic::Compression;
use parquet::file::metadata::ParquetMetaData;

use super::gather::{ANCHOR, STEP, meant};

/// The columns; those from the fourth on may be missing.
const COLUMNS: [&str; 6] = ["trace", "x", "y", STEP, ANCHOR[0], ANCHOR[1]];

/// Whether rows say where the anchor is. Either of the two columns alone is some other one.
pub(super) fn moves_anchor(schema: &Schema) -> bool {
    ANCHOR.iter().all(|column| schema.fields().iter().any(|field| field.name() == column))
}

/// A fault with its row in the batch.
type InRow = (usize, String);

/// The columns that are read.
fn read(moves_anchor: bool) -> impl Iterator<Item = &'static str> {
    COLUMNS.into_iter().filter(move |name| moves_anchor || !ANCHOR.contains(name))
}

/// The numbers of the columns in a schema, whose types must fit.
pub(super) fn find(schema: &Schema) -> Result<Vec<usize>, String> {
    let mut columns = Vec::new();
    let names: Vec<&String> = schema.fields().iter().map(|field| field.name()).collect();
    if let Some(fault) = meant(&names).filter(|_| !moves_anchor(schema)) {
        return Err(fault);
    }
    for name in read(moves_anchor(schema)) {
        let mut found = (0..schema.fields().len()).filter(|&i| schema.field(i).name() == name);
        let number = match (found.next(), found.next()) {
            (Some(number), None) => number,
            (None, _) if name == STEP => continue,
            (None, _) => {
                let all: Vec<_> = schema.fields().iter().map(|f| f.name().as_str()).collect();
                return Err(format!("no column {name} among {}; trace, x and y are needed", all.join(", ")));
            }
            (Some(_), Some(_)) => return Err(format!("two columns {name}; there must be one")),
        };
        let kind = schema.field(number).data_type();
        let whole = name == "trace" || name == STEP;
        if !(kind.is_integer() || (!whole && kind.is_floating())) {
            return Err(wrong_type(name, kind, whole));
        }
        columns.push(number);
    }
    Ok(columns)
}

/// What is said of a column of another type, with the cast that helps where programs write such columns unasked.
fn wrong_type(name: &str, kind: &DataType, whole: bool) -> String {
    let cast = if whole { "BIGINT" } else { "DOUBLE" };
    let (is, how) = match kind {
        DataType::Float64 => {
            (format!("{kind}, as DuckDB writes HUGEINT"), format!("a whole number of 64 bits, CAST({name} AS BIGINT)"))
        }
        DataType::FixedSizeBinary(16) => {
            (format!("{kind}, as Polars writes Int128"), "a whole number of 64 bits, cast(pl.Int64)".to_owned())
        }
        DataType::Float16 | DataType::Float32 => (kind.to_string(), format!("a whole number, CAST({name} AS {cast})")),
        DataType::Decimal32(..) | DataType::Decimal64(..) | DataType::Decimal128(..) | DataType::Decimal256(..) => {
            (kind.to_string(), format!("a number of 64 bits, CAST({name} AS {cast})"))
        }
        _ if whole => (kind.to_string(), "a whole number, best UInt64".to_owned()),
        _ => (kind.to_string(), "Float64, so that results are exact".to_owned()),
    };
    format!("column {name} is {is}; write it as {how}")
}

/// Refuses a compression that is not read here, before it looks like damage.
pub(super) fn check_compression(metadata: &ParquetMetaData, moves_anchor: bool) -> Result<(), String> {
    for column in metadata.row_groups().iter().flat_map(|group| group.columns()) {
        let name = column.column_path().string();
        let by = match column.compression() {
            Compression::BROTLI(_) => "Brotli",
            Compression::LZO => "LZO",
            _ => continue,
        };
        if read(moves_anchor).any(|column| column == name) {
            let what = "which is not read here; write the file with zstd or snappy compression";
            return Err(format!("column {name} is compressed with {by}, {what}"));
        }
    }
    Ok(())
}

/// The whole numbers from 0 in a column; `None` if there is no such column.
pub(super) fn whole<'a>(batch: &'a RecordBatch, name: &str) -> Result<Option<Cow<'a, [u64]>>, InRow> {
    fn wide<'a, T: ArrowPrimitiveType>(array: &'a dyn Array, name: &str) -> Result<Cow<'a, [u64]>, InRow>
    where
        T::Native: TryInto<u64> + Copy + std::fmt::Display,
    {
        let wide = |(row, &number): (usize, &T::Native)| match number.try_into() {
            Ok(number) => Ok(number),
            Err(_) => Err((row, format!("column {name}: {number} is not a whole number from 0"))),
        };
        let values = array.as_primitive::<T>().values().iter().enumerate();
        values.map(wide).collect::<Result<Vec<u64>, _>>().map(Cow::Owned)
    }
    let Some(array) = batch.column_by_name(name) else { return Ok(None) };
    no_nulls(array, name)?;
    let numbers = match array.data_type() {
        DataType::Int8 => wide::<Int8Type>(array, name),
        DataType::Int16 => wide::<Int16Type>(array, name),
        DataType::Int32 => wide::<Int32Type>(array, name),
        DataType::Int64 => wide::<Int64Type>(array, name),
        DataType::UInt8 => wide::<UInt8Type>(array, name),
        DataType::UInt16 => wide::<UInt16Type>(array, name),
        DataType::UInt32 => wide::<UInt32Type>(array, name),
        _ => Ok(Cow::Borrowed(&array.as_primitive::<UInt64Type>().values()[..])),
    };
    numbers.map(Some)
}

/// The coordinates in a column, each exactly as it stands there.
pub(super) fn coordinates<'a>(batch: &'a RecordBatch, name: &str) -> Result<Cow<'a, [f64]>, InRow> {
    fn wide<'a, T: ArrowPrimitiveType>(array: &'a dyn Array, to: impl Fn(T::Native) -> f64) -> Cow<'a, [f64]> {
        Cow::Owned(array.as_primitive::<T>().values().iter().map(|&number| to(number)).collect())
    }
    let array = batch.column_by_name(name).ok_or_else(|| (0, format!("no column {name}")))?;
    no_nulls(array, name)?;
    let exact = |row: usize, number: i128| match number as f64 {
        x if x as i128 == number => Ok(x),
        _ => Err((row, format!("column {name}: {number} has more digits than Float64; write it as Float64"))),
    };
    Ok(match array.data_type() {
        DataType::Float16 => wide::<Float16Type>(array, |x| x.to_f64()),
        DataType::Float32 => wide::<Float32Type>(array, f64::from),
        DataType::Int8 => wide::<Int8Type>(array, f64::from),
        DataType::Int16 => wide::<Int16Type>(array, f64::from),
        DataType::Int32 => wide::<Int32Type>(array, f64::from),
        DataType::UInt8 => wide::<UInt8Type>(array, f64::from),
        DataType::UInt16 => wide::<UInt16Type>(array, f64::from),
        DataType::UInt32 => wide::<UInt32Type>(array, f64::from),
        DataType::Int64 => {
            let values = array.as_primitive::<Int64Type>().values().iter().enumerate();
            Cow::Owned(values.map(|(row, &n)| exact(row, n.into())).collect::<Result<_, _>>()?)
        }
        DataType::UInt64 => {
            let values = array.as_primitive::<UInt64Type>().values().iter().enumerate();
            Cow::Owned(values.map(|(row, &n)| exact(row, n.into())).collect::<Result<_, _>>()?)
        }
        _ => Cow::Borrowed(&array.as_primitive::<Float64Type>().values()[..]),
    })
}

fn no_nulls(array: &dyn Array, name: &str) -> Result<(), InRow> {
    if array.null_count() == 0 {
        return Ok(());
    }
    let row = (0..array.len()).find(|&row| array.is_null(row)).unwrap_or_default();
    Err((row, format!("column {name}: null; every row needs a number")))
}
