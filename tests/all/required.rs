//! What a scene requires, against a look at every wall for every vertex, and that leaving out the rest changes no
//! event.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::OnceLock;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::candidates::Lists;
use tautline::engine::{Cpu, Engine, Job, Reference};
use tautline::geometry::{between, opposite, orient};
use tautline::gpu::Device;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};
use tautline::visibility::Visibility;

use crate::scenes::{KINDS, Kind, recipe};
use crate::support::{gpu_on, software};

/// The numbers of the vertices that are kept.
fn kept(model: &Model) -> Vec<u32> {
    Visibility::new(model).unwrap().only_required().listed()
}

/// A part of the plane about a place: from a wall's direction, or any, to the next one counter-clockwise.
struct Sector {
    at: usize,
    /// Towards which points its walls go, right and left; `None` where no wall meets the place.
    walls: Option<[DVec2; 2]>,
    /// Another sector that can be reached from it, or itself.
    linked: usize,
}

/// The sectors about all places, linked where one can go from one to the other without crossing a wall: along the line
/// between two places that no wall crosses and no place lies on.
struct Sectors {
    places: Vec<DVec2>,
    sectors: Vec<Sector>,
}

impl Sectors {
    fn of(walls: &[[DVec2; 2]], places: Vec<DVec2>) -> Self {
        let mut all = Sectors { places, sectors: vec![] };
        for at in 0..all.places.len() {
            let p = all.places[at];
            let on = |&&[a, b]: &&[DVec2; 2]| a == p || b == p || orient(a, b, p) == 0.0 && between(a, b, p);
            let ways = walls.iter().filter(on).flatten().copied().filter(|&end| end != p);
            let mut ways: Vec<DVec2> = ways.collect();
            // Counter-clockwise from the direction of greater x.
            let is_upper = |w: DVec2| w.y > p.y || w.y == p.y && w.x > p.x;
            let turn = |a: DVec2, b: DVec2| orient(p, b, a).total_cmp(&0.0);
            ways.sort_by(|&a, &b| is_upper(b).cmp(&is_upper(a)).then_with(|| turn(a, b)));
            ways.dedup_by(|a, b| is_upper(*a) == is_upper(*b) && orient(p, *a, *b) == 0.0);
            for i in 0..ways.len().max(1) {
                let walls = (!ways.is_empty()).then(|| [ways[i], ways[(i + 1) % ways.len()]]);
                all.sectors.push(Sector { at, walls, linked: all.sectors.len() });
            }
        }
        all.link(walls);
        all
    }

    fn link(&mut self, walls: &[[DVec2; 2]]) {
        for a in 0..self.places.len() {
            for b in 0..a {
                let (p, q) = (self.places[a], self.places[b]);
                let is_free = !self.places.iter().any(|&r| orient(p, q, r) == 0.0 && between(p, q, r))
                    && !walls.iter().any(|&[u, v]| {
                        opposite(orient(u, v, p), orient(u, v, q)) && opposite(orient(p, q, u), orient(p, q, v))
                    });
                if !is_free {
                    continue;
                }
                // Along a wall there are two ways from one to the other, on its left and on its right.
                for (left, right) in [(false, true), (true, false)] {
                    let from = self.sector(a, q, left);
                    let to = self.sector(b, p, right);
                    let (from, to) = (self.root(from), self.root(to));
                    self.sectors[from].linked = to;
                }
            }
        }
    }

    /// The sector about place `at` in which the way to `to` begins; where that is a wall, the one on its right or left.
    fn sector(&self, at: usize, to: DVec2, on_the_left: bool) -> usize {
        let p = self.places[at];
        let same = |a: DVec2| orient(p, a, to) == 0.0 && !between(a, to, p);
        let holds = |s: &Sector| {
            let Some([right, left]) = s.walls else { return true };
            if same(right) || same(left) {
                return if on_the_left { same(right) } else { same(left) };
            }
            let (past, short) = (orient(p, right, to) > 0.0, orient(p, left, to) < 0.0);
            if is_narrow(p, [right, left]) { past && short } else { past || short || right == left }
        };
        self.sectors.iter().position(|s| s.at == at && holds(s)).unwrap()
    }

    fn root(&self, mut sector: usize) -> usize {
        while self.sectors[sector].linked != sector {
            sector = self.sectors[sector].linked;
        }
        sector
    }

    /// The places with a sector of at least half a turn that is linked to any about place `anchor`.
    fn required(&self, anchor: usize) -> Vec<DVec2> {
        let about = |at: usize| self.sectors.iter().enumerate().filter(move |(_, s)| s.at == at);
        let starts: Vec<usize> = about(anchor).map(|(i, _)| self.root(i)).collect();
        let is_wide = |s: &Sector| s.walls.is_none_or(|walls| !is_narrow(self.places[s.at], walls));
        let is_required = |&at: &usize| about(at).any(|(i, s)| is_wide(s) && starts.contains(&self.root(i)));
        (0..self.places.len()).filter(is_required).map(|at| self.places[at]).collect()
    }
}

