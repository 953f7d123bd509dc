//! Studies against answers that are known otherwise.

use std::convert::Infallible;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::Mutex;

use glam::DVec2;
use tautline::engine::{Cpu, Engine, Job, Reference};
use tautline::example::{Walker, random_walls, walks};
use tautline::geometry::{opposite, orient};
use tautline::scene::Model;
use tautline::study::{Estimate, Plan, Shard, State, Study, Summary, run};
use tautline::trace::{Trace, settle};

/// The answer of a study, and the folder with its scene.
fn answer(plan: &str, folder: &std::path::Path) -> Summary {
    let study = Study::open(Plan::parse(plan).unwrap(), folder).unwrap();
    let mut engines: Vec<Box<dyn Engine>> = study.models().iter().map(|m| Box::new(Cpu::new(m.clone())) as _).collect();
    let state = Mutex::new(State::new(&study, Shard::WHOLE));
    run(&study, &mut engines, &state, &Job::new(), |_, _, _| Ok::<(), Infallible>(())).unwrap();
    state.into_inner().unwrap().summary(&study)
}

fn mean(summary: &Summary, name: &str) -> Estimate {
    summary.scalars.iter().find(|s| s.name == name).unwrap().mean
}

/// The wall that is integrated about, and its end points' coordinates.
const WALL: [DVec2; 2] = [DVec2::new(0.5, -1.0), DVec2::new(0.5, 0.3)];

fn meets_wall(a: DVec2, b: DVec2) -> bool {
    let [u, v] = WALL;
    opposite(orient(a, b, u), orient(a, b, v)) && opposite(orient(u, v, a), orient(u, v, b))
}

fn holds(triangle: [DVec2; 3], p: DVec2) -> bool {
    let [a, b, c] = triangle;
    let signs = [orient(a, b, p), orient(b, c, p), orient(c, a, p)];
    signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0)
}

/// The rope that was dragged from the origin to `a` and on to `b`: its length, and at how many wall ends it turns.
fn rope(a: DVec2, b: DVec2) -> (f64, u32) {
    let o = DVec2::ZERO;
    let inside: Vec<DVec2> = WALL.into_iter().filter(|&w| holds([o, a, b], w)).collect();
    let through = |points: &[DVec2]| points.windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
    match *inside.as_slice() {
        [] => (b.length(), 0),
        [p] => (through(&[o, p, b]), 1),
        // The hull of what lies inside: one of them, or both in the order that is shorter.
        [p, q] if holds([o, q, b], p) => (through(&[o, q, b]), 1),
        [p, q] if holds([o, p, b], q) => (through(&[o, p, b]), 1),
        [p, q] => (through(&[o, p, q, b]).min(through(&[o, q, p, b])), 2),
        _ => unreachable!("there are two wall ends"),
    }
}

