//! The groups of a DXF file: pairs of a code and a value, gathered into entities.

use crate::number::{self, NumberFault, VANISHES};
use crate::read_error::{Fault, Place};
use crate::words::plainly;

/// An entity, or any other thing that starts with code 0: its kind, and the groups up to the next one.
#[derive(Debug, Clone)]
pub(super) struct Entity<'a> {
    pub(super) kind: &'a str,
    /// The line of its kind.
    pub(super) line: u64,
    pub(super) groups: Vec<(i32, &'a str)>,
    /// The vertices of a POLYLINE, the attributes of an INSERT.
    pub(super) parts: Vec<Entity<'a>>,
}

impl<'a> Entity<'a> {
    /// A fault of this entity.
    pub(super) fn fault(&self, what: impl std::fmt::Display) -> Fault {
        Fault::new(Place::line(self.line), format!("{}: {what}", self.kind))
    }

    /// The parts of these groups of its own that begin with this code each, in order; what comes before the first is
    /// left out.
    pub(super) fn split(&self, groups: &[(i32, &'a str)], code: i32) -> Vec<Entity<'a>> {
        let parts = groups.chunk_by(|_, next| next.0 != code).filter(|part| part[0].0 == code);
        parts.map(|part| Entity { groups: part.to_vec(), parts: Vec::new(), ..*self }).collect()
    }

    /// The value of the first group with this code.
    pub(super) fn text(&self, code: i32) -> Option<&'a str> {
        self.groups.iter().find(|g| g.0 == code).map(|g| g.1)
    }

    /// All numbers with this code, in order.
    pub(super) fn numbers(&self, code: i32) -> Result<Vec<f64>, Fault> {
        let all = self.groups.iter().filter(|g| g.0 == code);
        all.map(|&(_, value)| self.parse(code, value)).collect()
    }

    /// The number with this code, if it is there.
    pub(super) fn maybe(&self, code: i32) -> Result<Option<f64>, Fault> {
        self.text(code).map(|value| self.parse(code, value)).transpose()
    }

    /// The number with this code, or what stands for it where it is left out.
    pub(super) fn or(&self, code: i32, default: f64) -> Result<f64, Fault> {
        Ok(self.maybe(code)?.unwrap_or(default))
    }

    /// The number with this code, which must be there.
    pub(super) fn number(&self, code: i32) -> Result<f64, Fault> {
        self.maybe(code)?.ok_or_else(|| self.fault(format_args!("no number with the group code {code}")))
    }

    /// The bits of a whole number, none where it is left out.
    pub(super) fn flags(&self, code: i32) -> Result<i64, Fault> {
        let Some(value) = self.text(code) else { return Ok(0) };
        value.parse().map_err(|_| self.wrong(code, value, "whole number"))
    }

    pub(super) fn parse(&self, code: i32, value: &str) -> Result<f64, Fault> {
        number::parse(value).map_err(|fault| match fault {
            NumberFault::NoNumber => self.wrong(code, value, "number"),
            NumberFault::Vanishes => self.fault(format_args!("group code {code} has the value {value:?}, {VANISHES}")),
        })
    }

    fn wrong(&self, code: i32, value: &str, right: &str) -> Fault {
        let start: String = value.chars().take(40).collect();
        self.fault(format_args!("group code {code} has the value {start:?}; it must be a {right}"))
    }
}

/// Gathers entities, in order.
pub(super) struct Entities<'a> {
    lines: std::str::Lines<'a>,
    /// How many lines were read.
    line: u64,
    /// The kind of the next entity and its line.
    next: Option<(&'a str, u64)>,
    /// An entity that was looked at and not taken.
    ahead: Option<Entity<'a>>,
}

impl<'a> Entities<'a> {
    pub(super) fn new(text: &'a str) -> Result<Self, Fault> {
        let mut entities = Entities { lines: text.lines(), line: 0, next: None, ahead: None };
        // Comments may come first.
        while let Some((code, value)) = entities.group()? {
            match code {
                0 => {
                    entities.next = Some((value, entities.line));
                    return Ok(entities);
                }
                999 => {}
                _ => {
                    let what = format!("not DXF: it begins with the group code {code}; it must begin with 0, SECTION");
                    return Err(Fault::new(Place::line(entities.line - 1), what));
                }
            }
        }
        Err(Fault::new(Place::default(), "not DXF: the file is empty"))
    }

    /// The next entity with those that belong to it, up to SEQEND; `None` after the one called EOF.
    pub(super) fn next(&mut self) -> Result<Option<Entity<'a>>, Fault> {
        let Some(mut entity) = self.single()? else { return Ok(None) };
        if entity.kind == "POLYLINE" || (entity.kind == "INSERT" && entity.flags(66)? == 1) {
            while let Some(part) = self.single()? {
                match part.kind {
                    "VERTEX" | "ATTRIB" => entity.parts.push(part),
                    "SEQEND" => break,
                    _ => {
                        self.ahead = Some(part);
                        break;
                    }
                }
            }
        }
        Ok(Some(entity))
    }

    fn single(&mut self) -> Result<Option<Entity<'a>>, Fault> {
        if let Some(entity) = self.ahead.take() {
            return Ok(Some(entity));
        }
        let Some((kind, line)) = self.next.take() else { return Ok(None) };
        if kind == "EOF" {
            return Ok(None);
        }
        let mut entity = Entity { kind, line, groups: Vec::new(), parts: Vec::new() };
        loop {
            match self.group()? {
                Some((0, value)) => {
                    self.next = Some((value, self.line));
                    return Ok(Some(entity));
                }
                Some(group) => entity.groups.push(group),
                None => {
                    let what = format!(
                        "the file ends after {} without 0, EOF: it is cut off",
                        plainly(self.line, "line", "lines")
                    );
                    return Err(Fault::new(Place::line(entity.line), what));
                }
            }
        }
    }

