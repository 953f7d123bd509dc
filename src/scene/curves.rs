//! Lines and curves of a drawing.
//!
//! A curve becomes n walls between points of it at equal steps of its parameter. A curve p(t) lies within
//! max |p''| h^2 / 8 of its chord over a step h: the error of linear interpolation. So n is the least number for which
//! that is no more than the tolerance. Ends are taken as given, so that what meets in the drawing meets in the scene.
//! All arithmetic is that of f64 and `libm`: the same walls on every machine.

use glam::DVec2;

/// A part of a drawing, in the scene's coordinates.
#[derive(Debug)]
pub(super) enum Piece {
    /// What follows belongs to the next object.
    Object,
    /// A line of its own begins here.
    Start(DVec2),
    /// Straight from where the last piece ends.
    Line(DVec2),
    /// Along a curve from where the last piece ends.
    Curve(Box<Curve>, DVec2),
}

/// A curve that is to become walls.
#[derive(Debug)]
pub(super) enum Curve {
    /// The control points, both ends included.
    Bezier(Vec<DVec2>),
    Ellipse(Ellipse),
}

/// An arc of an ellipse: centre + a cos t + b sin t for t from `from` to `from + sweep`, both in degrees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipse {
    pub(super) centre: DVec2,
    pub(super) a: DVec2,
    pub(super) b: DVec2,
    pub(super) from: f64,
    pub(super) sweep: f64,
}

impl Ellipse {
    /// The point at `degrees`.
    pub(super) fn at(&self, degrees: f64) -> DVec2 {
        let d = direction(degrees);
        self.centre + self.a * d.x + self.b * d.y
    }

    /// The greatest distance from the centre, which is also the greatest |p''| by radians.
    fn radius(&self) -> f64 {
        let DVec2 { x: ax, y: ay } = self.a;
        let DVec2 { x: bx, y: by } = self.b;
        (libm::hypot(ax + by, ay - bx) + libm::hypot(ax - by, ay + bx)) / 2.0
    }
}

/// The unit vector at `degrees` from the x axis towards the y axis; exact at quarter turns.
pub(super) fn direction(degrees: f64) -> DVec2 {
    match degrees % 360.0 {
        0.0 => DVec2::X,
        90.0 | -270.0 => DVec2::Y,
        180.0 | -180.0 => DVec2::NEG_X,
        270.0 | -90.0 => DVec2::NEG_Y,
        degrees => {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            DVec2::new(cos, sin)
        }
    }
}

impl Curve {
    /// In how many equal steps of its parameter the curve stays within `tolerance` of its chords.
    pub(super) fn steps(&self, tolerance: f64) -> f64 {
        match self {
            Curve::Bezier(points) => {
                let degree = (points.len() - 1) as f64;
                let bend = |w: &[DVec2]| libm::hypot(w[0].x - 2.0 * w[1].x + w[2].x, w[0].y - 2.0 * w[1].y + w[2].y);
                let most = points.windows(3).map(bend).fold(0.0, f64::max) * degree * (degree - 1.0);
                (most / tolerance / 8.0).sqrt().ceil().max(1.0)
            }
            Curve::Ellipse(e) => {
                let n = e.sweep.abs().to_radians() * (e.radius() / tolerance / 8.0).sqrt();
                // No step is more than a quarter turn, and a full turn is cut at its quarters.
                let quarters = e.sweep.abs() / 90.0;
                if quarters == 4.0 { (n / 4.0).ceil().max(1.0) * 4.0 } else { n.max(quarters).ceil().max(1.0) }
            }
        }
    }

    /// The point at `t` between 0 and 1.
    pub(super) fn at(&self, t: f64) -> DVec2 {
        match self {
            Curve::Bezier(points) => {
                let mut points = points.clone();
                for last in (1..points.len()).rev() {
                    for i in 0..last {
                        points[i] = points[i] * (1.0 - t) + points[i + 1] * t;
                    }
                }
                points[0]
            }
            Curve::Ellipse(e) => e.at(e.from + e.sweep * t),
        }
    }
}
