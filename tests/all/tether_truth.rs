//! Walks on a tether against answers that are known otherwise.

use std::convert::Infallible;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Mutex;

use glam::DVec2;
use tautline::engine::{Cpu, Engine, Job};
use tautline::rope::TraceRecord;
use tautline::study::{Plan, Shard, State, Study, Summary, TetherAnswer, run};

use crate::study_truth::shortest;

/// A study of the walls of this file, with its records and its answer.
fn answer(walls: &str, plan: &str) -> (Study, Vec<TraceRecord>, Summary) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.wkt"), walls).unwrap();
    answer_in(folder.path(), &format!("[scene]\nfile = \"s.wkt\"\n{plan}"))
}

fn answer_in(folder: &Path, plan: &str) -> (Study, Vec<TraceRecord>, Summary) {
    let study = Study::open(Plan::parse(plan).unwrap(), folder).unwrap();
    let mut engines: Vec<Box<dyn Engine>> = study.models().iter().map(|m| Box::new(Cpu::new(m.clone())) as _).collect();
    let state = Mutex::new(State::new(&study, Shard::WHOLE));
    let mut all = Vec::new();
    let keep = |_: &mut State, records: Vec<TraceRecord>, added: usize| {
        all.extend(records.into_iter().take(added));
        Ok::<(), Infallible>(())
    };
    run(&study, &mut engines, &state, &Job::new(), keep).unwrap();
    let summary = state.into_inner().unwrap().summary(&study);
    (study, all, summary)
}

/// A square far away.
const SQUARE: &str = "LINESTRING (-20 -20, 20 -20, 20 20, -20 20, -20 -20)\n";

/// How long the tether in the open is, and the steps there.
const LENGTH: f64 = 2.0;
const STEP: f64 = 0.7;

/// Walks in the open that start anywhere in the disc about the anchor that the tether lets them reach.
fn in_the_disc(at_tether: &str, traces: u32, steps: u32) -> (TetherAnswer, Summary) {
    let plan = format!(
        "[walk]\nkind = \"uniform\"\nstep = {STEP}\nsteps = {steps}\nstart = \"visible\"\ntether = {LENGTH}\n\
         at_tether = \"{at_tether}\"\n[run]\ntraces = {traces}\nblock = 100\n[tallies]\nmap = 320\nmap_every = 1\n"
    );
    let (_, records, summary) = answer(&format!("{SQUARE}POINT (0 0)\n"), &plan);
    assert!(records.iter().all(|record| record.max_length <= LENGTH && record.depth == 0));
    (summary.tether.clone().unwrap(), summary)
}

/// Of the steps of that length from a point so far from the middle, the share that ends in the disc.
fn share_inside(r: f64) -> f64 {
    // The angle off the way outwards at which the step's end is on the circle.
    let cos = (LENGTH * LENGTH - r * r - STEP * STEP) / (2.0 * r * STEP);
    1.0 - cos.clamp(-1.0, 1.0).acos() / PI
}

/// The mean over the disc of what is a function of the distance from the middle.
fn over_disc(of: impl Fn(f64) -> f64) -> f64 {
    let parts = 100_000;
    let middles = (0..parts).map(|i| LENGTH * (f64::from(i) + 0.5) / f64::from(parts));
    middles.map(|r| of(r) * 2.0 * r / (LENGTH * LENGTH)).sum::<f64>() * LENGTH / f64::from(parts)
}

/// A walk that stays where it is instead of leaving goes there and back alike, so it is anywhere alike, from its start
/// on. It is held back as often as a circle of steps lies out of the disc: what two discs so far apart do not share.
#[test]
fn a_walk_that_stays_is_uniform_over_the_disc() {
    let (tether, summary) = in_the_disc("stay", 4000, 150);
    let both = 2.0 * LENGTH * LENGTH * (STEP / (2.0 * LENGTH)).acos()
        - STEP / 2.0 * (4.0 * LENGTH * LENGTH - STEP * STEP).sqrt();
    let truth = 1.0 - both / (PI * LENGTH * LENGTH);
    assert!((over_disc(|r| 1.0 - share_inside(r)) - truth).abs() < 1e-6, "two ways to the same number");
    let found = tether.held_back;
    let error = found.error.unwrap();
    assert!(error < 0.001 && (found.value - truth).abs() < 4.5 * error, "{found:?} and {truth}");
    assert_eq!(summary.still, Some(found.value), "it stands still whenever it is held back, and only then");
    let mean = summary.scalars.iter().find(|s| s.name == "length").unwrap().mean;
    assert!((mean.value - 2.0 / 3.0 * LENGTH).abs() < 4.5 * mean.error.unwrap(), "{mean:?}");
    // Cells an eighth wide: those in which it was hold the disc, those about which it was as well lie in it.
    let visited = summary.map.unwrap().visited.unwrap();
    let disc = PI * LENGTH * LENGTH;
    assert!(visited.inner < disc && disc < visited.area, "{visited:?}");
    assert!(visited.area - visited.inner < 0.5 * disc, "{visited:?}");
}

