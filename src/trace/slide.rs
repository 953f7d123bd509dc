//! Slides: on which side of the walls a trace goes that follows them from end to end.

use std::rc::Rc;

use glam::DVec2;

use super::corner::{Corner, Way};
use crate::geometry::{Turn, orient};

/// A stretch of settled points `first..end` at one place.
pub(super) struct Stay {
    pub at: DVec2,
    pub first: usize,
    pub end: usize,
    pub corner: Option<Rc<Corner>>,
}

impl Stay {
    pub(super) fn slides_to(&self, next: &Stay) -> bool {
        self.corner.as_ref().is_some_and(|c| c.has_wall_towards(next.at))
    }
}

/// The side of the wall, as seen from corner `i` of a run looking back, on which the slide into it came: the mirror
/// image of the side that it has looking forwards. `sides[i]` is that of the slide from corner i to i + 1.
pub(super) fn incoming(sides: &[Turn], i: usize) -> Turn {
    if i > 0 { sides[i - 1].reversed() } else { Turn::Left }
}

pub(super) fn outgoing(sides: &[Turn], i: usize) -> Turn {
    sides.get(i).copied().unwrap_or(Turn::Left)
}

/// Chooses on which side of the walls each slide of a run of corners goes: one that connects at every corner; of those,
/// one that rounds no tip needlessly; of those, the one on the side that the trace comes from and goes on to; else the
/// left.
///
/// Where none connects at every corner, the trace breaks the rules where the longest start that does ends, and what
/// comes after is chosen anew.
pub(super) fn choose_sides(run: &[Stay], before: Option<&Stay>, after: Option<&Stay>) -> Vec<Turn> {
    // More than the two sides on which a slide can be wrong: a trace that turns back on a wall's end winds round
    // nothing.
    const TIP: u64 = 3;
    const BOTH: [Turn; 2] = [Turn::Left, Turn::Right];
    // More than all tips of a run together, since a trace has fewer than 2^31 points; and so many of these have a sum.
    const SLIPS: u64 = 1 << 33;
    let slides = run.len() - 1;
    if slides == 0 {
        return Vec::new();
    }
    let corner = |i: usize| run[i].corner.as_ref().expect("a run is made of corners");
    let cost_of = |i: usize, from: Way, to: Way| {
        if corner(i).connects(from, to) { TIP * u64::from(corner(i).rounds_tip(from, to)) } else { SLIPS }
    };
    // Which side of the line from p to q the point lies on, against the side chosen.
    let other_side = |p: DVec2, q: DVec2, point: DVec2, side: Turn| {
        let turn = orient(p, q, point);
        u64::from(if side == Turn::Left { turn < 0.0 } else { turn > 0.0 })
    };
    let enter = |side: Turn| {
        let to = corner(0).way(run[1].at, side);
        match before {
            Some(b) => cost_of(0, corner(0).way(b.at, Turn::Left), to) + other_side(run[0].at, run[1].at, b.at, side),
            None => SLIPS * u64::from(corner(0).is_solid(to)),
        }
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
    // At which corners the trace breaks the rules, whatever the sides. `open` are the sides of the last slide to which
    // it can have come since the last such corner.
    let mut broken = vec![false; slides + 1];
    let mut open = BOTH.map(|side| enter(side) < SLIPS);
    for (i, broken) in broken.iter_mut().enumerate() {
        if i > 0 {
            let comes =
                |cost: &dyn Fn(Turn) -> u64| BOTH.into_iter().zip(open).any(|(last, is)| is && cost(last) < SLIPS);
            open = if i < slides { BOTH.map(|next| comes(&|last| turn(i, last, next))) } else { [comes(&leave); 2] };
        }
        if open == [false; 2] {
            (*broken, open) = (true, [true; 2]);
        }
    }
    let forgiven = |i: usize, cost: u64| if broken[i] && cost >= SLIPS { cost - SLIPS } else { cost };
    // costs[k]: the least cost of slides k.. and the exit, for each side of slide k. Ties fall to the left.
    let mut costs = vec![BOTH.map(|side| forgiven(slides, leave(side))); slides];
    for k in (0..slides - 1).rev() {
        costs[k] = BOTH.map(|side| {
            let on = |(next, rest)| forgiven(k + 1, turn(k + 1, side, next)) + rest;
            BOTH.into_iter().zip(costs[k + 1]).map(on).min().unwrap_or(0)
        });
    }
    let pick = |cost: [u64; 2]| if cost[0] <= cost[1] { Turn::Left } else { Turn::Right };
    let mut sides: Vec<Turn> = Vec::with_capacity(slides);
    for (k, mut cost) in costs.into_iter().enumerate() {
        for (c, side) in cost.iter_mut().zip(BOTH) {
            *c += match sides.last() {
                None => forgiven(0, enter(side)),
                Some(&last) => forgiven(k, turn(k, last, side)),
            };
        }
        sides.push(pick(cost));
    }
    sides
}
