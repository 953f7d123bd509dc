//! HATCH entities with a solid fill: painted areas, each told by the paths round it.
//!
//! A path is a polyline, or edges that follow each other: lines, arcs and splines.

use glam::DVec2;

use super::super::curves::{Ellipse, direction};
use super::super::pen::{Drawn, Pen};
use super::entity::Entity;
use super::shapes::{BULGE_MIN, Corner, corners, curves, is_rational, point, polyline, radius, turn};
use crate::geometry::check_point;
use crate::read_error::Fault;

/// The group codes of paths. What follows them, seeds and patterns, begins with another one.
const CODES: [i32; 23] = [10, 11, 12, 13, 20, 21, 22, 23, 40, 42, 50, 51, 72, 73, 74, 92, 93, 94, 95, 96, 97, 330, 999];

/// Bits of a path's flags: it goes round all others of an area, it is a polyline, it goes round a hole of such an area.
const EXTERNAL: i64 = 1;
const POLYLINE: i64 = 2;
const OUTERMOST: i64 = 16;

/// Edges meet whose ends are apart by no more than this part of their path's longer side.
const MEETING: f64 = 1e-7;

/// Why a path is no border.
enum Unfit {
    Fault(Fault),
    /// It may be sound, but is of a kind that is not read: the name under which the hatch is passed over.
    PassedOver(&'static str),
}

impl From<Fault> for Unfit {
    fn from(fault: Fault) -> Self {
        Unfit::Fault(fault)
    }
}

/// The name under which a hatch is passed over that is not painted all over: it has no clear border.
pub(super) fn unpainted(hatch: &Entity<'_>) -> Result<Option<&'static str>, Fault> {
    Ok(if hatch.flags(70)? & 1 == 0 {
        Some("HATCH with a pattern")
    } else if hatch.flags(450)? != 0 {
        Some("HATCH with a gradient")
    } else {
        None
    })
}

/// Draws the border, or says under which name the hatch is passed over. Then it has drawn nothing.
pub(super) fn draw(hatch: &Entity<'_>, pen: &mut Pen<'_>) -> Result<Option<&'static str>, Fault> {
    let borders: Result<Vec<Border>, Unfit> = painted(hatch)?.iter().map(border).collect();
    let borders = match borders {
        Ok(borders) => borders,
        Err(Unfit::PassedOver(name)) => return Ok(Some(name)),
        Err(Unfit::Fault(fault)) => return Err(fault),
    };
    for border in borders {
        match border {
            Border::Corners(corners) => ring(hatch, &corners, pen)?,
            Border::Edges(edges) => follow(&edges, pen).map_err(|fault| hatch.fault(fault))?,
        }
    }
    Ok(None)
}

/// The paths between which the area is painted, by the hatch's style: as the even-odd rule has it.
fn painted<'a>(hatch: &Entity<'a>) -> Result<Vec<Entity<'a>>, Fault> {
    let Some(at) = hatch.groups.iter().position(|group| group.0 == 91) else {
        return Err(hatch.fault("no number with the group code 91, which says how many paths go round it"));
    };
    let groups = &hatch.groups[at + 1..];
    let end = groups.iter().position(|group| !CODES.contains(&group.0)).unwrap_or(groups.len());
    let paths = hatch.split(&groups[..end], 92);
    check_count(hatch, 91, "paths", paths.len())?;
    let kept = match hatch.flags(75)? {
        1 => EXTERNAL | OUTERMOST,
        2 => EXTERNAL,
        _ => return Ok(paths),
    };
    let flags: Vec<i64> = paths.iter().map(|path| path.flags(92)).collect::<Result<_, _>>()?;
    // Not every program says which path is which.
    if flags.iter().all(|flags| flags & kept == 0) {
        return Ok(paths);
    }
    Ok(paths.into_iter().zip(flags).filter(|(_, flags)| flags & kept != 0).map(|(path, _)| path).collect())
}

