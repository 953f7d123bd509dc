//! What a feature's properties say of it.

use std::collections::BTreeSet;

use geojson::feature::Id;
use geojson::{Feature, JsonValue};

use super::super::object::MEMBER;
use super::{Inside, Object};

/// The feature's label: its property `label`, else `name`, else its id where that is a text. Its layers: its property
/// `layer`, and for each of the `keys` that it has as a property, `KEY=VALUE`. Names of properties may be in any case.
pub(super) fn object(feature: &Feature, keys: &BTreeSet<&str>) -> Object {
    let id = match &feature.id {
        Some(Id::String(id)) => Some(id.clone()),
        _ => property(feature, "id").and_then(JsonValue::as_str).map(str::to_owned),
    };
    let text = |key: &str| property(feature, key).and_then(text);
    let label = text("label").or_else(|| text("name")).or(id.filter(|id| !id.is_empty()));
    let chosen = keys.iter().filter_map(|key| Some(format!("{key}={}", text(key)?)));
    Object { label, layers: text("layer").into_iter().chain(chosen).collect(), ..Object::default() }
}

/// What a feature says of the object of which it holds walls, as [`write_scene`](crate::output::write_scene) writes it:
/// which one of the file's, whether its outline goes against them, and the object.
pub(super) struct Kept {
    pub(super) number: u64,
    pub(super) reversed: bool,
    pub(super) object: Object,
}

/// What is kept of an object beside GeoJSON's own, if it is there and sound.
pub(super) fn kept(feature: &Feature, object: &Object) -> Option<Kept> {
    let member = feature.foreign_members.as_ref()?.get(MEMBER)?;
    let inside = member.get("inside").map_or(Some(Inside::Free), |name| Inside::named(name.as_str()?))?;
    let names = member.get("layers").and_then(JsonValue::as_array).into_iter().flatten();
    let mut layers: Vec<String> = names.filter_map(|name| name.as_str().map(str::to_owned)).collect();
    // Those that are asked for by other properties come last.
    layers.extend(object.layers.iter().filter(|layer| !layers.contains(layer)).cloned().collect::<Vec<_>>());
    Some(Kept {
        number: member.get("object")?.as_u64()?,
        reversed: member.get("reversed").and_then(JsonValue::as_bool).unwrap_or(false),
        object: Object { label: object.label.clone(), layers, inside },
    })
}

/// What of a feature looks as if it were meant for the anchor, but is not.
pub(super) fn almost_anchor(feature: &Feature) -> Option<String> {
    let is_anchor = |value: &JsonValue| value.as_str().is_some_and(|text| text.trim().eq_ignore_ascii_case("anchor"));
    let properties = feature.properties.iter().flatten();
    let is_one = |key: &str| ["role", "label", "name", "id", "layer"].iter().any(|k| key.eq_ignore_ascii_case(k));
    let found = properties.clone().find(|(key, value)| is_one(key) && is_anchor(value));
    let id = matches!(&feature.id, Some(Id::String(id)) if id.eq_ignore_ascii_case("anchor"));
    found.map(|(key, value)| format!("{key:?}: {value}")).or(id.then(|| "that id".to_owned()))
}

/// The property of that name, or one whose name differs by its case alone.
fn property<'a>(feature: &'a Feature, key: &str) -> Option<&'a JsonValue> {
    let other = || feature.properties.iter().flatten().find(|(name, _)| name.eq_ignore_ascii_case(key)).map(|(_, v)| v);
    feature.property(key).or_else(other)
}

/// What a value says in a word.
fn text(value: &JsonValue) -> Option<String> {
    match value {
        JsonValue::String(text) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
        JsonValue::Number(_) | JsonValue::Bool(_) => Some(value.to_string()),
        _ => None,
    }
}
