//! Traces as CSV: a header `trace,x,y` and one row a point.

use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};

use super::Trace;
use super::read::Gatherer;
use crate::read_error::{Fault, Place, ReadError};

/// The parser's buffer in bytes; large enough that reading costs little next to parsing.
const BUFFER: usize = 1 << 18;

const COLUMNS: [&str; 3] = ["trace", "x", "y"];

/// Reads the whole of `input`, the file at `path`.
pub(super) fn parse<R: Read + Seek>(input: R, path: &Path) -> Result<Vec<Trace>, ReadError> {
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).buffer_capacity(BUFFER).from_reader(input);
    gather(&mut reader).or_else(|stop| {
        let (byte, what) = match stop {
            Stop::Io(cause) => return Err(ReadError::io(path, cause)),
            Stop::Fault { byte, what } => (byte, what),
        };
        let line = line_at(reader.into_inner(), byte).map_err(|cause| ReadError::io(path, cause))?;
        Err(Fault::new(Place::line(line), what).in_file(path))
    })
}

/// Why reading stopped early.
enum Stop {
    Io(std::io::Error),
    /// A fault in the row that starts at `byte`.
    Fault {
        byte: u64,
        what: String,
    },
}

fn gather(reader: &mut Reader<impl Read>) -> Result<Vec<Trace>, Stop> {
    let mut record = ByteRecord::new();
    if !next(reader, &mut record)? {
        let what = "the file is empty; its first line must be the header trace,x,y".into();
        return Err(Stop::Fault { byte: 0, what });
    }
    let fault = |record: &ByteRecord, what| Stop::Fault { byte: record.position().map_or(0, |p| p.byte()), what };
    let header = header(&record).map_err(|what| fault(&record, what))?;
    let width = record.len();
    let mut gatherer = Gatherer::default();
    while next(reader, &mut record)? {
        if record.len() != width {
            let what = format!("{} fields; the header has {width}", record.len());
            return Err(fault(&record, what));
        }
        row(&record, header, &mut gatherer).map_err(|what| fault(&record, what))?;
    }
    Ok(gatherer.finish())
}

fn next(reader: &mut Reader<impl Read>, record: &mut ByteRecord) -> Result<bool, Stop> {
    reader.read_byte_record(record).map_err(|e| {
        let byte = e.position().map_or(0, |p| p.byte());
        match e.into_kind() {
            ErrorKind::Io(cause) => Stop::Io(cause),
            kind => Stop::Fault { byte, what: format!("not CSV: {kind:?}") },
        }
    })
}

/// The fields in which trace, x and y stand.
fn header(record: &ByteRecord) -> Result<[usize; 3], String> {
    let found: Vec<_> = record.iter().map(|name| String::from_utf8_lossy(name.trim_ascii())).collect();
    let mut fields = [0; 3];
    for (field, column) in fields.iter_mut().zip(COLUMNS) {
        let mut at = (0..found.len()).filter(|&i| found[i] == column);
        *field = match (at.next(), at.next()) {
            (Some(i), None) => i,
            (first, _) => {
                let fault = if first.is_some() { "two columns" } else { "no column" };
                let names = excerpt(&found.join(","));
                return Err(format!("{fault} {column} in the header {names}; it must name trace, x and y, once each"));
            }
        };
    }
    Ok(fields)
}

