//! Very long and very short steps, very many of them, and very many turns.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{along, around, case, model, nudged, numbered, on_circle, p, walls_of, way};
use crate::example::Draws;
use crate::example::{Walker, random_walls, walks};
use crate::scene::Model;

/// Steps across the whole scene and far beyond, and steps of 1 unit in the last place over rays and round walls' ends.
pub(super) fn steps() -> Vec<Extreme> {
    let walls = walls_of(&random_walls(25, 9));
    let anchor = p(0.0, 0.0);
    let model = model(&walls, anchor);
    let across = [1.5, 1e3, 1e9, 1e18, 1e60].map(|far| anywhere(&model, far));
    let mut cases = vec![case("across the scene and 10^60 scenes", walls.clone(), anchor, across)];
    // Between the tip of a wall and the one behind it, where the rope turns.
    let traces = model.vertices().iter().step_by(5).map(|&tip| round_tip(&model, tip));
    cases.push(case("of an ulp round walls' ends", walls.clone(), anchor, traces));
    let corner = [[p(0.1, 0.3), p(-0.2, 0.4)], [p(0.2, 0.6), p(-0.1, 0.9)]];
    for far in [0.7, 70.0, 7e5] {
        let beside = |ulps: i64| p(far, nudged(3.0 * far, ulps));
        let across = (-300..=300).chain((-300..=300).rev()).map(beside);
        let name = format!("of an ulp over a ray, {far:e} away");
        cases.push(case(name, corner.to_vec(), anchor, [[p(far, -far)].into_iter().chain(across).collect()]));
    }
    cases
}

/// Steps to anywhere up to `far` away that keep off the walls.
fn anywhere(model: &Model, far: f64) -> Vec<DVec2> {
    let mut draws = Draws::new(1, far as u64);
    let mut points = vec![model.anchor()];
    for _ in 0..20_000 {
        // Many of them pass the scene closely.
        let size = far * draws.unit() * draws.unit() * draws.unit();
        let (here, next) = (points[points.len() - 1], draws.point(size.max(1.2)));
        if model.is_clear(here, next) {
            points.push(next);
        }
    }
    points
}

/// To a wall's end and about it in steps of one unit in the last place.
fn round_tip(model: &Model, tip: DVec2) -> Vec<DVec2> {
    let mut draws = Draws::new(3, tip.x.to_bits());
    way(model, 150, |here| {
        if here == model.anchor() || here.distance(tip) > 1e-6 {
            // Close by first, from whatever side it can be reached.
            return tip + draws.point(1e-7);
        }
        if draws.unit() < 0.3 {
            return tip;
        }
        let mut one = |x: f64| nudged(x, draws.whole(-1, 1));
        p(one(if here == tip { tip.x } else { here.x }), one(if here == tip { tip.y } else { here.y }))
    })
}

/// A rope wound round a pillar and unwound again; some traces end there and some half way.
pub(super) fn windings() -> Vec<Extreme> {
    let square = [p(0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)];
    let dozen: Vec<DVec2> = (0..12).map(|k| on_circle(f64::from(k) / 12.0)).collect();
    let mut cases = Vec::new();
    // The few are for devices, which answer one event of a trace a round.
    for turns in [50, 100_000] {
        cases.push(wound(&square, p(-1.0, -2.0), turns));
        cases.push(wound(&dozen, p(3.0, -0.25), turns));
    }
    // Round two posts in the shape of an 8: the rope crosses itself.
    let posts = [[p(-2.25, 0.0), p(-2.0, 0.0)], [p(2.0, 0.0), p(2.25, 0.0)]];
    let eight = [p(0.0, -0.5), p(3.0, -0.5), p(3.0, 0.5), p(0.0, 0.25), p(-3.0, -0.5), p(-3.0, 0.5)];
    let stops = eight.repeat(50);
    let back: Vec<DVec2> = stops.iter().chain(stops.iter().rev()).copied().collect();
    cases.push(case("50 times round two posts in an 8", posts.to_vec(), p(0.0, -1.0), [stops, back]));
    cases
}

fn wound(corners: &[DVec2], anchor: DVec2, turns: usize) -> Extreme {
    let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
    // Each leg passes one corner closely.
    let ring: Vec<DVec2> = corners.iter().map(|&corner| middle + 1.75 * (corner - middle)).collect();
    let forth: Vec<DVec2> = ring.repeat(turns);
    let back: Vec<DVec2> = forth.iter().chain(forth.iter().rev()).copied().collect();
    let other_way: Vec<DVec2> = ring.iter().rev().copied().cycle().take(forth.len()).collect();
    let name = format!("{turns} turns round {} corners", corners.len());
    case(name, around(corners), anchor, [forth, back, other_way])
}

/// Traces of a million steps among few walls, and a million traces of one step.
pub(super) fn long_and_many() -> Vec<Extreme> {
    let walls = walls_of(&random_walls(4, 2));
    let anchor = p(0.0, 0.0);
    let model = model(&walls, anchor);
    let long = walks(&model, Walker { step: 0.001, steps: 1_000_000, seed: 6 }, 1);
    let mut case_of_many = case("10^6 traces of one step", walls.clone(), anchor, []);
    case_of_many.traces = numbered((0..1_000_000).map(|id| one_step(&model, id)));
    let mut case_of_long = case("a trace of 10^6 steps", walls, anchor, []);
    case_of_long.traces = long;
    let ladder: Vec<DVec2> = (0..400).map(|k| p(f64::from(k), f64::from(k % 2))).collect();
    // All along a wall of many links, standing on each joint.
    let links = case("along 400 walls from joint to joint", along(&ladder), p(-1.0, -1.0), [ladder.clone()]);
    vec![case_of_long, case_of_many, links]
}

/// From somewhere that the anchor sees to somewhere that can be seen from there.
fn one_step(model: &Model, id: u64) -> Vec<DVec2> {
    let mut draws = Draws::new(4, id);
    let mut seen_from =
        |here: DVec2| (0..16).map(|_| draws.point(1.0)).find(|&next| model.is_clear(here, next)).unwrap_or(here);
    let first = seen_from(model.anchor());
    vec![first, seen_from(first)]
}
