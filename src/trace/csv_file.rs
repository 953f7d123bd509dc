//! Traces as CSV: a header `trace,x,y` and one row a point.
//!
//! Lines without quotes need no parser: they end at line ends and their fields at commas. They are read in blocks,
//! whose pieces are read in parallel. From the first block with a quote on (or with line ends of old Macs), the crate
//! `csv` reads the rest, record by record.

use std::io::{Chain, Cursor, Read};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};
use rayon::prelude::*;

use super::csv_lines::{LINE_MAX, LINE_TOO_LONG, Watched, first_line, is_plain, line_ends, pieces, whole_lines};
use super::csv_rows::{Chunk, Header, names_anchor};
use super::gather::Gatherer;
use crate::read_error::{Fault, Place, ReadError};

/// How many bytes are read at a time: some pieces for every thread.
const BLOCK: usize = 1 << 22;

/// The same of a pipe, into which little may come at a time.
const PIPE_BLOCK: usize = LINE_MAX + 1;

/// The parser's buffer in bytes; large enough that reading costs little next to parsing.
const BUFFER: usize = 1 << 18;

/// How many records the parser reads at a time, if they have no more than a block of bytes.
const RECORDS: usize = 1 << 14;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The rows of a file under way.
pub(super) struct CsvRows<R> {
    input: Input<R>,
    header: Option<Header>,
    /// Where in the file the block or the parser's text starts, and in which line.
    start: u64,
    line: u64,
    size: u64,
    position: u64,
    /// How many bytes are read at a time.
    block: usize,
    path: PathBuf,
}

/// The parser over the block with the first quote and all that follows.
type Parser<R> = Reader<Watched<Chain<Cursor<Vec<u8>>, R>>>;

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

impl<R: Read> CsvRows<R> {
    /// The rows of `input`, the file of `size` bytes at `path`; of size 0 it may be a pipe.
    pub(super) fn new(input: R, size: u64, path: &Path) -> Self {
        let input = Input::Blocks(input, Vec::new());
        let block = if size > 0 { BLOCK } else { PIPE_BLOCK };
        CsvRows { input, header: None, start: 0, line: 1, size, position: 0, block, path: path.into() }
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

    /// Whether the rows say where the anchor is. Looks at the header without reading on; where there is none, or none
    /// that will do, [`read`](Self::read) says so, unless it names a column of the anchor's.
    pub(super) fn moves_anchor(&mut self) -> Result<bool, ReadError> {
        if self.header.is_none()
            && let Input::Blocks(input, start) = &mut self.input
        {
            let (block, rest) = match whole_lines(input, std::mem::take(start), self.block) {
                Ok((block, rest, _)) => (block, rest),
                Err(cause) => {
                    self.input = Input::Ended;
                    return Err(ReadError::io(&self.path, cause));
                }
            };
            *start = [block, rest].concat();
            let mut first = ByteRecord::new();
            let mut parser = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(&start[..]);
            if parser.read_byte_record(&mut first).is_err() {
                return Ok(false);
            }
            return match Header::new(first.iter()) {
                Ok(header) => Ok(header.moves_anchor()),
                // Else a rope that is not to be tied would be missed an anchor first.
                Err(what) if names_anchor(first.iter()) => {
                    // The parser passes over empty lines, and so does this.
                    let byte = first.position().map_or(0, |position| position.byte()) as usize;
                    let empty = start[byte..].iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
                    let line = 1 + line_ends(&start[..byte + empty]);
                    self.input = Input::Ended;
                    Err(Fault::new(Place::line(line), what).in_file(&self.path))
                }
                Err(_) => Ok(false),
            };
        }
        Ok(self.header.as_ref().is_some_and(Header::moves_anchor))
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
            self.line -= lead.len() as u64;
            let text = Cursor::new([lead, &block, &rest].concat()).chain(input);
            let mut builder = ReaderBuilder::new();
            builder.has_headers(false).flexible(true).buffer_capacity(BUFFER);
            let parser = builder.from_reader(Watched::new(text, self.line));
            self.input = Input::Parser(Box::new(parser));
            return Ok(true);
        }
        if let Err(stop) = self.parse_block(&block, ended, gatherer) {
            return Err(self.error(stop, |byte| self.line + line_ends(&block[..byte as usize])));
        }
        self.start += block.len() as u64;
        self.line += line_ends(&block);
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
            if line.len() > LINE_MAX {
                return Err((byte, LINE_TOO_LONG.to_owned()).into());
            }
            if !line.is_empty() {
                self.header = Some(Header::new(line.split(|&b| b == b',')).map_err(|what| (byte, what))?);
            }
        }
        let Some(header) = &self.header else {
            return if ended { Err((block.len() as u64, EMPTY.to_owned()).into()) } else { Ok(()) };
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
            Err(stop) => Err(self.error(stop, |byte| parser.get_ref().line_at(byte))),
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
        let start = parser.position().byte();
        parser.get_mut().forget(start);
        let within = |parser: &Parser<R>| parser.position().byte() - start < BLOCK as u64;
        while chunk.len() < RECORDS && chunk.is_sound() && matches!(more, Ok(true)) && within(parser) {
            more = next(parser, &mut record);
            if let Ok(true) = more {
                chunk.push(byte(&record), header.row(record.iter().map(String::from_utf8_lossy)));
            }
        }
        chunk.gather(gatherer)?;
        more
    }

    /// The error with its line, which `line_of` knows.
    fn error(&self, stop: Stop, line_of: impl Fn(u64) -> u64) -> ReadError {
        match stop {
            Stop::Io(cause) => ReadError::io(&self.path, cause),
            Stop::Fault { byte, what } => Fault::new(Place::line(line_of(byte)), what).in_file(&self.path),
        }
    }
}

/// Reads a record; false at the end.
fn next<R: Read>(parser: &mut Reader<Watched<R>>, record: &mut ByteRecord) -> Result<bool, Stop> {
    let start = parser.position().byte();
    parser.get_mut().allow(start + BLOCK as u64);
    let more = parser.read_byte_record(record);
    let byte = |record: &ByteRecord| record.position().map_or(start, |p| p.byte());
    match more {
        Ok(_) if record.as_slice().len() > LINE_MAX => {
            Err(Stop::Fault { byte: byte(record), what: LINE_TOO_LONG.to_owned() })
        }
        Ok(more) => Ok(more),
        Err(_) if parser.get_ref().is_spent() => Err(Stop::Fault { byte: start, what: LINE_TOO_LONG.to_owned() }),
        Err(e) => {
            let byte = e.position().map_or(start, |p| p.byte());
            match e.into_kind() {
                ErrorKind::Io(cause) => Err(Stop::Io(cause)),
                kind => Err(Stop::Fault { byte, what: format!("not CSV: {kind:?}") }),
            }
        }
    }
}

#[cfg(test)]
#[path = "csv_tests.rs"]
mod tests;
