//! Where in a study's file a fault lies: the key, and the line in which it stands.

use std::ops::Range;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};

use super::plain::{plain, replace, value_at};
use super::plan::Plan;
use super::plan_error::{PlanError, PlanFault};
use crate::number::{self, NumberFault, VANISHES};

/// Among how many keys the one at fault is looked for.
const KEYS_MAX: usize = 200;

/// A key of the file.
struct Key {
    /// With the tables in which it lies: `walk.step`.
    name: String,
    /// From its beginning to the end of its value.
    span: Range<usize>,
    /// Whether its value is no table.
    leaf: bool,
}

/// A fault of the file's form with the key and the line at fault and, for an unknown key, the nearest known one.
pub(super) fn explain(text: &str, error: &toml::de::Error) -> PlanError {
    let message = error.message();
    let keys = keys(text);
    let at = error.span().map(|span| span.start.min(text.len()));
    let Ok(document) = text.parse::<toml::Table>() else {
        return PlanError { line: at.map(|at| line(text, at)), ..PlanFault::Value(message.to_owned()).into() };
    };
    let within = |key: &&Key| at.is_some_and(|at| key.span.contains(&at));
    // The parser knows the place of some faults as that of their table only.
    let key = keys.iter().filter(|key| key.leaf).find(within).or_else(|| culprit(&document, message, &keys));
    let key = key.or_else(|| keys.iter().rev().find(within));
    let named: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let nearest = match named.split_first() {
        Some((&given, known)) if message.starts_with("unknown") => known
            .iter()
            .map(|k| (strsim::damerau_levenshtein(given, k), k))
            .min()
            .filter(|(distance, k)| *distance <= 1 + k.len() / 3)
            .map(|(_, nearest)| format!("; did you mean `{nearest}`?")),
        _ => None,
    };
    let fault = match message {
        _ if message.contains("AnchorPlan") => PlanFault::AnchorForm,
        _ if message.starts_with("unknown field `sweep`") => PlanFault::Value(
            "this file describes a sweep, which is several studies; `tautline study run` does them all, and without \
             [sweep] it is one"
                .to_owned(),
        ),
        _ if is_tether_of_another(key, message) => PlanFault::Value(
            "only walks whose steps are drawn one after the other are held back by a tether: give the kind uniform, \
             gaussian or persistent; whether other ropes are ever longer say tallies.limits"
                .to_owned(),
        ),
        _ => {
            let stands = key.and_then(|key| value_at(&document, &key.name));
            let said = plain(message, stands, || choices(&document, &key?.name)).unwrap_or_else(|| message.to_owned());
            PlanFault::Value(format!("{said}{}", nearest.unwrap_or_default()))
        }
    };
    let line = key.map(|key| line(text, key.span.start));
    PlanError { line, key: key.map(|key| key.name.clone()), ..fault.into() }
}

/// The words that a key takes, as far as it says when it is given another one.
fn choices(document: &toml::Table, key: &str) -> Option<String> {
    let mut asked = document.clone();
    if !replace(&mut asked, key, "?") {
        return None;
    }
    let told = Plan::deserialize(toml::Value::Table(asked)).err()?;
    let words = told.message().strip_prefix("unknown variant `?`, expected ")?;
    let words = words.strip_prefix("one of ").unwrap_or(words).replace('`', "\"");
    Some(match words.rsplit_once(", ") {
        Some((others, last)) => format!("{others} or {last}"),
        None => words,
    })
}

/// Whether the fault is that a walk is given a tether whose kind has none.
fn is_tether_of_another(key: Option<&Key>, message: &str) -> bool {
    message.starts_with("unknown field")
        && key.is_some_and(|key| ["walk.tether", "walk.at_tether"].contains(&&*key.name))
}

/// The line of the key `name`, if `text` has it; of its table, if the file leaves it out.
pub(super) fn line_of(text: &str, name: &str) -> Option<usize> {
    let tables = std::iter::successors(Some(name), |name| name.rsplit_once('.').map(|(table, _)| table));
    let keys = keys(text);
    let key = tables.into_iter().find_map(|name| keys.iter().find(|key| key.name == name));
    key.map(|key| line(text, key.span.start))
}

/// The names of all keys, with the tables in which they lie, in the order in which they stand.
pub(super) fn order_of(text: &str) -> Vec<String> {
    keys(text).into_iter().map(|key| key.name).collect()
}

/// What is said of the first number of the file that would be rounded to 0.
pub(super) fn vanishing(text: &str) -> Option<String> {
    fn within<'v>(value: &'v DeValue<'_>) -> Option<&'v str> {
        match value {
            DeValue::Float(float) => {
                let digits = float.as_str();
                (number::parse(&digits.replace('_', "")) == Err(NumberFault::Vanishes)).then_some(digits)
            }
            DeValue::Array(items) => items.iter().find_map(|item| within(item.get_ref())),
            _ => None,
        }
    }
    fn find(table: &DeTable<'_>, outer: &str) -> Option<String> {
        table.iter().find_map(|(key, value)| {
            let name = format!("{outer}{}", key.get_ref());
            match value.get_ref().as_table() {
                Some(inner) => find(inner, &format!("{name}.")),
                None => within(value.get_ref()).map(|digits| format!("{name}: {digits} is {VANISHES}")),
            }
        })
    }
    find(DeTable::parse_recoverable(text).0.get_ref(), "")
}

