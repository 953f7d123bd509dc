//! Path data.

use glam::DVec2;
use svgtypes::{PathParser, PathSegment};

use super::super::curves::{Ellipse, direction};
use super::super::pen::{Drawn, Pen};

/// Draws a path. Every subpath is a line of its own; one that is closed ends exactly where it began.
pub(super) fn draw(data: &str, pen: &mut Pen<'_>) -> Result<(), String> {
    let mut turtle = Turtle { pen, first: DVec2::ZERO, here: DVec2::ZERO, before: Before::Other, closed: false };
    for segment in PathParser::from(data) {
        turtle.go(segment.map_err(|e| format!("d: {e}"))?)?;
    }
    Ok(())
}

/// What a smooth curve goes on from.
enum Before {
    Cubic(DVec2),
    Quadratic(DVec2),
    Other,
}

/// Follows a path in its own coordinates.
struct Turtle<'a, 'b> {
    pen: &'a mut Pen<'b>,
    /// Where the subpath began, and where it is.
    first: DVec2,
    here: DVec2,
    before: Before,
    /// Whether the subpath was closed: what comes next starts another one.
    closed: bool,
}

impl Turtle<'_, '_> {
    fn go(&mut self, segment: PathSegment) -> Result<(), String> {
        let origin = if segment.is_abs() { DVec2::ZERO } else { self.here };
        let place = |x: f64, y: f64| origin + DVec2::new(x, y);
        let drawn = |result: Drawn| result.map_err(|fault| format!("d: {fault}"));
        if self.closed && !matches!(segment, PathSegment::MoveTo { .. } | PathSegment::ClosePath { .. }) {
            drawn(self.pen.start(self.first))?;
        }
        self.closed = matches!(segment, PathSegment::ClosePath { .. });
        let mut before = Before::Other;
        let to = match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.first = place(x, y);
                drawn(self.pen.start(self.first))?;
                self.first
            }
            PathSegment::LineTo { x, y, .. } => self.line(place(x, y))?,
            PathSegment::HorizontalLineTo { x, .. } => self.line(DVec2::new(place(x, 0.0).x, self.here.y))?,
            PathSegment::VerticalLineTo { y, .. } => self.line(DVec2::new(self.here.x, place(0.0, y).y))?,
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => {
                before = Before::Cubic(place(x2, y2));
                self.curve(&[place(x1, y1), place(x2, y2)], place(x, y))?
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                let first = if let Before::Cubic(c) = self.before { self.here * 2.0 - c } else { self.here };
                before = Before::Cubic(place(x2, y2));
                self.curve(&[first, place(x2, y2)], place(x, y))?
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                before = Before::Quadratic(place(x1, y1));
                self.curve(&[place(x1, y1)], place(x, y))?
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let middle = if let Before::Quadratic(c) = self.before { self.here * 2.0 - c } else { self.here };
                before = Before::Quadratic(middle);
                self.curve(&[middle], place(x, y))?
            }
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let to = place(x, y);
                match arc(self.here, DVec2::new(rx, ry), x_axis_rotation, [large_arc, sweep], to) {
                    Some(ellipse) => drawn(self.pen.ellipse_to(ellipse, to)).map(|()| to)?,
                    None => self.line(to)?,
                }
            }
            PathSegment::ClosePath { .. } => {
                self.pen.close();
                self.first
            }
        };
        (self.here, self.before) = (to, before);
        Ok(())
    }

    fn line(&mut self, to: DVec2) -> Result<DVec2, String> {
        self.pen.line_to(to).map_err(|fault| format!("d: {fault}")).map(|()| to)
    }

    fn curve(&mut self, inner: &[DVec2], to: DVec2) -> Result<DVec2, String> {
        self.pen.bezier_to(inner, to).map_err(|fault| format!("d: {fault}")).map(|()| to)
    }
}

/// The ellipse of an arc from `from` to `to`; `None` where the arc is a straight line.
///
/// Radii that do not reach are made larger by the same factor. See the SVG specification, "Elliptical arc
/// implementation notes": here the ellipse is a unit circle until the last line.
fn arc(from: DVec2, radii: DVec2, rotation: f64, [large, sweep]: [bool; 2], to: DVec2) -> Option<Ellipse> {
    let mut radii = radii.abs();
    let x_axis = direction(rotation);
    let y_axis = x_axis.perp();
    let half = (from - to) / 2.0;
    let mut start = DVec2::new(half.dot(x_axis), half.dot(y_axis)) / radii;
    let reach = start.length_squared();
    if !reach.is_finite() || reach == 0.0 {
        return None;
    }
    if reach > 1.0 {
        radii *= reach.sqrt();
        start /= reach.sqrt();
    }
    let away = ((1.0 - reach) / reach).max(0.0).sqrt();
    let centre = DVec2::new(start.y, -start.x) * if large == sweep { -away } else { away };
    let angle = |p: DVec2| libm::atan2(p.y, p.x).to_degrees();
    let begin = angle(start - centre);
    let turn = angle(-start - centre) - begin;
    let turn = match sweep {
        true if turn <= 0.0 => turn + 360.0,
        false if turn >= 0.0 => turn - 360.0,
        _ => turn,
    };
    let [a, b] = [x_axis * radii.x, y_axis * radii.y];
    let centre = (from + to) / 2.0 + a * centre.x + b * centre.y;
    Some(Ellipse { centre, a, b, from: begin, sweep: turn })
}

