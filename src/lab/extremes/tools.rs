//! What families are made with.

use std::sync::Arc;

use glam::DVec2;

use super::extreme::Extreme;
use crate::scene::{Model, Scene};
use crate::trace::{Trace, first_violation};

/// A point.
pub(super) fn p(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// The walls from each of `corners` to the next.
pub(super) fn along(corners: &[DVec2]) -> Vec<[DVec2; 2]> {
    corners.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

/// The walls from each of `corners` to the next and from the last to the first.
pub(super) fn around(corners: &[DVec2]) -> Vec<[DVec2; 2]> {
    (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect()
}

/// The walls of `scene`.
pub(super) fn walls_of(scene: &Scene) -> Vec<[DVec2; 2]> {
    (0..scene.walls().len()).map(|wall| scene.ends(wall)).collect()
}

/// The point of the unit circle after `turns`; quarters are exact. Made without angles: sines and cosines are not the
/// same on every machine.
pub(super) fn on_circle(turns: f64) -> DVec2 {
    let quarters = 4.0 * turns;
    let t = quarters - quarters.floor();
    let way = p(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
    (0..quarters.floor().rem_euclid(4.0) as usize).fold(way, |way, _| way.perp())
}

/// `x`, `ulps` units in the last place away from zero (towards zero for negative ones).
pub(super) fn nudged(x: f64, ulps: i64) -> f64 {
    f64::from_bits(x.to_bits().wrapping_add_signed(ulps))
}

/// Some points as traces, numbered from 0.
pub(super) fn numbered(traces: impl IntoIterator<Item = Vec<DVec2>>) -> Vec<Trace> {
    (0..).zip(traces).map(|(id, points)| Trace { id, points }).collect()
}

/// A case of which the traces need no check.
pub(super) fn case(
    name: impl Into<String>,
    walls: Vec<[DVec2; 2]>,
    anchor: DVec2,
    traces: impl IntoIterator<Item = Vec<DVec2>>,
) -> Extreme {
    Extreme { name: name.into(), walls, anchor, traces: numbered(traces) }
}

/// The way from the anchor over some of `stops` stops: those to which a step would break the rules are left out. `next`
/// gives the next stop, given where the free end stands.
pub(super) fn way(model: &Model, stops: usize, mut next: impl FnMut(DVec2) -> DVec2) -> Vec<DVec2> {
    let mut points = vec![model.anchor()];
    // On which side the free end passes what it touches is open until it stands clear of all walls.
    let mut clear = 0;
    for _ in 0..stops {
        let to = next(points[points.len() - 1]);
        let open = points[clear..].iter().copied().chain([to]).collect();
        if first_violation(model, Trace { id: 0, points: open }).is_none() {
            if !model.is_on_wall(to) {
                clear = points.len();
            }
            points.push(to);
        }
    }
    points
}

/// The model of some walls.
pub(super) fn model(walls: &[[DVec2; 2]], anchor: DVec2) -> Arc<Model> {
    Extreme { name: String::new(), walls: walls.to_vec(), anchor, traces: vec![] }.model()
}
