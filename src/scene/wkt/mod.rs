//! Scenes as well-known text: lines and rings are walls, a lone point is the anchor.

mod statements;

use std::borrow::Cow;
use std::str::FromStr;

use glam::DVec2;
use wkt::Wkt;
use wkt::types::{Coord, LineString, Polygon};

use super::format::SceneFormat;
use super::geographic;
use super::lines::Lines;
use super::{Object, Scene, excerpt};
use crate::geometry::check_point;
use crate::number::{self, NumberFault, VANISHES};
use crate::read_error::{Fault, Place};
use crate::read_file::{SCENE_MAX, read_text};
use statements::Statements;

/// Well-known text.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".wkt"],
    files: ".wkt",
    anchor: "put one POINT into the file",
    read: |path, _| parse(&read_text(path, SCENE_MAX)?).map_err(|fault| fault.in_file(path)),
};

/// What to do about a third number where the geometry does not announce it.
fn third_number(geometry: &str) -> &'static str {
    let head = geometry.split('(').next().unwrap_or_default();
    let is_announced = head.split_whitespace().count() > 1 || head.trim_end().ends_with(['Z', 'z', 'M', 'm']);
    let is_there = geometry.split(['(', ',', ')']).skip(1).any(|point| point.split_whitespace().count() == 3);
    if is_there && !is_announced {
        "; a third number of a point needs a Z, as in LINESTRING Z (0 0 1, 1 0 2)"
    } else {
        ""
    }
}

/// Reads geometries one after the other, each with or without `SRID=...;` before it.
///
/// LINESTRING, MULTILINESTRING, POLYGON and MULTIPOLYGON give one wall for each pair of consecutive positions. A POINT
/// is the anchor if the file has exactly one. Z and M are passed over, as are lines that start with `#` or `--`.
fn parse(text: &str) -> Result<Scene, Fault> {
    let mut found = Found::default();
    let mut statements = Statements::new(text);
    let mut count = 0;
    while let Some(statement) = statements.next()? {
        let place = Place::line(statement.line);
        if let Some((at, fault)) = number::wrong(statement.geometry) {
            let (before, word) = (&statement.geometry[..at.start], excerpt(&statement.geometry[at]));
            let line = statement.line + before.matches('\n').count() as u64;
            let what = match fault {
                NumberFault::NoNumber => {
                    format!("not WKT: {word:?} stands where a number must stand, such as -1.25 or 3e-7")
                }
                NumberFault::Vanishes => format!("{word:?} is {VANISHES}"),
            };
            return Err(Fault::new(Place::line(line), what));
        }
        let geometry = Wkt::<f64>::from_str(&with_signs(statement.geometry)).map_err(|e| {
            let (shown, third) = (excerpt(statement.geometry), third_number(statement.geometry));
            Fault::new(place.clone(), format!("not WKT: {e}: {shown:?}{third}"))
        })?;
        found.geometry(&geometry, &place)?;
        found.geographic |= matches!(statement.srid, Some(4326 | 4258 | 4269));
        found.projected |= statement.srid.is_some_and(|srid| srid != 0) && !found.geographic;
        count += 1;
    }
    if count == 0 {
        let what = "no geometry; a scene is made of LINESTRING, MULTILINESTRING, POLYGON and MULTIPOLYGON";
        return Err(Fault::new(Place::default(), what));
    }
    found.scene()
}

/// The same with a sign before each NaN and infinity, as programs write an altitude that they do not know: the parser
/// takes them for numbers only then.
fn with_signs(text: &str) -> Cow<'_, str> {
    let is_end = |b: u8| b.is_ascii_whitespace() || matches!(b, b'(' | b')' | b',');
    let mut signed = String::new();
    let mut from = 0;
    for (at, word) in text.split(|c: char| c.is_ascii() && is_end(c as u8)).scan(0, |next, word| {
        let at = *next;
        *next += word.len() + 1;
        Some((at, word))
    }) {
        // Not the name of a geometry.
        if at > 0 && ["nan", "inf", "infinity"].iter().any(|name| word.eq_ignore_ascii_case(name)) {
            signed += &text[from..at];
            signed.push('+');
            from = at;
        }
    }
    if from == 0 { Cow::Borrowed(text) } else { Cow::Owned(signed + &text[from..]) }
}

/// What the geometries seen so far hold.
#[derive(Default)]
struct Found {
    lines: Lines,
    points: Vec<DVec2>,
    /// Whether an SRID says so.
    geographic: bool,
    projected: bool,
}

