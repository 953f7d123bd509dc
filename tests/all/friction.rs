//! Friction, against the capstan equation, against integrals that are summed plainly, and against what must not change.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Cpu, Engine, Job, Reference};
use tautline::rope::{EndsSteps, Friction, RopeStep, Slip, Steps, Strain, TraceRecord, forces, moments, replay, turn};
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle, settle_ends};

use crate::scenes::{KINDS, on_lawful};

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn of(mu: f64) -> Friction {
    Friction::new(mu).unwrap()
}

fn record(model: &Arc<Model>, trace: &SettledTrace) -> TraceRecord {
    Reference::new(model.clone()).evaluate(std::slice::from_ref(trace), &Job::new()).unwrap().remove(0)
}

/// All steps with their strain.
fn told(model: &Model, trace: &SettledTrace, record: &TraceRecord, mu: f64) -> Vec<(RopeStep, Strain)> {
    let mut steps = Steps::new(model, trace, record, &[]).with_friction(Some(of(mu)));
    let mut all = vec![];
    while let Some(step) = steps.next() {
        all.push((step, steps.strain().unwrap()));
    }
    all
}

/// The corners of the taut ropes after each step.
fn corners(model: &Model, trace: &Trace, record: &TraceRecord) -> Vec<Vec<DVec2>> {
    let mut all = vec![];
    replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |k, rope| {
        let taut = rope.taut(trace.points[k]);
        let turns = taut.iter().map(|contact| contact.at);
        all.push([model.anchor()].into_iter().chain(turns).chain([trace.points[k]]).collect());
    });
    all
}

/// By which angle a way turns, from the headings of its legs as the standard library has them: the truth that is
/// computed otherwise.
fn turned(corners: &[DVec2]) -> f64 {
    let legs = corners.windows(2).map(|w| w[1] - w[0]).filter(|leg| *leg != DVec2::ZERO);
    let headings: Vec<f64> = legs.map(|leg| leg.y.atan2(leg.x)).collect();
    headings.windows(2).map(|w| (w[1] - w[0]).abs()).map(|angle| angle.min(TAU - angle)).sum()
}

/// A rope about the corners of a regular polygon, which turns by the same angle at each: `turns` corners of one of
/// `sides`, from far away on the tangent to far away.
fn spiral(sides: u32, turns: u32) -> (Vec<DVec2>, f64) {
    let corner = |i: f64| DVec2::from_angle(TAU * i / f64::from(sides));
    let points = (-1..=turns as i32).map(|i| corner(f64::from(i))).collect();
    (points, TAU / f64::from(sides) * f64::from(turns))
}

#[test]
fn tension_grows_as_the_capstan_equation_says() {
    for (sides, turns) in [(4, 3), (360, 90), (7, 700), (1000, 100_000)] {
        let (points, angle) = spiral(sides, turns);
        for mu in [0.0, 0.1, 0.35, 1.0] {
            let forces = forces(&points, of(mu), Slip::ToFreeEnd);
            let beyond = forces.last().unwrap().beyond;
            // The points themselves are rounded, and so are the angles: by a unit in the last place over the side.
            let rounded = f64::from(turns) * f64::from(sides) * 1e-16;
            assert!((beyond.ln() - mu * angle).abs() <= mu * rounded + 1e-15 * (1.0 + mu * angle), "{sides} {turns}");
            assert!(forces.windows(2).all(|pair| pair[0].beyond == pair[1].before));
            assert_eq!(forces[0].before, 1.0);
        }
    }
    // Square corners are exact.
    let square = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0), at(0.0, 0.0)];
    let tensions: Vec<f64> = forces(&square, of(0.5), Slip::ToAnchor).iter().map(|force| force.beyond).collect();
    assert_eq!(tensions, [1.0, 2.0, 3.0].map(|corner| libm::exp(-0.5 * corner * FRAC_PI_2)));
    assert_eq!(turn(at(0.0, 0.0), at(1.0, 0.0), at(-1.0, 0.0)), PI);
}

