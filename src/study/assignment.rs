//! A value for a key of a study's file, given elsewhere.

use std::str::FromStr;

use toml::{Table, Value};

use super::file_places::vanishing;
use super::plan_error::{PlanError, PlanFault};

/// A value for a key of a study's file, in place of what stands there: `walk.step=2`.
///
/// ```
/// use tautline::study::Assignment;
/// for text in ["walk.step=2", "walk.kind=uniform", "scene.anchor=[[0, 0], [1, 2]]"] {
///     assert!(text.parse::<Assignment>().is_ok());
/// }
/// assert!("walk.step".parse::<Assignment>().unwrap_err().contains("such as walk.step=2"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// The key, with the tables in which it lies: `walk.step`.
    key: String,
    value: Value,
}

impl Assignment {
    /// The key, with the tables in which it lies.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Puts the value into the table of a file.
    pub(super) fn apply(&self, table: &mut Table) -> Result<(), PlanError> {
        assign(table, &self.key, self.value.clone())
    }
}

impl FromStr for Assignment {
    type Err = String;

    /// Reads `KEY=VALUE`, with the value as in TOML; a word without quotes is a text.
    fn from_str(text: &str) -> Result<Assignment, String> {
        let wrong = || "give KEY=VALUE, such as walk.step=2 or walk.kind=uniform".to_owned();
        let (key, text) = text.split_once('=').ok_or_else(wrong)?;
        let (key, text) = (key.trim(), text.trim());
        let is_bare = |part: &str| {
            !part.is_empty() && part.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-'))
        };
        if text.is_empty() || !key.split('.').all(is_bare) {
            return Err(wrong());
        }
        let value = match text.parse() {
            Ok(value) => value,
            Err(error) if text.starts_with(['[', '{', '"', '\'']) => {
                let error: toml::de::Error = error;
                return Err(format!("{key}: the value cannot be read as TOML: {}", error.message()));
            }
            Err(_) => Value::String(text.to_owned()),
        };
        match vanishing(&format!("{key} = {text}")) {
            Some(what) => Err(what),
            None => Ok(Assignment { key: key.to_owned(), value }),
        }
    }
}

/// Puts a value at a key into the table of a file, in place of what stands there, and makes the tables that are not
/// there.
///
/// # Errors
///
/// A key in something that is no table.
pub(super) fn assign(table: &mut Table, key: &str, value: Value) -> Result<(), PlanError> {
    let Some((outer, rest)) = key.split_once('.') else {
        table.insert(key.to_owned(), value);
        return Ok(());
    };
    let inner = table.entry(outer).or_insert_with(|| Value::Table(Table::new()));
    let Value::Table(inner) = inner else {
        let what = format!("it is no table here, so it has no `{rest}`");
        return Err(PlanError::at_key(outer, PlanFault::Value(what)));
    };
    assign(inner, rest, value)
        .map_err(|error| PlanError { key: error.key.map(|key| format!("{outer}.{key}")), ..error })
}

/// Has keys with dots in their names be keys in tables, as they are without quotes: a table that is written so can be
/// assigned to.
///
/// # Errors
///
/// A key that is there in both forms, or in something that is no table.
pub(super) fn nested(table: Table) -> Result<Table, PlanError> {
    let mut whole = Table::new();
    let (dotted, plain): (Vec<_>, Vec<_>) = table.into_iter().partition(|(key, _)| key.contains('.'));
    whole.extend(plain);
    for (key, value) in dotted {
        let (outer, last) = key.rsplit_once('.').unwrap_or_default();
        let outer = outer.split('.').try_fold(&whole, |table, part| table.get(part)?.as_table());
        if outer.is_some_and(|outer| outer.contains_key(last)) {
            return Err(PlanError::at_key(&key, PlanFault::Value("it is there twice".to_owned())));
        }
        assign(&mut whole, &key, value)?;
    }
    Ok(whole)
}

/// Whether two keys are one, or one of them is in the other.
pub(super) fn covers(one: &str, other: &str) -> bool {
    let is_in = |inner: &str, outer: &str| inner.strip_prefix(outer).is_some_and(|rest| rest.starts_with('.'));
    one == other || is_in(one, other) || is_in(other, one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_in_toml_and_bare_words_as_texts() {
        let value = |text: &str| text.parse::<Assignment>().unwrap().value;
        assert_eq!(value("a.b = 2"), Value::Integer(2));
        assert_eq!(value("a=2.5e1"), Value::Float(25.0));
        assert_eq!(value("a=true"), Value::Boolean(true));
        for text in ["uniform", "../a plan=b.wkt", "2..5"] {
            assert_eq!(value(&format!("a={text}")), Value::String(text.to_owned()));
        }
        assert_eq!(value("a='2'"), Value::String("2".to_owned()));
        assert_eq!(value("a=[[0, 1]]").as_array().map(Vec::len), Some(1));
        for (wrong, what) in [
            ("a", "KEY=VALUE"),
            ("=2", "KEY=VALUE"),
            ("a..b=2", "KEY=VALUE"),
            ("a b=2", "KEY=VALUE"),
            ("a=", "KEY=VALUE"),
            ("a=[1", "a: the value cannot be read as TOML"),
            ("a.b=1e-400", "a.b: 1e-400 is too small"),
        ] {
            let told = wrong.parse::<Assignment>().unwrap_err();
            assert!(told.contains(what), "{wrong}: {told}");
        }
    }

    #[test]
    fn a_value_takes_the_place_of_what_stands_there() {
        let mut table: Table = "a = 1\n[b]\nc = 2\nd = 3\n".parse().unwrap();
        for (key, value) in [("b.c", 5), ("e.f.g", 6), ("a", 7)] {
            assign(&mut table, key, Value::Integer(value)).unwrap();
        }
        assert_eq!(table, "a = 7\n[b]\nc = 5\nd = 3\n[e.f]\ng = 6\n".parse().unwrap());
        let quoted: Table = "'b.c' = 5\na = 1\n[b]\nd = 3\n".parse().unwrap();
        assert_eq!(nested(quoted).unwrap(), "a = 1\n[b]\nc = 5\nd = 3\n".parse().unwrap());
        let twice: Table = "'b.c' = 5\n[b]\nc = 3\n".parse().unwrap();
        assert_eq!(nested(twice).unwrap_err().what(), "b.c: it is there twice");
        let told = assign(&mut table, "b.c.x", Value::Integer(1)).unwrap_err();
        assert_eq!(told.what(), "b.c: it is no table here, so it has no `x`");
    }
}
