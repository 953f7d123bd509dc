//! Settling a trace: checking its steps against the walls, and deciding on which side it passes the wall ends that it
//! touches.
//!
//! A trace may stand exactly on a vertex, pass exactly through one, or slide along walls from end to end. It then
//! counts as passing a hair off the walls, on the side that it comes from and goes on to; where both sides would do, on
//! the left. Settled traces need no further thought: their points carry their [`Hair`].

use glam::DVec2;

use super::Trace;
use super::corner::{Corner, Way};
use crate::geometry::{Hair, TracePoint, Turn, between, orient};
use crate::scene::Model;

/// How many steps share one look into the index. Traces move in small steps, so neighbours see the same few walls.
const STEPS_PER_LOOK: usize = 16;

/// What a trace does that a rope among solid walls cannot follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViolationKind {
    /// The step crosses a wall.
    Crosses,
    /// The step ends inside a wall, between its ends.
    EndsInside,
    /// The step leads through the end of a wall from one side of the walls that meet there to another.
    SlipsThrough,
}

/// A step that breaks the small update condition: point k must be visible from point k-1, and point 0 from the anchor.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("trace {trace}, step {step}: the move from ({}, {}) to ({}, {}) {} wall {wall}, from ({}, {}) to ({}, {}); each point must be visible from the one before, the first from the anchor",
    from.x, from.y, to.x, to.y, match kind {
        ViolationKind::Crosses => "crosses",
        ViolationKind::EndsInside => "ends inside",
        ViolationKind::SlipsThrough => "slips between the walls at the end of",
    }, ends[0].x, ends[0].y, ends[1].x, ends[1].y)]
pub struct Violation {
    /// The trace's number.
    pub trace: u64,
    /// The step: the move from point `step - 1` to point `step`; 0 is the move from the anchor to the first point.
    pub step: usize,
    /// What it does.
    pub kind: ViolationKind,
    /// Which wall, counted from 0.
    pub wall: usize,
    /// That wall's endpoints.
    pub ends: [DVec2; 2],
    /// Where the step starts.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
}

/// A trace that is ready to be evaluated.
///
/// Its points are those of the trace, with the anchor before them (unless the trace starts there) and a point added
/// wherever a step passes through a vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct SettledTrace {
    id: u64,
    points: Vec<DVec2>,
    /// Indices of the points that are not the ends of steps, ascending.
    added: Vec<u32>,
    /// The hairs by point index, ascending.
    hairs: Vec<(u32, Hair)>,
    violation: Option<Violation>,
}

impl SettledTrace {
    /// The trace's number.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Where the points stand, those added included.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Point `i` with its hair.
    #[inline]
    pub fn point(&self, i: usize) -> TracePoint {
        let hair = match self.hairs.as_slice() {
            [] => None,
            hairs => hairs.binary_search_by_key(&(i as u32), |h| h.0).ok().map(|h| hairs[h].1),
        };
        TracePoint { at: self.points[i], hair }
    }

    /// The step to which the move to point `i` belongs; 0 is the move from the anchor to the trace's first point.
    pub fn step(&self, i: usize) -> usize {
        i - self.added.partition_point(|&a| (a as usize) < i)
    }

    /// Whether point `i` is a point of the trace, so that a step ends there.
    #[inline]
    pub fn ends_step(&self, i: usize) -> bool {
        self.added.binary_search(&(i as u32)).is_err()
    }

    /// The number of the trace's steps: its points less one.
    pub fn steps(&self) -> usize {
        (self.points.len() - self.added.len()).saturating_sub(1)
    }

    /// The first step that breaks the small update condition, if one does.
    pub fn violation(&self) -> Option<&Violation> {
        self.violation.as_ref()
    }
}

