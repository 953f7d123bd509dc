//! Rows of CSV as numbers: the header, and what stands in the columns that it names.

use std::ops::Range;

use glam::DVec2;

use super::csv_lines::first_line;
use super::gather::Gatherer;

const COLUMNS: [&str; 3] = ["trace", "x", "y"];

/// What the header says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    /// The fields in which trace, x and y stand.
    fields: [usize; 3],
    /// How many fields each row has.
    width: usize,
}

/// Rows that have been read, up to the first fault.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    ids: Vec<u64>,
    points: Vec<DVec2>,
    /// Where each row starts.
    bytes: Vec<u64>,
    /// What is wrong with the row after these, and where it starts.
    fault: Option<(u64, String)>,
}

impl Header {
    /// Finds the columns among the fields of the first row.
    pub(super) fn new<'a>(fields: impl Iterator<Item = &'a [u8]>) -> Result<Self, String> {
        let found: Vec<_> = fields.map(|name| String::from_utf8_lossy(name.trim_ascii())).collect();
        let mut fields = [0; 3];
        for (field, column) in fields.iter_mut().zip(COLUMNS) {
            let mut at = (0..found.len()).filter(|&i| found[i] == column);
            *field = match (at.next(), at.next()) {
                (Some(i), None) => i,
                (first, _) => {
                    let fault = if first.is_some() { "two columns" } else { "no column" };
                    let names = excerpt(&found.join(","));
                    let rule = "it must name trace, x and y, once each";
                    return Err(format!("{fault} {column} in the header {names}; {rule}"));
                }
            };
        }
        Ok(Header { fields, width: found.len() })
    }

    /// The numbers in one row's fields. Where these are not UTF-8, they come with replacement characters, which are no part of
    /// a number.
    pub(super) fn row<T: AsRef<str> + Default>(&self, fields: impl Iterator<Item = T>) -> Result<(u64, DVec2), String> {
        let mut texts: [T; 3] = Default::default();
        let mut width = 0;
        for field in fields {
            if let Some(column) = self.fields.iter().position(|&number| number == width) {
                texts[column] = field;
            }
            width += 1;
        }
        if width != self.width {
            return Err(format!("{width} fields; the header has {}", self.width));
        }
        let [trace, x, y] = texts;
        let id = number(trace.as_ref(), "trace", "a whole number from 0")?;
        let coordinate = |text, column| number(text, column, "a number such as -1.25 or 3e-7");
        Ok((id, DVec2::new(coordinate(x.as_ref(), "x")?, coordinate(y.as_ref(), "y")?)))
    }
}

impl Chunk {
    /// Reads whole lines without quotes, which start `start` bytes into what faults are counted in.
    pub(super) fn of_lines(lines: &[u8], start: usize, header: &Header) -> Self {
        // One look at all of it is cheaper than one at each field.
        let text = std::str::from_utf8(lines);
        let mut chunk = Chunk::default();
        let mut rest = lines;
        while !rest.is_empty() && chunk.fault.is_none() {
            let at = lines.len() - rest.len();
            let line;
            (line, rest) = first_line(rest);
            if !line.is_empty() {
                let row = match text {
                    Ok(text) => header.row(fields(&text[at..at + line.len()])),
                    Err(_) => header.row(fields(&String::from_utf8_lossy(line))),
                };
                chunk.push((start + at) as u64, row);
            }
        }
        chunk
    }

    /// Adds the next row, which starts at `byte`, or its fault.
    pub(super) fn push(&mut self, byte: u64, row: Result<(u64, DVec2), String>) {
        match row {
            Ok((id, point)) => {
                self.ids.push(id);
                self.points.push(point);
                self.bytes.push(byte);
            }
            Err(what) => self.fault = Some((byte, what)),
        }
    }

    /// Whether no row had a fault.
    pub(super) fn is_sound(&self) -> bool {
        self.fault.is_none()
    }

    /// How many rows there are.
    pub(super) fn len(&self) -> usize {
        self.ids.len()
    }

    /// Gives the rows to `gatherer`; a fault comes with the byte at which its row starts.
    pub(super) fn gather(self, gatherer: &mut Gatherer) -> Result<(), (u64, String)> {
        let points = |rows: Range<usize>| self.points[rows].iter().copied();
        gatherer.extend(&self.ids, points).map_err(|(row, what)| (self.bytes[row], what))?;
        self.fault.map_or(Ok(()), Err)
    }
}

/// What stands between the commas of a line.
fn fields(line: &str) -> impl Iterator<Item = &str> {
    let mut start = 0;
    memchr::memchr_iter(b',', line.as_bytes()).chain(std::iter::once(line.len())).map(move |end| {
        let field = &line[start..end];
        start = end + 1;
        field
    })
}

fn number<T: std::str::FromStr>(field: &str, column: &str, right: &str) -> Result<T, String> {
    field.trim_ascii().parse().map_err(|_| format!("column {column}: {} is not {right}", excerpt(field)))
}

/// `text` in quotes, cut where it is too long for a message.
fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(60).collect();
    if start.len() < text.len() { format!("{start:?}...") } else { format!("{start:?}") }
}
