//! Basic shapes.

use glam::DVec2;
use roxmltree::Node;
use svgtypes::NumberListParser;

use super::super::curves::Ellipse;
use super::super::excerpt;
use super::super::pen::{Drawn, Pen};
use super::length::{Along, length};
use super::path;
use super::style::{Style, Value};
use crate::words::plainly;

/// The elements that are drawn as walls.
pub(super) const SHAPES: [&str; 7] = ["circle", "ellipse", "line", "path", "polygon", "polyline", "rect"];

/// The lengths that style sheets do not know.
const ATTRIBUTES_ONLY: [&str; 4] = ["x1", "x2", "y1", "y2"];

/// An element, its style, and the size of its viewport, if that is known.
#[derive(Clone, Copy)]
pub(super) struct Shape<'s, 'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) style: &'s Style<'a>,
    pub(super) viewport: Option<DVec2>,
}

impl Shape<'_, '_, '_> {
    /// Draws the element, which is one of [`SHAPES`].
    pub(super) fn draw(&self, pen: &mut Pen<'_>) -> Result<(), String> {
        match self.node.tag_name().name() {
            "path" => path::draw(self.data()?, pen)?,
            "line" => {
                let [from, to] = [self.point("x1", "y1")?, self.point("x2", "y2")?];
                pen.polyline(&[from, to], false).map_err(|fault| fault.to_string())?;
            }
            "polyline" => pen.polyline(&self.points()?, false).map_err(|fault| fault.to_string())?,
            "polygon" => pen.polyline(&self.points()?, true).map_err(|fault| fault.to_string())?,
            "rect" => self.rect(pen)?,
            _ => {
                let (centre, radii) = self.round()?;
                if radii.min_element() > 0.0 {
                    let [a, b] = [DVec2::new(radii.x, 0.0), DVec2::new(0.0, radii.y)];
                    pen.ellipse(centre, a, b).map_err(|fault| fault.to_string())?;
                }
            }
        }
        Ok(())
    }

    /// Path data: of the attribute, or in a style's `path("...")`.
    fn data(&self) -> Result<&str, String> {
        match self.style.get("d") {
            Some(Value { text, css: false }) => Ok(text),
            Some(value) if !value.is(&["none"]) => {
                let quoted = in_quotes(value.text);
                quoted.ok_or_else(|| {
                    format!("d is {:?} in a style; it must be path(\"...\") or none", excerpt(value.text))
                })
            }
            _ => Ok(""),
        }
    }

    /// The centre, if the element is a circle or an ellipse.
    pub(super) fn centre(&self) -> Result<Option<DVec2>, String> {
        let round = matches!(self.node.tag_name().name(), "circle" | "ellipse");
        if round { self.round().map(|(centre, _)| Some(centre)) } else { Ok(None) }
    }

    /// Centre and radii of a circle or an ellipse.
    fn round(&self) -> Result<(DVec2, DVec2), String> {
        let centre = self.point("cx", "cy")?;
        let radii = if self.node.tag_name().name() == "circle" {
            DVec2::splat(self.size("r", Along::Both)?.unwrap_or(0.0))
        } else {
            self.radii()?
        };
        Ok((centre, radii))
    }

    /// The radii `rx` and `ry`; one that is not given is the other one.
    fn radii(&self) -> Result<DVec2, String> {
        let [rx, ry] = [self.size("rx", Along::X)?, self.size("ry", Along::Y)?];
        Ok(DVec2::new(rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)))
    }

    fn rect(&self, pen: &mut Pen<'_>) -> Result<(), String> {
        let low = self.point("x", "y")?;
        let [width, height] = [self.size("width", Along::X)?, self.size("height", Along::Y)?];
        let size = DVec2::new(width.unwrap_or(0.0), height.unwrap_or(0.0));
        let high = low + size;
        let radii = self.radii()?.min(size / 2.0);
        if size.min_element() == 0.0 {
            return Ok(());
        }
        let drawn = if radii.min_element() == 0.0 {
            pen.polyline(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)], true)
        } else {
            rounded(pen, [low, high], radii, [radii.x == size.x / 2.0, radii.y == size.y / 2.0])
        };
        drawn.map_err(|fault| fault.to_string())
    }

    fn point(&self, x: &str, y: &str) -> Result<DVec2, String> {
        Ok(DVec2::new(self.length(x, Along::X)?.unwrap_or(0.0), self.length(y, Along::Y)?.unwrap_or(0.0)))
    }

    /// A length that is not negative.
    pub(super) fn size(&self, name: &str, along: Along) -> Result<Option<f64>, String> {
        match self.length(name, along)? {
            Some(size) if size < 0.0 => Err(format!("{name} is {size}; it must not be negative")),
            size => Ok(size),
        }
    }

    /// A length in the element's own coordinates; `None` if it is not given or `auto`.
    pub(super) fn length(&self, name: &str, along: Along) -> Result<Option<f64>, String> {
        let value = if ATTRIBUTES_ONLY.contains(&name) {
            self.node.attribute(name).map(|text| Value { text: text.trim(), css: false })
        } else {
            self.style.get(name)
        };
        value.map_or(Ok(None), |value| length(name, value, along, self.viewport))
    }

    fn points(&self) -> Result<Vec<DVec2>, String> {
        let text = self.node.attribute("points").unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = NumberListParser::from(text).collect();
        let numbers = numbers.map_err(|e| format!("points: {e}"))?;
        if numbers.len() % 2 == 1 {
            return Err(format!(
                "points: {}; each point needs two, x and y",
                plainly(numbers.len() as u64, "number", "numbers")
            ));
        }
        Ok(numbers.chunks_exact(2).map(|xy| DVec2::new(xy[0], xy[1])).collect())
    }
}

