//! The little YAML of a map: keys, each with a value or a list of values.

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::super::excerpt;
use crate::number;
use crate::read_error::{Fault, Place};

/// How many keys a map may have, each of which is compared with all others.
const KEYS_MAX: usize = 1 << 10;

/// A value of the file, and its line.
pub(super) struct Value {
    line: u64,
    items: Vec<String>,
    list: bool,
}

impl Value {
    /// A fault of this value of `key`, and what would be right.
    pub(super) fn fault(&self, key: &str, right: &str) -> Fault {
        let shown = if self.list { format!("[{}]", self.items.join(", ")) } else { self.items.concat() };
        Fault::new(Place::line(self.line), format!("{key} is {:?}; it must be {right}", excerpt(&shown)))
    }

    /// As many finite numbers: a list, or a value alone if it is to be one.
    pub(super) fn numbers<const N: usize>(&self, key: &str, right: &str) -> Result<[f64; N], Fault> {
        let numbers: Option<Vec<f64>> = self.items.iter().map(|item| number::parse(item).ok()).collect();
        let numbers = numbers.filter(|all| self.list == (N > 1) && all.iter().all(|n| n.is_finite()));
        numbers.and_then(|all| all.try_into().ok()).ok_or_else(|| self.fault(key, right))
    }

    /// A value alone that is not empty.
    pub(super) fn text(&self, key: &str, right: &str) -> Result<&str, Fault> {
        match &self.items[..] {
            [text] if !self.list && !text.is_empty() => Ok(text),
            _ => Err(self.fault(key, right)),
        }
    }
}

/// The values of all keys that a map has; others, with whatever is in them, are passed over.
pub(super) fn values(text: &str) -> Result<Vec<(String, Value)>, Fault> {
    let mut values: Vec<(String, Value)> = Vec::new();
    let mut depth = 0;
    let mut key: Option<String> = None;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| {
            let place = Place::line(e.marker().line() as u64).then("column", e.marker().col() as u64 + 1);
            Fault::new(place, format!("not YAML: {}", e.info()))
        })?;
        let line = span.start.line() as u64;
        let fault = |what: &str| Err(Fault::new(Place::line(line), what));
        match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                let list = matches!(event, Event::SequenceStart(..));
                if depth == 0 && list {
                    return fault("a list; a map is written as lines of a key and its value, such as resolution: 0.05");
                }
                if depth == 1 {
                    let key = key.clone().unwrap_or_default();
                    push(&mut values, key, Value { line, items: Vec::new(), list })?;
                }
                depth += 1;
            }
            Event::MappingEnd | Event::SequenceEnd => {
                depth -= 1;
                if depth == 1 {
                    key = None;
                }
            }
            Event::Scalar(scalar, style, ..) => match (depth, key.take()) {
                (0, _) => {
                    return fault("no map; a map is written as lines of a key and its value, such as resolution: 0.05");
                }
                (1, None) => key = Some(scalar.into_owned()),
                (1, Some(key)) => {
                    let empty = style == ScalarStyle::Plain && scalar == "~";
                    let items = vec![if empty { String::new() } else { scalar.into_owned() }];
                    push(&mut values, key, Value { line, items, list: false })?;
                }
                (_, of) => {
                    key = of;
                    if let (2, Some((_, value))) = (depth, values.last_mut()) {
                        value.items.push(scalar.into_owned());
                    }
                }
            },
            Event::Alias(_) => return fault("an alias (*); write the value out"),
            _ => {}
        }
    }
    Ok(values)
}

fn push(values: &mut Vec<(String, Value)>, key: String, value: Value) -> Result<(), Fault> {
    if values.len() > KEYS_MAX {
        return Err(Fault::new(Place::line(value.line), format!("more than {KEYS_MAX} keys; is this a map?")));
    }
    if values.iter().any(|(k, _)| *k == key) {
        return Err(Fault::new(Place::line(value.line), format!("{key} a second time")));
    }
    values.push((key, value));
    Ok(())
}
