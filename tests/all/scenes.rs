//! Random scenes and legal traces in them, of every kind that the golden cases have, in a form that shrinks.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

/// What walls a scene is made of, and how the trace moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Disjoint or crossing walls anywhere.
    Random,
    /// The same with short steps.
    Fine,
    /// The same with steps across half the scene.
    Coarse,
    /// Axis-parallel walls on integers, overlapping and touching; points at halves.
    Lattice,
    /// Walls on integers in any direction; points on quarters.
    Grid,
    /// Closed rectangles on integers.
    Boxes,
    /// Almost parallel, almost touching long walls.
    Needles,
    /// A pillar of 12 corners, and points round it.
    Winding,
    /// Random, 4 million units from the origin.
    Offset,
    /// Random, scaled by 2^-380.
    Tiny,
    /// Random, scaled by 2^400.
    /// Random, scaled by 2^380.
    Huge,
    /// Random, with steps of up to 2^60 scenes.
    Far,
}

pub(crate) const KINDS: [Kind; 12] = [
    Kind::Random,
    Kind::Fine,
    Kind::Coarse,
    Kind::Lattice,
    Kind::Grid,
    Kind::Boxes,
    Kind::Needles,
    Kind::Winding,
    Kind::Offset,
    Kind::Tiny,
    Kind::Huge,
    Kind::Far,
];

/// A scene and a trace as small integers; proptest shrinks these.
#[derive(Debug, Clone)]
pub(crate) struct Recipe {
    pub(crate) kind: Kind,
    walls: Vec<[i16; 4]>,
    /// Each a displacement, and, for some, a vertex or the middle of a wall to stand on instead.
    moves: Vec<(i16, i16, Option<u16>)>,
    /// Whether the anchor stands at a wall's end or in its middle.
    anchored: Option<bool>,
}

/// Runs `test` on so many random scenes of one kind, in each with the trace that `walk` makes of its recipe; shows the
/// simplest that fails.
pub(crate) fn on_random(
    kind: Kind,
    touching: bool,
    cases: u32,
    walk: impl Fn(&Recipe, &Model) -> Trace,
    test: impl Fn(&Arc<Model>, &Trace, &SettledTrace),
) {
    // PROPTEST_CASES=2560 runs ten times as many.
    let default = ProptestConfig::default();
    let cases = cases * default.cases / 256;
    let mut runner = TestRunner::new(ProptestConfig { cases, failure_persistence: None, ..default });
    let result = runner.run(&recipe(kind, touching), |recipe| {
        let model = recipe.model();
        let trace = walk(&recipe, &model);
        test(&model, &trace, &settle(&model, &trace));
        Ok(())
    });
    if let Err(TestError::Fail(why, recipe)) = &result {
        let model = recipe.model();
        let walls: Vec<_> = (0..model.scene().walls().len()).map(|w| model.scene().ends(w)).collect();
        let points = walk(recipe, &model).points;
        panic!("{kind:?}, touching {touching}: {why}\nanchor {}\nwalls {walls:?}\ntrace {points:?}", model.anchor());
    }
    result.unwrap();
}

/// As [`on_random`], with traces that keep to the rules.
pub(crate) fn on_lawful(kind: Kind, touching: bool, cases: u32, test: impl Fn(&Arc<Model>, &Trace, &SettledTrace)) {
    on_random(kind, touching, cases, |recipe, model| recipe.trace(model, 0), test);
}

/// Recipes of one kind; `touching` traces go to vertices and to middles of walls often.
pub(crate) fn recipe(kind: Kind, touching: bool) -> impl Strategy<Value = Recipe> {
    let wall = prop::array::uniform4(any::<i16>());
    let vertex = if touching {
        prop_oneof![2 => Just(None), 3 => any::<u16>().prop_map(Some)].boxed()
    } else {
        Just(None).boxed()
    };
    let step = (any::<i16>(), any::<i16>(), vertex);
    let anchored = prop::option::weighted(0.2, any::<bool>());
    (prop::collection::vec(wall, 0..28), prop::collection::vec(step, 0..50), anchored)
        .prop_map(move |(walls, moves, anchored)| Recipe { kind, walls, moves, anchored })
}

/// The middle of a wall; on lattices it lies on the wall exactly.
fn middle([u, v]: [DVec2; 2]) -> DVec2 {
    u / 2.0 + v / 2.0
}

/// A vertex or the middle of a wall, if there is one.
fn touched(model: &Model, number: u16) -> Option<DVec2> {
    let (vertices, number) = (model.vertices(), usize::from(number));
    if vertices.is_empty() {
        return None;
    }
    let walls = model.scene().walls().len();
    Some(if number % 4 == 3 {
        middle(model.scene().ends(number / 4 % walls))
    } else {
        vertices[number / 4 % vertices.len()]
    })
}

