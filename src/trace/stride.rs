//! Coarser traces: straight from every k-th point to the next.

use super::settled::Thinned;
use super::{SettledTrace, Trace, settle_owned};
use crate::scene::Model;

/// Settles the trace that goes straight from every `k`-th point of `trace` to the next, and to the last: fewer steps, which are
/// longer. Where a longer step would touch a wall, the trace is followed point by point instead, and that is
/// [counted](SettledTrace::jumps). So a trace that keeps to the rules still does.
///
/// Steps keep their numbers: what happens on a longer step is said of the last of those that it stands for. What the trace
/// went round between the points is passed straight, so a wall that lies there is passed on the other side if the longer
/// step does not touch it.
///
/// O(points + walls near the longer steps and those that are followed), through the model's index.
///
/// ```
/// use tautline::scene::{Model, Scene};
/// use tautline::trace::{Trace, settle_strided};
///
/// // Over the end of a wall, whose lower part is in the way of a longer step.
/// let model = Model::new(Scene::new([[[2.5, -9.0].into(), [2.5, 1.6].into()]])?, Some([0.0, 0.0].into()))?;
/// let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 2.0], [4.0, 0.0], [5.0, 0.0]].map(Into::into).to_vec();
/// let settled = settle_strided(&model, Trace { id: 0, points }, 2);
/// let at: Vec<_> = settled.points().iter().map(|p| p.x).collect();
/// assert_eq!((at, settled.jumps()), (vec![0.0, 2.0, 3.0, 4.0, 5.0], 1));
/// assert_eq!((settled.step(2), settled.steps()), (3, 5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
///
/// If `k` is 0, and where [`settle`](super::settle()) does.
pub fn settle_strided(model: &Model, mut trace: Trace, k: usize) -> SettledTrace {
    assert!(k > 0, "a stride is at least 1");
    let thinned = thin(model, &mut trace, k);
    let mut settled = settle_owned(model, trace);
    if !thinned.used.is_empty() {
        settled.broken.renumber(&thinned.used);
    }
    settled.thinned = thinned;
    settled
}

/// Leaves points out of `trace`, and says which.
fn thin(model: &Model, trace: &mut Trace, k: usize) -> Thinned {
    let last = trace.points.len().saturating_sub(1);
    if k == 1 || last == 0 {
        return Thinned::default();
    }
    let points = &mut trace.points;
    let mut thinned = Thinned { used: vec![0], jumps: 0 };
    let (mut from, mut start) = (0, points[0]);
    while from < last {
        let to = last.min(from + k);
        let end = points[to];
        // From a wall's end it could lead to the other side of the walls that meet there.
        let is_clear = || model.is_clear(start, end) && model.vertex_at(start).is_none();
        let first = if to - from == 1 || is_clear() {
            to
        } else {
            thinned.jumps += 1;
            from + 1
        };
        for i in first..=to {
            // Never further along than where it comes from.
            points[thinned.used.len()] = points[i];
            thinned.used.push(i as u32);
        }
        (from, start) = (to, end);
    }
    points.truncate(thinned.used.len());
    if thinned.used.len() > last {
        thinned.used.clear();
    }
    thinned
}