/// Whether the sector from `right` counter-clockwise to `left` spans less than half a turn.
fn is_narrow(p: DVec2, [right, left]: [DVec2; 2]) -> bool {
    orient(p, right, left) > 0.0
}

/// The points in which axis-parallel walls cross, and whether any others do.
fn crossings(walls: &[[DVec2; 2]]) -> (Vec<DVec2>, bool) {
    let (mut points, mut others) = (vec![], false);
    for (i, &[a, b]) in walls.iter().enumerate() {
        for &[c, d] in &walls[..i] {
            if opposite(orient(a, b, c), orient(a, b, d)) && opposite(orient(c, d, a), orient(c, d, b)) {
                match (a.x == b.x && c.y == d.y, a.y == b.y && c.x == d.x) {
                    (true, _) => points.push(DVec2::new(a.x, c.y)),
                    (_, true) => points.push(DVec2::new(c.x, a.y)),
                    _ => others = true,
                }
            }
        }
    }
    (points, others)
}

/// Compares what is kept with what is required. Returns how many vertices are left out.
fn check(model: &Model) -> Result<usize, TestCaseError> {
    let walls: Vec<[DVec2; 2]> = (0..model.scene().walls().len()).map(|w| model.scene().ends(w)).collect();
    let (crossings, more) = crossings(&walls);
    let mut places: Vec<DVec2> = [model.anchor()].into_iter().chain(model.vertices().iter().copied()).collect();
    for p in crossings {
        if !places.contains(&p) {
            places.push(p);
        }
    }
    // The anchor may be a vertex.
    let anchor = places.iter().rposition(|&p| p == model.anchor()).unwrap();
    let places = if anchor == 0 { places } else { places.split_off(1) };
    let required = Sectors::of(&walls, places).required(anchor.saturating_sub(1));
    let kept = kept(model);
    for (v, p) in (0..).zip(model.vertices()) {
        let is_required = required.contains(p);
        prop_assert!(!is_required || kept.contains(&v), "{p} is left out of {kept:?}");
        // Where walls cross at other points, some of them stay open, and what is reached beyond them is no part of the
        // truth.
        prop_assert!(is_required || more || !kept.contains(&v), "{p} is kept");
    }
    Ok(model.vertices().len() - kept.len())
}

/// Runs `test`, which counts something, on random scenes of a kind.
fn count(kind: Kind, cases: u32, test: impl Fn(&Arc<Model>, &Trace) -> Result<usize, TestCaseError>) -> usize {
    let cases = cases * ProptestConfig::default().cases / 256;
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let total = Cell::new(0);
    let result = TestRunner::new(config).run(&recipe(kind, true), |recipe| {
        let model = recipe.model();
        let trace = recipe.trace(&model, 0);
        total.set(total.get() + test(&model, &trace)?);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{kind:?}: {e}"));
    total.get()
}

/// Walls that cross, overlap and touch, and anchors at walls' ends among them.
#[test]
fn what_is_kept_is_what_a_look_at_every_wall_requires() {
    for kind in [Kind::Lattice, Kind::Boxes, Kind::Grid, Kind::Winding, Kind::Random] {
        count(kind, 40, |model, _| check(model));
    }
}

/// Many walls in little room, so that they close off parts of it and meet in all ways.
#[test]
fn what_is_kept_in_a_dense_lattice_is_what_a_look_at_every_wall_requires() {
    let wall = (0i8..7, 0i8..7, any::<bool>(), 1i8..4);
    let cases = 100 * ProptestConfig::default().cases / 256;
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let total = Cell::new(0);
    let scenes = (prop::collection::vec(wall, 10..50), any::<bool>());
    let result = TestRunner::new(config).run(&scenes, |(walls, is_tied_to_wall)| {
        let at = |x: i8, y: i8| DVec2::new(x.into(), y.into());
        let walls = walls.iter().map(|&(x, y, lies, long)| {
            let to = if lies { at(x + long, y) } else { at(x, y + long) };
            [at(x, y), to]
        });
        let scene = Scene::new(walls).unwrap();
        let anchor = if is_tied_to_wall { scene.vertices()[0] } else { DVec2::new(3.5, 3.25) };
        // A wall's end may lie inside another wall.
        let Ok(model) = Model::new(scene, Some(anchor)) else { return Ok(()) };
        total.set(total.get() + check(&model)?);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{e}"));
    assert!(total.get() > 50, "only {} left out", total.get());
}

fn run(engine: &mut dyn Engine, traces: &[SettledTrace]) -> Vec<tautline::rope::TraceRecord> {
    engine.evaluate(traces, &Job::new()).unwrap()
}

/// Lists, and what is tried where looks and lists are given up, leave out only what is never met.
#[test]
fn leaving_out_what_is_not_required_changes_no_event() {
    static ADAPTER: OnceLock<Device> = OnceLock::new();
    let adapter = ADAPTER.get_or_init(software);
    let left_out = Cell::new(0);
    for kind in KINDS {
        let events = count(kind, 150, |model, trace| {
            let batch = [settle(model, trace)];
            let truth = run(&mut Reference::new(model.clone()), &batch);
            let lists = || Lists::new(model.clone());
            for lists in [lists(), lists().after(0), lists().at_most(0), lists().after(0).at_most(0)] {
                let mut cpu = Cpu::with_lists(lists);
                prop_assert_eq!(&run(&mut cpu, &batch), &truth);
                if let Some(remaining) = cpu.remaining() {
                    left_out.set(left_out.get() + model.vertices().len() - remaining);
                }
            }
            prop_assert_eq!(&run(&mut gpu_on(adapter.clone(), lists().after(0).at_most(0)), &batch), &truth);
            Ok(truth[0].events.len())
        });
        assert!(events > 100, "{kind:?}: only {events} events");
    }
    assert!(left_out.get() > 50, "only {} left out", left_out.get());
}

/// A closed polygon with these corners.
fn ring(corners: &[[f64; 2]]) -> Vec<[DVec2; 2]> {
    (0..corners.len()).map(|i| [corners[i].into(), corners[(i + 1) % corners.len()].into()]).collect()
}

/// The places of the vertices that are kept.
fn kept_of(walls: impl IntoIterator<Item = [DVec2; 2]>, anchor: [f64; 2]) -> Vec<[f64; 2]> {
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(anchor.into())).unwrap());
    kept(&model).into_iter().map(|v| model.vertices()[v as usize].to_array()).collect()
}

const ROOM: [[f64; 2]; 4] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];

#[test]
fn a_room_has_corners_for_those_outside_only() {
    assert_eq!(kept_of(ring(&ROOM), [-1.0, 2.0]), ROOM);
    assert!(kept_of(ring(&ROOM), [1.0, 2.0]).is_empty());
    // Tied to a corner, the rope may start on either side.
    assert_eq!(kept_of(ring(&ROOM), ROOM[1]), ROOM);
}

#[test]
fn the_inner_corner_of_an_angle_is_left_out() {
    let angle = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 4.0], [2.0, 2.0], [0.0, 2.0]];
    let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 4.0], [0.0, 2.0]];
    assert_eq!(kept_of(ring(&angle), [-1.0, 1.0]), outer);
    // From inside it is the only one left.
    assert_eq!(kept_of(ring(&angle), [1.0, 1.0]), [[2.0, 2.0]]);
}

