//! The commonest ropes, each in a small picture of its own.

use glam::DVec2;

use super::chart::WIDTH;
use super::colour::{BLUE, INK, MUTED, VERMILION, WALL};
use super::label::{count, percent};
use super::plane::{Frame, View};
use super::svg::{Align, Svg};
use crate::scene::Scene;
use crate::study::{CommonRope, Summary};

/// How many ropes are drawn at the most.
const MOST: usize = 10;
const COLUMNS: usize = 3;
const MARGIN: f64 = 12.0;
const GAP: f64 = 14.0;
/// How much room the words above a small picture take.
const HEAD: f64 = 24.0;
/// How high a small picture is for its width.
const SHAPE: f64 = 0.8;
/// The least part of the scene's longer side that is shown.
const LEAST: f64 = 0.2;
const DASHES: &str = "stroke-width=\"1.8\" stroke-dasharray=\"5 3\" stroke-linejoin=\"round\"";

/// The commonest ropes over the scene, at most ten; `None` if there are none.
///
/// Each shows the part of the plane that its rope takes up, and some room round it.
pub fn ropes(summary: &Summary, scene: &Scene) -> Option<String> {
    let ropes = &summary.ropes[..summary.ropes.len().min(MOST)];
    if ropes.is_empty() {
        return None;
    }
    let width = (WIDTH - 2.0 * MARGIN - GAP * (COLUMNS - 1) as f64) / COLUMNS as f64;
    let height = width * SHAPE;
    let rows = ropes.len().div_ceil(COLUMNS);
    let bottom = MARGIN + rows as f64 * (HEAD + height + GAP);
    let mut svg = Svg::new(WIDTH, bottom + 48.0, "The commonest ropes at the end");
    let style = format!("fill=\"none\" stroke=\"{WALL}\" stroke-width=\".8\" stroke-linejoin=\"round\"");
    for (i, rope) in ropes.iter().enumerate() {
        let left = MARGIN + (i % COLUMNS) as f64 * (width + GAP);
        let top = MARGIN + HEAD + (i / COLUMNS) as f64 * (HEAD + height + GAP);
        let sign = if rope.at_most > rope.count { "≥ " } else { "" };
        svg.text([left, top - 7.0], Align::Start, "", &format!("{}.  {sign}{}", i + 1, percent(&rope.share)));
        let frame = Frame::fit(view(rope, scene)?, [left, top], [width, height]).of(scene);
        svg.rect([left, top], [frame.width, frame.height], "fill=\"#fafafa\"");
        svg.path(&frame.walls(scene), &style);
        svg.rect([left, top], [frame.width, frame.height], "fill=\"none\" stroke=\"#ccc\"");
        draw(&mut svg, &frame, rope);
    }
    key(&mut svg, bottom + 6.0);
    Some(svg.finish())
}

/// Which part of the plane is shown: what the rope takes up with room round it, in the shape of all pictures. A
/// straight rope, of which only the anchor is known, and a very short one are shown in a fifth of the scene.
fn view(rope: &CommonRope, scene: &Scene) -> Option<View> {
    let points = || rope.wraps.iter().chain([&rope.anchor]).map(|&p| DVec2::from(p));
    let whole = View::around(scene.vertices().iter().copied().chain(points()))?;
    let size = whole.size().max_element();
    let least =
        if size > 0.0 { LEAST * size } else { (whole.low.abs().max_element() * 0.1).max(f64::MIN_POSITIVE * 1e16) };
    let near = View::around(points())?.padded(0.25);
    let room = near.size().max(DVec2::splat(least));
    let wanted = room.max(DVec2::new(room.y / SHAPE, room.x * SHAPE));
    let more = (wanted - near.size()) / 2.0;
    Some(View { low: near.low - more, high: near.high + more })
}

