//! Traces as CSV: a header `trace,x,y` and one row a point.
//!
//! Lines without quotes need no parser: they end at line ends and their fields at commas. They are read in blocks, whose
//! pieces are read in parallel. From the first block with a quote on (or with line ends of old Macs), the crate `csv`
//! reads the rest, record by record.

use std::io::{Chain, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};
use rayon::prelude::*;

use super::csv_lines::{first_line, is_plain, line_at, pieces, whole_lines};
use super::csv_rows::{Chunk, Header};
use super::gather::Gatherer;
use crate::read_error::{Fault, Place, ReadError};

/// How many bytes are read at a time: some pieces for every thread.
const BLOCK: usize = 1 << 22;

/// The parser's buffer in bytes; large enough that reading costs little next to parsing.
const BUFFER: usize = 1 << 18;

/// How many records the parser reads at a time.
const RECORDS: usize = 1 << 14;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The rows of a file under way.
pub(super) struct CsvRows<R> {
    input: Input<R>,
    header: Option<Header>,
    /// Where in the file the block or the parser's text starts.
    start: u64,
    size: u64,
    position: u64,
    /// How many bytes are read at a time.
    block: usize,
    path: PathBuf,
}

/// The parser over the block with the first quote and all that follows.
type Parser<R> = Reader<Chain<Cursor<Vec<u8>>, R>>;

enum Input<R> {
    /// Blocks of lines; with the start of the next block.
    Blocks(R, Vec<u8>),
    Parser(Box<Parser<R>>),
    /// After the end or an error.
    Ended,
}

/// Why reading stopped early.
enum Stop {
    Io(std::io::Error),
    /// A fault in the row that starts `byte` bytes after the start of the block or of the parser's text.
    Fault {
        byte: u64,
        what: String,
    },
}

impl From<std::io::Error> for Stop {
    fn from(cause: std::io::Error) -> Self {
        Stop::Io(cause)
    }
}

impl From<(u64, String)> for Stop {
    fn from((byte, what): (u64, String)) -> Self {
        Stop::Fault { byte, what }
    }
}

const EMPTY: &str = "the file is empty; its first line must be the header trace,x,y";

impl<R: Read + Seek> CsvRows<R> {
    /// The rows of `input`, the file of `size` bytes at `path`.
    pub(super) fn new(input: R, size: u64, path: &Path) -> Self {
        let input = Input::Blocks(input, Vec::new());
        CsvRows { input, header: None, start: 0, size, position: 0, block: BLOCK, path: path.into() }
    }

    /// The same rows, read in blocks of about `block` bytes.
    #[cfg(test)]
    pub(super) fn in_blocks(self, block: usize) -> Self {
        CsvRows { block, ..self }
    }

    /// How many bytes the file has.
    pub(super) fn size(&self) -> u64 {
        self.size
    }

    /// How many of them have been read.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// Reads the next rows; false when there are no more.
    pub(super) fn read(&mut self, gatherer: &mut Gatherer) -> Result<bool, ReadError> {
        match std::mem::replace(&mut self.input, Input::Ended) {
            Input::Blocks(input, rest) => self.read_block(input, rest, gatherer),
            Input::Parser(parser) => self.read_records(parser, gatherer),
            Input::Ended => Ok(false),
        }
    }

    fn read_block(&mut self, mut input: R, rest: Vec<u8>, gatherer: &mut Gatherer) -> Result<bool, ReadError> {
        let (block, rest, ended) =
            whole_lines(&mut input, rest, self.block).map_err(|cause| ReadError::io(&self.path, cause))?;
        if !is_plain(&block) {
            // The parser takes a byte order mark at its start for one of the file; a line end before it is skipped.
            let lead: &[u8] = if self.start == 0 { b"" } else { b"\n" };
            self.start -= lead.len() as u64;
            let text = Cursor::new([lead, &block, &rest].concat()).chain(input);
            let mut builder = ReaderBuilder::new();
            let parser = builder.has_headers(false).flexible(true).buffer_capacity(BUFFER).from_reader(text);
            self.input = Input::Parser(Box::new(parser));
            return Ok(true);
        }
        if let Err(stop) = self.parse_block(&block, ended, gatherer) {
            return Err(self.error(input, stop));
        }
        self.start += block.len() as u64;
        self.position = self.start;
        if !ended {
            self.input = Input::Blocks(input, rest);
        }
        Ok(!ended)
    }