#[test]
fn corners_on_a_straight_wall_are_kept() {
    let room = [[0.0, 0.0], [1.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    assert_eq!(kept_of(ring(&room), [1.0, 2.0]), [[1.0, 0.0]]);
    assert_eq!(kept_of(ring(&room), [1.0, -2.0]), room);
}

#[test]
fn a_lake_on_an_island_is_out_of_reach() {
    let lake = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]];
    let island = || ring(&ROOM).into_iter().chain(ring(&lake));
    assert_eq!(kept_of(island(), [-1.0, 2.0]), ROOM);
    // Tied on the island the rope goes round the lake, tied in the lake it goes nowhere.
    assert_eq!(kept_of(island(), [0.5, 2.0]), lake);
    assert!(kept_of(island(), [2.0, 2.0]).is_empty());
}

/// Walls out of reach of all traces are left out, as far as lists are told of the traces.
#[test]
fn what_remains_depends_on_how_far_traces_go() {
    let posts = (0..10).map(|k| [DVec2::new(f64::from(k), 1.0), DVec2::new(f64::from(k), 2.0)]);
    let model = Arc::new(Model::new(Scene::new(posts).unwrap(), Some(DVec2::new(0.0, 0.0))).unwrap());
    let to = |x: f64| settle(&model, &Trace { id: 0, points: vec![DVec2::new(x, 0.0), DVec2::new(x, 3.0)] });
    let mut engine = Cpu::new(model.clone());
    assert_eq!(engine.remaining(), None);
    run(&mut engine, &[to(2.5)]);
    assert_eq!(engine.remaining(), Some(6));
    // A good deal further than was asked for.
    run(&mut engine, &[to(6.5)]);
    assert_eq!(engine.remaining(), Some(20));
    assert_eq!(Cpu::new(model.clone()).keep_all().remaining(), Some(20));
    assert_eq!(Reference::new(model.clone()).remaining(), None);
}

/// What is reached is reached within reach: round the far end of this island, no trace goes.
#[test]
fn walls_that_lead_out_of_reach_part_what_is_within() {
    // A strip with a notch on its right.
    let island = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.5, 2.0], [1.0, 2.0], [1.0, 99.0], [0.0, 99.0]];
    let model = Arc::new(Model::new(Scene::new(ring(&island)).unwrap(), Some(DVec2::new(-1.0, 3.0))).unwrap());
    let points = [[-1.0, -1.0], [2.0, -1.0], [2.0, 3.0]].map(DVec2::from).to_vec();
    let batch = [settle(&model, &Trace { id: 0, points })];
    let mut engine = Cpu::new(model.clone());
    assert_eq!(run(&mut engine, &batch), run(&mut Reference::new(model.clone()), &batch));
    assert_eq!(engine.remaining(), Some(4));
}