/// A rope from its anchor to beyond its last turn.
fn draw(svg: &mut Svg, frame: &Frame, rope: &CommonRope) {
    let anchor = frame.at(rope.anchor.into());
    let turns: Vec<[f64; 2]> = rope.wraps.iter().map(|&p| frame.at(p.into())).collect();
    let line: Vec<[f64; 2]> = std::iter::once(anchor).chain(turns.iter().copied()).collect();
    svg.polyline(&line, "stroke=\"#fff\" stroke-opacity=\".8\" stroke-width=\"4\"");
    svg.polyline(&line, &format!("stroke=\"{INK}\" {DASHES}"));
    if turns.is_empty() {
        let at = [frame.left + 8.0, frame.top + frame.height - 9.0];
        let outlined = format!("fill=\"{MUTED}\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"");
        svg.text(at, Align::Start, &outlined, "straight");
    }
    let left = |i: usize| rope.sides.get(i).is_some_and(|s| s == "left");
    if let [.., before, last] = line[..] {
        free_end(svg, before, last, left(turns.len() - 1));
    }
    for (i, &at) in turns.iter().enumerate() {
        mark(svg, at, left(i));
    }
    svg.circle(anchor, 4.5, &format!("fill=\"{INK}\" stroke=\"#fff\""));

    let mut taken: Vec<[f64; 2]> = vec![anchor];
    for (i, &at) in turns.iter().enumerate() {
        let place = beside(line[i], at, turns.get(i + 1).copied(), left(i));
        let place = [
            place[0].clamp(frame.left + 7.0, frame.left + frame.width - 7.0),
            place[1].clamp(frame.top + 7.0, frame.top + frame.height - 7.0),
        ];
        // Where turns crowd, only the first of them is numbered: the others follow along the rope.
        if taken.iter().all(|t| (t[0] - place[0]).hypot(t[1] - place[1]) > 12.0) {
            let outlined = "font-size=\"10\" stroke=\"#fff\" stroke-width=\"2.5\" paint-order=\"stroke\"";
            svg.text([place[0], place[1] + 3.5], Align::Middle, outlined, &count(i as u64 + 1));
            taken.push(place);
        }
    }
}

/// A turn: a round mark where the wall end lies to the left, a square one where it lies to the right.
fn mark(svg: &mut Svg, [x, y]: [f64; 2], left: bool) {
    if left {
        svg.circle([x, y], 3.4, &format!("fill=\"{BLUE}\" stroke=\"#fff\""));
    } else {
        svg.rect([x - 3.0, y - 3.0], [6.0, 6.0], &format!("fill=\"{VERMILION}\" stroke=\"#fff\""));
    }
}

/// The way from `a` to `b`, one pixel long.
pub(super) fn towards(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let length = x.hypot(y);
    if length > 0.0 { [x / length, y / length] } else { [0.0, 0.0] }
}

/// Where the number of a turn stands: on the side where the wall end does not lie.
pub(super) fn beside(before: [f64; 2], at: [f64; 2], after: Option<[f64; 2]>, left: bool) -> [f64; 2] {
    let (a, b) = (towards(before, at), after.map_or([0.0, 0.0], |next| towards(at, next)));
    let [x, y] = towards([0.0, 0.0], [a[0] + b[0], a[1] + b[1]]);
    let away = if left { [-y, x] } else { [y, -x] };
    let away = if away == [0.0, 0.0] { [0.0, -1.0] } else { away };
    [at[0] + 11.0 * away[0], at[1] + 11.0 * away[1]]
}

/// A short arrow from the last turn to the side to which the rope bends there: it goes on, nobody says how far.
fn free_end(svg: &mut Svg, before: [f64; 2], last: [f64; 2], left: bool) {
    let [x, y] = towards(before, last);
    // Turned by 45 degrees; pixels count downwards.
    let turned = |x: f64, y: f64, left: bool| {
        let s = if left { 1.0 } else { -1.0 };
        [(x + s * y) * std::f64::consts::FRAC_1_SQRT_2, (y - s * x) * std::f64::consts::FRAC_1_SQRT_2]
    };
    let [x, y] = turned(x, y, left);
    arrow(svg, last, [x, y], 17.0);
}

/// An open arrow along the unit vector (`x`, `y`).
fn arrow(svg: &mut Svg, from: [f64; 2], [x, y]: [f64; 2], length: f64) {
    let tip = [from[0] + length * x, from[1] + length * y];
    let barb = |s: f64| [tip[0] - 5.0 * x + s * 3.5 * y, tip[1] - 5.0 * y - s * 3.5 * x];
    let style = format!("stroke=\"{MUTED}\" stroke-width=\"1.3\" stroke-linejoin=\"round\"");
    svg.polyline(&[from, tip], &style);
    svg.polyline(&[barb(1.0), tip, barb(-1.0)], &style);
}

/// What the marks mean, in two lines.
fn key(svg: &mut Svg, y: f64) {
    let style = format!("fill=\"{MUTED}\"");
    let mut words = |x: f64, y: f64, text: &str| svg.text([x, y + 4.0], Align::Start, &style, text);
    words(26.0, y, "anchor");
    words(132.0, y, "rope");
    words(222.0, y, "turns, wall end on the left");
    words(446.0, y, "on the right");
    words(566.0, y, "on to the free end");
    words(MARGIN, y + 22.0, "Numbers count the turns from the anchor. Each picture is zoomed to its rope.");
    svg.circle([MARGIN + 5.0, y], 4.5, &format!("fill=\"{INK}\""));
    svg.line([98.0, y], [126.0, y], &format!("stroke=\"{INK}\" {DASHES}"));
    mark(svg, [212.0, y], true);
    mark(svg, [436.0, y], false);
    arrow(svg, [542.0, y], [1.0, 0.0], 17.0);
}
