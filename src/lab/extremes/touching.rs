//! Traces along walls, through their ends, and standing on them.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{along, around, case, model, on_circle, p, walls_of, way};
use crate::example::Draws;
use crate::example::lattice_walls;
use crate::scene::Model;

/// How many laps and slides the long traces make.
const LAPS: usize = 25_000;

pub(super) fn touching() -> Vec<Extreme> {
    let mut cases: Vec<Extreme> =
        plans().into_iter().map(|(name, walls, anchor)| wandering(name, walls, anchor)).collect();
    let [low, high] = [p(0.0, 0.0), p(3.0, 3.0)];
    let corners = [low, p(high.x, low.y), high, p(low.x, high.y)];
    let laps: Vec<DVec2> = corners.repeat(LAPS);
    let back: Vec<DVec2> = laps.iter().chain(laps.iter().rev()).copied().collect();
    cases.push(case("laps along the walls of a box", around(&corners), p(-1.0, -1.0), [corners.repeat(200), back]));
    let slides = corners[..2].repeat(2 * LAPS);
    cases.push(case("up and down along one wall", vec![[corners[0], corners[1]]], p(-1.0, -1.0), [slides]));
    cases
}

/// Walls, each kind with a name and an anchor.
fn plans() -> Vec<(&'static str, Vec<[DVec2; 2]>, DVec2)> {
    let comb = (0..8).flat_map(|k| {
        let foot = p(f64::from(k), 0.0);
        [[foot, foot + p(1.0, 0.0)], [foot, foot + p(0.25, 2.0)]]
    });
    // Inwards, each turn a unit closer.
    let spiral: Vec<DVec2> = (0..24).map(|k| f64::from(24 - k) / 4.0 * on_circle(f64::from(k) / 7.0)).collect();
    let star = (0..7).map(|k| [p(0.0, 0.0), 2.0 * on_circle(f64::from(k) / 7.0)]).collect();
    let pillar: Vec<DVec2> = (0..12).map(|k| on_circle(f64::from(k) / 12.0)).collect();
    vec![
        ("one wall", vec![[p(0.0, 0.0), p(2.0, 1.0)]], p(0.5, -1.0)),
        ("a comb", comb.collect(), p(3.5, -1.0)),
        ("a spiral", along(&spiral), p(0.01, 0.02)),
        ("a star", star, p(1.0, 0.7)),
        ("a pillar of 12 corners", around(&pillar), p(-1.5, 0.1)),
        ("a box, from inside", around(&[p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0)]), p(0.5, 0.25)),
        ("60 walls on a lattice", walls_of(&lattice_walls(60, 4)), p(0.5, 0.5)),
    ]
}

fn wandering(name: &str, walls: Vec<[DVec2; 2]>, anchor: DVec2) -> Extreme {
    let model = model(&walls, anchor);
    let traces: Vec<_> = (0..5).map(|id| wander(&model, &walls, 200, Draws::new(8, id))).collect();
    case(name, walls, anchor, traces)
}

/// From wall end to wall end, mostly along walls, with stays, and now and then somewhere else.
pub(super) fn wander(model: &Model, walls: &[[DVec2; 2]], stops: usize, mut draws: Draws) -> Vec<DVec2> {
    let (low, high) = model.bounds();
    way(model, stops, |here| {
        let [wall, end] = [walls.len(), 2].map(|count| draws.whole(0, count as i64 - 1) as usize);
        let from_here: Vec<DVec2> =
            walls.iter().filter(|ends| ends.contains(&here)).map(|&[u, v]| if u == here { v } else { u }).collect();
        match draws.whole(0, 9) {
            0 => here,
            1 => here + (high - low) * draws.point(0.3),
            // Through an end, as far again.
            2 => 2.0 * walls[wall][end] - here,
            3..=5 => walls[wall][end],
            _ if from_here.is_empty() => walls[wall][end],
            _ => from_here[wall % from_here.len()],
        }
    })
}
