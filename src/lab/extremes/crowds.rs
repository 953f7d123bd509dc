//! Few walls and many, on each other and through one point, and next to nothing.

use glam::DVec2;

use super::extreme::Extreme;
use super::tools::{case, model, on_circle, p, walls_of, way};
use super::touching::wander;
use crate::example::Draws;
use crate::example::{Walker, random_walls, walks};

/// Random walls, from one to 100,000, which have 200,000 ends.
pub(super) fn sizes() -> Vec<Extreme> {
    let sizes = [(1, 6, 300), (2, 6, 300), (3, 6, 300), (10, 6, 300), (100, 6, 300), (1000, 6, 300), (10_000, 4, 200)];
    let sizes = sizes.into_iter().chain([(100_000, 2, 100)]);
    let walked = |(walls, traces, steps): (usize, u64, usize)| {
        let scene = random_walls(walls, 7);
        let ends = walls_of(&scene);
        let model = model(&ends, DVec2::ZERO);
        let step = 0.6 / (walls as f64).sqrt();
        let mut case = case(format!("{walls} walls"), ends, DVec2::ZERO, []);
        case.traces = walks(&model, Walker { step, steps, seed: 13 }, traces);
        case
    };
    sizes.map(walked).collect()
}

/// The same wall many times, walls of no length, walls on each other, and many through one point.
pub(super) fn piles() -> Vec<Extreme> {
    let count = |n: i32| (0..n).map(f64::from);
    let spoke = |n: i32, k: f64| (1.0 + k % 5.0) * on_circle(k / f64::from(n));
    let nested = |n: i32| count(n).map(|k| [p(-1.0 - k / 1024.0, 0.5), p(1.0 + k / 1024.0, 0.5)]).collect::<Vec<_>>();
    let scenes: Vec<(&str, Vec<[DVec2; 2]>)> = vec![
        ("3,000 times the same two walls", [[p(1.0, 0.0), p(1.0, 2.0)], [p(1.0, 2.0), p(-2.0, 1.0)]].repeat(3000)),
        ("1,000 walls of no length beside three", {
            let points = count(1000).map(|k| [on_circle(k / 1000.0); 2]);
            points
                .chain([[p(1.0, 0.0), p(1.0, 2.0)], [p(-1.0, 1.0), p(-1.0, -1.0)], [p(0.5, -1.0), p(0.5, -2.0)]])
                .collect()
        }),
        ("200 walls on one line, each in the next", nested(200)),
        ("1,000 walls on one line, like scales", {
            count(1000).map(|k| [p(k / 256.0 - 2.0, 0.5), p(k / 256.0 - 1.75, 0.5)]).collect()
        }),
        ("3,000 walls from one point", count(3000).map(|k| [p(0.0, 3.0), p(0.0, 3.0) + spoke(3000, k)]).collect()),
        ("1,000 walls through one point", {
            count(1000).map(|k| [p(0.0, 3.0) + spoke(2000, k), p(0.0, 3.0) - spoke(2000, k)]).collect()
        }),
        ("1,000 walls through one lattice point", {
            let at = p(0.0, 300.0);
            let ways = count(1000).map(|k| p((k / 32.0).floor() + 1.0, 2.0 * (k % 32.0) - 31.0));
            ways.map(|way| [at + way, at - way]).collect()
        }),
        ("a grid of 40 by 40 walls that cross", {
            let bars = count(40).flat_map(|k| [[p(k, 1.0), p(k, 41.0)], [p(-1.0, k + 1.5), p(40.0, k + 1.5)]]);
            bars.collect()
        }),
        ("walls that end in the middle of others", {
            let tees = count(200).flat_map(|k| [[p(k, 1.0), p(k + 0.5, 1.0)], [p(k + 0.25, 1.0), p(k + 0.25, 3.0)]]);
            tees.collect()
        }),
    ];
    // Across their line a step wraps the rope round 3,000 ends, each of which costs a look at all; along it, it touches
    // as many, and at each up to 1,500 walls are looked at: none is made here.
    let most = pile("1,500 walls on one line, each in the next", nested(1500), 0);
    scenes.into_iter().map(|(name, walls)| pile(name, walls, 3)).chain([most]).collect()
}

/// Traces among `walls` and a small one, `touching` of which go from end to end.
fn pile(name: &str, mut walls: Vec<[DVec2; 2]>, touching: u64) -> Extreme {
    walls.push([p(-0.5, -2.0), p(-0.25, -1.5)]);
    let model = model(&walls, DVec2::ZERO);
    let mut traces: Vec<_> = (0..touching).map(|id| wander(&model, &walls, 30, Draws::new(17, id))).collect();
    let (low, high) = model.bounds();
    let size = (high - low).max_element();
    let mut draws = Draws::new(18, 0);
    traces.push(way(&model, 100, |_| (low + high) / 2.0 + draws.point(size)));
    case(name, walls, DVec2::ZERO, traces)
}

/// No walls or hardly any, all on one line, and traces that hardly are ones.
pub(super) fn degenerate() -> Vec<Extreme> {
    let anchor = p(0.25, 0.5);
    let hardly =
        || [vec![anchor], vec![anchor; 300], vec![p(0.5, 0.125)], vec![p(0.5, 0.125); 3], vec![p(0.5, 0.125), anchor]];
    let on_line = |y: f64| (0..10).map(|k| [p(f64::from(2 * k), y), p(f64::from(2 * k + 1), y)]).collect::<Vec<_>>();
    let wall = [p(0.0, 0.0), p(1.0, 0.0)];
    let mut cases = vec![
        case("no walls", vec![], anchor, hardly()),
        case("a wall of no length", vec![[p(1.0, 1.0); 2]], anchor, hardly()),
        case("a wall of no length under the anchor", vec![[anchor; 2]], anchor, hardly()),
        case("one wall", vec![wall], anchor, hardly()),
        case("no traces", vec![wall], anchor, []),
        case("no walls and no traces", vec![], anchor, []),
        case("always on a wall's end", vec![wall], wall[0], [vec![wall[0]; 300], vec![wall[1]; 300], vec![wall[1]]]),
    ];
    let ends: [(&str, DVec2, f64); 3] =
        [("beside it", anchor, 0.0), ("on it", p(-1.0, 0.0), 0.0), ("between two of them", p(1.5, 0.0), 0.0)];
    for (name, anchor, y) in ends {
        let walls = on_line(y);
        let model = model(&walls, anchor);
        let along = |k: i64| p(k as f64 / 2.0, y);
        let traces: Vec<_> = (0..3)
            .map(|id| {
                let mut draws = Draws::new(19, id);
                way(&model, 200, |here| match draws.whole(0, 3) {
                    0 => here + draws.point(3.0),
                    // On the line: at ends, in gaps, and straight through all gaps and walls' ends.
                    1 | 2 => along(draws.whole(-2, 40)),
                    _ => p(here.x, -here.y),
                })
            })
            .collect();
        cases.push(case(format!("all walls on one line, the anchor {name}"), walls, anchor, traces));
    }
    cases
}
