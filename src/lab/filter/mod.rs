//! How good the candidate pass is as a filter: what it names, and whether it misses anything.

mod trial;

use std::iter::Sum;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use crate::candidates::{Frame, Lists, MARGIN, Query, Simd, Slopes, Window};
use crate::engine::{Cpu, Engine, EngineError, FIRST_WINDOW, Job, WINDOW};
use crate::geometry::{higher, lower, orient};
use crate::rope::{TraceRecord, replay};
use crate::scene::Model;
use crate::trace::SettledTrace;

pub use trial::{QUERIES, Trial};

/// How a candidate pass did on some queries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Filter {
    /// How many queries it was asked.
    pub queries: u64,
    /// How many vertices it tried, over all queries.
    pub tried: u64,
    /// How many of them it named.
    pub named: u64,
    /// How many of those named lie in their query's triangle before it is grown, as far as f64 tells: the others were
    /// named in vain because f32 is trusted no further.
    pub covered: u64,
    /// How many of those tried lie in a triangle that the rope's last leg sweeps on one of the query's legs, exactly. A
    /// query of several legs covers more than these.
    pub inside: u64,
    /// How many of these it did not name.
    pub missed: u64,
}

impl Filter {
    /// Which share of the vertices named is outside their query's triangle, and named because of its margin; 0 where
    /// none was named.
    pub fn false_share(&self) -> f64 {
        if self.named == 0 { 0.0 } else { (self.named - self.covered) as f64 / self.named as f64 }
    }

    /// The queries of `traces`, in windows from event to event as engines fold them, each about the vertices that the
    /// pivot sees; without those that go on from the middle of a leg in which something happened. The traces keep to
    /// the rules, start at the anchor and touch no wall, as those of [`settled_walks`](crate::example::settled_walks)
    /// do. On all cores; every vertex tried is compared with every leg, exactly.
    ///
    /// # Errors
    ///
    /// What the engine `cpu` fails with.
    pub fn of_walks(model: &Arc<Model>, traces: &[SettledTrace]) -> Result<Filter, EngineError> {
        let records = Cpu::new(model.clone()).evaluate(traces, &Job::new())?;
        let lists = Lists::new(model.clone()).after(0);
        let all = traces.par_iter().zip(&records).map(|(trace, record)| of_walk(&lists, trace, record));
        Ok(all.collect::<Vec<_>>().into_iter().sum())
    }

    /// Counts one query in, with what is true of each vertex that was tried, and whether it was named.
    fn count(&mut self, vertices: impl Iterator<Item = (Truth, bool)>) {
        self.queries += 1;
        for (Truth { is_covered, is_inside }, is_named) in vertices {
            self.tried += 1;
            self.named += u64::from(is_named);
            self.covered += u64::from(is_named && is_covered);
            self.inside += u64::from(is_inside);
            self.missed += u64::from(is_inside && !is_named);
        }
    }
}

impl Sum for Filter {
    fn sum<I: Iterator<Item = Filter>>(filters: I) -> Filter {
        filters.fold(Filter::default(), |a, b| Filter {
            queries: a.queries + b.queries,
            tried: a.tried + b.tried,
            named: a.named + b.named,
            covered: a.covered + b.covered,
            inside: a.inside + b.inside,
            missed: a.missed + b.missed,
        })
    }
}

fn of_walk(lists: &Lists, trace: &SettledTrace, record: &TraceRecord) -> Filter {
    let (model, points) = (lists.model(), trace.points());
    let mut pivots = Vec::with_capacity(points.len());
    replay(model.anchor(), model.vertices(), points.len(), &record.events, |_, rope| {
        pivots.push(model.pivot(rope.contacts().last().map(|c| c.vertex)));
    });
    let mut happens = vec![false; points.len()];
    record.events.iter().for_each(|event| happens[event.step as usize] = true);
    let (mut at, mut width, mut filter, mut slopes) = (0, FIRST_WINDOW, Filter::default(), Slopes::default());
    while at + 1 < points.len() {
        let most = width.min(WINDOW).min(points.len() - 1 - at);
        let legs = (1..most).find(|leg| happens[at + leg]).unwrap_or(most);
        let at_pivot = model.position(pivots[at]);
        let asked = &points[at..=at + legs];
        let (legs, query) = asked_of(lists, at_pivot, asked, &mut slopes);
        let list = lists.of(pivots[at], f64::INFINITY).expect("lists are made at once");
        let mut named = Vec::new();
        Simd::detected().sweep(&list, &query, list.len(), &mut named);
        filter.count(list.numbers().map(|v| {
            let p = model.vertices()[v as usize];
            let is_inside = (0..legs).any(|leg| holds([at_pivot, asked[leg], asked[leg + 1]], p));
            (Truth { is_covered: covers(&query, lists.frame(), p), is_inside }, named.contains(&v))
        }));
        width = if happens[at + legs] { FIRST_WINDOW } else { 2 * width };
        at += legs;
    }
    filter
}

/// The query for the first of the legs between `points`, and how many these are.
fn asked_of(lists: &Lists, pivot: DVec2, points: &[DVec2], slopes: &mut Slopes) -> (usize, Query) {
    match Window::fold(Simd::detected(), pivot, None, points, slopes) {
        Some(window) => (window.legs, window.query(lists.frame(), pivot)),
        None => (1, Query::leg(lists.frame(), pivot, points[0], points[1])),
    }
}

/// What is true of a vertex and a query.
#[derive(Clone, Copy)]
struct Truth {
    is_covered: bool,
    is_inside: bool,
}

/// Whether the triangle of `query` holds `p` without its margin, to within rounding of the query.
fn covers(query: &Query, frame: &Frame, p: DVec2) -> bool {
    let p = frame.place(p);
    [query.right, query.left, query.far].into_iter().all(|half_plane| {
        let [x, y, offset] = half_plane.map(f64::from);
        x * p.x + y * p.y + offset >= MARGIN
    })
}

/// Whether `p` lies in the closed triangle, exactly. Where it has no area, that is the segment between its outermost
/// corners.
fn holds([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    let (low, high) = (lower(lower(a, b), c), higher(higher(a, b), c));
    if !(p.cmpge(low).all() && p.cmple(high).all()) {
        return false;
    }
    let sides = [orient(a, b, p), orient(b, c, p), orient(c, a, p)];
    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
}