impl Found {
    fn geometry(&mut self, geometry: &Wkt<f64>, place: &Place) -> Result<(), Fault> {
        match geometry {
            Wkt::Point(point) => {
                if let Some(c) = point.coord() {
                    self.points.push(position(c).map_err(|what| Fault::new(place.clone(), what))?);
                }
            }
            Wkt::MultiPoint(_) => {}
            Wkt::LineString(line) => self.line(line, place)?,
            Wkt::MultiLineString(lines) => {
                for (i, line) in lines.line_strings().iter().enumerate() {
                    self.line(line, &place.then("line string", i))?;
                }
            }
            Wkt::Polygon(polygon) => self.polygon(polygon, place)?,
            Wkt::MultiPolygon(polygons) => {
                for (i, polygon) in polygons.polygons().iter().enumerate() {
                    self.polygon(polygon, &place.then("polygon", i))?;
                }
            }
            Wkt::GeometryCollection(collection) => {
                for (i, geometry) in collection.geometries().iter().enumerate() {
                    self.geometry(geometry, &place.then("geometry", i))?;
                }
            }
        }
        Ok(())
    }

    fn line(&mut self, line: &LineString<f64>, place: &Place) -> Result<(), Fault> {
        self.lines.begin(Object::default());
        self.lines.push_line(line.coords().iter().map(position), place)
    }

    fn polygon(&mut self, polygon: &Polygon<f64>, place: &Place) -> Result<(), Fault> {
        self.lines.begin_polygon(&Object::default());
        let mut rings = polygon.rings().iter().enumerate();
        rings.try_for_each(|(i, ring)| self.lines.push_ring(ring.coords().iter().map(position), &place.then("ring", i)))
    }

    fn scene(self) -> Result<Scene, Fault> {
        let mut scene = self.lines.scene()?;
        match self.points[..] {
            [] => {}
            [anchor] => scene = scene.with_anchor(anchor),
            _ => {
                scene.note(format!("{} POINTs; a scene's anchor is the only one, so none is taken", self.points.len()))
            }
        }
        if self.geographic || (!self.projected && geographic::looks_so(scene.vertices())) {
            scene.note(geographic::WARNING);
        }
        Ok(scene)
    }
}