    fn parse_block(&mut self, block: &[u8], ended: bool, gatherer: &mut Gatherer) -> Result<(), Stop> {
        let mut rows = block;
        if self.start == 0 {
            rows = rows.strip_prefix(BYTE_ORDER_MARK).unwrap_or(rows);
        }
        while self.header.is_none() && !rows.is_empty() {
            let byte = (block.len() - rows.len()) as u64;
            let line;
            (line, rows) = first_line(rows);
            if !line.is_empty() {
                self.header = Some(Header::new(line.split(|&b| b == b',')).map_err(|what| (byte, what))?);
            }
        }
        let Some(header) = &self.header else {
            return if ended { Err((0, EMPTY.to_owned()).into()) } else { Ok(()) };
        };
        let pieces = pieces(rows, block.len() - rows.len());
        let chunks: Vec<Chunk> =
            pieces.into_par_iter().map(|(start, lines)| Chunk::of_lines(lines, start, header)).collect();
        Ok(chunks.into_iter().try_for_each(|chunk| chunk.gather(gatherer))?)
    }

    fn read_records(&mut self, mut parser: Box<Parser<R>>, gatherer: &mut Gatherer) -> Result<bool, ReadError> {
        match self.parse_records(&mut parser, gatherer) {
            Ok(more) => {
                self.position = self.start + parser.position().byte();
                if more {
                    self.input = Input::Parser(parser);
                }
                Ok(more)
            }
            Err(stop) => Err(self.error(parser.into_inner().into_inner().1, stop)),
        }
    }

    fn parse_records(&mut self, parser: &mut Parser<R>, gatherer: &mut Gatherer) -> Result<bool, Stop> {
        let mut record = ByteRecord::new();
        let byte = |record: &ByteRecord| record.position().map_or(0, |p| p.byte());
        if self.header.is_none() {
            if !next(parser, &mut record)? {
                return Err((0, EMPTY.to_owned()).into());
            }
            self.header = Some(Header::new(record.iter()).map_err(|what| (byte(&record), what))?);
        }
        let header = self.header.as_ref().expect("it has been read");
        let mut chunk = Chunk::default();
        let mut more = Ok(true);
        while chunk.len() < RECORDS && chunk.is_sound() && matches!(more, Ok(true)) {
            more = next(parser, &mut record);
            if let Ok(true) = more {
                chunk.push(byte(&record), header.row(record.iter().map(String::from_utf8_lossy)));
            }
        }
        chunk.gather(gatherer)?;
        more
    }

    fn error(&self, input: R, stop: Stop) -> ReadError {
        let (byte, what) = match stop {
            Stop::Io(cause) => return ReadError::io(&self.path, cause),
            Stop::Fault { byte, what } => (byte, what),
        };
        match line_at(input, self.start + byte) {
            Ok(line) => Fault::new(Place::line(line), what).in_file(&self.path),
            Err(cause) => ReadError::io(&self.path, cause),
        }
    }
}

fn next(parser: &mut Reader<impl Read>, record: &mut ByteRecord) -> Result<bool, Stop> {
    parser.read_byte_record(record).map_err(|e| {
        let byte = e.position().map_or(0, |p| p.byte());
        match e.into_kind() {
            ErrorKind::Io(cause) => Stop::Io(cause),
            kind => Stop::Fault { byte, what: format!("not CSV: {kind:?}") },
        }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trace::Trace;

    fn read_in_blocks(text: &[u8], block: usize) -> Result<Vec<Trace>, String> {
        let mut gatherer = Gatherer::default();
        let mut rows = CsvRows::new(Cursor::new(text), text.len() as u64, Path::new("t.csv")).in_blocks(block);
        while rows.read(&mut gatherer).map_err(|e| e.to_string())? {}
        assert_eq!(rows.position(), rows.size());
        Ok(gatherer.take(usize::MAX, usize::MAX, true).unwrap_or_default())
    }

    fn read(text: impl AsRef<[u8]>) -> Result<Vec<Trace>, String> {
        let text = text.as_ref();
        let all = read_in_blocks(text, BLOCK);
        if text.len() < 1000 {
            for block in [1, 5, 40] {
                assert_eq!(read_in_blocks(text, block), all);
            }
        }
        all
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

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Whatever a file holds, its lines are read as the parser reads them.
        #[test]
        fn lines_are_read_as_by_the_parser(
            parts in prop::collection::vec(prop::sample::select(vec![
                "0", "1", "2.5", ",", ",", ",", "\n", "\n", "\r\n", "\r", " ", "x", "\"", "\"\"", "\u{feff}", "0,1,2\n",
                "1,1,1\r\n", "\"1\",2,3\n", "2,-1e-7,nan\n",
            ]), 0..40),
            start in prop::sample::select(vec!["trace,x,y\n", "\u{feff}trace,x,y\r\n", "x,trace,y,n\n"]),
            block in 1..50usize,
        ) {
            let text = format!("{start}{}", parts.concat());
            let lines = read_in_blocks(text.as_bytes(), block);
            // A quoted field in front changes nothing but makes the parser read all.
            let quoted = text.replacen("trace", "\"trace\"", 1);
            prop_assert_eq!(lines, read_in_blocks(quoted.as_bytes(), BLOCK));
        }
    }
}
