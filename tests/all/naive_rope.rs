//! Taut ropes by pulling strings, without anything of the library: a point of the rope that is pulled straight leaves
//! what lies in the triangle with its neighbours as new turns. For walls in general position.

use robust::{Coord, orient2d};

pub(crate) type P = [f64; 2];

pub(crate) fn orient(p: P, q: P, r: P) -> f64 {
    let coord = |p: P| Coord { x: p[0], y: p[1] };
    orient2d(coord(p), coord(q), coord(r))
}

/// A rope: where it is tied, and its turns, each with the sign of the turn.
#[derive(Clone)]
pub(crate) struct NaiveRope {
    anchor: P,
    turns: Vec<(P, f64)>,
}

impl NaiveRope {
    pub(crate) fn new(anchor: P) -> Self {
        NaiveRope { anchor, turns: vec![] }
    }

    /// Where it is tied.
    pub(crate) fn anchor(&self) -> P {
        self.anchor
    }

    /// Where it turns.
    pub(crate) fn turns(&self) -> impl Iterator<Item = P> {
        self.turns.iter().map(|turn| turn.0)
    }

    /// The rope after its free end went from `from` straight to `to`, among walls with these ends.
    pub(crate) fn moved(&self, from: P, to: P, ends: &[P]) -> NaiveRope {
        let mut path = vec![(self.anchor, 0.0)];
        path.extend(&self.turns);
        path.extend([(from, 0.0), (to, 0.0)]);
        path.dedup_by_key(|point| point.0);
        let bend = |path: &[(P, f64)], i: usize| orient(path[i - 1].0, path[i].0, path[i + 1].0);
        while let Some(i) = (1..path.len() - 1).rev().find(|&i| bend(&path, i) * path[i].1 <= 0.0) {
            let (turn, [a, b, c]) = (bend(&path, i), [path[i - 1].0, path[i].0, path[i + 1].0]);
            let is_inside =
                |p: &P| [orient(a, b, *p), orient(b, c, *p), orient(c, a, *p)].iter().all(|s| s * turn > 0.0);
            let mut left: Vec<P> = ends.iter().copied().filter(is_inside).chain([c]).collect();
            let (mut at, mut chain) = (a, vec![]);
            while at != c {
                at = *left.iter().find(|&&p| left.iter().all(|&q| orient(at, p, q) * turn >= 0.0)).unwrap();
                left.retain(|&p| p != at);
                chain.push((at, turn.signum()));
            }
            chain.pop();
            path.splice(i..=i, chain);
        }
        NaiveRope { anchor: self.anchor, turns: path[1..path.len() - 1].to_vec() }
    }

    /// Its length to `to`, summed from the anchor on.
    pub(crate) fn length(&self, to: P) -> f64 {
        let mut from = self.anchor;
        self.turns().chain([to]).fold(0.0, |sum, at| {
            let leg = distance(from, at);
            from = at;
            sum + leg
        })
    }
}

pub(crate) fn distance(p: P, q: P) -> f64 {
    let (x, y) = (p[0] - q[0], p[1] - q[1]);
    (x * x + y * y).sqrt()
}
