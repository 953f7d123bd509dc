//! Anchors at walls' ends.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{around, case, model, on_circle, p, walls_of};
use super::touching::wander;
use crate::example::Draws;
use crate::example::{lattice_walls, random_walls};

/// Each trace starts on the anchor, stays there, wanders about, and comes back now and then.
pub(super) fn anchors() -> Vec<Extreme> {
    let square = around(&[p(0.0, 0.0), p(2.0, 0.0), p(2.0, 2.0), p(0.0, 2.0)]);
    let hub = (0..400).map(|k| [p(0.0, 0.0), f64::from(1 + k % 3) * on_circle(f64::from(k) / 400.0)]);
    let (random, lattice) = (walls_of(&random_walls(30, 5)), walls_of(&lattice_walls(40, 6)));
    let end_of = |walls: &[[DVec2; 2]]| walls[0][0];
    let plans = [
        ("a lone wall's end", vec![[p(0.0, 0.0), p(1.0, 0.5)]], p(0.0, 0.0)),
        ("a box's corner", square.clone(), p(2.0, 2.0)),
        ("a corner where two boxes meet", [square.clone(), moved(&square, p(2.0, 2.0))].concat(), p(2.0, 2.0)),
        ("where 400 walls meet", hub.collect(), p(0.0, 0.0)),
        ("the end of one of 30 walls", random.clone(), end_of(&random)),
        ("the end of one of 40 walls on a lattice", lattice.clone(), end_of(&lattice)),
    ];
    plans.map(|(name, walls, anchor)| tied(name, walls, anchor)).into()
}

fn moved(walls: &[[DVec2; 2]], by: DVec2) -> Vec<[DVec2; 2]> {
    walls.iter().map(|ends| ends.map(|end| end + by)).collect()
}

fn tied(name: &str, walls: Vec<[DVec2; 2]>, anchor: DVec2) -> Extreme {
    let model = model(&walls, anchor);
    let mut traces: Vec<_> = (0..4).map(|id| wander(&model, &walls, 150, Draws::new(21, id))).collect();
    traces.push(vec![anchor; 50]);
    // There and back, which is always allowed.
    let retraced: Vec<DVec2> = traces[0].iter().chain(traces[0].iter().rev()).copied().chain([anchor]).collect();
    traces.push(retraced);
    case(name, walls, anchor, traces)
}
