//! Rows of CSV as numbers: the header, and what stands in the columns that it names.

use std::ops::Range;

use glam::DVec2;

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

    /// The numbers in one row's fields.
    pub(super) fn row<'a>(&self, fields: impl Iterator<Item = &'a [u8]>) -> Result<(u64, DVec2), String> {
        let mut texts = [&[][..]; 3];
        let mut width = 0;
        for field in fields {
            for (text, number) in texts.iter_mut().zip(self.fields) {
                if number == width {
                    *text = field;
                }
            }
            width += 1;
        }
        if width != self.width {
            return Err(format!("{width} fields; the header has {}", self.width));
        }
        let [trace, x, y] = texts;
        let id = number(trace, "trace", "a whole number from 0")?;
        let coordinate = |text, column| number(text, column, "a number such as -1.25 or 3e-7");
        Ok((id, DVec2::new(coordinate(x, "x")?, coordinate(y, "y")?)))
    }
}

impl Chunk {
    /// Reads whole lines without quotes, which start `start` bytes into what faults are counted in.
    pub(super) fn of_lines(lines: &[u8], start: usize, header: &Header) -> Self {
        let mut chunk = Chunk::default();
        let mut rest = lines;
        while !rest.is_empty() && chunk.fault.is_none() {
            let byte = (start + lines.len() - rest.len()) as u64;
            let line;
            (line, rest) = first_line(rest);
            if !line.is_empty() {
                chunk.push(byte, header.row(line.split(|&b| b == b',')));
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

/// Splits off the first line, which comes without its end.
pub(super) fn first_line(text: &[u8]) -> (&[u8], &[u8]) {
    let (mut line, rest) = match memchr::memchr(b'\n', text) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, &[][..]),
    };
    while let [start @ .., b'\r'] = line {
        line = start;
    }
    (line, rest)
}

fn number<T: std::str::FromStr>(field: &[u8], column: &str, right: &str) -> Result<T, String> {
    let text = std::str::from_utf8(field.trim_ascii()).ok();
    text.and_then(|text| text.parse().ok()).ok_or_else(|| {
        let found = excerpt(&String::from_utf8_lossy(field));
        format!("column {column}: {found} is not {right}")
    })
}

/// `text` in quotes, cut where it is too long for a message.
fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(60).collect();
    if start.len() < text.len() { format!("{start:?}...") } else { format!("{start:?}") }
}
