//! A file of well-known text, cut into its geometries.

use super::super::excerpt;
use crate::read_error::{Fault, Place};

/// How deep parentheses may lie in each other. A multi-polygon needs three.
const DEPTH_MAX: usize = 64;

/// One geometry of the file.
pub(super) struct Statement<'a> {
    /// Where it starts.
    pub(super) line: u64,
    pub(super) srid: Option<u32>,
    pub(super) geometry: &'a str,
}

/// Cuts the file into geometries: each ends with its last parenthesis or with the word EMPTY.
pub(super) struct Statements<'a> {
    text: &'a str,
    at: usize,
    /// The line in which `at` lies.
    line: u64,
}

impl<'a> Statements<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Statements { text, at: 0, line: 1 }
    }

    /// The next geometry; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Statement<'a>>, Fault> {
        self.skip();
        if self.at == self.text.len() {
            return Ok(None);
        }
        let line = self.line;
        let srid = self.srid()?;
        let start = self.at;
        let length = self.length()?;
        self.advance(length);
        Ok(Some(Statement { line, srid, geometry: &self.text[start..start + length] }))
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn advance(&mut self, bytes: usize) {
        self.line += self.rest().as_bytes()[..bytes].iter().filter(|&&b| b == b'\n').count() as u64;
        self.at += bytes;
    }

    /// Goes on to the next geometry.
    fn skip(&mut self) {
        loop {
            let rest = self.rest();
            let blank = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == ';').len();
            let comment = if rest[blank..].starts_with('#') || rest[blank..].starts_with("--") {
                rest[blank..].find('\n').unwrap_or(rest.len() - blank)
            } else {
                0
            };
            if blank + comment == 0 {
                return;
            }
            self.advance(blank + comment);
        }
    }

    /// Reads `SRID=...;` if it is there.
    fn srid(&mut self) -> Result<Option<u32>, Fault> {
        let rest = self.rest();
        if !rest.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("SRID=")) {
            return Ok(None);
        }
        let wrong = || Fault::new(Place::line(self.line), format!("{:?}; write SRID=4326; for one", excerpt(rest)));
        let (number, _) = rest[5..].split_once(';').ok_or_else(wrong)?;
        let srid = number.trim().parse().map_err(|_| wrong())?;
        self.advance(5 + number.len() + 1);
        let rest = self.rest();
        self.advance(rest.len() - rest.trim_ascii_start().len());
        Ok(Some(srid))
    }

    /// How many bytes the geometry has that starts here.
    fn length(&self) -> Result<usize, Fault> {
        let rest = self.rest();
        let fault = |what: String| Err(Fault::new(Place::line(self.line), what));
        let (mut depth, mut word) = (0, 0);
        for (i, b) in rest.bytes().enumerate() {
            match b {
                b'(' => depth += 1,
                b')' if depth <= 1 => return Ok(i + 1),
                b')' => depth -= 1,
                _ if depth == 0 && b.is_ascii_alphabetic() => word += 1,
                _ if depth == 0 && rest.is_char_boundary(i) && rest[i - word..i].eq_ignore_ascii_case("EMPTY") => {
                    return Ok(i);
                }
                _ => {}
            }
            if !b.is_ascii_alphabetic() {
                word = 0;
            }
            if depth > DEPTH_MAX {
                return fault(format!("parentheses lie in each other more than {DEPTH_MAX} deep"));
            }
        }
        if depth == 0 {
            // A last EMPTY, or no geometry at all, which the parser says.
            return Ok(rest.len());
        }
        fault(format!("the file ends inside of this geometry; open parentheses: {depth}: {:?}", excerpt(rest)))
    }
}
