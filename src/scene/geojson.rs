//! Scenes as GeoJSON: lines and rings are walls, a point with property `"role": "anchor"` is the anchor.

use geojson::{Feature, GeoJson, Geometry, GeometryValue, JsonValue, Position};
use glam::DVec2;

use super::lines::Lines;
use super::{Object, Scene, excerpt, geographic};
use crate::geometry::check_point;
use crate::number::{self, VANISHES};
use crate::read_error::{Fault, Place};

/// Reads a FeatureCollection, a Feature or a bare geometry.
///
/// LineString, MultiLineString, Polygon and MultiPolygon give one wall for each pair of consecutive positions; points
/// that are no anchor are passed over. The member `"y": "down"` of a FeatureCollection says so. Further numbers of a position (its altitude) are passed over too.
pub(super) fn parse(text: &str) -> Result<Scene, Fault> {
    check_numbers(text)?;
    let document: GeoJson = serde_json::from_str(text).map_err(|e| syntax_fault(&e))?;
    let mut found = Found::default();
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
    if degrees.unwrap_or_else(|| geographic::looks_so(scene.vertices())) {
        scene.note(geographic::WARNING);
    }
    Ok(if y_down { scene.with_y_down() } else { scene })
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

/// Moves the place out of the parser's message to where all messages have it.
fn syntax_fault(e: &serde_json::Error) -> Fault {
    let message = e.to_string();
    let suffix = format!(" at line {} column {}", e.line(), e.column());
    let place = match e.line() {
        0 => Place::default(),
        line => Place::default().then("line", line).then("column", e.column()),
    };
    let message = message.strip_suffix(&suffix).unwrap_or(&message);
    let message = message.strip_prefix("Error while deserializing GeoJSON: ").unwrap_or(message);
    Fault::new(place, format!("not GeoJSON: {message}"))
}

/// What the features seen so far hold.
#[derive(Default)]
struct Found {
    lines: Lines,
    /// What the feature says of itself.
    object: Object,
    /// The anchor and the number of its feature.
    anchor: Option<(DVec2, usize)>,
}

impl Found {
    fn feature(&mut self, feature: &Feature, number: usize) -> Result<(), Fault> {
        let place = Place::default().then("feature", number);
        let is_anchor = feature.property("role").and_then(JsonValue::as_str) == Some("anchor");
        if let Some(geometry) = &feature.geometry {
            self.geometry(geometry, &place, is_anchor.then_some(number))?;
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
            GeometryValue::Point { coordinates } => {
                if let Some(number) = anchor_of {
                    self.mark_anchor(point(coordinates, place)?, number, place)?;
                }
            }
            GeometryValue::MultiPoint { .. } => {}
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
        self.lines.begin(self.object.clone());
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
        short => Err(format!("a position of {} numbers; it needs two, x and y", short.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> String {
        let fault = parse(text).unwrap_err();
        format!("{}: {}", fault.place, fault.what)
    }

    fn features(features: &[&str]) -> String {
        let all: Vec<String> = features
            .iter()
            .map(|f| match f.split_once('|') {
                Some((role, g)) => {
                    format!(r#"{{"type":"Feature","properties":{{"role":"{role}"}},"geometry":{g}}}"#)
                }
                None => format!(r#"{{"type":"Feature","properties":null,"geometry":{f}}}"#),
            })
            .collect();
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, all.join(",\n"))
    }

    fn geometry(kind: &str, coordinates: &str) -> String {
        format!(r#"{{"type":"{kind}","coordinates":{coordinates}}}"#)
    }

    #[test]
    fn every_kind_of_geometry_gives_its_walls() {
        for (kind, coordinates, walls) in [
            ("LineString", "[[0,0],[1,0],[2,1]]", 2),
            ("LineString", "[]", 0),
            ("MultiLineString", "[[[0,0],[1,0]],[[5,5],[6,6],[7,5]]]", 3),
            ("Polygon", "[[[0,0],[9,0],[9,9],[0,0]],[[2,1],[3,1],[3,2],[2,1]]]", 6),
            ("MultiPolygon", "[[[[0,0],[9,0],[9,9],[0,0]]],[[[20,1],[30,1],[30,2],[20,1]]]]", 6),
            ("Point", "[1,2]", 0),
            ("MultiPoint", "[[1,2],[3,4]]", 0),
        ] {
            let g = geometry(kind, coordinates);
            let collection = format!(r#"{{"type":"GeometryCollection","geometries":[{g},{g}]}}"#);
            let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{g}}}"#);
            for (text, times) in [(&g, 1), (&feature, 1), (&collection, 2), (&features(&[&g, "null", &g]), 2)] {
                let scene = parse(text).unwrap();
                assert_eq!((scene.walls().len(), scene.anchor()), (walls * times, None), "{text}");
            }
        }
    }

    #[test]
    fn positions_are_read_exactly_and_altitude_is_passed_over() {
        let scene = parse(&geometry("LineString", "[[0.1,-2.2250738585072014e-100,7],[123456789012345678,1e23]]"));
        let scene = scene.unwrap();
        let [u, v] = scene.ends(0);
        assert_eq!([u.x, u.y, v.x, v.y], [0.1, -2.2250738585072014e-100, 123456789012345678.0, 1e23]);
    }

    #[test]
    fn a_wall_of_zero_length_is_dropped_and_counted() {
        let scene = parse(&geometry("LineString", "[[0,0],[0,0],[1,0]]")).unwrap();
        assert_eq!((scene.walls().len(), scene.dropped()), (1, 1));
    }

    #[test]
    fn the_anchor_is_the_point_that_has_the_role() {
        let point = geometry("Point", "[1.5,-2]");
        let anchor = format!("anchor|{point}");
        let scene = parse(&features(&[&point, &format!("tree|{point}"), &anchor])).unwrap();
        assert_eq!(scene.anchor(), Some(DVec2::new(1.5, -2.0)));
        let collection = format!(r#"anchor|{{"type":"GeometryCollection","geometries":[{point}]}}"#);
        assert!(parse(&features(&[&collection])).unwrap().anchor().is_some());

        let two = fault(&features(&[&anchor, &point, &anchor]));
        assert_eq!(two, "feature 2: a second anchor; feature 0 marks one already, and a scene has one at most");
        for (g, kind) in [(geometry("MultiPoint", "[[0,0]]"), "MultiPoint"), ("null".into(), "null")] {
            let what = fault(&features(&[&point, &format!("anchor|{g}")]));
            assert_eq!(what, format!("feature 1: role is anchor, but the geometry is {kind}; it must be a Point"));
        }
    }

    #[test]
    fn faults_of_positions_name_their_place() {
        let g = |kind, coordinates| features(&["null", &geometry(kind, coordinates)]);
        let large = "is too large for exact products: coordinates must lie within 2^500 (3.27e150) of zero";
        let small = "is too small for exact products: coordinates must be 0 or at least 2^-450 (3.4e-136) in magnitude";
        let short = "a position of 1 numbers; it needs two, x and y";
        for (text, expected) in [
            (g("LineString", "[[0,0],[1e200,0]]"), format!("feature 1, position 1: 1e200 {large}")),
            (
                g("MultiLineString", "[[],[[0,1e-200],[0,1]]]"),
                format!("feature 1, line string 1, position 0: 1e-200 {small}"),
            ),
            (g("Polygon", "[[[0,0],[1],[0,0]]]"), format!("feature 1, ring 0, position 1: {short}")),
            (g("MultiPolygon", "[[[]],[[[0,0],[1]]]]"), format!("feature 1, polygon 1, ring 0, position 1: {short}")),
            (geometry("LineString", "[[0,0],[0,-1e300]]"), format!("position 1: -1e300 {large}")),
            (g("LineString", "[[0,0]]"), "feature 1: one position only; a line needs two or more".into()),
            (features(&["anchor|{\"type\":\"Point\",\"coordinates\":[1e200,0]}"]), format!("feature 0: 1e200 {large}")),
        ] {
            assert_eq!(fault(&text), expected);
        }
    }

    #[test]
    fn an_open_ring_is_named() {
        let ring = geometry("MultiPolygon", "[[[[0,0],[1,0],[0,0]],[[0,0],[1,0],[1,1]]]]");
        let what = "the ring is open: it starts at (0, 0) and ends at (1, 1)";
        let expected = format!("feature 0, polygon 0, ring 1: {what}; the last position must repeat the first");
        assert_eq!(fault(&features(&[&ring])), expected);
    }

    #[test]
    fn what_is_not_geojson_is_placed_by_line_and_column() {
        for (text, expected) in [
            ("", "line 1, column 0: not GeoJSON: EOF while parsing a value"),
            ("{\n \"type\": oops", "line 2, column 10: not GeoJSON: expected value"),
            ("[1, 2]", "not GeoJSON: "),
            (r#"{"type":"Wall"}"#, "line 1, column 14: not GeoJSON: unknown variant `Wall`"),
            (r#"{"type":"FeatureCollection"}"#, "not GeoJSON: missing field `features`"),
            (r#"{"type":"LineString","coordinates":[[0,1e999],[1,1]]}"#, "number out of range"),
            (
                r#"{"type":"LineString","coordinates":[[0,NaN],[1,1]]}"#,
                "line 1, column 40: not GeoJSON: expected value",
            ),
            (r#"{"type":"LineString","coordinates":[[0,null],[1,1]]}"#, "line 1, column 43: not GeoJSON: invalid type"),
            (r#"{"type":"LineString","coordinates":[0,1]}"#, "not GeoJSON: "),
            (r#"{"type":"LineString"}"#, "not GeoJSON: "),
            (r#"{"type":"Point","coordinates":[]}"#, "A position must contain two or more"),
        ] {
            let what = fault(text);
            assert!(what.contains(expected), "{text}: {what}");
            assert!(!what.contains(" at line"), "{what}");
        }
        let deep = format!("{}{}", r#"{"type":"GeometryCollection","geometries":["#.repeat(500), "]}".repeat(500));
        assert!(fault(&deep).contains("recursion limit"));
    }
}
