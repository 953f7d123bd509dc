//! Directions about a point, in their order counter-clockwise from its cut, by exact signs.
//!
//! A cut leaves its point upwards, turned clockwise by an infinitely small angle that is larger than the turn of any
//! hair. So no direction is that of the cut: straight up is the first one after it.

use std::cmp::Ordering;

use glam::DVec2;

use crate::geometry::{Hair, Turn, orient};

/// A direction from a point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Direction {
    /// Towards another point.
    Towards(DVec2),
    /// In which that hair of the point is displaced.
    Hair(Hair),
}

/// Compares the directions from `at` by their angles from the cut, counter-clockwise in (0, 360) degrees. Those of a
/// hair and of a point are never equal.
pub(super) fn by_angle(at: DVec2, one: Direction, other: Direction) -> Ordering {
    half(at, one).cmp(&half(at, other)).then_with(|| {
        // Both in the same half open half plane: less than half a turn apart.
        let side = match (one, other) {
            (Direction::Towards(p), Direction::Towards(q)) => orient(at, p, q),
            (Direction::Towards(p), Direction::Hair(hair)) => from_point_to_hair(at, p, hair),
            (Direction::Hair(hair), Direction::Towards(p)) => -from_point_to_hair(at, p, hair),
            (Direction::Hair(_), Direction::Hair(_)) => unreachable!("a point has one hair"),
        };
        0.0f64.total_cmp(&if side == 0.0 { 0.0 } else { side })
    })
}

/// A number with the sign of the angle from the direction towards `p` to that of the hair, which is less than half a
/// turn.
fn from_point_to_hair(at: DVec2, p: DVec2, hair: Hair) -> f64 {
    let side = orient(at, p, hair.witness) * if hair.away { -1.0 } else { 1.0 };
    match hair.turn {
        _ if side != 0.0 => side,
        Turn::Left => 1.0,
        Turn::Right => -1.0,
    }
}

/// Whether a direction lies in the second half of the turn: to the right, or straight down.
fn half(at: DVec2, direction: Direction) -> bool {
    let (p, away) = match direction {
        Direction::Towards(p) => (p, false),
        Direction::Hair(hair) => (hair.witness, hair.away),
    };
    if p.x != at.x { (p.x > at.x) != away } else { (p.y < at.y) != away }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a lattice, where most directions are ties, against angles in floating point.
    #[test]
    fn directions_are_in_the_order_of_their_angles() {
        let at = DVec2::ZERO;
        let around: Vec<DVec2> =
            (0..25).map(|i| DVec2::new(f64::from(i % 5 - 2), f64::from(i / 5 - 2))).filter(|p| *p != at).collect();
        let mut all: Vec<(f64, Direction)> = Vec::new();
        let angle = |p: DVec2, turned: f64| {
            (p.y.atan2(p.x) + turned - (90f64.to_radians() - 1e-6)).rem_euclid(std::f64::consts::TAU)
        };
        for &p in &around {
            all.push((angle(p, 0.0), Direction::Towards(p)));
            for away in [false, true] {
                for turn in [Turn::Left, Turn::Right] {
                    let turned = if turn == Turn::Left { 1e-9 } else { -1e-9 };
                    let hair = Hair { witness: p, away, turn };
                    all.push((angle(if away { -p } else { p }, turned), Direction::Hair(hair)));
                }
            }
        }
        for &(a, one) in &all {
            for &(b, other) in &all {
                if matches!((one, other), (Direction::Hair(_), Direction::Hair(_))) {
                    continue;
                }
                let truth = if (a - b).abs() < 1e-12 { Ordering::Equal } else { a.total_cmp(&b) };
                assert_eq!(by_angle(at, one, other), truth, "{one:?} {other:?}");
            }
        }
    }
}
