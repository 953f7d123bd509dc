//! From text to a document, or to what is wrong with it and where.

use geojson::{Feature, GeoJson, JsonValue};

use crate::number::{self, VANISHES};
use crate::read_error::{Fault, Place};
use crate::scene::excerpt;

/// The document. A LinearRing, which some programs write, becomes the LineString that it is.
///
/// The second look at a document that is not taken at once costs several times its size; it is a rare one.
pub(super) fn parse(text: &str) -> Result<GeoJson, Fault> {
    check_numbers(text)?;
    serde_json::from_str(text).or_else(|e| {
        let Ok(mut value) = serde_json::from_str::<JsonValue>(text) else { return Err(fault(&e, None)) };
        let rings = replace_rings(&mut value);
        if let Some(features) = value.get("features").and_then(JsonValue::as_array) {
            for (number, feature) in features.iter().enumerate() {
                serde_json::from_value::<Feature>(feature.clone()).map_err(|e| fault(&e, Some(number)))?;
            }
        }
        match serde_json::from_value(value) {
            Ok(document) => Ok(document),
            Err(other) => Err(fault(if rings { &other } else { &e }, None)),
        }
    })
}

/// Refuses numbers that the parser would round to 0. They are looked for outside of strings.
fn check_numbers(text: &str) -> Result<(), Fault> {
    let (mut rest, mut quoted) = (text, false);
    while !rest.is_empty() {
        let end = rest.find('"').unwrap_or(rest.len());
        let at = text.len() - rest.len();
        if !quoted && let Some(number) = number::vanishing(&rest[..end]) {
            let before = &text[..at + number.start];
            let column = before.len() - before.rfind('\n').map_or(0, |end| end + 1) + 1;
            let place = Place::line(before.matches('\n').count() as u64 + 1).then("column", column);
            return Err(Fault::new(place, format!("{} is {VANISHES}", excerpt(&rest[number]))));
        }
        let escaped = quoted && rest[..end].bytes().rev().take_while(|&b| b == b'\\').count() % 2 == 1;
        quoted ^= !escaped;
        rest = rest.get(end + 1..).unwrap_or_default();
    }
    Ok(())
}

/// Makes a LineString of each LinearRing; whether there are any.
fn replace_rings(value: &mut JsonValue) -> bool {
    let mut found = false;
    if let Some(kind) = value.get_mut("type").filter(|kind| *kind == "LinearRing") {
        *kind = "LineString".into();
        found = true;
    }
    for key in ["features", "geometries"] {
        for part in value.get_mut(key).and_then(JsonValue::as_array_mut).into_iter().flatten() {
            found |= replace_rings(part);
        }
    }
    value.get_mut("geometry").is_some_and(replace_rings) || found
}

/// Moves the place out of the parser's message to where all messages have it; that of a feature is its number.
fn fault(e: &serde_json::Error, feature: Option<usize>) -> Fault {
    let message = e.to_string();
    let suffix = format!(" at line {} column {}", e.line(), e.column());
    let place = match (feature, e.line()) {
        (Some(number), _) => Place::default().then("feature", number),
        (None, 0) => Place::default(),
        (None, line) => Place::default().then("line", line).then("column", e.column()),
    };
    let message = message.strip_suffix(&suffix).unwrap_or(&message);
    let message = message.strip_prefix("Error while deserializing GeoJSON: ").unwrap_or(message);
    // An empty list in place of a polygon says nothing of how deep it is.
    let right = match message.contains("coordinates dimensions") {
        true => {
            "; its coordinates must be nested as deep as its type says, and none may be an empty list in place of a \
             polygon"
        }
        false => "",
    };
    Fault::new(place, format!("not GeoJSON: {message}{right}"))
}
