//! Random walks that respect the walls.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::draws::Draws;
use crate::scene::Model;
use crate::trace::{SettledTrace, Trace, settle_owned};

/// By how much the heading turns at most in one step, in radians.
const TURN: f64 = 0.4;

/// Persistent random walks from the anchor: the heading turns by a uniform angle within 0.4 rad a step, and a step is
/// 0.8 `step` along it plus a uniform offset within 0.2 `step` in x and y. A step that would touch a wall or leave the
/// scene's bounding box is drawn again with a wider turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// The length of a step, about, in the scene's unit.
    pub step: f64,
    /// How many steps a trace has.
    pub steps: usize,
    /// The seed: trace i of a seed is the same whatever else is walked.
    pub seed: u64,
}

/// Traces 0 to `count` - 1 of `walker`, on all cores.
///
/// A walker that finds no way on stays where it is for that step.
pub fn walks(model: &Model, walker: Walker, count: u64) -> Vec<Trace> {
    some_walks(model, walker, 0..count)
}

/// The traces of `walker` with these numbers, on all cores: [`walks`] part by part, for more than fit into memory.
pub fn some_walks(model: &Model, walker: Walker, numbers: Range<u64>) -> Vec<Trace> {
    let bounds = model.bounds();
    numbers.into_par_iter().map(|id| walk(model, bounds, walker, id)).collect()
}

/// The same traces, settled. Holds no trace twice, so that long ones in large numbers fit in memory.
pub fn settled_walks(model: &Model, walker: Walker, count: u64) -> Vec<SettledTrace> {
    let bounds = model.bounds();
    (0..count).into_par_iter().map(|id| settle_owned(model, walk(model, bounds, walker, id))).collect()
}

fn walk(model: &Model, (low, high): (DVec2, DVec2), walker: Walker, id: u64) -> Trace {
    let mut draws = Draws::new(walker.seed, id);
    let mut here = model.anchor();
    let mut heading = draws.within(std::f64::consts::PI);
    let mut points = Vec::with_capacity(walker.steps + 1);
    points.push(here);
    for _ in 0..walker.steps {
        let mut widest = TURN;
        for _ in 0..32 {
            let turned = heading + draws.within(widest);
            let offset = draws.point(0.2);
            let next = here + walker.step * (0.8 * DVec2::from_angle(turned) + offset);
            let inside = next.cmpge(low).all() && next.cmple(high).all();
            if inside && model.is_clear(here, next) {
                (here, heading) = (next, turned);
                break;
            }
            widest = (widest * 1.5).min(std::f64::consts::PI);
        }
        points.push(here);
    }
    Trace { id, points }
}
