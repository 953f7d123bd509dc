//! Scenes as GeoJSON: lines and rings are walls, a point with property `"role": "anchor"` is the anchor.

mod document;
mod properties;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap};

use geojson::{Feature, GeoJson, Geometry, GeometryValue, JsonValue, Position};
use glam::DVec2;

use super::format::SceneFormat;
use super::lines::Lines;
use super::{Inside, Object, Scene, geographic, layers};
use crate::geometry::check_point;
use crate::read_error::{Fault, Place};
use crate::read_file::{SCENE_MAX, read_text};
use crate::words::plainly;
use properties::Kept;

/// GeoJSON.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".geojson", ".json"],
    files: ".geojson, .json",
    anchor: "put a Point with the property \"role\": \"anchor\" into the file",
    read: |path, options| {
        parse(&read_text(path, SCENE_MAX)?, &layers::keys(options)).map_err(|fault| fault.in_file(path))
    },
};

/// Reads a FeatureCollection, a Feature or a bare geometry.
///
/// LineString, LinearRing, MultiLineString, Polygon and MultiPolygon give one wall for each pair of consecutive
/// positions; points that are no anchor are passed over. The member `"y": "down"` of a FeatureCollection says so.
/// Further numbers of a position (its altitude) are passed over too. Walls can be chosen by what the properties called
/// `keys` say.
fn parse(text: &str, keys: &BTreeSet<&str>) -> Result<Scene, Fault> {
    let document = document::parse(text)?;
    let mut found = Found { keys: keys.clone(), ..Found::default() };
    let degrees = is_in_degrees(&document);
    let y_down = member(&document, "y").and_then(JsonValue::as_str) == Some("down");
    match document {
        GeoJson::FeatureCollection(collection) => {
            for (i, feature) in collection.features.iter().enumerate() {
                found.feature(feature, i)?;
            }
        }
        GeoJson::Feature(feature) => found.feature(&feature, 0)?,
        GeoJson::Geometry(geometry) => found.geometry(&geometry, &Place::default(), None)?,
    }
    let mut scene = found.lines.scene()?;
    if let Some((anchor, _)) = found.anchor {
        scene = scene.with_anchor(anchor);
    }
    found.notes.into_iter().for_each(|note| scene.note(note));
    for (count, what) in [
        (found.nulls, "features without a geometry (null), passed over"),
        (found.points, "points that mark no anchor, passed over"),
    ] {
        if count > 0 {
            scene.note(format!("{what}: {count}"));
        }
    }
    if degrees.unwrap_or_else(|| geographic::looks_so(scene.vertices())) {
        scene.note(geographic::WARNING);
    }
    Ok(if y_down { scene.with_y_down() } else { scene })
}

/// A member of a FeatureCollection that GeoJSON does not define.
fn member<'a>(document: &'a GeoJson, name: &str) -> Option<&'a JsonValue> {
    let GeoJson::FeatureCollection(collection) = document else { return None };
    collection.foreign_members.as_ref()?.get(name)
}

/// What the document's `crs` says, as files have it that were written by GDAL or before RFC 7946.
fn is_in_degrees(document: &GeoJson) -> Option<bool> {
    let name = member(document, "crs")?.pointer("/properties/name")?.as_str()?;
    Some(["CRS84", "CRS84h", "4326", "4979"].iter().any(|code| name.rsplit(':').next() == Some(code)))
}

/// What the features seen so far hold.
#[derive(Default)]
struct Found<'a> {
    lines: Lines,
    /// The properties by which walls are chosen.
    keys: BTreeSet<&'a str>,
    /// What the feature says of itself.
    object: Object,
    /// The anchor and the number of its feature.
    anchor: Option<(DVec2, usize)>,
    /// How many features have no geometry, and how many points mark no anchor.
    nulls: usize,
    points: usize,
    notes: Vec<String>,
    /// Where the feature at hand is a part of an object that several features may share: its number and the outline's
    /// direction.
    part: Option<(u32, bool)>,
    /// Which object is that of each number in the file.
    shared: HashMap<u64, u32>,
}

