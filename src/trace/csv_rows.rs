//! Rows of CSV as numbers: the header, and what stands in the columns that it names.

use std::ops::Range;

use glam::DVec2;

use super::csv_lines::{LINE_MAX, LINE_TOO_LONG, first_line};
use super::gather::{ANCHOR, Gatherer, STEP, meant};
use crate::number::{NumberFault, VANISHES};

/// The columns; the last may be missing.
const COLUMNS: [&str; 4] = ["trace", "x", "y", STEP];

/// What the header says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    /// The fields in which trace, x, y and step stand; the last is beyond all of them where there are no steps.
    fields: [usize; 4],
    /// Those in which it stands where the anchor is, if it moves.
    anchor: Option<[usize; 2]>,
    /// How many fields each row has.
    width: usize,
}

/// What stands in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    trace: u64,
    step: Option<u64>,
    point: DVec2,
    anchor: Option<DVec2>,
}

/// Rows that have been read, up to the first fault.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    ids: Vec<u64>,
    /// One for each row, or none at all.
    steps: Vec<u64>,
    points: Vec<DVec2>,
    /// One for each row, or none at all.
    anchors: Vec<DVec2>,
    /// Where each row starts.
    bytes: Vec<u64>,
    /// What is wrong with the row after these, and where it starts.
    fault: Option<(u64, String)>,
}

impl Header {
    /// Finds the columns among the fields of the first row.
    pub(super) fn new<'a>(fields: impl Iterator<Item = &'a [u8]>) -> Result<Self, String> {
        let found: Vec<_> = fields.map(|name| String::from_utf8_lossy(name.trim_ascii())).collect();
        let (mut fields, mut anchor) = ([found.len(); 4], [found.len(); 2]);
        // Either alone is some other column.
        let moves = ANCHOR.iter().all(|column| found.iter().any(|name| name == column));
        if let Some(fault) = meant(&found).filter(|_| !moves) {
            return Err(fault);
        }
        let columns = COLUMNS.into_iter().chain(ANCHOR.into_iter().filter(|_| moves));
        for (field, column) in fields.iter_mut().chain(&mut anchor).zip(columns) {
            let mut at = (0..found.len()).filter(|&i| found[i] == column);
            *field = match (at.next(), at.next()) {
                (Some(i), None) => i,
                (None, _) if column == STEP => continue,
                (first, _) => {
                    let fault = if first.is_some() { "two columns" } else { "no column" };
                    let names = found.join(",");
                    let rule = separators(&names).unwrap_or("it must name trace, x and y, once each");
                    return Err(format!("{fault} {column} in the header {}; {rule}", excerpt(&names)));
                }
            };
        }
        Ok(Header { fields, anchor: moves.then_some(anchor), width: found.len() })
    }

    /// Whether rows say where the anchor is.
    pub(super) fn moves_anchor(&self) -> bool {
        self.anchor.is_some()
    }

    /// The numbers in one row's fields. Where these are not UTF-8, they come with replacement characters, which are no
    /// part of a number.
    pub(super) fn row<T: AsRef<str> + Default>(&self, fields: impl Iterator<Item = T>) -> Result<Row, String> {
        let (mut texts, mut anchors): ([T; 4], [T; 2]) = Default::default();
        let mut width = 0;
        for field in fields {
            let is_here = |&number: &usize| number == width;
            if let Some(column) = self.fields.iter().position(is_here) {
                texts[column] = field;
            } else if let Some(column) = self.anchor.and_then(|anchor| anchor.iter().position(is_here)) {
                anchors[column] = field;
            }
            width += 1;
        }
        if width != self.width {
            let semicolon = texts.iter().chain(&anchors).any(|text| text.as_ref().contains(';'));
            let why = match width > self.width {
                true => "; a decimal comma makes two fields of a number, so write 1.5, not 1,5",
                false if semicolon => "; the fields are separated by semicolons here: write commas, and 1.5, not 1,5",
                false => "",
            };
            let fields = if width == 1 { "field" } else { "fields" };
            return Err(format!("{width} {fields}; the header has {}{why}", self.width));
        }
        let [trace, x, y, step] = texts;
        let whole = |text, column| number(text, column, "a whole number from 0", |t| t.parse().ok());
        let point = |x: &T, y: &T, [in_x, in_y]: [&str; 2]| {
            Ok::<_, String>(DVec2::new(coordinate(x.as_ref(), in_x)?, coordinate(y.as_ref(), in_y)?))
        };
        let [bx, by] = anchors;
        Ok(Row {
            trace: whole(trace.as_ref(), "trace")?,
            point: point(&x, &y, ["x", "y"])?,
            anchor: if self.moves_anchor() { Some(point(&bx, &by, ANCHOR)?) } else { None },
            step: if self.fields[3] < width { Some(whole(step.as_ref(), STEP)?) } else { None },
        })
    }
}

