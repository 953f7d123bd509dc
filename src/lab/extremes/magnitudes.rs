//! Scenes that are huge, tiny, stretched, or far away.

use glam::DVec2;

use super::extreme::Extreme;
use super::rays::lattice;
use super::tools::{model, p, walls_of};
use crate::example::{Walker, random_walls, walks};

/// The same scenes and traces at all scales, all powers of two and so exact: what happens is the same in all of them.
/// The lattice reaches from 2^-450 to 2^500, the first and the last magnitude that is taken.
pub(super) fn scales() -> Vec<Extreme> {
    let (walls, lattice) = (anywhere(p(0.0, 0.0), 1.0), whole());
    let alike = [0, -300, -150, -60, -8, 8, 60, 150, 300].map(|k| (k, k));
    let stretched = [(300, -300), (-300, 300), (20, -20), (-60, 10)];
    let mut cases = Vec::new();
    for (x, y) in alike.into_iter().chain(stretched) {
        cases.push(scaled(&walls, x, y));
        cases.push(scaled(&lattice, x, y));
    }
    cases.extend([(-450, -450), (496, 496), (496, -450), (-450, 496)].map(|(x, y)| scaled(&lattice, x, y)));
    cases
}

/// A lattice moved by whole numbers, which changes nothing that happens, and random walls moved, which rounds them.
pub(super) fn offsets() -> Vec<Extreme> {
    let lattice = whole();
    let mut cases = vec![moved(&lattice, "not at all", p(0.0, 0.0))];
    for k in 0..=12 {
        let offset = 10f64.powi(k) * p(32.0, -7.0);
        cases.push(moved(&lattice, &format!("by 10^{k} sizes"), offset));
        let name = format!("random walls, moved by 10^{k} sizes");
        cases.push(Extreme { name, ..anywhere(10f64.powi(k) * p(-0.6, 2.0), 1.0) });
    }
    cases
}

/// Random walls and walks among them, with the anchor at `centre`.
fn anywhere(centre: DVec2, size: f64) -> Extreme {
    let walls: Vec<_> = walls_of(&random_walls(40, 3)).iter().map(|w| w.map(|end| centre + size * end)).collect();
    let model = model(&walls, centre);
    let traces = [(0.02, 400), (0.3, 200), (1.0, 150)].into_iter().zip(0..).flat_map(|((step, steps), seed)| {
        let mut traces = walks(&model, Walker { step: size * step, steps, seed }, 2);
        traces.iter_mut().zip(2 * seed..).for_each(|(trace, id)| trace.id = id);
        traces
    });
    Extreme { name: "random walls".to_owned(), traces: traces.collect(), anchor: centre, walls }
}

/// A lattice of whole numbers up to 16, with traces on it.
fn whole() -> Extreme {
    lattice(60, 16, 5, false)
}

fn scaled(case: &Extreme, x: i32, y: i32) -> Extreme {
    let name = if x == y { format!("{} by 2^{x}", case.name) } else { format!("{} by 2^{x}, 2^{y}", case.name) };
    let scale = p(2f64.powi(x), 2f64.powi(y));
    changed(case, name, |q| q * scale)
}

fn moved(case: &Extreme, how: &str, offset: DVec2) -> Extreme {
    changed(case, format!("{}, moved {how}", case.name), |q| q + offset)
}

fn changed(case: &Extreme, name: String, change: impl Fn(DVec2) -> DVec2) -> Extreme {
    let mut case = Extreme { name, ..case.clone() };
    case.anchor = change(case.anchor);
    case.walls.iter_mut().flatten().for_each(|q| *q = change(*q));
    case.traces.iter_mut().flat_map(|trace| &mut trace.points).for_each(|q| *q = change(*q));
    case
}
