//! Entities as lines and curves.

use glam::DVec2;

use super::super::curves::Ellipse;
use super::super::pen::{Drawn, Pen};
use super::entity::Entity;
use super::spline::beziers;
use crate::read_error::Fault;

/// A bulge below this is none: the arc lies nearer to its chord than this part of the chord's length.
pub(super) const BULGE_MIN: f64 = 1e-9;

/// Draws an entity, or says under which name it is passed over if it is of a kind that is not drawn. Of what has no
/// extent it draws nothing.
pub(super) fn draw<'a>(entity: &Entity<'a>, pen: &mut Pen<'_>) -> Result<Option<&'a str>, Fault> {
    let drawn = match entity.kind {
        "LINE" => {
            let [from, to] = [point(entity, 10)?, point(entity, 11)?];
            pen.polyline(&[from, to], false)
        }
        "CIRCLE" => {
            let Some(radius) = radius(entity)? else { return Ok(None) };
            pen.ellipse(point(entity, 10)?, DVec2::new(radius, 0.0), DVec2::new(0.0, radius))
        }
        "ARC" => {
            let [from, to] = [entity.number(50)?, entity.number(51)?];
            let Some(radius) = radius(entity)? else { return Ok(None) };
            let [a, b] = [DVec2::new(radius, 0.0), DVec2::new(0.0, radius)];
            arc(pen, Ellipse { centre: point(entity, 10)?, a, b, from, sweep: turn(from, to) })
        }
        "ELLIPSE" => {
            let a = point(entity, 11)?;
            let b = a.perp() * entity.number(40)? * upside(entity)?;
            if b == DVec2::ZERO {
                return Ok(None);
            }
            let [from, to] = [entity.or(41, 0.0)?, entity.or(42, std::f64::consts::TAU)?].map(f64::to_degrees);
            arc(pen, Ellipse { centre: point(entity, 10)?, a, b, from, sweep: turn(from, to) })
        }
        "LWPOLYLINE" => {
            let corners = corners(entity)?;
            return polyline(entity, &corners, entity.flags(70)? & 1 == 1, pen).map(|()| None);
        }
        "POLYLINE" => {
            let (corners, closed) = vertices(entity)?;
            return polyline(entity, &corners, closed, pen).map(|()| None);
        }
        "SOLID" | "TRACE" => {
            // Its corners are told along two opposite sides, both in the same direction.
            let [a, b, c, d] = corners_of_face(entity)?;
            pen.polyline(&if c == d { vec![a, b, c] } else { vec![a, b, d, c] }, true)
        }
        "3DFACE" => face(entity, pen)?,
        "SPLINE" => return spline(entity, pen).map(|()| None),
        kind => return Ok(Some(kind)),
    };
    drawn.map_err(|fault| entity.fault(fault))?;
    Ok(None)
}

/// The point whose x has this group code; its y has the code 10 higher.
pub(super) fn point(entity: &Entity<'_>, code: i32) -> Result<DVec2, Fault> {
    Ok(DVec2::new(entity.number(code)?, entity.number(code + 10)?))
}

/// 1 where the entity's z axis points to the eye, -1 where it points away.
///
/// # Errors
///
/// Another direction: the entity does not lie in the plane.
pub(super) fn upside(entity: &Entity<'_>) -> Result<f64, Fault> {
    match [entity.or(210, 0.0)?, entity.or(220, 0.0)?, entity.or(230, 1.0)?] {
        [0.0, 0.0, z] if z > 0.0 => Ok(1.0),
        [0.0, 0.0, z] if z < 0.0 => Ok(-1.0),
        [x, y, z] => {
            Err(entity.fault(format_args!("lies askew in space, normal to ({x}, {y}, {z}); flatten the drawing")))
        }
    }
}

/// The radius; `None` if it is 0.
pub(super) fn radius(entity: &Entity<'_>) -> Result<Option<f64>, Fault> {
    match entity.number(40)? {
        0.0 => Ok(None),
        radius if radius > 0.0 => Ok(Some(radius)),
        radius => Err(entity.fault(format_args!("radius {radius}; it must not be negative"))),
    }
}

/// The four corners of a SOLID, TRACE or 3DFACE in the order of the file; the fourth may be left out.
fn corners_of_face(entity: &Entity<'_>) -> Result<[DVec2; 4], Fault> {
    let [a, b, c] = [point(entity, 10)?, point(entity, 11)?, point(entity, 12)?];
    Ok([a, b, c, if entity.text(13).is_some() { point(entity, 13)? } else { c }])
}

/// The sides of a face that are not marked as invisible: those lie between faces that are one.
fn face(entity: &Entity<'_>, pen: &mut Pen<'_>) -> Result<Drawn, Fault> {
    let (corners, flags) = (corners_of_face(entity)?, entity.flags(70)?);
    for side in 0..4 {
        let [from, to] = [corners[side], corners[(side + 1) % 4]];
        if flags >> side & 1 == 0 && from != to {
            let drawn = pen.polyline(&[from, to], false);
            if drawn.is_err() {
                return Ok(drawn);
            }
        }
    }
    Ok(Ok(()))
}

/// The greatest width of a polyline, 0 of all others.
pub(super) fn width(entity: &Entity<'_>) -> Result<f64, Fault> {
    let codes: &[i32] = match entity.kind {
        "LWPOLYLINE" => &[40, 41, 43],
        "POLYLINE" => &[40, 41],
        _ => return Ok(0.0),
    };
    let mut widest = 0.0f64;
    for entity in std::iter::once(entity).chain(&entity.parts) {
        for &code in codes {
            widest = entity.numbers(code)?.into_iter().fold(widest, f64::max);
        }
    }
    Ok(widest)
}