    /// The next pair of lines.
    fn group(&mut self) -> Result<Option<(i32, &'a str)>, Fault> {
        let Some(code) = self.lines.next() else { return Ok(None) };
        self.line += 1;
        let Ok(number) = code.trim().parse() else {
            if code.trim().is_empty() && self.lines.clone().all(|line| line.trim().is_empty()) {
                return Ok(None);
            }
            let start: String = code.chars().take(40).collect();
            let what = format!("not DXF: {start:?} stands where a group code must stand, a whole number");
            return Err(Fault::new(Place::line(self.line), what));
        };
        let Some(value) = self.lines.next() else {
            return Err(Fault::new(Place::line(self.line), "the file ends after a group code: it is cut off"));
        };
        self.line += 1;
        Ok(Some((number, value.trim())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_gathered_with_their_lines() {
        let text = "999\nmade by hand\n  0\nLINE\r\n 10\n 1.5 \n 10\n2e1\n  0\nPOINT\n70\n3\n0\nEOF\n\n";
        let mut entities = Entities::new(text).unwrap();
        let line = entities.next().unwrap().unwrap();
        assert_eq!((line.kind, line.line, line.numbers(10).unwrap()), ("LINE", 4, vec![1.5, 20.0]));
        assert_eq!((line.or(20, 7.0).unwrap(), line.maybe(20).unwrap(), line.flags(70).unwrap()), (7.0, None, 0));
        assert_eq!(line.number(20).unwrap_err().what, "LINE: no number with the group code 20");
        let point = entities.next().unwrap().unwrap();
        assert_eq!((point.line, point.flags(70).unwrap()), (10, 3));
        assert!(entities.next().unwrap().is_none() && entities.next().unwrap().is_none());
    }

    #[test]
    fn parts_belong_to_their_entity() {
        let text = "0\nPOLYLINE\n0\nVERTEX\n10\n1\n0\nVERTEX\n0\nSEQEND\n0\nINSERT\n0\nPOLYLINE\n0\nLINE\n0\nEOF";
        let mut entities = Entities::new(text).unwrap();
        let mut found = Vec::new();
        while let Some(entity) = entities.next().unwrap() {
            found.push((entity.kind, entity.parts.len()));
        }
        assert_eq!(found, [("POLYLINE", 2), ("INSERT", 0), ("POLYLINE", 0), ("LINE", 0)]);
    }

    #[test]
    fn what_is_not_dxf_is_named() {
        let fault = |text: &str| {
            let read = |text| {
                let mut entities = Entities::new(text)?;
                while entities.next()?.is_some() {}
                Ok(())
            };
            let fault: Fault = read(text).unwrap_err();
            format!("{}: {}", fault.place, fault.what)
        };
        assert_eq!(fault(""), ": not DXF: the file is empty");
        assert_eq!(fault("{}"), "line 1: not DXF: \"{}\" stands where a group code must stand, a whole number");
        let first = "line 1: not DXF: it begins with the group code 10; it must begin with 0, SECTION";
        assert_eq!(fault("10\n1\n"), first);
        let cut = "line 2: the file ends after 4 lines without 0, EOF: it is cut off";
        assert_eq!(fault("0\nLINE\n10\n1\n"), cut);
        assert_eq!(fault("0\nLINE\n10"), "line 3: the file ends after a group code: it is cut off");
        let number = Entities::new("0\nLINE\n10\nx\n0\nEOF").unwrap().next().unwrap().unwrap().number(10).unwrap_err();
        assert_eq!(number.what, "LINE: group code 10 has the value \"x\"; it must be a number");
    }
}