/// Checks `trace` against the model's walls and settles on which side it passes the vertices that it touches.
///
/// O(points + walls near them), through the model's index.
///
/// # Panics
///
/// If the trace has no point or more than 2^31.
pub fn settle(model: &Model, trace: &Trace) -> SettledTrace {
    assert!(!trace.points.is_empty() && trace.points.len() < 1 << 31, "a trace has 1 to 2^31 points");
    let mut settler = Settler::new(model, trace);
    settler.walk();
    settler.pluck();
    settler.settled
}

struct Settler<'a> {
    model: &'a Model,
    trace: &'a Trace,
    settled: SettledTrace,
    /// Indices of the settled points that stand on vertices, ascending.
    touching: Vec<u32>,
}

impl<'a> Settler<'a> {
    fn new(model: &'a Model, trace: &'a Trace) -> Self {
        let settled = SettledTrace {
            id: trace.id,
            points: Vec::with_capacity(trace.points.len() + 1),
            added: Vec::new(),
            hairs: Vec::new(),
            violation: None,
        };
        Settler { model, trace, settled, touching: Vec::new() }
    }

    fn violate(&mut self, step: usize, kind: ViolationKind, wall: u32) {
        let from = if step == 0 { self.model.anchor() } else { self.trace.points[step - 1] };
        let to = self.trace.points[step];
        let ends = self.model.scene().ends(wall as usize);
        let found = Violation { trace: self.trace.id, step, kind, wall: wall as usize, ends, from, to };
        if self.settled.violation.is_none_or(|v| (found.step, found.wall) < (v.step, v.wall)) {
            self.settled.violation = Some(found);
        }
    }

    fn add(&mut self, at: DVec2, ends_step: bool, touches: bool) {
        let i = self.settled.points.len() as u32;
        self.settled.points.push(at);
        if !ends_step {
            self.settled.added.push(i);
        }
        if touches {
            self.touching.push(i);
        }
    }

    /// Lays out the settled points: step after step, with the vertices that each passes through.
    fn walk(&mut self) {
        let (anchor, points) = (self.model.anchor(), &self.trace.points);
        if points[0] != anchor {
            self.add(anchor, false, self.model.vertex_at(anchor).is_some());
        }
        let mut walls = Vec::new();
        for first in (0..points.len()).step_by(STEPS_PER_LOOK) {
            let last = points.len().min(first + STEPS_PER_LOOK);
            let start = if first == 0 { anchor } else { points[first - 1] };
            let (low, high) = (points[first..last].iter()).fold((start, start), |(l, h), &p| (l.min(p), h.max(p)));
            walls.clear();
            walls.extend(self.model.index().near(low, high));
            walls.sort_unstable();
            let mut from = start;
            for step in first..last {
                self.step(step, from, points[step], &walls);
                from = points[step];
            }
        }
    }

    /// Adds the points of one step, given all walls near it in ascending order.
    fn step(&mut self, step: usize, a: DVec2, b: DVec2, walls: &[u32]) {
        let (low, high) = (a.min(b), a.max(b));
        let mut near = false;
        let mut passed: Vec<DVec2> = Vec::new();
        for &wall in walls {
            let [u, v] = self.model.scene().ends(wall as usize);
            if u.min(v).cmpgt(high).any() || u.max(v).cmplt(low).any() {
                continue;
            }
            near = true;
            let (from_a, from_b) = (orient(u, v, a), orient(u, v, b));
            if from_b == 0.0 && between(u, v, b) && self.model.vertex_at(b).is_none() {
                self.violate(step, ViolationKind::EndsInside, wall);
            }
            if a == b || (from_a > 0.0 && from_b > 0.0) || (from_a < 0.0 && from_b < 0.0) {
                continue;
            }
            let (to_u, to_v) = (orient(a, b, u), orient(a, b, v));
            if from_a * from_b < 0.0 && to_u * to_v < 0.0 {
                self.violate(step, ViolationKind::Crosses, wall);
            }
            passed
                .extend([(to_u, u), (to_v, v)].into_iter().filter(|&(s, w)| s == 0.0 && between(a, b, w)).map(|p| p.1));
        }
        passed.sort_by(|p, q| {
            let ahead = |p: DVec2| if a.x < b.x || (a.x == b.x && a.y < b.y) { p } else { -p };
            let (p, q) = (ahead(*p), ahead(*q));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
        });
        passed.dedup();
        for p in passed {
            self.add(p, false, true);
        }
        self.add(b, true, near && self.model.vertex_at(b).is_some());
    }