/// Checks that there are as many things as the first group with this code says.
fn check_count(part: &Entity<'_>, code: i32, things: &str, count: usize) -> Result<(), Fault> {
    let said = part.flags(code)?;
    if usize::try_from(said) == Ok(count) {
        return Ok(());
    }
    Err(part.fault(format_args!("{count} {things}, where the group code {code} says {said}; they must be as many")))
}

/// A path that is read.
enum Border {
    Corners(Vec<Corner>),
    Edges(Vec<Edge>),
}

/// An edge from one end to the other, and whether the border goes along it from the second to the first.
struct Edge {
    ends: [DVec2; 2],
    along: Along,
    backwards: bool,
}

enum Along {
    Line,
    Arc(Ellipse),
    /// Bezier curves, with all their control points.
    Spline(Vec<Vec<DVec2>>),
}

impl Edge {
    fn start(&self) -> DVec2 {
        self.ends[usize::from(self.backwards)]
    }

    fn end(&self) -> DVec2 {
        self.ends[usize::from(!self.backwards)]
    }

    /// How little its ends, as they are, are worth: those of a line are told, those of an arc computed.
    fn looseness(&self) -> u8 {
        match self.along {
            Along::Line => 0,
            Along::Spline(_) => 1,
            Along::Arc(_) => 2,
        }
    }
}

fn border(path: &Entity<'_>) -> Result<Border, Unfit> {
    if path.flags(92)? & POLYLINE != 0 {
        let mut corners = corners(path)?;
        check_count(path, 93, "corners of a path", corners.len())?;
        // Some programs tell the first corner again as the last one.
        while corners.len() > 1 && corners[0].0 == corners[corners.len() - 1].0 {
            corners.pop();
        }
        return Ok(Border::Corners(corners));
    }
    let parts = path.split(&path.groups, 72);
    check_count(path, 93, "edges of a path", parts.len())?;
    let mut edges = Vec::with_capacity(parts.len());
    for part in parts {
        edges.extend(edge(&part)?);
    }
    join(&mut edges)?;
    Ok(Border::Edges(edges))
}

/// `None` of what has no extent.
fn edge(part: &Entity<'_>) -> Result<Option<Edge>, Unfit> {
    let edge = match part.flags(72)? {
        1 => Edge { ends: [point(part, 10)?, point(part, 11)?], along: Along::Line, backwards: false },
        2 => {
            let Some(radius) = radius(part)? else { return Ok(None) };
            arc(part, DVec2::new(radius, 0.0), DVec2::new(0.0, radius), |degrees| degrees)?
        }
        3 => {
            let (a, ratio) = (point(part, 11)?, part.number(40)?);
            let b = a.perp() * ratio;
            if b == DVec2::ZERO {
                return Ok(None);
            }
            // Other than those of an ELLIPSE, its angles are as seen from the centre, where a, too, is seen at 0.
            arc(part, a, b, |degrees| {
                let seen = direction(degrees);
                libm::atan2(seen.y / ratio, seen.x).to_degrees()
            })?
        }
        4 => {
            if is_rational(part, 42)? {
                return Err(Unfit::PassedOver("HATCH with a rational spline"));
            }
            if part.text(10).is_none() {
                return Err(Unfit::PassedOver("HATCH with a spline without control points"));
            }
            let curves = curves(part, 94)?;
            let (Some([from, ..]), Some([.., to])) =
                (curves.first().map(Vec::as_slice), curves.last().map(Vec::as_slice))
            else {
                return Ok(None);
            };
            Edge { ends: [*from, *to], along: Along::Spline(curves), backwards: false }
        }
        kind => {
            let what = format_args!("an edge of the kind {kind} (group code 72); it must be 1, 2, 3 or 4");
            return Err(part.fault(what).into());
        }
    };
    for end in edge.ends {
        check_point(end).map_err(|fault| part.fault(fault))?;
    }
    Ok(Some(edge))
}

