//! How formats draw: in coordinates of their own, which a transform places in the scene.

use glam::{DAffine2, DVec2};

use super::curves::{Curve, Ellipse, Piece};
use super::outlines::Outlines;
use crate::geometry::{CoordinateFault, check_point};

/// Draws into [`Outlines`]. All points are in the pen's own coordinates; curves go from where the last piece ended.
pub(super) struct Pen<'a> {
    outlines: &'a mut Outlines,
    transform: DAffine2,
    /// Where the line began, where it is, and its largest coordinate so far, all in the scene's coordinates.
    first: DVec2,
    here: DVec2,
    size: f64,
}

/// What drawing says of coordinates that cannot be computed with.
pub(super) type Drawn = Result<(), CoordinateFault>;

impl Outlines {
    /// A pen that draws here what it is told in other coordinates.
    pub(super) fn pen(&mut self, transform: DAffine2) -> Pen<'_> {
        Pen::new(self, transform)
    }
}

impl<'a> Pen<'a> {
    /// A pen that draws what it is told in the coordinates before `transform`.
    fn new(outlines: &'a mut Outlines, transform: DAffine2) -> Self {
        Pen { outlines, transform, first: DVec2::ZERO, here: DVec2::ZERO, size: 0.0 }
    }

    /// The scene's coordinates of `p`.
    fn place(&self, p: DVec2) -> Result<DVec2, CoordinateFault> {
        check_point(self.transform.transform_point2(p))
    }

    fn go(&mut self, to: DVec2) {
        self.here = to;
        self.size = self.size.max(to.abs().max_element());
    }

    pub(super) fn start(&mut self, at: DVec2) -> Drawn {
        let at = self.place(at)?;
        self.outlines.pieces.push(Piece::Start(at));
        (self.first, self.size) = (at, 0.0);
        self.go(at);
        Ok(())
    }

    pub(super) fn line_to(&mut self, to: DVec2) -> Drawn {
        let to = self.place(to)?;
        self.outlines.pieces.push(Piece::Line(to));
        self.go(to);
        Ok(())
    }

    /// A Bezier curve by the control points `inner` to `to`.
    pub(super) fn bezier_to(&mut self, inner: &[DVec2], to: DVec2) -> Drawn {
        let mut points = vec![self.here];
        for p in inner {
            points.push(self.place(*p)?);
        }
        let to = self.place(to)?;
        points.push(to);
        self.outlines.pieces.push(Piece::Curve(Box::new(Curve::Bezier(points)), to));
        self.go(to);
        Ok(())
    }

    /// An arc that begins where the pen is and ends at `to`, whatever rounding makes of its own ends.
    pub(super) fn ellipse_to(&mut self, arc: Ellipse, to: DVec2) -> Drawn {
        let to = self.place(to)?;
        let [a, b] = [arc.a, arc.b].map(|v| self.transform.transform_vector2(v));
        let arc = Ellipse { centre: self.place(arc.centre)?, a: check_point(a)?, b: check_point(b)?, ..arc };
        self.outlines.pieces.push(Piece::Curve(Box::new(Curve::Ellipse(arc)), to));
        self.go(to);
        Ok(())
    }

    /// A whole ellipse.
    pub(super) fn ellipse(&mut self, centre: DVec2, a: DVec2, b: DVec2) -> Drawn {
        self.start(centre + a)?;
        self.ellipse_to(Ellipse { centre, a, b, from: 0.0, sweep: 360.0 }, centre + a)
    }

    /// An open or closed line through `points`.
    pub(super) fn polyline(&mut self, points: &[DVec2], closed: bool) -> Drawn {
        let [first, rest @ ..] = points else { return Ok(()) };
        self.start(*first)?;
        for p in rest {
            self.line_to(*p)?;
        }
        if closed {
            self.close();
        }
        Ok(())
    }

    /// Straight back to where the line began, unless it is there. A line that misses its beginning by no more than the
    /// roundings of relative coordinates (2^-40 of its largest coordinate) ends on it, without a tiny wall in between.
    pub(super) fn close(&mut self) {
        let first = self.first;
        let missed = (self.here - first).abs().max_element();
        if let Some(Piece::Line(end) | Piece::Curve(_, end)) = self.outlines.pieces.last_mut()
            && missed <= self.size * 2f64.powi(-40)
        {
            *end = first;
        } else if missed > 0.0 {
            self.outlines.pieces.push(Piece::Line(first));
        }
        self.here = first;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn a_line_that_misses_its_beginning_by_rounding_ends_on_it() {
        for (last, count) in [(p(0.3, 0.1 + 1e-16), 3), (p(0.3, 0.1), 3), (p(0.3, 0.1 + 1e-9), 4)] {
            let mut outlines = Outlines::default();
            outlines.pen(DAffine2::IDENTITY).polyline(&[p(0.3, 0.1), p(1.0, 0.0), p(1.0, 1.0), last], true).unwrap();
            let walls = outlines.flatten(None).unwrap().walls;
            assert_eq!(walls.len(), count);
            assert_eq!(walls[count - 1].ends[1], walls[0].ends[0]);
        }
    }

    #[test]
    fn coordinates_that_cannot_be_computed_with_are_refused() {
        let mut outlines = Outlines::default();
        let mut pen = outlines.pen(DAffine2::from_scale(DVec2::splat(1e100)));
        pen.start(p(1.0, 2.0)).unwrap();
        for wrong in [p(1e60, 0.0), p(0.0, 1e-240), p(f64::NAN, 0.0), p(0.0, 1e300)] {
            pen.line_to(wrong).unwrap_err();
            pen.bezier_to(&[wrong], p(1.0, 1.0)).unwrap_err();
            pen.ellipse(wrong, p(1.0, 0.0), p(0.0, 1.0)).unwrap_err();
        }
    }
}