    /// Gives every touching point its hair.
    fn pluck(&mut self) {
        if self.touching.is_empty() {
            return;
        }
        let stays = self.stays();
        let mut chosen: Vec<(u32, Vec<Hair>)> = Vec::new();
        let mut s = 0;
        while s < stays.len() {
            let Some(_) = stays[s].corner else {
                s += 1;
                continue;
            };
            // The run of corners s..e that slides along walls link.
            let mut e = s + 1;
            while e < stays.len() && stays[e].corner.is_some() && stays[e - 1].slides_to(&stays[e]) {
                e += 1;
            }
            self.pluck_run(&stays, s, e, &mut chosen);
            s = e;
        }
        self.insert(&stays, chosen);
    }

    /// The settled points with repeats of the same place taken together, from one point before the first touching one
    /// on; only stays that touch, and those beside them, matter.
    fn stays(&self) -> Vec<Stay> {
        let points = &self.settled.points;
        let mut stays: Vec<Stay> = Vec::new();
        let mut touching = self.touching.iter().peekable();
        for (i, &at) in points.iter().enumerate() {
            let touches = touching.next_if(|&&t| t as usize == i).is_some();
            match stays.last_mut() {
                Some(stay) if stay.at == at => stay.end = i + 1,
                _ => {
                    let corner = touches.then(|| Corner::new(self.model, at));
                    stays.push(Stay { at, first: i, end: i + 1, corner });
                }
            }
        }
        stays
    }

    /// Chooses the sides of the slides in `stays[s..e]` and from them the hairs.
    fn pluck_run(&mut self, stays: &[Stay], s: usize, e: usize, chosen: &mut Vec<(u32, Vec<Hair>)>) {
        let before = (s > 0).then(|| &stays[s - 1]);
        let after = stays.get(e);
        let sides = choose_sides(&stays[s..e], before, after);
        for i in s..e {
            let corner = stays[i].corner.as_ref().expect("a run is made of corners");
            let from = (i > 0).then(|| corner.way(stays[i - 1].at, incoming(&sides, i - s)));
            let to = stays.get(i + 1).map(|next| corner.way(next.at, outgoing(&sides, i - s)));
            let (from, to) = match (from, to) {
                (Some(from), Some(to)) => (from, to),
                (Some(way), None) | (None, Some(way)) => (way, way),
                // The trace never leaves this point: any side will do.
                (None, None) => (corner.any_way(), corner.any_way()),
            };
            if !corner.connects(from, to) {
                let at = stays[i].at;
                let walls = self.model.index().near(at, at);
                let wall = walls.filter(|&w| self.model.scene().ends(w as usize).contains(&at)).min();
                // The step that goes on to the wrong side.
                let step = self.settled.step(stays[i].end);
                self.violate(step, ViolationKind::SlipsThrough, wall.expect("a corner has walls"));
            }
            chosen.push((i as u32, corner.hairs(from, to)));
        }
    }

    /// Writes the hairs down, adding a point where a stay needs two.
    fn insert(&mut self, stays: &[Stay], chosen: Vec<(u32, Vec<Hair>)>) {
        let mut shift = 0;
        for (stay, hairs) in chosen {
            let stay = &stays[stay as usize];
            for i in stay.first..stay.end {
                self.settled.hairs.push(((i + shift) as u32, hairs[0]));
            }
            if let Some(&second) = hairs.get(1) {
                // The stay's last point moves on to the second hair, and a point with the first is added before it.
                let i = stay.end - 1 + shift;
                self.settled.points.insert(i, stay.at);
                let place = self.settled.added.partition_point(|&a| (a as usize) < i);
                self.settled.added[place..].iter_mut().for_each(|a| *a += 1);
                self.settled.added.insert(place, i as u32);
                self.settled.hairs.push((i as u32 + 1, second));
                shift += 1;
            }
        }
    }
}

