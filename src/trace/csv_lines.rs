//! Lines of a file: whole ones, pieces of them, and their numbers.

use std::io::{BufRead, BufReader, Read, Seek};

/// How many bytes of lines a thread reads at a time: enough that switching costs little, and few enough that many threads
/// have work.
const PIECE: usize = 1 << 18;

/// Reads on for about `size` bytes after `start`, and returns the whole lines, the start of the next and whether the input
/// has ended; then what is left is a whole line too.
pub(super) fn whole_lines(
    input: &mut impl Read,
    start: Vec<u8>,
    size: usize,
) -> std::io::Result<(Vec<u8>, Vec<u8>, bool)> {
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

/// The line (from 1) of the first row at or after `byte`.
///
/// The parser's own line numbers are off where a row follows an empty line or a line that ends with CR LF, because it
/// takes those line ends as part of the next row. Counting anew is exact, and is done for errors only.
pub(super) fn line_at(mut input: impl Read + Seek, byte: u64) -> std::io::Result<u64> {
    input.rewind()?;
    let mut input = BufReader::with_capacity(PIECE, input);
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
