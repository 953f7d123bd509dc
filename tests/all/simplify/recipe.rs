//! Random scenes, their anchors and a trace in each.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use tautline::scene::{Model, Scene};
use tautline::trace::{Trace, settle};

/// What the walls of a random scene are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Rings, some around others, which do not meet.
    Rings,
    /// The same on whole numbers, where rings may meet, cross, overlap and lie in line.
    Lattice,
    /// Open lines, which may cross themselves and others.
    Chains,
    /// Rings and chains anywhere.
    Crossing,
}

#[derive(Debug, Clone)]
pub(super) struct Recipe {
    kind: Kind,
    /// Of each ring the numbers that place it, and how far its corners are out.
    lines: Vec<([u8; 2], Vec<u8>)>,
    moves: Vec<(i8, i8, Option<u8>)>,
    /// Where the anchor is, and whether it is at a wall's end.
    pub(super) anchor: ([u8; 2], bool),
    /// Where others are, if they can be there.
    others: Vec<[u8; 2]>,
    pub(super) tolerance: f64,
}

pub(super) fn recipes(kinds: Vec<Kind>) -> impl Strategy<Value = Recipe> {
    let line = (any::<[u8; 2]>(), prop::collection::vec(any::<u8>(), 3..24));
    let step = (any::<i8>(), any::<i8>(), prop::option::weighted(0.3, any::<u8>()));
    (
        prop::sample::select(kinds),
        prop::collection::vec(line, 1..7),
        prop::collection::vec(step, 0..40),
        (any::<[u8; 2]>(), prop::bool::weighted(0.1)),
        prop::collection::vec(any::<[u8; 2]>(), 0..3),
        prop::sample::select(vec![0.01, 0.1, 0.5, 2.0, 1e9]),
    )
        .prop_map(|(kind, lines, moves, anchor, others, tolerance)| Recipe {
            kind,
            lines,
            moves,
            anchor,
            others,
            tolerance,
        })
}

fn spot(at: [u8; 2]) -> DVec2 {
    DVec2::from(at.map(|p| f64::from(p) / 17.0 - 2.5))
}

impl Recipe {
    fn walls(&self) -> Vec<[DVec2; 2]> {
        let line = |(i, (place, radii)): (usize, &([u8; 2], Vec<u8>))| {
            let count = radii.len();
            let [x, y] = place.map(|p| f64::from(p) / 25.6);
            let corner = |(k, &r): (usize, &u8)| {
                let out = f64::from(r) / 256.0;
                let way = DVec2::from_angle(std::f64::consts::TAU * k as f64 / count as f64);
                match self.kind {
                    // Three side by side, and three round them.
                    Kind::Rings if i < 3 => DVec2::new(4.0 * i as f64, 5.0) + way * (0.3 + 1.5 * out),
                    Kind::Rings => DVec2::new(4.0, 5.0) + way * (7.0 + 2.0 * i as f64 + 1.8 * out),
                    Kind::Lattice => (DVec2::new(x, y) + way * (1.0 + 2.0 * out)).round(),
                    Kind::Chains => DVec2::new(x, y) + DVec2::new(k as f64 * 0.4, f64::from(r % 16) / 10.0),
                    Kind::Crossing => DVec2::new(x, y) + way * (1.0 + 2.0 * out),
                }
            };
            let corners: Vec<DVec2> = radii.iter().enumerate().map(corner).collect();
            let closed = match self.kind {
                Kind::Chains => false,
                Kind::Crossing => place[0] % 2 == 0,
                _ => true,
            };
            let walls = (0..count - usize::from(!closed)).map(|k| [corners[k], corners[(k + 1) % count]]);
            walls.collect::<Vec<_>>()
        };
        self.lines.iter().enumerate().flat_map(line).collect()
    }

    pub(super) fn model(&self) -> Option<Arc<Model>> {
        let scene = Scene::new(self.walls()).unwrap();
        let anchor = match self.anchor {
            (at, true) => *scene.vertices().get(usize::from(at[0]))?,
            (at, false) => spot(at),
        };
        Some(Arc::new(Model::new(scene, Some(anchor)).ok()?))
    }

    /// The model's anchor, and others.
    pub(super) fn anchors(&self, model: &Model) -> Vec<DVec2> {
        let others = self.others.iter().filter_map(|&at| model.tied(spot(at)).ok());
        std::iter::once(model.anchor()).chain(others.map(|model| model.anchor())).collect()
    }

    /// The moves that keep to the rules; some to wall ends.
    pub(super) fn trace(&self, model: &Model) -> Trace {
        let mut trace = Trace { id: 0, points: vec![model.anchor()] };
        for &(dx, dy, vertex) in &self.moves {
            let here = trace.points[trace.points.len() - 1];
            trace.points.push(match vertex {
                // One nearby.
                Some(v) => {
                    let mut near = model.vertices().to_vec();
                    near.sort_by(|a, b| a.distance_squared(here).total_cmp(&b.distance_squared(here)));
                    near[usize::from(v) % near.len().min(9)]
                }
                None => here + DVec2::new(f64::from(dx), f64::from(dy)) / 40.0,
            });
            if settle(model, &trace).violation().is_some() {
                trace.points.pop();
            }
        }
        trace
    }
}
