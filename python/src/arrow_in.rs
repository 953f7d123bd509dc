//! Tables that are handed over by the Arrow C stream interface, as rows of traces.

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{ArrayStreamReader, FFI_ArrowArrayStream};
use arrow_array::types::{
    ArrowPrimitiveType, Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type,
    Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayReader, ArrayRef};
use arrow_schema::{DataType, Fields};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

use crate::fault::Fault;
use crate::traces::Rows;

/// Takes the stream out of what `__arrow_c_stream__` returned, and reads it to its end.
pub(crate) fn rows(py: Python<'_>, capsule: &Bound<'_, PyCapsule>) -> PyResult<Rows> {
    let stream = capsule.pointer_checked(Some(c"arrow_array_stream"))?.cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of this name holds a stream; it is moved out, and what stays behind is marked as released. The
    // lock of the interpreter, which is held, keeps others from doing the same.
    #[allow(unsafe_code)]
    let reader = unsafe { ArrayStreamReader::from_raw(stream.as_ptr()) };
    let reader = reader.map_err(|error| {
        Fault::input(format!("{error}; a stream can be read once: hand over the table itself, or a new stream"))
    })?;
    // Whoever makes the batches may need the lock for that.
    Ok(py.detach(|| read(reader))?)
}

fn read(reader: ArrayStreamReader) -> Result<Rows, Fault> {
    let fields = match reader.field().data_type() {
        DataType::Struct(fields) => fields.clone(),
        other => return Err(Fault::input(format!("a table with the columns trace, x and y is needed, not {other}"))),
    };
    let columns = find(&fields)?;
    let mut rows = Rows { step: columns[3].map(|_| Vec::new()), ..Rows::default() };
    for batch in reader {
        let batch = batch.map_err(|error| Fault::input(format!("the table cannot be read: {error}")))?;
        let first = rows.trace.len() as u64;
        let in_row = |(row, what): (usize, String)| {
            let row = first + row as u64;
            Fault::input(format!("row {row}: {what}")).number("row", row)
        };
        // Before the columns: they know nothing of it.
        no_nulls(&batch, "the row").map_err(in_row)?;
        let table = batch.as_struct();
        let column = |i: usize| columns[i].map(|number| table.column(number));
        if let Some(trace) = column(0) {
            whole(trace, "trace", &mut rows.trace).map_err(in_row)?;
        }
        if let Some(x) = column(1) {
            coordinates(x, "x", &mut rows.x).map_err(in_row)?;
        }
        if let Some(y) = column(2) {
            coordinates(y, "y", &mut rows.y).map_err(in_row)?;
        }
        if let (Some(step), Some(steps)) = (column(3), &mut rows.step) {
            whole(step, "step", steps).map_err(in_row)?;
        }
    }
    Ok(rows)
}

/// The numbers of the columns `trace`, `x`, `y`, and of `step` if it is there.
fn find(fields: &Fields) -> Result<[Option<usize>; 4], Fault> {
    let mut columns = [None; 4];
    for (name, column) in ["trace", "x", "y", "step"].into_iter().zip(&mut columns) {
        let mut found = (0..fields.len()).filter(|&i| fields[i].name() == name);
        *column = found.next();
        if found.next().is_some() {
            return Err(Fault::input(format!("two columns {name}; there must be one")));
        }
        if column.is_none() && name != "step" {
            let all: Vec<_> = fields.iter().map(|field| field.name().as_str()).collect();
            return Err(Fault::input(format!("no column {name} among {}; trace, x and y are needed", all.join(", "))));
        }
    }
    Ok(columns)
}

/// A fault with its row in the batch.
type InRow = (usize, String);

fn no_nulls(array: &dyn Array, name: &str) -> Result<(), InRow> {
    // Of a dictionary its values may be null, too.
    match array.logical_nulls().filter(|nulls| nulls.null_count() > 0) {
        None => Ok(()),
        Some(nulls) => {
            let row = (0..nulls.len()).find(|&row| nulls.is_null(row)).unwrap_or_default();
            Err((row, format!("{name} is null; every row needs numbers")))
        }
    }
}