#[cfg(test)]
mod tests {
    use glam::DAffine2;

    use super::super::super::Wall;
    use super::super::super::outlines::Outlines;
    use super::*;

    fn walls(data: &str, tolerance: f64) -> Vec<[f64; 4]> {
        let mut outlines = Outlines::default();
        draw(data, &mut outlines.pen(DAffine2::IDENTITY)).unwrap();
        let walls = outlines.flatten(Some(tolerance)).unwrap().walls;
        walls.iter().map(|&Wall { ends: [a, b], .. }| [a.x, a.y, b.x, b.y]).collect()
    }

    #[test]
    fn straight_commands_in_both_forms() {
        let square = [[1., 1., 3., 1.], [3., 1., 3., 3.], [3., 3., 1., 3.], [1., 3., 1., 1.]];
        for data in [
            "M1,1 L3,1 L3,3 L1,3 Z",
            "M 1 1 3 1 3 3 1 3 z",
            "m1,1 2,0 0,2 -2,0z",
            "M1 1H3V3H1Z",
            "m1 1h2v2h-2v-2",
            "M1 1h2v2h-2l0-2z",
        ] {
            assert_eq!(walls(data, 1.0), square, "{data}");
        }
        // What follows a closed path without a move begins where that began.
        assert_eq!(walls("M1,1 H3 V3 z l0,-1", 1.0)[3], [1., 1., 1., 0.]);
        assert_eq!(walls("M1,1 H3 m1,1 h1", 1.0), [[1., 1., 3., 1.], [4., 2., 5., 2.]]);
        assert!(walls("", 1.0).is_empty() && walls("M1,1", 1.0).is_empty() && walls("M1,1z", 1.0).is_empty());
    }

    #[test]
    fn curves_go_where_they_should() {
        // A smooth curve mirrors the control point before it; alone, it starts straight.
        assert_eq!(walls("M0,0 C0,1 1,2 2,2 S4,1 4,0", 0.01), walls("M0,0 C0,1 1,2 2,2 C3,2 4,1 4,0", 0.01));
        assert_eq!(walls("M0,0 S4,1 4,0", 0.01), walls("M0,0 C0,0 4,1 4,0", 0.01));
        assert_eq!(walls("M0,0 q1,2 2,0 t2,0", 0.01), walls("M0,0 Q1,2 2,0 Q3,-2 4,0", 0.01));
        assert_eq!(walls("M1,1 c0,1 1,2 2,2", 0.01), walls("M1,1 C1,2 2,3 3,3", 0.01));
        assert_eq!(walls("M0,0 Q1,1 2,2", 0.01), [[0., 0., 2., 2.]]);
    }

    #[test]
    fn arcs_keep_their_radius_and_their_side() {
        for (flags, middle) in [("0 0", [3.0, -1.0]), ("0 1", [3.0, 1.0]), ("1 0", [3.0, -1.0]), ("1 1", [3.0, 1.0])] {
            // From (2, 0) to (4, 0) by a circle of radius 1: both arcs are half circles.
            let found = walls(&format!("M2,0 A1,1 0 {flags} 4,0"), 1e-4);
            // With y downwards, the positive direction is clockwise to the eye and above the middle.
            let middle = DVec2::new(middle[0], -middle[1]);
            let near = found.iter().map(|w| DVec2::new(w[0], w[1]).distance(middle)).fold(1.0, f64::min);
            assert!(near < 0.05, "{flags}: {near}");
        }
        let large = walls("M2,0 a 5 5 0 1 1 6,0", 1e-4);
        assert_eq!((large[0][..2].to_vec(), large[large.len() - 1][2..].to_vec()), (vec![2.0, 0.0], vec![8.0, 0.0]));
        for w in &large {
            assert!((DVec2::new(w[0], w[1]).distance(DVec2::new(5.0, -4.0)) - 5.0).abs() < 1e-12, "{w:?}");
        }
        // Too small radii are made to reach; without a radius it is a straight line.
        assert_eq!(walls("M2,0 A 1 1 0 0 1 8,0", 1e-3), walls("M2,0 A 3 3 0 0 1 8,0", 1e-3));
        assert_eq!(walls("M2,0 A 0 3 0 0 1 8,0", 1e-3), [[2., 0., 8., 0.]]);
        assert_eq!(walls("M2,0 A 3 3 0 0 1 2,0", 1e-3), [[2., 0., 2., 0.]]);
        // Turned by a quarter, the radii change places.
        let turned = walls("M0,2 A 1 2 90 0 1 0,-2 z", 1e-3);
        let reach = turned.iter().map(|w| w[0].abs()).fold(0.0, f64::max);
        assert!((reach - 4.0).abs() < 1e-3, "{reach}");
    }

    #[test]
    fn faults_say_where_in_the_data() {
        let fault = |data: &str| draw(data, &mut Outlines::default().pen(DAffine2::IDENTITY)).unwrap_err();
        for data in ["L1,1", "M1,1 L2", "M1,1 X3", "M1,1 L1e999,0", "M1,1 A1 1 0 2 0 3 3", "M1,1 z 3"] {
            let what = fault(data);
            assert!(what.starts_with("d: ") && what.contains("position") || what.contains("end of"), "{data}: {what}");
        }
        assert!(fault("M1,1 L1e200,0").starts_with("d: 1e200 is too large"));
    }
}
