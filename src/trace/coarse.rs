//! Coarser traces: straight from every k-th point to the next.

use super::settle_owned;
use super::settled::Coarse;
use super::{SettledTrace, Trace};
use crate::scene::Model;

impl SettledTrace {
    /// The trace on coarser terms: straight from every `k`-th of its points to the next, and to the last, among the
    /// walls of `model`, which has the anchor for which the trace was settled. Its scene is that of the trace, or one
    /// that was [simplified](crate::simplify::simplify()) from it.
    ///
    /// Where a longer step would touch a wall, the trace is followed point by point instead, and that is
    /// [counted](Self::jumps). So a trace that keeps to the rules still does, but for simplified walls that are in its
    /// way: these steps are counted [as well](Self::crossings). What the trace does against the rules [as it was
    /// given](Self::violation) is kept, in steps that are left out, too.
    ///
    /// Steps keep their numbers: what happens on a longer step is said of the last of those that it stands for. What
    /// the trace went round between the points is passed straight, so a wall that lies there is passed on the other
    /// side if the longer step does not touch it.
    ///
    /// O(points + walls near the longer steps and those that are followed), through the model's index.
    ///
    /// ```
    /// use tautline::scene::{Model, Scene};
    /// use tautline::trace::{Trace, settle};
    ///
    /// // Over the end of a wall, whose lower part is in the way of a longer step.
    /// let model = Model::new(Scene::new([[[2.5, -9.0].into(), [2.5, 1.6].into()]])?, Some([0.0, 0.0].into()))?;
    /// let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 2.0], [4.0, 0.0], [5.0, 0.0]].map(Into::into).to_vec();
    /// let coarse = settle(&model, &Trace { id: 0, points }).coarsened(&model, 2);
    /// let at: Vec<_> = coarse.points().iter().map(|p| p.x).collect();
    /// assert_eq!((at, coarse.jumps()), (vec![0.0, 2.0, 3.0, 4.0, 5.0], 1));
    /// assert_eq!((coarse.step(2), coarse.steps()), (3, 5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If `k` is 0, or if the trace was coarsened before and has lost points.
    #[must_use]
    pub fn coarsened(self, model: &Model, k: usize) -> SettledTrace {
        assert!(k > 0, "a stride is at least 1");
        assert!(!self.is_thinned(), "a trace is coarsened once");
        let SettledTrace { id, mut points, added, broken, walked, .. } = self;
        let mut added = added.into_iter().peekable();
        let mut i = 0;
        points.retain(|_| {
            i += 1;
            added.next_if_eq(&(i - 1)).is_none()
        });
        let mut coarse =
            Coarse { still: points.windows(2).filter(|pair| pair[0] == pair[1]).count(), ..Coarse::default() };
        if k > 1 && points.len() > 1 {
            thin(model, &mut points, k, &mut coarse);
        }
        let mut settled = settle_owned(model, Trace { id, points });
        coarse.crossings = settled.violations();
        settled.broken = broken;
        settled.coarse = coarse;
        settled.walked = walked;
        settled
    }
}

/// Leaves out of the points, of which there are two or more, what `k` says, and notes it.
fn thin(model: &Model, points: &mut Vec<glam::DVec2>, k: usize, coarse: &mut Coarse) {
    let last = points.len() - 1;
    coarse.used.push(0);
    let (mut from, mut start) = (0, points[0]);
    while from < last {
        let to = last.min(from + k);
        let end = points[to];
        // From a wall it could lead to the other side of the walls that meet there.
        let is_clear = || model.is_clear(start, end) && !model.is_on_wall(start);
        let first = if to - from == 1 || is_clear() {
            to
        } else {
            coarse.jumps += 1;
            from + 1
        };
        for i in first..=to {
            // Never further along than where it comes from.
            points[coarse.used.len()] = points[i];
            coarse.used.push(i as u32);
        }
        (from, start) = (to, end);
    }
    points.truncate(coarse.used.len());
    if coarse.used.len() > last {
        coarse.used.clear();
    }
}