/// Adds the whole numbers from 0 in a column.
fn whole(array: &ArrayRef, name: &str, to: &mut Vec<u64>) -> Result<(), InRow> {
    no_nulls(array, &format!("column {name}"))?;
    let refused = |kind: &DataType| (0, format!("column {name} is {kind}; whole numbers are needed, best UInt64"));
    fn add<T: ArrowPrimitiveType>(array: &ArrayRef, name: &str, to: &mut Vec<u64>) -> Result<(), InRow>
    where
        T::Native: TryInto<u64> + Copy + std::fmt::Display,
    {
        for (row, &number) in array.as_primitive::<T>().values().iter().enumerate() {
            let wrong = |_| (row, format!("column {name}: {number} is not a whole number from 0 to 2^64 - 1"));
            to.push(number.try_into().map_err(wrong)?);
        }
        Ok(())
    }
    match array.data_type() {
        DataType::Int8 => add::<Int8Type>(array, name, to),
        DataType::Int16 => add::<Int16Type>(array, name, to),
        DataType::Int32 => add::<Int32Type>(array, name, to),
        DataType::Int64 => add::<Int64Type>(array, name, to),
        DataType::UInt8 => add::<UInt8Type>(array, name, to),
        DataType::UInt16 => add::<UInt16Type>(array, name, to),
        DataType::UInt32 => add::<UInt32Type>(array, name, to),
        DataType::UInt64 => {
            to.extend_from_slice(array.as_primitive::<UInt64Type>().values());
            Ok(())
        }
        // What DuckDB's sum gives.
        DataType::Decimal128(_, 0) => add::<Decimal128Type>(array, name, to),
        DataType::Dictionary(_, of) => {
            let dictionary = array.as_any_dictionary();
            let mut values = Vec::new();
            if dictionary.values().null_count() > 0 {
                return Err((0, format!("column {name}: its categories have a null among them")));
            }
            match **of {
                DataType::Dictionary(..) => return Err(refused(array.data_type())),
                _ => whole(dictionary.values(), name, &mut values).map_err(|(_, what)| (0, what))?,
            }
            for (row, key) in dictionary.normalized_keys().into_iter().enumerate() {
                let wrong = || (row, format!("column {name}: there is no category {key}"));
                to.push(*values.get(key).ok_or_else(wrong)?);
            }
            Ok(())
        }
        kind => Err(refused(kind)),
    }
}

/// Adds the coordinates in a column, each exactly as it stands there.
fn coordinates(array: &ArrayRef, name: &str, to: &mut Vec<f64>) -> Result<(), InRow> {
    no_nulls(array, &format!("column {name}"))?;
    fn add<T: ArrowPrimitiveType>(array: &ArrayRef, to: &mut Vec<f64>, wide: impl Fn(T::Native) -> f64) {
        to.extend(array.as_primitive::<T>().values().iter().map(|&number| wide(number)));
    }
    fn exact<T: ArrowPrimitiveType>(array: &ArrayRef, name: &str, to: &mut Vec<f64>) -> Result<(), InRow>
    where
        T::Native: Into<i128> + Copy,
    {
        for (row, &number) in array.as_primitive::<T>().values().iter().enumerate() {
            let number: i128 = number.into();
            match number as f64 {
                x if x as i128 == number => to.push(x),
                _ => return Err((row, format!("column {name}: {number} has more digits than Float64"))),
            }
        }
        Ok(())
    }
    match array.data_type() {
        DataType::Float64 => to.extend_from_slice(array.as_primitive::<Float64Type>().values()),
        DataType::Float32 => add::<Float32Type>(array, to, f64::from),
        DataType::Float16 => add::<Float16Type>(array, to, |x| x.to_f64()),
        DataType::Int8 => exact::<Int8Type>(array, name, to)?,
        DataType::Int16 => exact::<Int16Type>(array, name, to)?,
        DataType::Int32 => exact::<Int32Type>(array, name, to)?,
        DataType::Int64 => exact::<Int64Type>(array, name, to)?,
        DataType::UInt8 => exact::<UInt8Type>(array, name, to)?,
        DataType::UInt16 => exact::<UInt16Type>(array, name, to)?,
        DataType::UInt32 => exact::<UInt32Type>(array, name, to)?,
        DataType::UInt64 => exact::<UInt64Type>(array, name, to)?,
        kind => return Err((0, format!("column {name} is {kind}; cast it to Float64"))),
    }
    Ok(())
}