/// How far it is from one angle on to another, in degrees above 0 up to a whole turn.
pub(super) fn turn(from: f64, to: f64) -> f64 {
    let turn = (to - from) % 360.0;
    let turn = if turn <= 0.0 { turn + 360.0 } else { turn };
    // Angles in radians seldom make a whole turn to the last bit.
    if (1e-9..360.0 - 1e-9).contains(&turn) { turn } else { 360.0 }
}

/// An arc alone; one of a whole turn ends where it begins.
fn arc(pen: &mut Pen<'_>, arc: Ellipse) -> Drawn {
    let begin = arc.at(arc.from);
    pen.start(begin)?;
    pen.ellipse_to(arc, if arc.sweep == 360.0 { begin } else { arc.at(arc.from + arc.sweep) })
}

/// A corner of a polyline and the bulge of the side behind it: the tangent of a quarter of its arc's angle.
pub(super) type Corner = (DVec2, f64);

/// The corners of a LWPOLYLINE or of a HATCH's path: each begins with its x.
pub(super) fn corners(entity: &Entity<'_>) -> Result<Vec<Corner>, Fault> {
    let mut corners: Vec<Corner> = Vec::new();
    for &(code, value) in &entity.groups {
        let number = || entity.parse(code, value);
        match (code, corners.last_mut()) {
            (10, _) => corners.push((DVec2::new(number()?, f64::NAN), 0.0)),
            (20, Some((p, _))) => p.y = number()?,
            (42, Some((_, bulge))) => *bulge = number()?,
            _ => {}
        }
    }
    if let Some(i) = corners.iter().position(|(p, _)| p.y.is_nan()) {
        return Err(entity.fault(format_args!("corner {i} has an x but no y")));
    }
    Ok(corners)
}

/// The corners of a POLYLINE, and whether it is closed.
fn vertices(entity: &Entity<'_>) -> Result<(Vec<Corner>, bool), Fault> {
    let flags = entity.flags(70)?;
    if flags & (16 | 64) != 0 {
        return Err(entity.fault("is a mesh in space; explode it into lines"));
    }
    let mut corners = Vec::new();
    for vertex in &entity.parts {
        // Control points of a fitted curve; the curve's own points follow.
        if vertex.kind == "VERTEX" && vertex.flags(70)? & 16 == 0 {
            corners.push((point(vertex, 10)?, vertex.or(42, 0.0)?));
        }
    }
    Ok((corners, flags & 1 == 1))
}

pub(super) fn polyline(entity: &Entity<'_>, corners: &[Corner], closed: bool, pen: &mut Pen<'_>) -> Result<(), Fault> {
    let [(first, _), ..] = corners else { return Ok(()) };
    let mut ends: Vec<DVec2> = corners[1..].iter().map(|c| c.0).collect();
    ends.extend(closed.then_some(*first));
    pen.start(*first).map_err(|fault| entity.fault(fault))?;
    for (&(from, bulge), &to) in corners.iter().zip(&ends) {
        let straight = bulge.abs() < BULGE_MIN || from == to;
        let drawn = if straight { pen.line_to(to) } else { pen.ellipse_to(bulged(from, to, bulge), to) };
        drawn.map_err(|fault| entity.fault(fault))?;
    }
    Ok(())
}

/// The circle through `from` and `to` of which the side is a part.
fn bulged(from: DVec2, to: DVec2, bulge: f64) -> Ellipse {
    let across = (to - from).perp();
    let centre = (from + to) / 2.0 + across * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let a = from - centre;
    Ellipse { centre, a, b: a.perp(), from: 0.0, sweep: (4.0 * libm::atan(bulge)).to_degrees() }
}

fn spline(entity: &Entity<'_>, pen: &mut Pen<'_>) -> Result<(), Fault> {
    if is_rational(entity, 41)? {
        return Err(entity.fault("has weights that differ (a rational spline); make a polyline of it"));
    }
    if entity.text(10).is_none() {
        return Err(entity.fault("has no control points; make a polyline of it"));
    }
    for (i, curve) in curves(entity, 71)?.iter().enumerate() {
        let [first, inner @ .., last] = &curve[..] else { continue };
        let drawn = if i == 0 { pen.start(*first) } else { Ok(()) };
        drawn.and_then(|()| pen.bezier_to(inner, *last)).map_err(|fault| entity.fault(fault))?;
    }
    // A closed spline's last point is its first one, but for rounding.
    if entity.flags(70)? & 1 == 1 {
        pen.close();
    }
    Ok(())
}

/// Whether a spline, whose weights have this group code, has some that differ.
pub(super) fn is_rational(entity: &Entity<'_>, weights: i32) -> Result<bool, Fault> {
    Ok(entity.numbers(weights)?.windows(2).any(|w| w[0] != w[1]))
}

/// The Bezier curves of a spline whose degree has this group code.
pub(super) fn curves(entity: &Entity<'_>, degree: i32) -> Result<Vec<Vec<DVec2>>, Fault> {
    let [x, y] = [entity.numbers(10)?, entity.numbers(20)?];
    if x.len() != y.len() {
        return Err(entity.fault(format_args!("{} x and {} y of control points", x.len(), y.len())));
    }
    let points: Vec<DVec2> = x.into_iter().zip(y).map(DVec2::from).collect();
    let degree = usize::try_from(entity.flags(degree)?).unwrap_or(0);
    beziers(degree, &entity.numbers(40)?, &points).map_err(|what| entity.fault(what))
}