/// How often a circle of steps lies out of the disc is what the share of steps held back is about.
#[test]
fn intervals_hold_the_share_held_back_as_often_as_they_say() {
    let truth = over_disc(|r| 1.0 - share_inside(r));
    let studies = 300;
    let held = (0..studies).filter(|seed| {
        let plan = format!(
            "[walk]\nkind = \"uniform\"\nstep = {STEP}\nsteps = 40\nstart = \"visible\"\ntether = {LENGTH}\n\
             [run]\ntraces = 40\nblock = 40\nseed = {seed}\n[tallies]\nconfidence = 0.9\nmap = 0\n"
        );
        let share = answer(&format!("{SQUARE}POINT (0 0)\n"), &plan).2.tether.unwrap().held_back;
        share.low.unwrap() <= truth && truth <= share.high.unwrap()
    });
    // Four standard deviations of such a count.
    let held = held.count() as f64;
    assert!((held - 270.0).abs() < 4.0 * 27f64.sqrt(), "{held} of {studies}");
}

/// A walk that draws again goes from p to q as often as from q to p where p has as much more time as it has fewer
/// places to go.
#[test]
fn a_walk_that_turns_is_held_back_as_often_as_its_law_says() {
    let (tether, summary) = in_the_disc("turn", 400, 2000);
    let truth = over_disc(|r| share_inside(r) * (1.0 - share_inside(r))) / over_disc(share_inside);
    let found = tether.held_back;
    let error = found.error.unwrap();
    assert!(error < 0.001 && (found.value - truth).abs() < 4.5 * error, "{found:?} and {truth}");
    assert_eq!(summary.still, Some(0.0));
}

/// What a walk in the open does that slides: it goes to the nearest point of the disc.
#[test]
fn a_walk_that_slides_is_held_back_as_often_as_one_that_is_projected() {
    let (tether, summary) = in_the_disc("slide", 400, 2000);
    let mut seed = 7_u64;
    let mut at = DVec2::ZERO;
    let steps = 2_000_000;
    let held = (0..steps).filter(|_| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        at += STEP * DVec2::from_angle(2.0 * PI * (seed >> 11) as f64 / (1_u64 << 53) as f64);
        let is_held = at.length() > LENGTH;
        at = at.clamp_length_max(LENGTH);
        is_held
    });
    let truth = held.count() as f64 / f64::from(steps);
    let found = tether.held_back;
    assert!((found.value - truth).abs() < 4.5 * found.error.unwrap() + 0.002, "{found:?} and {truth}");
    assert_eq!(summary.still, Some(0.0));
    let most = summary.scalars.iter().find(|s| s.name == "max_length").unwrap();
    assert!(most.min > LENGTH * (1.0 - 1e-15) && most.max <= LENGTH, "{most:?}");
}

/// A wall from (1, 0) down, beyond what the tether of 3 lets the free end reach. Before it that is the disc about the
/// anchor, but for its part behind the wall; and behind the wall a quarter of the disc of radius 2 about the wall's end.
/// A walk that stays instead of leaving, or of touching the wall, is in the end anywhere alike.
#[test]
fn behind_a_wall_the_border_is_an_arc_about_its_end() {
    let walls = format!("{SQUARE}LINESTRING (1 0, 1 -20)\nPOINT (0 0)\n");
    let plan = |at_tether: &str, traces: u32| {
        format!(
            "[walk]\nkind = \"uniform\"\nstep = 0.6\nsteps = 2000\nat_walls = \"reject\"\ntether = 3\n\
             at_tether = \"{at_tether}\"\n[run]\ntraces = {traces}\nblock = 25\n[tallies]\nmap = 640\nmap_every = 1\n"
        )
    };
    let (study, records, summary) = answer(&walls, &plan("stay", 1500));
    // Half of what a line at a distance of 1 cuts off the disc.
    let shadow = (9.0 * (1.0_f64 / 3.0).acos() - 8.0_f64.sqrt()) / 2.0;
    let (before, behind) = (9.0 * PI - shadow, PI);
    let truth = behind / (before + behind);
    let depth = summary.scalars.iter().find(|s| s.name == "depth").unwrap();
    assert!((depth.max, depth.min) == (1.0, 0.0) && records.iter().all(|record| record.max_length <= 3.0));
    let error = depth.mean.error.unwrap();
    assert!(error < 0.01 && (depth.mean.value - truth).abs() < 4.5 * error, "{:?} and {truth}", depth.mean);
    let visited = summary.map.unwrap().visited.unwrap();
    assert!(visited.inner < before + behind && before + behind < visited.area, "{visited:?}");
    assert!(visited.area - visited.inner < 0.3 * (before + behind), "{visited:?}");

    let end = DVec2::new(1.0, 0.0);
    let check = |study: &Study, traces: u64| {
        let mut nearest = [f64::INFINITY; 3];
        for p in (0..traces).flat_map(|number| study.trace(number).unwrap().ends().into_owned()) {
            let shortest = if p.x > 1.0 && p.y < 0.0 { 1.0 + p.distance(end) } else { p.length() };
            assert!(shortest <= 3.0 * (1.0 + 1e-15), "{p}");
            // The points furthest down behind the wall, and to the left and to the right.
            for (least, corner) in nearest.iter_mut().zip([[1.0, -2.0], [-3.0, 0.0], [3.0, 0.0]]) {
                *least = least.min(p.distance(corner.into()));
            }
        }
        assert!(nearest.iter().all(|&distance| distance < 0.1), "{nearest:?}");
    };
    check(&study, 1500);
    let (study, records, summary) = answer(&walls, &plan("slide", 200));
    check(&study, 200);
    // It is on the border of what is behind the wall too, where the rope turns.
    let at_end = |record: &&TraceRecord| record.depth == 1 && record.length > 3.0 * (1.0 - 1e-15);
    assert!(records.iter().filter(at_end).count() > 3 && records.iter().all(|record| record.max_length <= 3.0));
    assert_eq!(summary.tether.unwrap().never.value, 0.0);
}

