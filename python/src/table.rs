//! Tables in memory, handed on by the Arrow C stream interface, as arrays, and as bytes.

use std::collections::HashMap;
use std::fs::File;
use std::path::PathBuf;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{
    Array, ArrayRef, ArrowPrimitiveType, RecordBatch, RecordBatchIterator, RecordBatchOptions, RecordBatchReader,
};
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, SchemaRef};
use numpy::{Element, PyArray1, PyArrayMethods};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyList};

use crate::fault::Fault;

/// A table in memory.
#[pyclass(module = "tautrope._tautrope", frozen)]
#[derive(Clone)]
pub(crate) struct Table {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

impl Table {
    pub(crate) fn of((schema, batches): (SchemaRef, Vec<RecordBatch>)) -> Self {
        Table { schema, batches }
    }

    pub(crate) fn ipc(&self) -> Result<Vec<u8>, Fault> {
        let mut writer = StreamWriter::try_new(Vec::new(), &self.schema).map_err(wrong)?;
        self.batches.iter().try_for_each(|batch| writer.write(batch)).map_err(wrong)?;
        writer.into_inner().map_err(wrong)
    }

    pub(crate) fn from_ipc(bytes: &[u8]) -> Result<Self, Fault> {
        let reader = StreamReader::try_new(bytes, None).map_err(wrong)?;
        let schema = reader.schema();
        Ok(Table { schema, batches: reader.collect::<Result<_, _>>().map_err(wrong)? })
    }

    fn column(&self, number: usize) -> impl Iterator<Item = &ArrayRef> {
        self.batches.iter().map(move |batch| batch.column(number))
    }
}

fn wrong(error: ArrowError) -> Fault {
    Fault::input(format!("a table: {error}"))
}

#[pymethods]
impl Table {
    /// The rows of a Parquet file.
    #[staticmethod]
    fn of_parquet(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let shown = path.display().to_string();
        let failed = |error: &dyn std::fmt::Display| Fault::new("ReadError", format!("cannot read {shown}: {error}"));
        let read = || {
            let file = File::open(&path).map_err(|error| failed(&error))?;
            let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| failed(&error))?;
            let schema = builder.schema().clone();
            let reader = builder.with_batch_size(1 << 16).build().map_err(|error| failed(&error))?;
            let batches = reader.collect::<Result<_, _>>().map_err(|error| failed(&error))?;
            Ok::<_, Fault>(Table { schema, batches })
        };
        Ok(py.detach(read)?)
    }

    /// What `to_ipc` gave.
    #[staticmethod]
    fn of_ipc(bytes: &[u8]) -> PyResult<Self> {
        Ok(Table::from_ipc(bytes)?)
    }

    /// The table as bytes: an Arrow IPC stream.
    fn to_ipc<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.ipc()?))
    }

    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    /// The names of the columns.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// A new stream of the table. No other schema can be had than its own.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets who makes a table pass over what is only wished for.
        let _ = requested_schema;
        let mut batches = self.batches.clone();
        if batches.is_empty() {
            let options = RecordBatchOptions::new().with_row_count(Some(0));
            let columns = self.schema.fields().iter().map(|field| arrow_array::new_empty_array(field.data_type()));
            let empty = RecordBatch::try_new_with_options(self.schema.clone(), columns.collect(), &options);
            batches.push(empty.map_err(wrong)?);
        }
        capsule(py, RecordBatchIterator::new(batches.into_iter().map(Ok), self.schema.clone()))
    }

    /// The columns as arrays. Numbers are one array, texts codes and the list of texts, points an array of shape (n, 2)
    /// with NaN for a missing one, windings one of whole numbers of that shape, and lists their offsets and the column of
    /// all their values.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for (number, field) in self.schema.fields().iter().enumerate() {
            let arrays: Vec<ArrayRef> = self.column(number).cloned().collect();
            columns.set_item(field.name(), column(py, field.data_type(), &arrays)?)?;
        }
        Ok(columns)
    }
}

/// A stream of batches as whoever reads Arrow streams takes it.
pub(crate) fn capsule<'py>(
    py: Python<'py>,
    batches: impl RecordBatchReader + Send + 'static,
) -> PyResult<Bound<'py, PyCapsule>> {
    PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), c"arrow_array_stream")
}