/// The key without which the fault is another one, or none.
fn culprit<'k>(document: &toml::Table, message: &str, keys: &'k [Key]) -> Option<&'k Key> {
    let fault = |document: &toml::Table| {
        Plan::deserialize(toml::Value::Table(document.clone())).err().map(|e| e.message().to_owned())
    };
    let whole = fault(document);
    // A field that is not known is named.
    let unknown = message.strip_prefix("unknown field `").and_then(|rest| rest.split('`').next());
    // How surely a key is at fault: without it nothing is, or nothing but that it is missing; or another fault comes
    // first.
    let decides = |key: &Key| {
        let mut names: Vec<&str> = key.name.split('.').collect();
        let last = names.pop().unwrap_or_default();
        if let Some(unknown) = unknown {
            return (unknown == last).then_some(0);
        }
        let mut rest = document.clone();
        let table = names.iter().try_fold(&mut rest, |table, name| table.get_mut(*name)?.as_table_mut());
        table.and_then(|table| table.remove(last))?;
        match fault(&rest) {
            same if same == whole => None,
            None => Some(0),
            Some(other) => Some(u8::from(other != format!("missing field `{last}`"))),
        }
    };
    // What is missing is so in a table. Without its kind nothing else is said of a walk, nor without a whole section.
    let missing = message.starts_with("missing");
    let rank = |key: &Key| match (key.leaf, key.name.contains('.')) {
        (true, _) if !key.name.ends_with(".kind") => 0,
        (false, true) => 1,
        (true, _) => 2,
        (false, false) => 3,
    };
    let mut candidates: Vec<&Key> = keys.iter().filter(|key| !(missing && key.leaf)).collect();
    candidates.sort_by_key(|key| rank(key));
    // All are tried; no person writes so many.
    candidates.truncate(KEYS_MAX);
    let surely = candidates.into_iter().filter_map(|key| Some((decides(key)?, key)));
    surely.min_by_key(|(doubt, _)| *doubt).map(|(_, key)| key)
}

/// All keys, in the order in which they stand.
fn keys(text: &str) -> Vec<Key> {
    fn gather(table: &DeTable<'_>, outer: &str, keys: &mut Vec<Key>) {
        for (key, value) in table {
            let name = format!("{outer}{}", key.get_ref());
            let inner = value.get_ref().as_table();
            keys.push(Key { name: name.clone(), span: key.span().start..value.span().end, leaf: inner.is_none() });
            if let Some(inner) = inner {
                gather(inner, &format!("{name}."), keys);
            }
        }
    }
    let mut keys = Vec::new();
    gather(DeTable::parse_recoverable(text).0.get_ref(), "", &mut keys);
    keys.sort_by_key(|key| key.span.start);
    keys
}

