//! Lattices, where every sign is zero again and again, and points on rays.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{case, model, p, way};
use crate::example::Draws;

/// Walls and trace points on the same lattice.
pub(super) fn lattices() -> Vec<Extreme> {
    let mut cases = Vec::new();
    for seed in 0..3 {
        cases.push(lattice(12, 4, seed, false));
        cases.push(lattice(40, 8, seed, true));
        cases.push(lattice(150, 16, seed, false));
        cases.push(lattice(150, 16, seed, true));
    }
    cases
}

/// `walls` walls between whole numbers up to `half` in magnitude, short ones along x or y or, if `slanted`, in any
/// direction; and traces on whole numbers, the anchor among them.
pub(super) fn lattice(walls: usize, half: i64, seed: u64, slanted: bool) -> Extreme {
    let mut draws = Draws::new(seed, Draws::SCENE);
    let anchor = p(1.0, 1.0);
    let draw = |draws: &mut Draws, low, high| p(draws.whole(low, high) as f64, draws.whole(low, high) as f64);
    let ends: Vec<[DVec2; 2]> = (0..walls)
        .map(|_| {
            loop {
                let (from, mut by) = (draw(&mut draws, -half, half), draw(&mut draws, -3, 3));
                if !slanted {
                    by = if draws.unit() < 0.5 { p(by.x, 0.0) } else { p(0.0, by.y) };
                }
                // Walls that only end at the anchor are good.
                let through = (anchor - from).perp_dot(by) == 0.0
                    && (0.0..by.length_squared()).contains(&(anchor - from).dot(by));
                if (from + by).abs().max_element() <= half as f64 && (!through || from == anchor) {
                    break [from, from + by];
                }
            }
        })
        .collect();
    let model = model(&ends, anchor);
    let traces: Vec<_> = (0..4)
        .map(|id| {
            let (mut draws, reach) = (Draws::new(seed, id), [1, 3, half / 2, half][id as usize]);
            way(&model, 150, |here| {
                let next = here + draw(&mut draws, -reach, reach);
                if next.abs().max_element() <= half as f64 { next } else { here }
            })
        })
        .collect();
    let kind = if slanted { "slanted " } else { "" };
    case(format!("{walls} {kind}walls on a lattice, seed {seed}"), ends, anchor, traces)
}

/// Points on rays, and to and fro over them.
pub(super) fn rays() -> Vec<Extreme> {
    let mut cases = vec![on_all_rays(6), on_all_rays(20)];
    // A million times, and so often that a device is done soon which answers one event of a trace a round.
    for (times, name) in [(150, "300"), (500_000, "a million")] {
        let walls = |count: i32| (1..=count).map(|k| [p(f64::from(k), 0.0), p(f64::from(k), 1.0)]).collect::<Vec<_>>();
        let to_and_fro = |a: [f64; 2], b: [f64; 2]| [a, b].map(DVec2::from).repeat(times);
        let anchor = p(0.0, 0.0);
        let traces = [to_and_fro([2.0, -1.0], [2.0, 1.0]), to_and_fro([2.0, -1.0], [2.0, 0.0])];
        cases.push(case(format!("{name} steps over a ray, onto it and off it"), walls(1), anchor, traces));
        let traces = [to_and_fro([4.0, -1.0], [4.0, 0.0])];
        cases.push(case(format!("{name} steps over three rays on one line"), walls(3), anchor, traces));
        // 1 unit in the last place to either side of a ray whose direction no f64 holds.
        let (tip, far) = (p(0.1, 0.3), p(0.7, 2.1));
        let beside = |ulps: f64| far + p(0.0, ulps * 2f64.powi(-51));
        let walls = vec![[tip, p(-0.2, 0.4)]];
        let traces = [[beside(-1.0), beside(1.0)].repeat(times)];
        cases.push(case(format!("{name} steps of two units in the last place over a ray"), walls, anchor, traces));
    }
    cases
}

/// Small walls round the anchor, and traces over points that lie exactly on the anchor's rays of their ends, and on the
/// rays from one end over another.
fn on_all_rays(walls: usize) -> Extreme {
    let Extreme { walls, anchor, .. } = lattice(walls, 6, 11, true);
    let model = model(&walls, anchor);
    let vertices = model.vertices().to_vec();
    let traces: Vec<_> = (0..4)
        .map(|id| {
            let mut draws = Draws::new(12, id);
            way(&model, 250, |_| {
                let mut pick = || vertices[draws.whole(0, vertices.len() as i64 - 1) as usize];
                let (from, over) = if id % 2 == 0 { (anchor, pick()) } else { (pick(), pick()) };
                over + (over - from) * draws.whole(0, 3) as f64
            })
        })
        .collect();
    case(format!("points on rays among {} walls", walls.len()), walls, anchor, traces)
}