fn column<'py>(py: Python<'py>, kind: &DataType, arrays: &[ArrayRef]) -> PyResult<Bound<'py, PyAny>> {
    match kind {
        DataType::UInt64 => Ok(numbers::<UInt64Type>(py, arrays)),
        DataType::UInt32 => Ok(numbers::<UInt32Type>(py, arrays)),
        DataType::Int64 => Ok(numbers::<Int64Type>(py, arrays)),
        DataType::Float64 => Ok(floats(py, arrays)),
        DataType::Utf8 => texts(py, arrays),
        DataType::Struct(of) if *of[0].data_type() == DataType::UInt32 => windings(py, arrays),
        DataType::Struct(_) => points(py, arrays),
        DataType::List(of) => {
            let mut offsets = vec![0i64];
            let mut values = Vec::new();
            for array in arrays {
                let list = array.as_list::<i32>();
                let own = list.value_offsets();
                let (first, last) = (own[0], *own.last().unwrap_or(&0));
                let start = offsets[offsets.len() - 1];
                offsets.extend(own[1..].iter().map(|&end| start + i64::from(end - first)));
                values.push(list.values().slice(first as usize, (last - first) as usize));
            }
            let offsets = PyArray1::from_vec(py, offsets);
            Ok((offsets, column(py, of.data_type(), &values)?).into_pyobject(py)?.into_any())
        }
        kind => Err(Fault::input(format!("a column of type {kind} cannot be shown as an array")).into()),
    }
}

fn numbers<'py, T: ArrowPrimitiveType>(py: Python<'py>, arrays: &[ArrayRef]) -> Bound<'py, PyAny>
where
    T::Native: Element + Copy,
{
    let slices: Vec<&[T::Native]> = arrays.iter().map(|array| &array.as_primitive::<T>().values()[..]).collect();
    PyArray1::from_vec(py, slices.concat()).into_any()
}

/// Numbers with NaN for a missing one.
fn floats<'py>(py: Python<'py>, arrays: &[ArrayRef]) -> Bound<'py, PyAny> {
    if arrays.iter().all(|array| array.null_count() == 0) {
        return numbers::<Float64Type>(py, arrays);
    }
    let all = arrays.iter().flat_map(|array| array.as_primitive::<Float64Type>()).map(|x| x.unwrap_or(f64::NAN));
    PyArray1::from_vec(py, all.collect()).into_any()
}

/// Texts as numbers of a list of different ones; a missing text is None there.
fn texts<'py>(py: Python<'py>, arrays: &[ArrayRef]) -> PyResult<Bound<'py, PyAny>> {
    let mut numbers: HashMap<Option<&str>, i64> = HashMap::new();
    let mut different = Vec::new();
    let mut codes = Vec::new();
    for array in arrays {
        for text in array.as_string::<i32>() {
            codes.push(*numbers.entry(text).or_insert_with(|| {
                different.push(text);
                different.len() as i64 - 1
            }));
        }
    }
    Ok((PyArray1::from_vec(py, codes), PyList::new(py, different)?).into_pyobject(py)?.into_any())
}

fn points<'py>(py: Python<'py>, arrays: &[ArrayRef]) -> PyResult<Bound<'py, PyAny>> {
    let mut flat: Vec<f64> = Vec::new();
    for array in arrays {
        let points = array.as_struct();
        let [x, y] = [0, 1].map(|i| points.column(i).as_primitive::<Float64Type>());
        for row in 0..points.len() {
            let there = points.is_valid(row);
            flat.extend([x, y].map(|c| if there { c.value(row) } else { f64::NAN }));
        }
    }
    pairs(py, flat)
}

/// Obstacles, each with how often a rope winds about it.
fn windings<'py>(py: Python<'py>, arrays: &[ArrayRef]) -> PyResult<Bound<'py, PyAny>> {
    let mut flat: Vec<i64> = Vec::new();
    for array in arrays {
        let windings = array.as_struct();
        let obstacles = windings.column(0).as_primitive::<UInt32Type>().values();
        let turns = windings.column(1).as_primitive::<Int64Type>().values();
        flat.extend(obstacles.iter().zip(turns).flat_map(|(&obstacle, &turns)| [i64::from(obstacle), turns]));
    }
    pairs(py, flat)
}

/// An array of shape (n, 2).
pub(crate) fn pairs<T: Element>(py: Python<'_>, flat: Vec<T>) -> PyResult<Bound<'_, PyAny>> {
    let count = flat.len() / 2;
    Ok(PyArray1::from_vec(py, flat).reshape([count, 2])?.into_any())
}
