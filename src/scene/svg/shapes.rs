//! Basic shapes, and the lengths that describe them.

use std::str::FromStr;

use glam::DVec2;
use roxmltree::Node;
use svgtypes::{Length, LengthUnit, NumberListParser};

use super::super::curves::Ellipse;
use super::super::excerpt;
use super::super::pen::{Drawn, Pen};
use super::path;

/// What a percentage is a part of.
#[derive(Debug, Clone, Copy)]
pub(super) enum Along {
    X,
    Y,
    /// Neither: the viewport's diagonal over the square root of two.
    Both,
}

/// An element and the size of its viewport, if that is known.
#[derive(Clone, Copy)]
pub(super) struct Shape<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) viewport: Option<DVec2>,
}

impl Shape<'_, '_> {
    /// Draws the element if it is a shape, and says whether it is.
    pub(super) fn draw(&self, pen: &mut Pen<'_>) -> Result<bool, String> {
        match self.node.tag_name().name() {
            "path" => path::draw(self.node.attribute("d").unwrap_or_default(), pen)?,
            "line" => {
                let [from, to] = [self.point("x1", "y1")?, self.point("x2", "y2")?];
                pen.polyline(&[from, to], false).map_err(|fault| fault.to_string())?;
            }
            "polyline" => pen.polyline(&self.points()?, false).map_err(|fault| fault.to_string())?,
            "polygon" => pen.polyline(&self.points()?, true).map_err(|fault| fault.to_string())?,
            "rect" => self.rect(pen)?,
            "circle" | "ellipse" => {
                let (centre, radii) = self.round()?;
                if radii.min_element() > 0.0 {
                    let [a, b] = [DVec2::new(radii.x, 0.0), DVec2::new(0.0, radii.y)];
                    pen.ellipse(centre, a, b).map_err(|fault| fault.to_string())?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
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
            rounded(pen, [low, high], radii)
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
        let Some(text) = self.node.attribute(name).map(str::trim).filter(|&text| text != "auto") else {
            return Ok(None);
        };
        let length = Length::from_str(text)
            .map_err(|_| format!("{name} is {:?}; it must be a length such as 12.5, 12.5mm or 50%", excerpt(text)))?;
        Ok(Some(match length.unit {
            LengthUnit::Percent => {
                let all = self.viewport.ok_or_else(|| format!("{name} is {text:?}, but of what is not known"))?;
                let all = match along {
                    Along::X => all.x,
                    Along::Y => all.y,
                    Along::Both => (all.length_squared() / 2.0).sqrt(),
                };
                length.number / 100.0 * all
            }
            unit => {
                let pixels = pixels(unit)
                    .ok_or_else(|| format!("{name} is {text:?}, which depends on a font; give it in px or mm"))?;
                length.number * pixels
            }
        }))
    }

    fn points(&self) -> Result<Vec<DVec2>, String> {
        let text = self.node.attribute("points").unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = NumberListParser::from(text).collect();
        let numbers = numbers.map_err(|e| format!("points: {e}"))?;
        if numbers.len() % 2 == 1 {
            return Err(format!("points: {} numbers; each point needs two, x and y", numbers.len()));
        }
        Ok(numbers.chunks_exact(2).map(|xy| DVec2::new(xy[0], xy[1])).collect())
    }
}

/// How many pixels a unit is; `None` if that depends on something else.
pub(super) fn pixels(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::None | LengthUnit::Px => Some(1.0),
        LengthUnit::In => Some(96.0),
        LengthUnit::Cm => Some(96.0 / 2.54),
        LengthUnit::Mm => Some(96.0 / 25.4),
        LengthUnit::Pt => Some(96.0 / 72.0),
        LengthUnit::Pc => Some(16.0),
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => None,
    }
}

/// A rectangle with rounded corners, from its upper left one on.
fn rounded(pen: &mut Pen<'_>, [low, high]: [DVec2; 2], radii: DVec2) -> Drawn {
    let [a, b] = [DVec2::new(radii.x, 0.0), DVec2::new(0.0, radii.y)];
    pen.start(DVec2::new(low.x + radii.x, low.y))?;
    for (corner, degrees) in
        [(DVec2::new(high.x, low.y), -90.0), (high, 0.0), (DVec2::new(low.x, high.y), 90.0), (low, 180.0)]
    {
        // The centre lies a radius inwards of the corner, along both axes.
        let inwards = radii * ((low + high) / 2.0 - corner).signum();
        let arc = Ellipse { centre: corner + inwards, a, b, from: degrees, sweep: 90.0 };
        let [from, to] = [DVec2::new(inwards.x, 0.0), DVec2::new(0.0, inwards.y)];
        // Clockwise to the eye: at the right and the lower left corner the arc arrives along y.
        let (from, to) = if degrees == -90.0 || degrees == 90.0 { (from, to) } else { (to, from) };
        pen.line_to(corner + from)?;
        pen.ellipse_to(arc, corner + to)?;
    }
    pen.close();
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DAffine2;
    use roxmltree::Document;

    use super::super::super::Wall;
    use super::super::super::curves::Outlines;
    use super::*;

    fn walls(element: &str) -> Result<Vec<[f64; 4]>, String> {
        let document = Document::parse(element).unwrap();
        let mut outlines = Outlines::default();
        let viewport = Some(DVec2::new(200.0, 100.0));
        let shape = Shape { node: document.root_element(), viewport };
        assert!(shape.draw(&mut outlines.pen(DAffine2::IDENTITY))?, "{element}");
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
        let round: Vec<_> = walls("<rect x='3' y='-3' width='4' height='4' rx='9'/>").unwrap();
        let arcs = round.iter().filter(|w| w[..2] != w[2..]).copied().collect();
        on(arcs, [5.0, -1.0], [2.0, 2.0]);
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
    fn faults_say_what_would_be_right() {
        for (element, what) in [
            ("<line x2='far'/>", "x2 is \"far\"; it must be a length such as 12.5, 12.5mm or 50%"),
            ("<line x2='2em'/>", "x2 is \"2em\", which depends on a font; give it in px or mm"),
            ("<circle r='-1'/>", "r is -1; it must not be negative"),
            ("<rect width='1' height='-2'/>", "height is -2; it must not be negative"),
            ("<polygon points='1 2 3'/>", "points: 3 numbers; each point needs two, x and y"),
            ("<polygon points='1 2 a'/>", "points: invalid number at position 5"),
        ] {
            assert_eq!(walls(element).unwrap_err(), what);
        }
    }
}