/// The text in quotes in `path(...)`.
fn in_quotes(text: &str) -> Option<&str> {
    let inside = text.strip_prefix("path(")?.strip_suffix(')')?.trim();
    let quote = inside.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    inside[1..].strip_suffix(quote).filter(|data| !data.contains(quote))
}

/// A rectangle with rounded corners, from its upper left one on. Where corners meet, along x or along y, there is no
/// straight line between them.
fn rounded(pen: &mut Pen<'_>, [low, high]: [DVec2; 2], radii: DVec2, met: [bool; 2]) -> Drawn {
    let [a, b] = [DVec2::new(radii.x, 0.0), DVec2::new(0.0, radii.y)];
    let middle = (low + high) / 2.0;
    // Where the arcs begin and end, counted from either side.
    let near = [if met[0] { middle.x } else { low.x + radii.x }, if met[1] { middle.y } else { low.y + radii.y }];
    let far = [if met[0] { middle.x } else { high.x - radii.x }, if met[1] { middle.y } else { high.y - radii.y }];
    pen.start(DVec2::new(near[0], low.y))?;
    // Clockwise to the eye, each corner: its centre, and where its arc begins and ends.
    for (centre, degrees, from, to) in [
        ([far[0], near[1]], -90.0, [far[0], low.y], [high.x, near[1]]),
        ([far[0], far[1]], 0.0, [high.x, far[1]], [far[0], high.y]),
        ([near[0], far[1]], 90.0, [near[0], high.y], [low.x, far[1]]),
        ([near[0], near[1]], 180.0, [low.x, near[1]], [near[0], low.y]),
    ] {
        let straight = if degrees == -90.0 || degrees == 90.0 { !met[0] } else { !met[1] };
        if straight {
            pen.line_to(from.into())?;
        }
        pen.ellipse_to(Ellipse { centre: centre.into(), a, b, from: degrees, sweep: 90.0 }, to.into())?;
    }
    pen.close();
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DAffine2;
    use roxmltree::Document;

    use super::super::super::Wall;
    use super::super::super::outlines::Outlines;
    use super::super::style::Styles;
    use super::*;

    fn walls(element: &str) -> Result<Vec<[f64; 4]>, String> {
        let document = Document::parse(element).unwrap();
        let comments = Default::default();
        let style = Styles::of(&document, &comments).of_element(document.root_element());
        let mut outlines = Outlines::default();
        let viewport = Some(DVec2::new(200.0, 100.0));
        let shape = Shape { node: document.root_element(), style: &style, viewport };
        shape.draw(&mut outlines.pen(DAffine2::IDENTITY))?;
        let walls = outlines.flatten(Some(0.01)).unwrap().walls;
        Ok(walls.iter().map(|&Wall { ends: [a, b], .. }| [a.x, a.y, b.x, b.y]).collect())
    }

    #[test]
    fn straight_shapes() {
        let rect = [[1., 2., 4., 2.], [4., 2., 4., 4.], [4., 4., 1., 4.], [1., 4., 1., 2.]];
        assert_eq!(walls("<line x2='3' y2='0.5'/>").unwrap(), [[0., 0., 3., 0.5]]);
        assert_eq!(walls("<rect x='1' y='2' width='3' height='2'/>").unwrap(), rect);
        assert_eq!(walls("<polygon points='1,2 4,2 4,4 1,4'/>").unwrap(), rect);
        assert_eq!(walls("<polyline points='1,2 4,2 4 4, 1 4'/>").unwrap(), rect[..3]);
        for nothing in ["<rect x='1'/>", "<rect width='3' height='0'/>", "<circle/>", "<polygon/>", "<path/>"] {
            assert!(walls(nothing).unwrap().is_empty(), "{nothing}");
        }
    }

    #[test]
    fn lengths_have_units() {
        let x2 = |length: &str| walls(&format!("<line x2='{length}'/>")).unwrap()[0][2];
        let all = ["1", "2px", "1in", "2.54cm", "25.4mm", "72pt", "6pc", "10%", "-1e1"];
        assert_eq!(all.map(x2), [1.0, 2.0, 96.0, 96.0, 96.0, 96.0, 96.0, 20.0, -10.0]);
        assert_eq!(walls("<line y2='10%'/>").unwrap()[0][3], 10.0);
    }

    #[test]
    fn round_shapes_keep_to_their_equation_and_close() {
        let on = |walls: Vec<[f64; 4]>, centre: [f64; 2], radii: [f64; 2]| {
            let off = |w: &[f64; 4]| {
                let [x, y] = [(w[0] - centre[0]) / radii[0], (w[1] - centre[1]) / radii[1]];
                (x.hypot(y) - 1.0).abs()
            };
            assert!(walls.len() >= 8 && walls.iter().all(|w| off(w) < 1e-12));
            assert_eq!(walls[0][..2], walls[walls.len() - 1][2..]);
        };
        on(walls("<circle cx='5' cy='-1' r='2'/>").unwrap(), [5.0, -1.0], [2.0, 2.0]);
        on(walls("<ellipse cx='5' cy='-1' rx='2' ry='3'/>").unwrap(), [5.0, -1.0], [2.0, 3.0]);
        on(walls("<ellipse rx='2' ry='auto'/>").unwrap(), [0.0, 0.0], [2.0, 2.0]);
        // Rounded so much that nothing straight is left.
        on(walls("<rect x='3' y='-3' width='4' height='4' rx='9'/>").unwrap(), [5.0, -1.0], [2.0, 2.0]);
    }

    #[test]
    fn a_rounded_rectangle_is_straight_between_its_corners() {
        let found = walls("<rect x='1' y='2' width='10' height='6' rx='2' ry='1'/>").unwrap();
        for side in [[3., 2., 9., 2.], [11., 3., 11., 7.], [9., 8., 3., 8.], [1., 7., 1., 3.]] {
            assert!(found.contains(&side), "{side:?} is not in {found:?}");
        }
        assert!(found.windows(2).all(|w| w[0][2..] == w[1][..2]));
        assert_eq!(found[0][..2], found[found.len() - 1][2..]);
        assert!(found.iter().all(|w| (1.0..=11.0).contains(&w[0]) && (2.0..=8.0).contains(&w[1])));
    }

    #[test]
    fn where_rounded_corners_meet_there_is_no_wall_between_them() {
        // One radius is given and too large for one side: the other one stays, and no side is left at the ends.
        let found = walls("<rect width='400' height='200' x='10' y='10' rx='134'/>").unwrap();
        assert!(found.iter().all(|w| w[..2] != w[2..]), "{found:?}");
        let straight = [[144., 10., 276., 10.], [276., 210., 144., 210.]];
        assert!(straight.iter().all(|side| found.contains(side)), "{found:?}");
        let off = |[x, y]: [f64; 2]| {
            let x = (x - 210.0).abs() - 66.0;
            if x > 0.0 {
                ((x / 134.0).hypot((y - 110.0) / 100.0) - 1.0).abs()
            } else {
                ((y - 110.0).abs() - 100.0).abs()
            }
        };
        assert!(found.iter().all(|w| off([w[0], w[1]]) < 1e-12));
        // With sizes that are no sums of powers of two, no tiny wall comes in between either.
        for x in [0.1, 0.3, 1.7, 12.345] {
            let found = walls(&format!("<rect x='{x}' y='{x}' width='{x}' height='0.7' rx='9'/>")).unwrap();
            assert!(found.iter().all(|w| (w[0] - w[2]).hypot(w[1] - w[3]) > 1e-3), "{x}: {found:?}");
        }
    }

    #[test]
    fn style_sheets_give_lengths_too() {
        let rect = [[1., 2., 4., 2.], [4., 2., 4., 4.], [4., 4., 1., 4.], [1., 4., 1., 2.]];
        assert_eq!(walls("<rect style='x:1px;y:2px;width:3px;height:2px'/>").unwrap(), rect);
        assert_eq!(walls("<rect x='9' style='x:0.5%;y:2px;width:3px;HEIGHT:2px' width='7'/>").unwrap(), rect);
        let circle = walls("<circle cx='5' cy='5' r='2'/>");
        assert_eq!(walls("<circle style='cx:5px;cy:5px;r:2px'/>"), circle);
        assert_eq!(walls("<ellipse style='cx:5px;cy:5px;rx:2px'/>"), circle);
        assert_eq!(walls("<path style='d:path(\"M1,2 L4,2\")' d='M0,0h1'/>").unwrap(), [rect[0]]);
        assert!(walls("<path style='d:none' d='M0,0h1'/>").unwrap().is_empty());
        assert_eq!(walls("<line style='x1:7px' x2='3' y2='0.5'/>").unwrap(), [[0., 0., 3., 0.5]]);
    }

    #[test]
    fn faults_say_what_would_be_right() {
        for (element, what) in [
            ("<line x2='far'/>", "x2 is \"far\"; it must be a length such as 12.5, 12.5mm or 50%"),
            ("<line x2='2em'/>", "x2 is \"2em\", which depends on a font; give it in px or mm"),
            ("<circle r='-1'/>", "r is -1; it must not be negative"),
            ("<rect width='1' height='-2'/>", "height is -2; it must not be negative"),
            ("<circle style='r:8'/>", "r is \"8\" in a style, where lengths need a unit, such as 8px"),
            (
                "<circle style='r:calc(1px + 2px)'/>",
                "r is \"calc(1px + 2px)\"; it must be a length such as 12.5, 12.5mm or 50%",
            ),
            ("<path style='d:url(#d)'/>", "d is \"url(#d)\" in a style; it must be path(\"...\") or none"),
            ("<polygon points='1 2 3'/>", "points: 3 numbers; each point needs two, x and y"),
            ("<polygon points='1 2 a'/>", "points: invalid number at position 5"),
        ] {
            assert_eq!(walls(element).unwrap_err(), what);
        }
    }
}
