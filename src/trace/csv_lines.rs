//! Lines of a file: whole ones, pieces of them, and their numbers.

use std::io::{self, Read};

/// How many bytes of lines a thread reads at a time: enough that switching costs little, and few enough that many
/// threads have work.
const PIECE: usize = 1 << 18;

/// How long a line may be, in bytes: what goes on without an end is no table, and is not held in memory.
pub(super) const LINE_MAX: usize = 1 << 16;

/// What is said of a longer one.
pub(super) const LINE_TOO_LONG: &str = "a line of more than 65536 bytes, so this is no table of points";

/// Reads on for about `size` bytes after `start`, and returns the whole lines, the start of the next and whether the
/// input has ended; then what is left is a whole line too. What has no line end within [`LINE_MAX`] bytes counts as
/// whole.
pub(super) fn whole_lines(input: &mut impl Read, start: Vec<u8>, size: usize) -> io::Result<(Vec<u8>, Vec<u8>, bool)> {
    let mut block = start;
    loop {
        let old = block.len();
        block.reserve_exact(size);
        if input.by_ref().take(size as u64).read_to_end(&mut block)? < size {
            return Ok((block, Vec::new(), true));
        }
        if let Some(last) = memchr::memrchr(b'\n', &block[old..]) {
            let rest = block.split_off(old + last + 1);
            return Ok((block, rest, false));
        }
        if block.len() > LINE_MAX {
            return Ok((block, Vec::new(), false));
        }
    }
}

/// Whether whole lines can be read without a parser: without quotes, and all carriage returns right before line ends.
pub(super) fn is_plain(lines: &[u8]) -> bool {
    let ends = |at: usize| matches!(lines.get(at + 1), Some(b'\n' | b'\r') | None);
    memchr::memchr(b'"', lines).is_none() && memchr::memchr_iter(b'\r', lines).all(ends)
}

/// Cuts lines into pieces of whole lines, each with its start; counted from `start`.
pub(super) fn pieces(lines: &[u8], start: usize) -> Vec<(usize, &[u8])> {
    let mut pieces = Vec::new();
    let mut rest = lines;
    while !rest.is_empty() {
        let at = rest.len().min(PIECE);
        let end = memchr::memchr(b'\n', &rest[at..]).map_or(rest.len(), |end| at + end + 1);
        pieces.push((start + lines.len() - rest.len(), &rest[..end]));
        rest = &rest[end..];
    }
    pieces
}

/// How many lines end in `text`.
pub(super) fn line_ends(text: &[u8]) -> u64 {
    memchr::memchr_iter(b'\n', text).count() as u64
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

/// What the parser reads, with what is needed to say in which line a row starts.
///
/// The parser's own line numbers are off where a row follows an empty line or a line that ends with CR LF, because it
/// takes those line ends as part of the next row. And it would take a quote that never ends for one row, whatever
/// comes.
pub(super) struct Watched<R> {
    input: R,
    /// What was read since [`forget`](Self::forget), and where that starts.
    recent: Vec<u8>,
    start: u64,
    /// The line in which it starts.
    line: u64,
    /// Up to where the parser may read.
    most: u64,
}

impl<R> Watched<R> {
    /// Input that begins in that line.
    pub(super) fn new(input: R, line: u64) -> Self {
        Watched { input, recent: Vec::new(), start: 0, line, most: 0 }
    }

    /// Nothing before `byte` will be asked for again.
    pub(super) fn forget(&mut self, byte: u64) {
        let old = (byte.saturating_sub(self.start) as usize).min(self.recent.len());
        self.line += line_ends(&self.recent[..old]);
        self.recent.drain(..old);
        self.start += old as u64;
    }

    /// Lets the parser read up to `byte` and its buffer full.
    pub(super) fn allow(&mut self, byte: u64) {
        self.most = byte;
    }

    /// Whether the parser wants more than it may have.
    pub(super) fn is_spent(&self) -> bool {
        self.start + self.recent.len() as u64 > self.most
    }

    /// The line (from 1) of the first row at or after `byte`.
    pub(super) fn line_at(&self, byte: u64) -> u64 {
        let before = (byte.saturating_sub(self.start) as usize).min(self.recent.len());
        let (old, rest) = self.recent.split_at(before);
        let empty = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
        self.line + line_ends(old) + line_ends(&rest[..empty])
    }
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.is_spent() {
            return Err(io::Error::other(LINE_TOO_LONG));
        }
        let read = self.input.read(buffer)?;
        self.recent.extend_from_slice(&buffer[..read]);
        Ok(read)
    }
}