/// An arc with these axes; `parameter` says where on it the angles are that the edge tells.
fn arc(part: &Entity<'_>, a: DVec2, b: DVec2, parameter: impl Fn(f64) -> f64) -> Result<Edge, Fault> {
    let [from, to] = [part.number(50)?, part.number(51)?];
    let clockwise = part.text(73).is_some() && part.flags(73)? == 0;
    // The angles of a clockwise arc are told clockwise. It is drawn the other way, as the ARC is drawn on which it may
    // lie.
    let [from, to] = if clockwise { [360.0 - to, 360.0 - from] } else { [from, to] };
    let (begin, whole) = (parameter(from), turn(from, to) == 360.0);
    let sweep = if whole { 360.0 } else { turn(begin, parameter(to)) };
    let ellipse = Ellipse { centre: point(part, 10)?, a, b, from: begin, sweep };
    let first = ellipse.at(begin);
    let ends = [first, if whole { first } else { ellipse.at(begin + sweep) }];
    Ok(Edge { ends, along: Along::Arc(ellipse), backwards: clockwise })
}

/// Turns edges so that each begins where the one before it ends, and makes their ends meet. They may be several rings.
fn join(edges: &mut [Edge]) -> Result<(), Unfit> {
    let ends = || edges.iter().flat_map(|edge| edge.ends);
    let Some(first) = ends().next() else { return Ok(()) };
    let [low, high] = ends().fold([first, first], |[low, high], p| [low.min(p), high.max(p)]);
    let size = low.abs().max(high.abs()).max_element();
    // Computed ends miss each other by rounding, more so far from the origin.
    let near = ((high - low).max_element() * MEETING).max(size * 2f64.powi(-40));
    let meet = |p: DVec2, q: DVec2| (p - q).abs().max_element() <= near;
    let mut first = 0;
    for i in 1..edges.len() {
        let here = edges[i - 1].end();
        let [start, end] = [edges[i].start(), edges[i].end()];
        if meet(here, start) {
            continue;
        }
        let back = edges[first].start();
        if meet(here, back) {
            close(&mut edges[first..i]);
            first = i;
        } else if meet(here, end) {
            edges[i].backwards ^= true;
        } else if i == first + 1 && (meet(back, start) || meet(back, end)) {
            edges[first].backwards ^= true;
            edges[i].backwards ^= !meet(back, start);
        } else {
            return Err(Unfit::PassedOver(OPEN));
        }
    }
    if !meet(edges[edges.len() - 1].end(), edges[first].start()) {
        return Err(Unfit::PassedOver(OPEN));
    }
    close(&mut edges[first..]);
    Ok(())
}

const OPEN: &str = "HATCH with an open border";

/// Makes the ends of a ring of edges equal where they meet.
fn close(ring: &mut [Edge]) {
    for i in 0..ring.len() {
        let next = (i + 1) % ring.len();
        let [before, after] = [&ring[i], &ring[next]];
        let joint = if after.looseness() < before.looseness() { after.start() } else { before.end() };
        let [end, start] = [usize::from(!before.backwards), usize::from(after.backwards)];
        ring[i].ends[end] = joint;
        ring[next].ends[start] = joint;
    }
}

/// A closed polyline; the painted area closes it where the file does not.
fn ring(hatch: &Entity<'_>, corners: &[Corner], pen: &mut Pen<'_>) -> Result<(), Fault> {
    let bends = corners.last().is_some_and(|corner| corner.1.abs() >= BULGE_MIN);
    polyline(hatch, corners, bends && corners.len() > 1, pen)?;
    if !corners.is_empty() {
        pen.close();
    }
    Ok(())
}

/// Draws edges, each in its own direction: by the even-odd rule it does not matter in which.
fn follow(edges: &[Edge], pen: &mut Pen<'_>) -> Drawn {
    let mut here = None;
    for Edge { ends: [from, to], along, .. } in edges {
        if here != Some(from) {
            pen.start(*from)?;
        }
        match along {
            Along::Line => pen.line_to(*to)?,
            Along::Arc(arc) => pen.ellipse_to(*arc, *to)?,
            Along::Spline(curves) => {
                for (i, curve) in curves.iter().enumerate() {
                    let [_, inner @ .., last] = &curve[..] else { continue };
                    pen.bezier_to(inner, if i + 1 == curves.len() { *to } else { *last })?;
                }
            }
        }
        here = Some(to);
    }
    Ok(())
}