#[test]
fn forces_halve_the_angle_and_add_up_to_the_pulls_of_the_ends() {
    for (sides, turns) in [(3, 1), (5, 3), (50, 120)] {
        let (points, _) = spiral(sides, turns);
        for force in forces(&points, of(0.0), Slip::ToFreeEnd) {
            assert!((force.force.length() - 2.0 * (force.angle / 2.0).sin()).abs() < 1e-14);
            // On a circle the middle of the angle leads inwards.
            assert!(force.force.normalize().distance(-force.at.normalize()) < 1e-13);
        }
        for slip in [Slip::ToFreeEnd, Slip::ToAnchor] {
            let all = forces(&points, of(0.2), slip);
            let sum: DVec2 = all.iter().map(|force| force.force).sum();
            let n = points.len();
            let ends = (points[0] - points[1]).normalize()
                + (points[n - 1] - points[n - 2]).normalize() * all.last().unwrap().beyond;
            assert!(sum.distance(ends) < 1e-12 * all.last().unwrap().beyond.max(1.0));
        }
    }
}

/// Runs `test` on random scenes of all kinds, with traces that keep to the rules.
fn check(touching: bool, test: impl Fn(&Arc<Model>, &Trace)) {
    for kind in KINDS {
        on_lawful(kind, touching, 16, |model, trace, _| test(model, trace));
    }
}