fn row(record: &ByteRecord, [trace, x, y]: [usize; 3], gatherer: &mut Gatherer) -> Result<(), String> {
    let id = number(&record[trace], "trace", "a whole number from 0")?;
    let coordinate = |field, column| number(&record[field], column, "a number such as -1.25 or 3e-7");
    gatherer.push(id, coordinate(x, "x")?, coordinate(y, "y")?)
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

/// The line (from 1) of the first row at or after `byte`.
///
/// The parser's own line numbers are off where a row follows an empty line or a line that ends with CR LF, because it
/// takes those line ends as part of the next row. Counting anew is exact, and is done for errors only.
fn line_at(mut input: impl Read + Seek, byte: u64) -> std::io::Result<u64> {
    input.rewind()?;
    let mut input = BufReader::with_capacity(BUFFER, input);
    let (mut line, mut at) = (1, 0);
    loop {
        let buffer = input.fill_buf()?;
        if buffer.is_empty() {
            return Ok(line);
        }
        for &b in buffer {
            if at >= byte && !matches!(b, b'\r' | b'\n') {
                return Ok(line);
            }
            line += u64::from(b == b'\n');
            at += 1;
        }
        let read = buffer.len();
        input.consume(read);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn read(text: impl AsRef<[u8]>) -> Result<Vec<Trace>, String> {
        parse(Cursor::new(text.as_ref().to_vec()), Path::new("t.csv")).map_err(|e| e.to_string())
    }

    fn shape(traces: &[Trace]) -> Vec<(u64, Vec<[f64; 2]>)> {
        traces.iter().map(|t| (t.id, t.points.iter().map(|p| p.to_array()).collect())).collect()
    }

    #[test]
    fn columns_are_found_by_name() {
        let expected = [(0, vec![[0.1, -2e-7], [1.0, 2.0]]), (5, vec![[3.0, 4.5]])];
        for text in [
            "trace,x,y\n0,0.1,-2e-7\n0,1,2\n5,3,4.5\n",
            "trace,x,y\r\n0,0.1,-2e-7\r\n0,1,2\r\n5,3,4.5",
            "\u{feff}trace, x ,y\n\n 0, 0.1 ,-2e-7\n0,1,2\n\n5,3,+4.50\n\n",
            "note,y,trace,x\n\"a,b\",-2e-7,0,0.1\nc,2,0,1\n,4.5,5,3\n",
            "\"trace\",\"x\",\"y\"\n\"0\",\"0.1\",\"-2e-7\"\n0,1,2\n5,3,4.5\n",
        ] {
            assert_eq!(shape(&read(text).unwrap()), expected, "{text}");
        }
        assert!(read("trace,x,y\n").unwrap().is_empty());
        assert!(read("trace,x,y").unwrap().is_empty());
    }

    #[test]
    fn numbers_are_read_exactly() {
        for x in
            [0.1 + 0.2, 1e23, 9007199254740993.0, 1.7976931348623157e100, 2.2250738585072014e-100, f64::MIN_POSITIVE]
        {
            let traces = read(format!("trace,x,y\n18446744073709551615,{x:?},{x}\n"));
            match traces {
                Ok(traces) => {
                    assert_eq!(shape(&traces), [(u64::MAX, vec![[x, x]])]);
                }
                Err(e) => assert!(x == f64::MIN_POSITIVE && e.contains("too small"), "{e}"),
            }
        }
    }

    #[test]
    fn a_header_is_needed() {
        let empty = "t.csv: line 1: the file is empty; its first line must be the header trace,x,y";
        assert_eq!(read("").unwrap_err(), empty);
        let rest = "it must name trace, x and y, once each";
        for (text, expected) in [
            ("0,1.5,2\n", format!("line 1: no column trace in the header \"0,1.5,2\"; {rest}")),
            ("trace;x;y\n", format!("line 1: no column trace in the header \"trace;x;y\"; {rest}")),
            ("\n\ntrace,X,y\n", format!("line 3: no column x in the header \"trace,X,y\"; {rest}")),
            ("y,trace,x,y\n0,0,0,0\n", format!("line 1: two columns y in the header \"y,trace,x,y\"; {rest}")),
        ] {
            assert_eq!(read(text).unwrap_err(), format!("t.csv: {expected}"));
        }
        assert!(read("z".repeat(100_000)).unwrap_err().len() < 250);
    }

    #[test]
    fn faults_name_line_column_and_text() {
        let order = "the rows of one trace must follow each other, and the numbers increase";
        let id = "is not a whole number from 0";
        let coordinate = "is not a number such as -1.25 or 3e-7";
        for (rows, expected) in [
            ("0,0,0\n0,1.2.3,0\n", format!("line 3: column x: \"1.2.3\" {coordinate}")),
            ("0,0,0\n\n\n0,0,\n", format!("line 5: column y: \"\" {coordinate}")),
            ("-1,0,0\n", format!("line 2: column trace: \"-1\" {id}")),
            ("0.0,0,0\n", format!("line 2: column trace: \"0.0\" {id}")),
            ("18446744073709551616,0,0\n", format!("line 2: column trace: \"18446744073709551616\" {id}")),
            ("0,0,0\n0,nan,0\n", "line 3: column x: NaN is not a finite number".into()),
            ("0,0,-inf\n", "line 2: column y: -inf is not a finite number".into()),
            ("0,0,1e999\n", "line 2: column y: inf is not a finite number".into()),
            ("0,0,0\n1,0,0\n0,0,0\n", format!("line 4: trace 0 after trace 1; {order}")),
            ("7,0,0\n3,0,0\n", format!("line 3: trace 3 after trace 7; {order}")),
            ("0,0,0\n0,0\n", "line 3: 2 fields; the header has 3".into()),
            ("0,0,0\n0,0,0,0\n", "line 3: 4 fields; the header has 3".into()),
        ] {
            for start in ["", "\u{feff}"] {
                let text = format!("{start}trace,x,y\n{rows}");
                assert_eq!(read(&text).unwrap_err(), format!("t.csv: {expected}"));
                assert_eq!(read(text.replace('\n', "\r\n")).unwrap_err(), format!("t.csv: {expected}"));
            }
        }
        let e = read(b"trace,x,y\n0,\xff\xfe,0\n").unwrap_err();
        assert_eq!(e, format!("t.csv: line 2: column x: \"\u{fffd}\u{fffd}\" {coordinate}"));
    }

    #[test]
    fn lines_are_right_far_into_the_file() {
        let text = format!("trace,x,y\r\n{}0,x,0\r\n", "0,0.5,0.5\r\n".repeat(100_000));
        assert!(read(text).unwrap_err().starts_with("t.csv: line 100002: column x"));
    }
}