impl Found<'_> {
    fn feature(&mut self, feature: &Feature, number: usize) -> Result<(), Fault> {
        let place = Place::default().then("feature", number);
        let is_anchor = feature.property("role").and_then(JsonValue::as_str) == Some("anchor");
        self.object = properties::object(feature, &self.keys);
        self.part = properties::kept(feature, &self.object).map(|Kept { number, reversed, object }| {
            let lines = &mut self.lines;
            let number = *self.shared.entry(number).or_insert_with(|| {
                lines.begin(object);
                lines.object()
            });
            (number, reversed)
        });
        match &feature.geometry {
            None => self.nulls += 1,
            Some(geometry) => {
                let is_point = matches!(geometry.value, GeometryValue::Point { .. });
                if let Some(how) = properties::almost_anchor(feature).filter(|_| is_point && !is_anchor) {
                    self.notes.push(format!(
                        "feature {number} is a point with {how} and is not taken for the anchor: that has \"role\": \
                         \"anchor\""
                    ));
                }
                self.geometry(geometry, &place, is_anchor.then_some(number))?;
            }
        }
        // A role that no point takes up is a mistake that would otherwise show as a missing anchor.
        if is_anchor && self.anchor.is_none_or(|(_, of)| of != number) {
            let kind = feature.geometry.as_ref().map_or("null", |g| g.value.type_name());
            return Err(Fault::new(place, format!("role is anchor, but the geometry is {kind}; it must be a Point")));
        }
        Ok(())
    }

    /// Adds `geometry`; `anchor_of` is the number of its feature if that marks the anchor.
    fn geometry(&mut self, geometry: &Geometry, place: &Place, anchor_of: Option<usize>) -> Result<(), Fault> {
        match &geometry.value {
            GeometryValue::Point { coordinates } => match anchor_of {
                Some(number) => self.mark_anchor(point(coordinates, place)?, number, place)?,
                None => self.points += 1,
            },
            GeometryValue::MultiPoint { coordinates } => self.points += coordinates.len(),
            GeometryValue::LineString { coordinates } => self.line(coordinates, place)?,
            GeometryValue::MultiLineString { coordinates } => {
                for (i, line) in coordinates.iter().enumerate() {
                    self.line(line, &place.then("line string", i))?;
                }
            }
            GeometryValue::Polygon { coordinates } => self.polygon(coordinates, place)?,
            GeometryValue::MultiPolygon { coordinates } => {
                for (i, rings) in coordinates.iter().enumerate() {
                    self.polygon(rings, &place.then("polygon", i))?;
                }
            }
            GeometryValue::GeometryCollection { geometries } => {
                for (i, geometry) in geometries.iter().enumerate() {
                    self.geometry(geometry, &place.then("geometry", i), anchor_of)?;
                }
            }
        }
        Ok(())
    }

    fn mark_anchor(&mut self, at: DVec2, number: usize, place: &Place) -> Result<(), Fault> {
        if let Some((_, first)) = self.anchor {
            let what = format!("a second anchor; feature {first} marks one already, and a scene has one at most");
            return Err(Fault::new(place.clone(), what));
        }
        self.anchor = Some((at, number));
        Ok(())
    }

    /// Adds the walls of one line string.
    fn line(&mut self, positions: &[Position], place: &Place) -> Result<(), Fault> {
        match self.part {
            Some((object, reversed)) => self.lines.resume(object, reversed),
            None => self.lines.begin(self.object.clone()),
        }
        self.lines.push_line(positions.iter().map(point_of), place)
    }

    fn polygon(&mut self, rings: &[Vec<Position>], place: &Place) -> Result<(), Fault> {
        self.lines.begin_polygon(&self.object);
        let mut rings = rings.iter().enumerate();
        rings.try_for_each(|(i, ring)| self.lines.push_ring(ring.iter().map(point_of), &place.then("ring", i)))
    }
}

fn point(position: &Position, place: &Place) -> Result<DVec2, Fault> {
    point_of(position).map_err(|what| Fault::new(place.clone(), what))
}

/// The position's x and y, or what is wrong with them.
fn point_of(position: &Position) -> Result<DVec2, String> {
    match position.as_slice() {
        [x, y, ..] => check_point(DVec2::new(*x, *y)).map_err(|fault| fault.to_string()),
        short => {
            Err(format!("a position of {}; it needs two, x and y", plainly(short.len() as u64, "number", "numbers")))
        }
    }
}