/// Turns, tension and pull of every step are those of the taut rope's corners, and those of the rope reversed.
fn strain_is_that_of_the_corners(model: &Arc<Model>, trace: &Trace) {
    let settled = settle(model, trace);
    let record = record(model, &settled);
    let mu = 0.25;
    for ((step, strain), mut corners) in
        told(model, &settled, &record, mu).into_iter().zip(corners(model, trace, &record))
    {
        let truth = turned(&corners);
        assert!(
            (strain.turned - truth).abs() <= 1e-14 * corners.len() as f64,
            "step {}: {strain:?} {truth}",
            step.step
        );
        assert_eq!(strain.tension, libm::exp(mu * strain.turned));
        assert_eq!(strain.turned == 0.0, step.turns == 0, "step {}", step.step);
        match strain.anchor_pull {
            None => assert_eq!(step.pull, None),
            Some(pull) => assert!((pull - (corners[1] - corners[0]).normalize()).length() < 1e-15, "{corners:?}"),
        }
        let there = forces(&corners, of(mu), Slip::ToFreeEnd);
        corners.reverse();
        let back = forces(&corners, of(mu), Slip::ToAnchor);
        if let (Some(last), Some(first)) = (there.last(), back.last()) {
            assert!((last.beyond * first.beyond - 1.0).abs() < 1e-13);
            assert!((last.beyond / strain.tension - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn every_step_has_the_strain_of_its_corners() {
    check(false, strain_is_that_of_the_corners);
    check(true, strain_is_that_of_the_corners);
}

/// The work, by the sum over very many short moves between the moments of the trace, each with the tensions at both of
/// its ends.
fn summed(model: &Model, trace: &Trace, record: &TraceRecord, mu: f64, parts: u32) -> Vec<f64> {
    let (mut from, mut before, mut work, mut all) = (model.anchor(), None, 0.0, vec![]);
    moments(model.anchor(), model.vertices(), &trace.points, &record.events, |moment| {
        // Between two moments the rope has the contacts that it had before the second.
        let rope = before.take().unwrap_or_else(|| tautline::rope::Rope::new(model.anchor()));
        let look = |a: DVec2| {
            let taut = rope.taut(a);
            let corners: Vec<DVec2> =
                [model.anchor()].into_iter().chain(taut.iter().map(|c| c.at)).chain([a]).collect();
            (rope.length(a), turned(&corners))
        };
        let mut last = look(from);
        for part in 1..=parts {
            let next = look(from.lerp(moment.at, f64::from(part) / f64::from(parts)));
            let grown = next.0 - last.0;
            let [a, b] = [last.1, next.1].map(|turned| (mu * turned * grown.signum()).exp());
            work += grown * (a + b) / 2.0;
            last = next;
        }
        from = moment.at;
        before = Some(moment.rope.clone());
        if moment.event.is_none() {
            all.push(work);
        }
    });
    all
}

#[test]
fn work_is_the_integral_of_the_tension() {
    let model = Arc::new(Model::new(tautline::example::floor_plan(), None).unwrap());
    // Long steps, with several events in one.
    let walker = tautline::example::Walker { step: 2.0, steps: 60, seed: 5 };
    let mut turned_by = 0.0f64;
    for trace in tautline::example::walks(&model, walker, 6) {
        let settled = settle(&model, &trace);
        let record = record(&model, &settled);
        for mu in [0.0, 0.3, 1.5] {
            let all = told(&model, &settled, &record, mu);
            let truth = summed(&model, &trace, &record, mu, 2000);
            for ((step, strain), truth) in all.iter().zip(&truth) {
                let most = all.iter().map(|(_, strain)| strain.tension).fold(1.0, f64::max);
                // The plain sum is good to the square of a move: 1e-3 of the way, times what the rope passes it by.
                assert!((strain.work - truth).abs() < 2e-4 * most, "mu {mu}, step {}: {strain:?} {truth}", step.step);
                turned_by = turned_by.max(strain.turned);
            }
        }
    }
    assert!(turned_by > TAU, "{turned_by}");
}

/// Straight past a wall's end, where the integral is known: in the angle p from the line on which the rope bends, with
/// a way at right angles to that, at the distance d, the rope's last leg is d / cos p long.
#[test]
fn work_is_known_past_a_wall() {
    let scene = Scene::new([[at(0.0, 0.0), at(0.0, -9.0)]]).unwrap();
    let model = Arc::new(Model::new(scene, Some(at(-1.0, 0.0))).unwrap());
    let trace = Trace { id: 0, points: vec![at(-1.0, 0.0), at(2.0, 0.0), at(2.0, -6.0), at(2.0, 0.0)] };
    let settled = settle(&model, &trace);
    let record = record(&model, &settled);
    for mu in [0.0, 0.3, 2.0, 10.0] {
        let all = told(&model, &settled, &record, mu);
        // Simpson's rule in the angle: d tan p / cos p dp times the tension.
        let integral = |mu: f64| {
            let (parts, end) = (200_000, 6f64.atan2(2.0));
            let f = |p: f64| 2.0 * p.tan() / p.cos() * (mu * p).exp();
            let h = end / f64::from(parts);
            let inner: f64 =
                (1..parts).map(|i| f64::from(i) * h).zip([4.0, 2.0].into_iter().cycle()).map(|(p, w)| w * f(p)).sum();
            (f(0.0) + inner + f(end)) * h / 3.0
        };
        let [there, back] = [integral(mu), integral(-mu)];
        assert!((all[1].1.work - 3.0).abs() < 1e-15);
        assert!((all[2].1.work - 3.0 - there).abs() < 1e-10 * there, "mu {mu}: {} {there}", all[2].1.work - 3.0);
        let lost = there - back;
        assert!((all[3].1.work - 3.0 - lost).abs() < 1e-10 * there.max(1.0), "mu {mu}: {} {lost}", all[3].1.work);
        assert_eq!(all[2].1.turned, libm::atan2(6.0, 2.0));
    }
}

/// What is true of all traces: without friction work is the length, friction only ever takes, and neither depends on
/// the unit.
fn work_goes_one_way(model: &Arc<Model>, trace: &Trace) {
    let settled = settle(model, trace);
    let record = record(model, &settled);
    let frictionless = told(model, &settled, &record, 0.0);
    let mut most = 0.0f64;
    for (step, strain) in &frictionless {
        most = most.max(step.length);
        let far = step.at.abs().max_element().max(most);
        assert!(
            (strain.work - step.length).abs() <= 1e-12 * far,
            "step {}: {} {}",
            step.step,
            strain.work,
            step.length
        );
        assert_eq!(strain.tension, 1.0);
    }
    let mut lost = 0.0;
    for (step, strain) in told(model, &settled, &record, 0.4) {
        let heat = strain.work - step.length;
        assert!(heat >= lost - 1e-9 * strain.work.abs().max(most), "step {}: {heat} {lost}", step.step);
        lost = heat;
    }
}

#[test]
fn friction_only_takes() {
    check(false, work_goes_one_way);
    check(true, work_goes_one_way);
}

/// Steps along the rope itself: up and down lines on which wall ends lie, and on the middle of a wall, where points are
/// rounded. No crossing of lines says there when a contact comes or goes.
#[test]
fn work_is_right_along_the_rope_itself() {
    let column: &[[[f64; 2]; 2]] =
        &[[[1.0, 2.0], [1.0, 1.0]], [[-1.0, -1.0], [3.0, -1.0]], [[1.0, 4.0], [1.0, 3.0]], [[0.0, 5.0], [0.0, 2.0]]];
    let up = [[0.5, 1.0], [1.0, 4.0], [-0.5, 7.0], [3.0, 10.5], [1.0, -1.0], [1.0, 4.0], [1.5, 4.5]];
    let walls: &[[[f64; 2]; 2]] = &[
        [[0.332611083984375, 0.63104248046875], [0.285601806640625, 0.54215087890625]],
        [[0.7176513671875, 0.406829833984375], [0.4409912109375, 0.522344970703125]],
    ];
    let along = [
        [0.013, 0.70639208984375],
        [0.9074244384765625, 0.70639208984375],
        [1.0513453369140624, 0.26748828125],
        [0.4409912109375, 0.522344970703125],
        [0.5793212890625, 0.46458740234375],
        [0.4409912109375, 0.522344970703125],
        [0.285601806640625, 0.54215087890625],
    ];
    for (walls, points) in [(column, up), (walls, along)] {
        let scene = Scene::new(walls.iter().map(|ends| ends.map(DVec2::from))).unwrap();
        let model = Arc::new(Model::new(scene, Some(at(0.013, 0.017))).unwrap());
        let trace = Trace { id: 0, points: points.map(DVec2::from).to_vec() };
        assert_eq!(settle(&model, &trace).violation(), None);
        work_goes_one_way(&model, &trace);
        let deepest = told(&model, &settle(&model, &trace), &record(&model, &settle(&model, &trace)), 0.0);
        assert!(deepest.iter().any(|(step, _)| step.contacts > 3));
    }
}

#[test]
fn strain_scales_with_the_scene() {
    let plan = tautline::example::floor_plan();
    let strained = |scale: f64| {
        let walls = (0..plan.walls().len()).map(|wall| plan.ends(wall).map(|end| end * scale));
        let scene = Scene::new(walls).unwrap();
        let model = Arc::new(Model::new(scene, plan.anchor().map(|anchor| anchor * scale)).unwrap());
        let tied = Arc::new(Model::new(plan.clone(), None).unwrap());
        let walker = tautline::example::Walker { step: 0.5, steps: 300, seed: 9 };
        let mut trace = tautline::example::walks(&tied, walker, 1).remove(0);
        trace.points.iter_mut().for_each(|point| *point *= scale);
        let settled = settle(&model, &trace);
        let record = record(&model, &settled);
        told(&model, &settled, &record, 0.3)
    };
    let one = strained(1.0);
    assert!(one.iter().any(|(step, _)| step.turns > 1));
    // By powers of two nothing is rounded otherwise.
    for scale in [2f64.powi(-400), 2f64.powi(-20), 2f64.powi(450)] {
        for ((_, here), (_, there)) in one.iter().zip(strained(scale)) {
            let expected = Strain { work: here.work * scale, ..*here };
            assert_eq!(there, expected);
        }
    }
}

/// Both ends: the anchor at rest is a rope that is tied; ends that change places turn by the same.
#[test]
fn both_ends_strain_as_one_does() {
    let plan = tautline::example::floor_plan();
    let model = Arc::new(Model::new(plan, None).unwrap());
    let walker = tautline::example::Walker { step: 1.0, steps: 120, seed: 4 };
    let walks = tautline::example::walks(&model, walker, 8);
    let ends = |free: &Trace, anchor: &[DVec2], mu: f64| -> Vec<(RopeStep, Strain)> {
        let settled = settle_ends(&model, free, anchor).unwrap();
        let mut engine = Cpu::new(model.clone());
        let record = engine.evaluate_ends(std::slice::from_ref(&settled), &Job::new()).unwrap().remove(0);
        let mut steps = EndsSteps::new(&model, &settled, &record, &[]).with_friction(Some(of(mu)));
        let mut all = vec![];
        while let Some((step, _)) = steps.next() {
            all.push((step, steps.strain().unwrap()));
        }
        all
    };
    let mut most = 0.0f64;
    for pair in walks.windows(2) {
        let (free, other) = (&pair[0], &pair[1]);
        let still = vec![model.anchor(); free.points.len()];
        let settled = settle(&model, free);
        let tied = told(&model, &settled, &record(&model, &settled), 0.3);
        for ((_, one), (_, two)) in tied.iter().zip(ends(free, &still, 0.3)) {
            assert_eq!((one.turned, one.tension, one.anchor_pull), (two.turned, two.tension, two.anchor_pull));
            assert!((one.work - two.work).abs() <= 1e-9 * one.work.abs().max(1.0), "{one:?} {two:?}");
        }
        let (there, back) = (ends(free, &other.points, 0.3), ends(other, &free.points, 0.3));
        for ((here, one), (away, two)) in there.iter().zip(&back) {
            assert!((one.turned - two.turned).abs() < 1e-13 && (one.tension / two.tension - 1.0).abs() < 1e-13);
            assert_eq!((one.anchor_pull, two.anchor_pull), (away.pull, here.pull));
            most = most.max(one.turned);
        }
        // With the moves of both ends told apart: work is done while the free end moves, and is then the change of
        // length where there is no friction.
        let twice = |points: &[DVec2], first: usize| -> Vec<DVec2> {
            (0..2 * points.len() - 1).map(|step| points[(step + first) / 2]).collect()
        };
        let apart = ends(&Trace { id: 0, points: twice(&free.points, 1) }, &twice(&other.points, 0), 0.0);
        let mut work = apart[0].0.length;
        for (k, (_, strain)) in ends(free, &other.points, 0.0).iter().enumerate().skip(1) {
            work += apart[2 * k - 1].0.length - apart[2 * k - 2].0.length;
            assert!((strain.work - work).abs() < 1e-11, "step {k}: {} {work}", strain.work);
        }
    }
    assert!(most > PI, "{most}");
}

#[test]
fn tensions_beyond_all_numbers_are_infinite_and_nothing_is_no_number() {
    // Wound about a wall's ends so often that e to the power of it is beyond f64.
    let scene = Scene::new([[at(0.0, 0.0), at(1.0, 0.0)]]).unwrap();
    let model = Arc::new(Model::new(scene, Some(at(0.5, -1.0))).unwrap());
    let round = [at(2.0, 0.0), at(0.5, 1.0), at(-1.0, 0.0), at(0.5, -1.0)];
    let rounds = 20;
    let points: Vec<DVec2> = [at(0.5, -1.0)].into_iter().chain((0..rounds).flat_map(|_| round)).collect();
    let points = points.iter().chain(points.iter().rev()).copied().collect();
    let settled = settle(&model, &Trace { id: 0, points });
    let record = record(&model, &settled);
    let all = told(&model, &settled, &record, 10.0);
    assert!(all.iter().any(|(_, strain)| strain.tension == f64::INFINITY));
    assert!(
        all.iter().all(|(_, strain)| !strain.work.is_nan() && !strain.tension.is_nan() && strain.turned.is_finite())
    );
    assert_eq!(all.last().unwrap().1.turned, 0.0);
    // Round a square again and again, forces point into it, however great they are.
    let square = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let corners: Vec<DVec2> = (0..30).flat_map(|_| square).collect();
    let felt = forces(&corners, of(10.0), Slip::ToFreeEnd);
    assert!(felt.last().unwrap().beyond == f64::INFINITY && felt[0].beyond.is_finite());
    for force in felt {
        let inwards = at(0.5, 0.5) - force.at;
        assert!(force.force.x * inwards.x > 0.0 && force.force.y * inwards.y > 0.0, "{force:?}");
    }
    for bad in [-0.1, 10.5, f64::NAN, f64::INFINITY] {
        let message = Friction::new(bad).unwrap_err().to_string();
        assert!(message.ends_with("is no coefficient of friction; give a number from 0 to 10"), "{message}");
    }
}
