//! The scalar twin of `shaders/decide.wgsl`: the same rules, one vertex after the other.

use glam::Vec2;

use super::question::{Answer, NOTHING, Question, UNWRAP};
use crate::candidates::Rank;

/// By how much the wedge is grown, in the frame's unit: 2^-18, as that of the candidate pass.
const MARGIN: f32 = 1.0 / (1 << 18) as f32;

/// The answer to `question`, in f32 as it comes: the first event of the legs between `points`, of which there is one
/// more than `question.legs`, about the pivot. `vertices` are those to be tried, the one at place `question.first`
/// first. The device gives the same unless it fuses or reassociates. O(vertices + vertices in the wedge * legs).
///
/// ```
/// use glam::Vec2;
/// use tautline::candidates::DevicePlace;
/// use tautline::fast::{NOBODY, Question, decide};
/// let points = [[2.0, -2.0], [2.0, -1.0], [2.0, 1.0]].map(Vec2::from);
/// let question = Question { reach: 1.0, legs: 2, count: 1, barred: NOBODY, ..Question::default() };
/// let answer = decide(&question, &points, &[Vec2::new(1.0, 0.0)]);
/// assert_eq!((answer.leg, answer.place, answer.dir), (1, DevicePlace(0), 1.0));
/// ```
pub fn decide(question: &Question, points: &[Vec2], vertices: &[Vec2]) -> Answer {
    let mut met = Answer { leg: NOTHING, ..Answer::default() };
    for (rank, &vertex) in (0..).map(Rank).zip(vertices) {
        let p = vertex - question.origin;
        if in_wedge(question, p) {
            try_vertex(question, points, rank, p, &mut met);
        }
    }
    try_pivot(question, points, &mut met);
    met
}

fn cross(u: Vec2, v: Vec2) -> f32 {
    u.x * v.y - u.y * v.x
}

fn dot(u: Vec2, v: Vec2) -> f32 {
    u.x * v.x + u.y * v.y
}

fn in_wedge(question: &Question, p: Vec2) -> bool {
    let sides = dot(question.right, p).min(dot(question.left, p));
    sides.min(question.reach - dot(question.ahead, p)) >= -MARGIN
}

/// Whether `a` lies left of the line from the pivot along `way`; on the line counts as left.
fn is_left(way: Vec2, a: Vec2) -> bool {
    cross(way, a) >= 0.0
}

/// Takes the vertex of this rank, at `p`, for the first event if it is wrapped before that.
fn try_vertex(question: &Question, points: &[Vec2], rank: Rank, p: Vec2, met: &mut Answer) {
    for leg in 0..question.legs {
        if leg > met.leg {
            return;
        }
        let (a, b) = (points[leg as usize], points[leg as usize + 1]);
        let dir = if leg == 0 && question.dir != 0.0 { wraps_further(question, rank, p, a, b) } else { wraps(p, a, b) };
        if dir != 0.0 {
            if leg < met.leg || meets_before(p, met.at, dir) {
                *met = Answer { leg, place: question.first.of(rank), dir, unused: 0, at: p };
            }
            return;
        }
    }
}

/// The way in which the rope turns across the ray of `p` on the leg from `a` to `b`; 0 if it does not.
fn wraps(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let after = is_left(p, b);
    if is_left(p, a) == after {
        return 0.0;
    }
    let dir = if after { 1.0 } else { -1.0 };
    if cross(a - p, b - p) * dir >= 0.0 { dir } else { 0.0 }
}

/// The same on a leg on which the rope has turned already.
fn wraps_further(question: &Question, rank: Rank, p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let dir = question.dir;
    let turn = cross(question.start, p) * dir;
    let comes_after = turn > 0.0 || (turn == 0.0 && question.wrapped == 1 && dot(question.start, p) > 0.0);
    let is_past = is_left(p, b) == (dir > 0.0) && cross(a - p, b - p) * dir >= 0.0;
    if rank != question.barred && comes_after && is_past { dir } else { 0.0 }
}

/// Whether the rope, turning by `dir`, meets `p` before `q`: the nearer first where both lie on one line.
fn meets_before(p: Vec2, q: Vec2, dir: f32) -> bool {
    let order = cross(p, q) * dir;
    order > 0.0 || (order == 0.0 && dot(p, q - p) > 0.0)
}

/// Takes the unwrap of the pivot for the first event if it comes before that.
fn try_pivot(question: &Question, points: &[Vec2], met: &mut Answer) {
    let sides = dot(question.right, question.way).min(dot(question.left, question.way));
    if question.back == 0.0 || sides < -MARGIN {
        return;
    }
    for leg in 0..question.legs {
        if leg > met.leg {
            return;
        }
        let (a, b) = (points[leg as usize], points[leg as usize + 1]);
        let unwraps =
            if leg == 0 && question.dir != 0.0 { unwraps_further(question, a, b) } else { unwraps(question, a, b) };
        if unwraps {
            // On the same leg, the wrap is first where both lie on one line.
            if leg < met.leg || cross(question.way, met.at) * question.back > 0.0 {
                *met = Answer { leg, place: UNWRAP, dir: question.back, unused: 0, at: Vec2::ZERO };
            }
            return;
        }
    }
}

/// Whether the rope turns back across the ray of its pivot on the leg from `a` to `b`. If it was across before, by
/// rounding, it is enough that it points ahead.
fn unwraps(question: &Question, a: Vec2, b: Vec2) -> bool {
    let (way, back) = (question.way, question.back);
    let is_past = is_left(way, b) == (back > 0.0);
    let was_past = is_left(way, a) == (back > 0.0);
    is_past && if was_past { dot(way, b) > 0.0 } else { cross(a, b) * back >= 0.0 }
}

/// The same on a leg on which the rope has turned already. A ray that lies behind its direction is one that the rope
/// doubles back on, a half turn away.
fn unwraps_further(question: &Question, a: Vec2, b: Vec2) -> bool {
    let (way, back) = (question.way, question.back);
    let is_past = is_left(way, b) == (back > 0.0) && cross(a, b) * back >= 0.0;
    let is_ahead = cross(question.start, way) * back > 0.0 || dot(question.start, way) > 0.0;
    question.dir == back && is_past && is_ahead
}
