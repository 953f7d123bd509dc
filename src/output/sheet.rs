//! Small tables whose columns are known only as they are made.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array};
use arrow_schema::{DataType, Field, SchemaRef};

use super::WriteError;
use super::batches::whole;
use super::labels::field;
use super::rows::Rows;
use super::tables::Columns;
use super::text::number;

/// The values of one column, from the first row on.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// Texts.
    Text(Vec<Option<String>>),
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Whole numbers from 0 on.
    Count(Vec<Option<u64>>),
}

impl Column {
    fn len(&self) -> usize {
        match self {
            Column::Text(all) => all.len(),
            Column::Number(all) => all.len(),
            Column::Count(all) => all.len(),
        }
    }

    fn kind(&self) -> DataType {
        match self {
            Column::Text(_) => DataType::Utf8,
            Column::Number(_) => DataType::Float64,
            Column::Count(_) => DataType::UInt64,
        }
    }

    fn array(self) -> ArrayRef {
        match self {
            Column::Text(all) => Arc::new(StringArray::from(all)),
            Column::Number(all) => Arc::new(Float64Array::from(all)),
            Column::Count(all) => Arc::new(UInt64Array::from(all)),
        }
    }

    /// A value as JSON.
    fn json(&self, row: usize) -> serde_json::Value {
        match self {
            Column::Text(all) => all[row].clone().into(),
            Column::Number(all) => all[row].into(),
            Column::Count(all) => all[row].into(),
        }
    }

    fn csv(&self, out: &mut Vec<u8>, row: usize) -> io::Result<()> {
        match self {
            Column::Text(all) => all[row].iter().try_for_each(|text| field(out, text)),
            Column::Number(all) => all[row].iter().try_for_each(|&x| number(out, x)),
            Column::Count(all) => all[row].iter().try_for_each(|n| write!(out, "{n}")),
        }
    }
}

/// A table that is held in memory: each column with its name. All have as many rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sheet {
    columns: Vec<(String, Column)>,
}

impl Sheet {
    /// Adds a column on the right.
    ///
    /// # Panics
    ///
    /// If it has not as many rows as those before it.
    pub fn push(&mut self, name: impl Into<String>, column: Column) {
        assert!(self.columns.first().is_none_or(|(_, first)| first.len() == column.len()), "all columns are as long");
        self.columns.push((name.into(), column));
    }

    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    /// Writes it, in the format that the extension names; what is null is nothing in CSV. The bytes depend on the table
    /// alone.
    ///
    /// # Errors
    ///
    /// An extension that names no format, and what the operating system says.
    ///
    /// ```
    /// use tautline::output::{Column, Sheet};
    /// let mut sheet = Sheet::default();
    /// sheet.push("walk.step", Column::Number(vec![Some(0.5), None]));
    /// sheet.push("traces", Column::Count(vec![Some(10), Some(20)]));
    /// let folder = tempfile::tempdir()?;
    /// sheet.write(&folder.path().join("a.csv"))?;
    /// assert_eq!(std::fs::read_to_string(folder.path().join("a.csv"))?, "walk.step,traces\n0.5,10\n,20\n");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let mut header = Vec::new();
        let between = |i: usize| if i == 0 { "" } else { "," };
        for (i, (name, _)) in self.columns.iter().enumerate() {
            header.extend(between(i).as_bytes());
            field(&mut header, name).map_err(|cause| WriteError::io(path, cause))?;
        }
        let mut rows = Rows::create(path, &String::from_utf8_lossy(&header), Held(self.columns.clone()))?;
        let json = |out: &mut Vec<u8>, row: &usize| {
            let line: serde_json::Map<_, _> =
                self.columns.iter().map(|(name, column)| (name.clone(), column.json(*row))).collect();
            serde_json::to_writer(&mut *out, &line)?;
            out.write_all(b"\n")
        };
        let csv = |out: &mut Vec<u8>, row: &usize| {
            for (i, (_, column)) in self.columns.iter().enumerate() {
                out.write_all(between(i).as_bytes())?;
                column.csv(out, *row)?;
            }
            out.write_all(b"\n")
        };
        // Where it is Parquet, all rows are in the columns already.
        rows.write_all(&Vec::from_iter(0..self.rows()), json, csv, |_, _| Ok(()))?;
        rows.complete()?.finish_durably()
    }

    /// The same in memory: the columns, and all rows in one batch. They are those of a Parquet file of it.
    pub fn batches(&self) -> (SchemaRef, Vec<RecordBatch>) {
        whole(Held(self.columns.clone()))
    }
}

/// Columns that are there, until they are taken.
struct Held(Vec<(String, Column)>);

impl Columns for Held {
    fn fields(&self) -> Vec<Field> {
        self.0.iter().map(|(name, column)| Field::new(name, column.kind(), true)).collect()
    }

    fn len(&self) -> usize {
        self.0.first().map_or(0, |(_, column)| column.len())
    }

    fn take(&mut self) -> Vec<ArrayRef> {
        std::mem::take(&mut self.0).into_iter().map(|(_, column)| column.array()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_formats_hold_the_same() {
        use arrow_array::Array;
        use arrow_array::cast::AsArray;
        use arrow_array::types::Float64Type;
        use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

        let mut sheet = Sheet::default();
        sheet.push("what, \"so\"", Column::Text(vec![Some("a, b".to_owned()), None]));
        sheet.push("x", Column::Number(vec![None, Some(0.1)]));
        sheet.push("n", Column::Count(vec![Some(u64::MAX), Some(0)]));
        let folder = tempfile::tempdir().unwrap();
        let [csv, jsonl, parquet] = ["t.csv", "t.jsonl", "t.parquet"].map(|name| folder.path().join(name));
        [&csv, &jsonl, &parquet].into_iter().for_each(|path| sheet.write(path).unwrap());
        let text = std::fs::read_to_string(csv).unwrap();
        assert_eq!(text, "\"what, \"\"so\"\"\",x,n\n\"a, b\",,18446744073709551615\n,0.1,0\n");
        let text = std::fs::read_to_string(jsonl).unwrap();
        assert!(text.lines().nth(1).unwrap().contains("\"x\":0.1"), "{text}");
        let file = std::fs::File::open(parquet).unwrap();
        let rows = ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap().next().unwrap().unwrap();
        let x = rows.column_by_name("x").unwrap();
        assert!(x.is_null(0) && x.as_primitive::<Float64Type>().value(1) == 0.1);
        assert_eq!(rows.column(0).as_string::<i32>().value(0), "a, b");
        let (schema, batches) = sheet.batches();
        assert_eq!((schema.fields(), &batches[..]), (rows.schema().fields(), &[rows.clone()][..]));
    }
}