#[test]
fn two_gaussian_steps_past_a_wall_are_as_integrated() {
    const SIGMA: f64 = 0.6;
    // The middles of equal parts of four standard deviations to either side, and their weights.
    const PARTS: usize = 64;
    let middles = (0..PARTS).map(|i| 8.0 * (i as f64 + 0.5) / PARTS as f64 - 4.0);
    let steps: Vec<(f64, f64)> = middles.map(|z| (SIGMA * z, (-0.5 * z * z).exp())).collect();
    let grid: Vec<(DVec2, f64)> =
        steps.iter().flat_map(|&(x, v)| steps.iter().map(move |&(y, w)| (DVec2::new(x, y), v * w))).collect();
    let (mut length, mut wrapped, mut count) = (0.0, 0.0, 0.0);
    for &(first, v) in &grid {
        let a = if meets_wall(DVec2::ZERO, first) { DVec2::ZERO } else { first };
        for &(second, w) in &grid {
            let b = if meets_wall(a, a + second) { a } else { a + second };
            let (long, depth) = rope(a, b);
            length += v * w * long;
            wrapped += v * w * f64::from(depth);
            count += v * w;
        }
    }
    let (length, depth) = (length / count, wrapped / count);

    let folder = tempfile::tempdir().unwrap();
    // Four far specks make room.
    let far = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(DVec2::from);
    let specks = far.map(|p| [p, p + DVec2::new(0.01, 0.0)]);
    let lines: Vec<String> =
        [WALL].iter().chain(&specks).map(|w| format!("[[{},{}],[{},{}]]", w[0].x, w[0].y, w[1].x, w[1].y)).collect();
    let scene = format!(r#"{{"type":"MultiLineString","coordinates":[{}]}}"#, lines.join(","));
    std::fs::write(folder.path().join("wall.geojson"), scene).unwrap();
    let plan = format!(
        "[scene]\nfile = \"wall.geojson\"\nanchor = [0.0, 0.0]\n[walk]\nkind = \"gaussian\"\nstep = {SIGMA}\nsteps = 2\n\
         at_walls = \"reject\"\n[run]\ntraces = 1_000_000\nblock = 10_000\n"
    );
    let summary = answer(&plan, folder.path());
    // Ropes turn and steps are rejected at sharp borders, which cut through the parts: with half as many the integrals
    // differs by 0.0008.
    for (name, truth) in [("length", length), ("depth", depth)] {
        let found = mean(&summary, name);
        let error = found.error.unwrap();
        assert!(error < 0.001, "{name}: {error}");
        assert!((found.value - truth).abs() < 5.0 * error + 0.002, "{name}: {found:?}, integrated {truth}");
    }
    assert!(depth > 0.02, "the wall matters: {depth}");
}

/// The length of the shortest path among the walls, by Dijkstra's algorithm over all pairs that see each other; and the
/// path.
pub(crate) fn shortest(model: &Model, goal: DVec2) -> (f64, Vec<DVec2>) {
    let mut points = model.vertices().to_vec();
    points.extend([model.anchor(), goal]);
    let blocked = |a: DVec2, b: DVec2| {
        (0..model.scene().walls().len()).any(|wall| {
            let [u, v] = model.scene().ends(wall);
            opposite(orient(a, b, u), orient(a, b, v)) && opposite(orient(u, v, a), orient(u, v, b))
        })
    };
    let n = points.len();
    let (mut best, mut from, mut done) = (vec![f64::INFINITY; n], vec![n - 2; n], vec![false; n]);
    best[n - 2] = 0.0;
    while let Some(i) = (0..n).filter(|&i| !done[i] && best[i].is_finite()).min_by(|&i, &j| best[i].total_cmp(&best[j]))
    {
        done[i] = true;
        for j in 0..n {
            let length = best[i] + points[i].distance(points[j]);
            if !done[j] && length < best[j] && !blocked(points[i], points[j]) {
                (best[j], from[j]) = (length, i);
            }
        }
    }
    let mut path = vec![goal];
    let mut at = n - 1;
    while at != n - 2 {
        at = from[at];
        path.push(points[at]);
    }
    path.reverse();
    (best[n - 1], path)
}

#[test]
fn ropes_are_never_shorter_than_the_shortest_path_and_as_long_along_it() {
    let (mut longer, mut bent) = (0, 0);
    for seed in 0..12 {
        let model = Arc::new(Model::new(random_walls(25, seed), None).unwrap());
        for trace in walks(&model, Walker { step: 0.05, steps: 120, seed }, 8) {
            let end = *trace.points.last().unwrap();
            let (length, path) = shortest(&model, end);
            let rope_of = |trace: &Trace| {
                let settled = settle(&model, trace);
                assert!(settled.violation().is_none());
                Reference::new(model.clone()).evaluate(&[settled], &Job::new()).unwrap().remove(0)
            };
            let walked = rope_of(&trace);
            assert!(walked.length >= length * (1.0 - 1e-12), "{} < {length}", walked.length);
            longer += usize::from(walked.length > length * (1.0 + 1e-9));
            bent += usize::from(path.len() > 2);
            let dragged = rope_of(&Trace { id: 0, points: path });
            assert!((dragged.length - length).abs() <= 1e-12 * length, "{} along a path of {length}", dragged.length);
        }
    }
    assert!(longer > 5 && bent > 30, "{longer} ropes were longer, {bent} paths bent");
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let plan = |traces: u32, block: u32, seed: u32| {
        format!(
            "[scene]\nbuilt_in = \"random-40\"\n[walk]\nkind = \"uniform\"\nstep = 0.12\nsteps = 40\n[run]\n\
             traces = {traces}\nblock = {block}\nseed = {seed}\n[tallies]\nconfidence = 0.9\nlimits = [0.8]\nmap = 4\nmap_every = 1\n"
        )
    };
    let here = std::path::Path::new(".");
    // Of each quantity an estimate; cells and contacts are ratios whose errors come from blocks.
    let quantities = |s: &Summary, touched: u32| -> Vec<(String, Estimate)> {
        let mut all: Vec<_> = s.scalars.iter().map(|q| (q.name.clone(), q.mean)).collect();
        all.push(("survival".into(), s.survival[0].curve.last().unwrap().share));
        all.push(("median".into(), s.scalars[1].quantiles[4].value));
        let map = s.map.as_ref().unwrap();
        let middle = |number| map.cells.iter().find(|c| c.cell == number).unwrap();
        all.push(("cell 5".into(), middle(5).length.unwrap()));
        all.push(("cell 10".into(), middle(10).length.unwrap()));
        all.push(("contact".into(), s.contacts.iter().find(|c| c.vertex == touched).unwrap().share));
        all
    };
    let truth = answer(&plan(400_000, 4000, 99), here);
    let touched = truth.contacts[0].vertex;
    let truth = quantities(&truth, touched);
    const STUDIES: u32 = 400;
    let mut held = vec![0u32; truth.len()];
    for seed in 1000..1000 + STUDIES {
        let found = quantities(&answer(&plan(600, 20, seed), here), touched);
        for ((held, (_, found)), (_, truth)) in held.iter_mut().zip(&found).zip(&truth) {
            *held += u32::from(found.low.unwrap() <= truth.value && truth.value <= found.high.unwrap());
        }
    }
    for (held, (name, _)) in held.iter().zip(&truth) {
        let share = f64::from(*held) / f64::from(STUDIES);
        // Four standard deviations of what 400 studies can show: 0.06. Quantiles come in steps of the sketch, which
        // only makes their intervals wider.
        let most = if name == "median" { 1.0 } else { 0.96 };
        assert!((0.84..=most).contains(&share), "{name}: {share} of the intervals of 0.9 hold the truth");
    }
}

/// By how much the angle about a small obstacle spreads, of which that share is at least a whole turn either way.
///
/// The angle of a walk about what it cannot enter has in the limit the density `sech(pi x / 2 s) / 2 s`, where s is
/// half the logarithm of the number of steps and a constant that depends on the obstacle (Bélisle, "Windings of random
/// walks", Ann. Probab. 17, 1989; Rudnick and Hu, "The winding angle distribution of an ordinary random walk", J. Phys.
/// A 20, 1987). So a share of `4 / pi * atan(exp(-pi x / 2 s))` is at x or beyond, and x is a whole turn here.
fn spread_of_angle(share: f64) -> f64 {
    -PI * PI / (PI * share / 4.0).tan().ln()
}

#[test]
fn winding_about_a_small_obstacle_follows_its_law() {
    let folder = tempfile::tempdir().unwrap();
    // So much room about it that no walk comes to its end.
    let far = [[-2000.0, -2000.0], [2000.0, 2000.0]].map(DVec2::from);
    let walls: Vec<String> = far
        .iter()
        .chain(&[DVec2::ZERO])
        .map(|p| format!("[[{},{}],[{},{}]]", p.x - 0.5, p.y, p.x + 0.5, p.y))
        .collect();
    let scene = format!(r#"{{"type":"MultiLineString","coordinates":[{}]}}"#, walls.join(","));
    std::fs::write(folder.path().join("speck.geojson"), scene).unwrap();
    let spread = |steps: u32, traces: u32| {
        let plan = format!(
            "[scene]\nfile = \"speck.geojson\"\nanchor = [0.0, 1.0]\n[walk]\nkind = \"gaussian\"\nstep = 1.0\n\
             steps = {steps}\n[run]\ntraces = {traces}\nblock = 500\n[tallies]\nmap_every = 1000\n"
        );
        let summary = answer(&plan, folder.path());
        let obstacle = summary.obstacles.iter().find(|o| o.at[1] == 0.0).unwrap();
        let share = obstacle.wound.value;
        let error = (share * (1.0 - share) / f64::from(traces)).sqrt();
        let found = spread_of_angle(share);
        (found, spread_of_angle(share + error) - found)
    };
    // The constant falls out of the difference.
    let (few, few_error) = spread(400, 100_000);
    let (many, many_error) = spread(40_000, 10_000);
    let (grown, error) = (many - few, few_error.hypot(many_error));
    assert!((grown - 0.5 * 100.0f64.ln()).abs() < 4.0 * error + 0.05, "{few} to {many}: {grown} +- {error}");
}