/// The number of the line in which a byte stands.
fn line(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of the fourth line, where it is this one.
    fn fault(wrong: &str) -> String {
        let head = "[scene]\nbuilt_in = \"rooms\"\n\n";
        let text = format!("{head}{wrong}\n");
        Plan::parse(&text).unwrap_err().what()
    }

    #[test]
    fn keys_and_lines_are_the_true_ones() {
        let walk = "[walk]\nkind = \"uniform\"\nsteps = 5\n";
        for (text, expected) in [
            (format!("{walk}step = \"x\""), "line 7: walk.step: must be a number, such as 0.5, and is \"x\""),
            (format!("{walk}step = 1.0\nstpes = 3"), "line 8: walk.stpes: unknown field `stpes`"),
            (walk.replace("uniform", "unifrom"), "line 5: walk.kind: unknown variant `unifrom`"),
            (walk.to_owned(), "line 4: walk: missing field `step`"),
            (format!("{walk}step = 1.0\nturn = 3.0"), "line 8: walk.turn: unknown field `turn`"),
            (
                format!("{walk}step = 1.0\n[run]\nblock = 10\ntraces = -1"),
                "line 10: run.traces: must be a whole number, 0 or more, and is -1",
            ),
            (format!("{walk}step = 1.0\n[run]\nblock = 10\ntraces = 0"), "line 8: run: `traces` and `block`"),
            (format!("{walk}step = 1.0\nat_walls = \"jump\""), "line 8: walk.at_walls: unknown variant `jump`"),
            (format!("{walk}step = -1.0"), "line 7: walk.step: -1 is no length"),
            (format!("{walk}step = 1.0\ntether = 0"), "line 8: walk.tether: 0 is no length of a tether; give a number"),
            (
                format!("{walk}step = 1.0\ntether = 'long'"),
                "line 8: walk.tether: must be a number, such as 0.5, and is \"long\"",
            ),
            (format!("{walk}step = 1.0\nat_tether = 'slide'"), "line 8: walk.at_tether: there is no tether; give"),
            (format!("{walk}step = 1.0\ntether = 5\nat_tether = 'jump'"), "line 9: walk.at_tether: unknown variant"),
            (format!("{walk}step = 1.0\ntehter = 5"), "line 8: walk.tehter: unknown field `tehter`"),
            (
                format!("{walk}step = 1.0\ntether = 5").replace("uniform", "waypoints"),
                "line 8: walk.tether: only walks whose steps are drawn one after the other are held back by a tether: \
                 give the kind uniform, gaussian or persistent;",
            ),
            (
                "[walk]\nkind = \"given\"\nfile = \"a.csv\"\nat_tether = 'stay'".to_owned(),
                "line 7: walk.at_tether: only",
            ),
            (format!("{walk}step = 1.0\n[run]\ntether = 5"), "line 9: run.tether: unknown field `tether`"),
            (
                format!("{walk}step = 1.0\n[tallies]\nlimits = [1.0, 'a']"),
                "line 9: tallies.limits: must be a number, such as 0.5, and is \"a\"",
            ),
            (format!("{walk}step = 1.0\nwalk.x = 1"), "line 8: walk.walk: unknown field `walk`"),
            (format!("{walk}step = 1.0\n[wlak]\nstep = 1.0"), "line 8: wlak: unknown field `wlak`"),
            (format!("{walk}step = 1e-400"), "line 7: walk.step: 1e-400 is too small"),
            (
                format!("{walk}step = 1.0\n[run]\nblock = 99999999999"),
                "line 9: run.block: must be a whole number up to",
            ),
            (
                format!("{walk}step = 1.0\n[run]\nseed = 1979-05-27"),
                "line 9: run.seed: must be a whole number, 0 or more, and is the date 1979",
            ),
            (
                format!("{walk}step = 1.0\n[run]\nprecision = 3"),
                "line 9: run.precision: must be \"certified\" or \"fast\", and is 3",
            ),
            (
                format!("{walk}step = 1.0\nat_walls = true"),
                "line 8: walk.at_walls: must be \"redraw\", \"reject\" or \"reflect\", and is true",
            ),
            (format!("{walk}step = 1.0\nstart = 3"), "line 8: walk.start: must be \"anchor\" or \"visible\", and is 3"),
            ("[walk]\nkind = 3".to_owned(), "line 5: walk.kind: must be \"uniform\", "),
            ("walk = 3".to_owned(), "line 4: scene.walk: unknown field `walk`"),
            (format!("{walk}step = [1.0]"), "line 7: walk.step: must be a number, such as 0.5, and is a list"),
            (
                walk.replace("5", "5.5") + "step = 1.0",
                "line 6: walk.steps: must be a whole number, 0 or more, and is 5.5",
            ),
            (
                format!("{walk}step = 1.0\n[outputs]\ntraces = 1"),
                "line 9: outputs.traces: must be true or false, and is 1",
            ),
            (
                format!("{walk}step = 1.0\n[tallies]\nlimits = 3"),
                "line 9: tallies.limits: must be a list in brackets, and is 3",
            ),
            (
                format!("{walk}step = 1.0\n[run.block]\na = 1"),
                "line 8: run.block: must be a whole number, 0 or more, and is a table",
            ),
            (format!("run = 3\n{walk}step = 1.0"), "line 4: scene.run: unknown field `run`"),
            (
                format!("{walk}step = 1.0\n[run]\ntraces = 1e3"),
                "line 9: run.traces: must be a whole number, 0 or more, and is 1000.0",
            ),
            (format!("{walk}step = 1.0 1"), "line 7: "),
            (format!("{walk}step = 1.0\nsteps = 7"), "line 8: duplicate key"),
        ] {
            let what = fault(&text);
            assert!(what.starts_with(expected), "{text}\n{what}\n{expected}");
        }
        let what =
            Plan::parse("[scene]\nfile = \"a.wkt\"\nanchor = \"here\"\n[walk]\nkind = \"given\"\nfile = \"a.csv\"");
        assert_eq!(what.unwrap_err().what(), "line 3: scene.anchor must be [x, y], a list of such, or { sample = N }");
        let what = Plan::parse(&format!("scene = {{ file = 3 }}\n{walk}step = 1.0")).unwrap_err().what();
        assert_eq!(what, "line 1: scene.file: must be a text in quotes, and is 3");
        let what = Plan::parse(&format!("run = 3\n[scene]\nbuilt_in = 'rooms'\n{walk}step = 1.0")).unwrap_err().what();
        assert_eq!(what, "line 1: run: must be a table with keys of its own, and is 3");
        let walk = walk.replace("steps", "stpes");
        let what = Plan::parse(&format!("[scene]\nbuilt_in = 'rooms'\nanchor = {{ sample = 3 }}\n{walk}step = 1.0"));
        assert!(what.unwrap_err().what().starts_with("line 6: walk.stpes: unknown field `stpes`"));
        let what = Plan::parse("scene = { file = \"a.wkt\",\n anchor = [0.0,\n 1e-400] }\nwalk = { kind = \"given\" }");
        assert!(what.unwrap_err().what().starts_with("line 4: walk: missing field `file`"));
    }
}