/// A stretch of settled points `first..end` at one place.
struct Stay {
    at: DVec2,
    first: usize,
    end: usize,
    corner: Option<Corner>,
}

impl Stay {
    fn slides_to(&self, next: &Stay) -> bool {
        self.corner.as_ref().is_some_and(|c| c.has_wall_towards(next.at))
    }
}

/// The side of the wall, as seen from corner `i` of a run looking back, on which the slide into it came: the mirror
/// image of the side that it has looking forwards. `sides[i]` is that of the slide from corner i to i + 1.
fn incoming(sides: &[Turn], i: usize) -> Turn {
    if i > 0 { sides[i - 1].reversed() } else { Turn::Left }
}

fn outgoing(sides: &[Turn], i: usize) -> Turn {
    sides.get(i).copied().unwrap_or(Turn::Left)
}

/// Chooses on which side of the walls each slide of a run of corners goes: one that connects at every corner; of those,
/// the one on the side that the trace comes from and goes on to, without rounding tips needlessly; else the left.
fn choose_sides(run: &[Stay], before: Option<&Stay>, after: Option<&Stay>) -> Vec<Turn> {
    const SLIPS: u32 = 1 << 16;
    const BOTH: [Turn; 2] = [Turn::Left, Turn::Right];
    let slides = run.len() - 1;
    if slides == 0 {
        return Vec::new();
    }
    let corner = |i: usize| run[i].corner.as_ref().expect("a run is made of corners");
    let cost_of = |i: usize, from: Way, to: Way| {
        if corner(i).connects(from, to) { u32::from(corner(i).rounds_tip(from, to)) } else { SLIPS }
    };
    // Which side of the line from p to q the point lies on, against the side chosen.
    let other_side = |p: DVec2, q: DVec2, point: DVec2, side: Turn| {
        let turn = orient(p, q, point);
        u32::from(if side == Turn::Left { turn < 0.0 } else { turn > 0.0 })
    };
    let enter = |side: Turn| {
        before.map_or(0, |b| {
            let (from, to) = (corner(0).way(b.at, Turn::Left), corner(0).way(run[1].at, side));
            cost_of(0, from, to) + other_side(run[0].at, run[1].at, b.at, side)
        })
    };
    let leave = |side: Turn| {
        after.map_or(0, |a| {
            let (from, to) =
                (corner(slides).way(run[slides - 1].at, side.reversed()), corner(slides).way(a.at, Turn::Left));
            cost_of(slides, from, to) + other_side(run[slides - 1].at, run[slides].at, a.at, side)
        })
    };
    let turn = |i: usize, side: Turn, next: Turn| {
        cost_of(i, corner(i).way(run[i - 1].at, side.reversed()), corner(i).way(run[i + 1].at, next))
    };
    // costs[k]: the least cost of slides k.. and the exit, for each side of slide k. Ties fall to the left.
    let mut costs = vec![BOTH.map(leave); slides];
    for k in (0..slides - 1).rev() {
        costs[k] = BOTH.map(|side| {
            BOTH.into_iter().zip(costs[k + 1]).map(|(next, rest)| turn(k + 1, side, next) + rest).min().unwrap_or(0)
        });
    }
    let pick = |cost: [u32; 2]| if cost[0] <= cost[1] { Turn::Left } else { Turn::Right };
    let mut sides: Vec<Turn> = Vec::with_capacity(slides);
    for k in 0..slides {
        let mut cost = costs[k];
        for (c, side) in cost.iter_mut().zip(BOTH) {
            *c += match sides.last() {
                None => enter(side),
                Some(&last) => turn(k, last, side),
            };
        }
        sides.push(pick(cost));
    }
    sides
}