/// No walk comes to a place that has no way to it as short as the tether; walks that slide come to the border of what
/// has.
#[test]
fn no_place_is_further_than_the_tether_by_the_shortest_way() {
    let mut reached = 0;
    for (walls, length) in [(8, 0.5), (20, 0.4), (40, 0.6)] {
        for at_tether in ["stay", "slide", "turn"] {
            let plan = format!(
                "[scene]\nbuilt_in = \"random-{walls}\"\n[walk]\nkind = \"persistent\"\nstep = 0.05\nsteps = 150\n\
                 tether = {length}\nat_tether = \"{at_tether}\"\n[run]\ntraces = 6\nblock = 3\n"
            );
            let (study, records, _) = answer_in(Path::new(""), &plan);
            assert!(records.iter().all(|record| record.max_length <= length));
            for number in 0..6 {
                for &p in study.trace(number).unwrap().ends().iter().step_by(3) {
                    let (shortest, _) = shortest(study.model(number), p);
                    assert!(shortest <= length * (1.0 + 1e-14), "{p}: {shortest}");
                    reached += usize::from(at_tether == "slide" && shortest > length * (1.0 - 1e-12));
                }
            }
        }
    }
    assert!(reached > 50, "{reached}");
}

/// Until it is held back first, a walk is the one without a tether: so those not held back yet are those whose rope was
/// never longer there, step by step and trace by trace.
#[test]
fn walks_are_held_back_first_when_ropes_without_a_tether_become_longer() {
    for kind in ["uniform", "gaussian", "persistent"] {
        for at_walls in ["redraw", "reject", "reflect"] {
            let study = |more: &str| {
                let plan = format!(
                    "[scene]\nbuilt_in = \"rooms\"\nanchor = {{ sample = 3 }}\n[walk]\nkind = \"{kind}\"\nstep = 0.7\n\
                     steps = 120\nat_walls = \"{at_walls}\"\n{more}[run]\ntraces = 330\nblock = 50\n[tallies]\nlimits = [6.5]\n"
                );
                answer_in(Path::new(""), &plan).2
            };
            let free = study("");
            assert!(free.tether.is_none() && free.map.unwrap().visited.is_none());
            let [survival] = &free.survival[..] else { unreachable!("there is one limit") };
            for at_tether in ["stay", "slide", "turn"] {
                let held = study(&format!("tether = 6.5\nat_tether = \"{at_tether}\"\n"));
                let tether = held.tether.unwrap();
                assert_eq!(tether.curve, survival.curve, "{kind} {at_walls} {at_tether}");
                let last = tether.curve.last().unwrap().share;
                assert!(tether.never == last && last.value > 0.0 && last.value < 1.0, "{last:?}");
                // By the second curve no rope was ever longer.
                assert!(held.survival[0].curve.iter().all(|point| point.share.value == 1.0));
                // The quantiles are where the curve comes down to them.
                for quantile in &tether.quantiles {
                    let step = quantile.value.value as u64;
                    let at =
                        |step: u64| tether.curve.iter().filter(|p| p.step <= step).map(|p| p.share.value).next_back();
                    assert!(at(step - 1).unwrap() > 1.0 - quantile.share - 1e-12, "{quantile:?}");
                    let behind = tether.curve.iter().find(|p| p.step >= step).unwrap();
                    assert!(behind.share.value <= 1.0 - quantile.share + 1e-12, "{quantile:?}");
                }
                assert_eq!(tether.quantiles.len(), free_quantiles(1.0 - last.value));
            }
        }
    }
}

/// How many of the usual quantiles are no greater than a share.
fn free_quantiles(share: f64) -> usize {
    [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99].iter().filter(|q| **q <= share + 1e-12).count()
}
