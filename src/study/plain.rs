//! Faults of a file's form in the words of people: what a key must be, rather than of which type.

use toml::{Table, Value};

/// What the parser says of a value of another type than the key's, in plain words; `None` where it says something else.
/// `stands` is what stands at the key, and `choices` are the words that may.
pub(super) fn plain(message: &str, stands: Option<&Value>, choices: impl Fn() -> Option<String>) -> Option<String> {
    let split = |kind: &str| message.strip_prefix(kind).and_then(|rest| rest.split_once(", expected "));
    let (found, wanted) = match (split("invalid type: "), split("invalid value: ")) {
        (Some(both), _) | (None, Some(both)) => both,
        _ if message.starts_with("wanted ") => ("", "word"),
        _ => {
            return split("invalid length ").map(|(found, wanted)| {
                format!(
                    "must be {}, and has {found}",
                    wanted
                        .strip_prefix("an array of length")
                        .map_or_else(|| wanted.to_owned(), |length| format!("a list of{length}"),)
                )
            });
        }
    };
    let must_be = match wanted {
        "f32" | "f64" => "a number, such as 0.5".to_owned(),
        "u8" | "u16" | "u32" | "u64" | "usize" => match most(wanted) {
            Some(most) if found.starts_with("integer") && !found.contains('-') => {
                format!("a whole number up to {most}")
            }
            _ => "a whole number, 0 or more".to_owned(),
        },
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" | "string" | "path string" | "a borrowed string" => "a text in quotes".to_owned(),
        "a sequence" => "a list in brackets".to_owned(),
        "word" | "variant identifier" | "string or map" | "string or table" => {
            choices().unwrap_or_else(|| "a word in quotes".to_owned())
        }
        _ if wanted.starts_with("a map") || wanted.starts_with("struct ") || wanted.contains("tagged enum") => {
            "a table with keys of its own".to_owned()
        }
        _ => wanted.to_owned(),
    };
    Some(format!("must be {must_be}, and is {}", is(found, stands)))
}

/// The greatest whole number of a type that is smaller than a file's.
fn most(kind: &str) -> Option<u64> {
    match kind {
        "u8" => Some(u8::MAX.into()),
        "u16" => Some(u16::MAX.into()),
        "u32" => Some(u32::MAX.into()),
        _ => None,
    }
}

/// What was found, as it is written.
fn is(found: &str, stands: Option<&Value>) -> String {
    if let Some(Value::Datetime(date)) = stands {
        return format!("the date {date}");
    }
    match found.split_once(' ') {
        Some(("string", text)) => text.to_owned(),
        Some(("integer" | "boolean", value)) => value.trim_matches('`').to_owned(),
        Some(("floating", value)) => value.trim_start_matches("point ").trim_matches('`').to_owned(),
        _ => match (found, stands) {
            ("sequence", _) | ("", Some(Value::Array(_))) => "a list".to_owned(),
            ("map", _) | ("", Some(Value::Table(_))) => "a table".to_owned(),
            ("", Some(value)) => value.to_string(),
            _ => found.to_owned(),
        },
    }
}

/// The value at a key, with the tables in which it lies.
pub(super) fn value_at<'v>(table: &'v Table, key: &str) -> Option<&'v Value> {
    let mut parts = key.split('.');
    let first = table.get(parts.next()?)?;
    parts.try_fold(first, |value, part| value.get(part))
}

/// Puts a word that no key takes in the place of what stands at one. Tells whether it could.
pub(super) fn replace(table: &mut Table, key: &str, word: &str) -> bool {
    let (outer, last) = key.rsplit_once('.').unwrap_or(("", key));
    let inner = outer.split('.').filter(|part| !part.is_empty());
    let Some(inner) = inner.into_iter().try_fold(table, |table, part| table.get_mut(part)?.as_table_mut()) else {
        return false;
    };
    inner.insert(last.to_owned(), Value::String(word.to_owned())).is_some()
}