impl Recipe {
    pub(crate) fn model(&self) -> Arc<Model> {
        let walls: Vec<[DVec2; 2]> = self.walls.iter().flat_map(|&w| self.walls_of(w)).collect();
        let anchor = match (walls.first(), self.anchored) {
            (Some(wall), Some(true)) => wall[0],
            (Some(wall), Some(false)) => middle(*wall),
            _ => self.placed(if self.kind == Kind::Needles { [-1.5, 0.031] } else { [0.013, 0.017] }),
        };
        Arc::new(Model::new(Scene::new(walls).unwrap(), Some(anchor)).unwrap())
    }

    /// A trace from the anchor that keeps to the rules: moves that do not are left out.
    pub(crate) fn trace(&self, model: &Model, id: u64) -> Trace {
        let mut trace = Trace { id, points: vec![] };
        let mut here = model.anchor();
        for &(dx, dy, vertex) in &self.moves {
            let next = match vertex {
                Some(v) => touched(model, v).unwrap_or_else(|| self.moved(here, dx, dy)),
                None => self.moved(here, dx, dy),
            };
            trace.points.push(next);
            if settle(model, &trace).violation().is_some() {
                trace.points.pop();
            } else {
                here = next;
            }
        }
        if trace.points.is_empty() {
            trace.points.push(here);
        }
        trace
    }

    /// All moves, whether they keep to the rules or not.
    pub(crate) fn lawless_trace(&self, model: &Model, id: u64) -> Trace {
        let mut points = vec![model.anchor()];
        for &(dx, dy, vertex) in &self.moves {
            let here = points[points.len() - 1];
            points.push(match vertex {
                Some(v) => touched(model, v).unwrap_or_else(|| self.moved(here, dx, dy)),
                None => self.moved(here, dx, dy),
            });
        }
        Trace { id, points }
    }

    fn moved(&self, here: DVec2, dx: i16, dy: i16) -> DVec2 {
        let d = DVec2::new(f64::from(dx), f64::from(dy)) / 32768.0;
        match self.kind {
            Kind::Fine => here + d * self.scale() * 0.05,
            Kind::Far => d * 2f64.powi(i32::from(dx.wrapping_mul(31).rem_euclid(61))),
            Kind::Coarse => here + d * self.scale() * 1.5,
            Kind::Lattice => (here * 2.0 + d * 8.0).round() / 2.0,
            Kind::Grid => (here * 4.0 + d * 12.0).round() / 4.0,
            Kind::Boxes => here + d * 3.0,
            Kind::Winding => DVec2::from_angle(d.x * 3.2) * (0.61 + 0.3 * d.y.abs()),
            _ => here + d * self.scale() * 0.6,
        }
    }

    fn scale(&self) -> f64 {
        match self.kind {
            Kind::Tiny => 2f64.powi(-380),
            Kind::Huge => 2f64.powi(400),
            _ => 1.0,
        }
    }

    fn placed(&self, p: [f64; 2]) -> DVec2 {
        let offset = if self.kind == Kind::Offset { DVec2::new(4_500_000.0, 6_200_000.0) } else { DVec2::ZERO };
        DVec2::from(p) * self.scale() + offset
    }

    fn walls_of(&self, raw: [i16; 4]) -> Vec<[DVec2; 2]> {
        let [a, b, c, d] = raw.map(|r| f64::from(r) / 32768.0);
        let whole = |x: f64, n: f64| (x * n).round();
        match self.kind {
            Kind::Lattice => {
                let (x, y, along) = (whole(a, 5.0), whole(b, 5.0), whole(d, 4.0));
                let end = if c < 0.0 { [x + along, y] } else { [x, y + along] };
                vec![[DVec2::new(x, y), end.into()]]
            }
            Kind::Grid => {
                let start = DVec2::new(whole(a, 4.0), whole(b, 4.0));
                vec![[start, start + DVec2::new(whole(c, 3.0), whole(d, 3.0))]]
            }
            Kind::Boxes => {
                let low = DVec2::new(whole(a, 5.0), whole(b, 5.0));
                let high = low + DVec2::new(1.0 + whole(c.abs(), 2.0), 1.0 + whole(d.abs(), 2.0));
                let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
                (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect()
            }
            Kind::Needles => {
                let tilt = |t: f64| t * 2f64.powi(-46);
                vec![[
                    DVec2::new(a, whole(b, 6.0) / 8.0 + tilt(c)),
                    DVec2::new(a + 0.7 * d.abs() + 0.01, whole(b, 6.0) / 8.0 + tilt(d)),
                ]]
            }
            Kind::Winding => {
                let n = 12.0;
                let angle = |k: f64| DVec2::from_angle(std::f64::consts::TAU * k / n) * 0.6;
                let k = whole(a.abs(), 11.0);
                vec![
                    [angle(k), angle(k + 1.0)],
                    [DVec2::new(b, c) * 1.4, DVec2::new(b, c) * 1.4 + DVec2::new(d, a) * 0.1],
                ]
            }
            _ => {
                let start = [a, b];
                vec![[self.placed(start), self.placed([a + c * 0.4, b + d * 0.4])]]
            }
        }
    }
}