fn position(c: &Coord<f64>) -> Result<DVec2, String> {
    check_point(DVec2::new(c.x, c.y)).map_err(|fault| fault.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walls(text: &str) -> Vec<[f64; 4]> {
        let scene = parse(text).unwrap_or_else(|fault| panic!("{text}: {}: {}", fault.place, fault.what));
        (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
    }

    fn fault(text: &str) -> String {
        let Err(fault) = parse(text) else { panic!("{text} was taken") };
        format!("{}: {}", fault.place, fault.what)
    }

    #[test]
    fn every_kind_of_geometry_gives_its_walls() {
        let line = [0.0, 0.0, 1.0, 0.5];
        let triangle = [[0., 0., 4., 0.], [4., 0., 0., 4.], [0., 4., 0., 0.]];
        let hole = [[1., 1., 2., 1.], [2., 1., 1., 2.], [1., 2., 1., 1.]];
        let rings = "((0 0, 4 0, 0 4, 0 0), (1 1, 2 1, 1 2, 1 1))";
        assert_eq!(walls("LINESTRING (0 0, 1 .5)"), [line]);
        assert_eq!(walls("LINEARRING(0 0,1 0.5)"), [line]);
        assert_eq!(walls("multilinestring((0 0,1 5e-1),(0 0,1 0.5))"), [line, line]);
        assert_eq!(walls(&format!("POLYGON {rings}")), [triangle, hole].concat());
        assert_eq!(walls(&format!("MULTIPOLYGON ({rings}, ((1 1, 2 1, 1 2, 1 1)))")), [triangle, hole, hole].concat());
        let collection = "GEOMETRYCOLLECTION (LINESTRING (0 0, 1 0.5), GEOMETRYCOLLECTION (LINESTRING (0 0, 1 0.5)))";
        assert_eq!(walls(collection), [line, line]);
        for none in ["LINESTRING EMPTY", "POLYGON EMPTY", "MULTIPOINT (1 2, 3 4)", "geometrycollection empty\n"] {
            assert!(walls(none).is_empty(), "{none}");
        }
        // Further coordinates are passed over, in each spelling.
        for text in ["LINESTRING Z (0 0 7, 1 0.5 8)", "LINESTRINGM(0 0 7,1 0.5 8)", "LINESTRING ZM (0 0 7 1,1 0.5 8 1)"]
        {
            assert_eq!(walls(text), [line], "{text}");
        }
    }

    #[test]
    fn an_altitude_that_is_not_known_is_passed_over() {
        for text in [
            "LINESTRING Z (1 0 5, 1 1 NaN)",
            "LINESTRING Z (1 0 nan,1 1 nan)",
            "LINESTRING ZM (1 0 NaN -nan, 1 1 +NaN NAN)",
            "LINESTRING M (1 0 inf, 1 1 -inf)",
        ] {
            assert_eq!(walls(text), [[1.0, 0.0, 1.0, 1.0]], "{text}");
        }
    }

    #[test]
    fn geometries_follow_each_other_as_people_write_them() {
        let line = [0.0, 0.0, 1.0, 0.5];
        let one = "LINESTRING (0 0, 1 0.5)";
        for text in [
            format!("{one}\n{one}\n"),
            format!("{one};{one};"),
            format!("# walls\r\n{one}\r\n\r\n-- and\r\n  {one}"),
            format!("SRID=32633;{one}\nsrid=0; {one}"),
            format!("LINESTRING EMPTY {one} POLYGON\nEMPTY\n{one} LINESTRING EMPTY"),
            "LINESTRING\n(0 0,\n1 0.5)\nLINESTRING(0\n0, 1 0.5)# end".into(),
        ] {
            assert_eq!(walls(&text), [line, line], "{text}");
        }
    }

    #[test]
    fn a_lone_point_is_the_anchor() {
        let line = "LINESTRING (0 0, 1 0.5)\n";
        let scene = parse(&format!("{line}POINT (0.1 -2)")).unwrap();
        assert_eq!((scene.anchor(), scene.notes().len()), (Some(DVec2::new(0.1, -2.0)), 0));
        assert_eq!(
            parse(&format!("{line}GEOMETRYCOLLECTION (POINT Z (3 4 5))")).unwrap().anchor(),
            Some(DVec2::new(3.0, 4.0))
        );
        let two = parse(&format!("POINT (0 0)\n{line}POINT (0 0)")).unwrap();
        assert_eq!((two.anchor(), two.notes().len()), (None, 1));
        assert!(two.notes()[0].starts_with("2 POINTs; "), "{:?}", two.notes());
        assert_eq!(parse("POINT EMPTY").unwrap().anchor(), None);
    }

    #[test]
    fn degrees_are_warned_about() {
        let warned = |text: &str| parse(text).unwrap().notes().iter().any(|note| note == geographic::WARNING);
        assert!(warned("SRID=4326;LINESTRING (0 0, 1 0.5)"));
        assert!(!warned("SRID=32633;LINESTRING (13.37771 52.51628, 13.40952 52.52083)"));
        assert!(warned("LINESTRING (13.37771 52.51628, 13.40952 52.52083)"));
    }

    #[test]
    fn faults_name_line_and_part() {
        let line = "LINESTRING (0 0, 1 0.5)\n";
        let large = "is too large for exact products: coordinates must lie within 2^500 (3.27e150) of zero";
        for (text, expected) in [
            (format!("{line}LINESTRING (0 0, 1e200 0)"), format!("line 2, position 1: 1e200 {large}")),
            (format!("{line}\nPOINT (0 -1e999)"), "line 3: -inf is not a finite number".into()),
            (
                "MULTIPOLYGON (((0 0, 1 0, 0 0), (0 0, 1 0, 1 1)))".into(),
                "line 1, polygon 0, ring 1: the ring is open: it starts at (0, 0) and ends at (1, 1); the last \
                 position must repeat the first"
                    .into(),
            ),
            (
                "GEOMETRYCOLLECTION (POINT (0 0), LINESTRING (0 0))".into(),
                "line 1, geometry 1: one position only; a line needs two or more".into(),
            ),
            (
                "".into(),
                ": no geometry; a scene is made of LINESTRING, MULTILINESTRING, POLYGON and \
                MULTIPOLYGON"
                    .into(),
            ),
            (
                format!("{line}SRID=x;{line}"),
                "line 2: \"SRID=x;LINESTRING (0 0, 1 0.5)\\n\"; write SRID=4326; for one".into(),
            ),
        ] {
            assert_eq!(fault(&text), expected);
        }
        for (text, part) in [
            ("WALL (0 0, 1 1)", "line 1: not WKT: Invalid type"),
            ("LINESTRING (0 0, 1)", "line 1: not WKT: "),
            ("LINESTRING (0 0, 1 nan)", "line 1, position 1: NaN is not a finite number"),
            ("LINESTRING Z (0 0 5, NaN 1 NaN)", "line 1, position 1: NaN is not a finite number"),
            ("LINESTRING (0 0, 1 Infinity)", "line 1, position 1: inf is not a finite number"),
            ("LINESTRING (0 0, 1 nano)", "line 1: not WKT: "),
            ("LINESTRING (0 0, 1 xnan)", "line 1: not WKT: "),
            ("NaN (0 0, 1 1)", "line 1: not WKT: "),
            ("LINESTRING (0 0, 1 1) x", "line 1: not WKT: "),
            ("LINESTRING (0 0, 1 1))", "line 1: not WKT: "),
            ("LINESTRING (0 0 0, 1 1 1)", "needs a Z, as in LINESTRING Z"),
            ("LINESTRING (0,0 1,1)", "line 1: not WKT: "),
            ("\nLINESTRING (0 0, 1 1", "line 2: the file ends inside of this geometry; open parentheses: 1"),
            ("CIRCULARSTRING (0 0, 1 1, 2 0)", "line 1: not WKT: Invalid type"),
            ("é", "line 1: not WKT: "),
        ] {
            let what = fault(text);
            assert!(what.contains(part), "{text}: {what}");
        }
        let deep = "GEOMETRYCOLLECTION(".repeat(100_000);
        assert!(fault(&deep).contains("more than 64 deep"));
    }
}