/// Whether a header names a column that may say where the anchor is, whatever else it does.
pub(super) fn names_anchor<'a>(mut fields: impl Iterator<Item = &'a [u8]>) -> bool {
    fields.any(|name| ANCHOR.iter().any(|column| name.trim_ascii().eq_ignore_ascii_case(column.as_bytes())))
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
                let row = if line.len() > LINE_MAX { Err(LINE_TOO_LONG.to_owned()) } else { row };
                chunk.push((start + at) as u64, row);
            }
        }
        chunk
    }

    /// Adds the next row, which starts at `byte`, or its fault.
    pub(super) fn push(&mut self, byte: u64, row: Result<Row, String>) {
        match row {
            Ok(Row { trace, step, point, anchor }) => {
                self.ids.push(trace);
                self.steps.extend(step);
                self.points.push(point);
                self.anchors.extend(anchor);
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
        let steps = (!self.steps.is_empty()).then_some(&self.steps[..]);
        let anchors = |rows: Range<usize>| self.anchors[rows].iter().copied();
        let gathered = match self.anchors.is_empty() {
            true => gatherer.extend(&self.ids, steps, points),
            false => gatherer.extend_both(&self.ids, steps, points, anchors),
        };
        gathered.map_err(|(row, what)| (self.bytes[row], what))?;
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

fn coordinate(field: &str, column: &str) -> Result<f64, String> {
    match crate::number::parse(field.trim_ascii()) {
        Err(NumberFault::Vanishes) => Err(format!("column {column}: {} is {VANISHES}", excerpt(field))),
        parsed => number(field, column, "a number such as -1.25 or 3e-7", |_| parsed.ok()),
    }
}

fn number<T>(field: &str, column: &str, right: &str, parse: impl Fn(&str) -> Option<T>) -> Result<T, String> {
    let text = field.trim_ascii();
    parse(text).ok_or_else(|| {
        let comma = text.contains(',') && crate::number::parse(&text.replacen(',', ".", 1)).is_ok();
        let why = if comma { "; its decimal comma must be a point" } else { "" };
        format!("column {column}: {} is not {right}{why}", excerpt(field))
    })
}

/// What to do about a header that has the columns, separated by something else than commas.
fn separators(names: &str) -> Option<&'static str> {
    let rules = [
        (';', "it is separated by semicolons: separate columns by commas, and write numbers with a point (1.5)"),
        ('\t', "it is separated by tabulators: separate columns by commas"),
        ('|', "it is separated by bars: separate columns by commas"),
        (' ', "it is separated by spaces: separate columns by commas"),
    ];
    if names.starts_with('\u{fffd}') && names.contains('\0') {
        return Some("the file is UTF-16: save it as UTF-8 text");
    }
    let has_all = |separator: char| {
        let found: Vec<&str> = names.split(separator).map(|name| name.trim().trim_matches('"')).collect();
        ["trace", "x", "y"].iter().all(|column| found.contains(column))
    };
    rules.iter().find(|(separator, _)| has_all(*separator)).map(|(_, rule)| *rule)
}

/// `text` in quotes, cut where it is too long for a message.
fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(60).collect();
    if start.len() < text.len() { format!("{start:?}...") } else { format!("{start:?}") }
}
