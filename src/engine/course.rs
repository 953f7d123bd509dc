//! One trace evaluated window by window: asks a query for a window of legs, and goes on exactly once the candidates in it
//! are known.

use super::walk::Walk;
use crate::candidates::{Frame, Line, Query, ROOM, Simd, Slopes, Window};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many legs the first window of a trace covers at most, and the first after an event.
const FIRST_WINDOW: usize = 16;

/// How far a trace has come, and the window that was asked for last.
pub(super) struct Course {
    walk: Walk,
    /// How many legs the next window should have.
    width: usize,
    /// The window asked for; `None` for a single leg that spreads too far for one.
    window: Option<Window>,
    /// The point at which the window starts.
    first: usize,
    /// The candidates that can be wrapped in the window.
    lines: Vec<Wrapping>,
}

impl Course {
    pub(super) fn new() -> Self {
        Course { walk: Walk::new(), width: FIRST_WINDOW, window: None, first: 0, lines: Vec::new() }
    }

    /// Stands at the start of `trace`.
    pub(super) fn start(&mut self, model: &Model, trace: &SettledTrace) {
        self.walk.start(model, trace);
        self.width = FIRST_WINDOW;
    }

    /// The record of a trace that is done.
    pub(super) fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        self.walk.is_done(trace).then(|| self.walk.record(trace))
    }

    /// The settled point at which the free end stands.
    pub(super) fn at(&self) -> usize {
        self.walk.at
    }

    /// The rope's pivot: a vertex, or their number for the anchor.
    pub(super) fn pivot(&self, model: &Model) -> u32 {
        self.walk.rope.contacts().last().map_or(model.vertices().len() as u32, |c| c.vertex)
    }

    /// The query for what comes next, of at most `most` legs; the trace is not done. Leaves the window's slopes in `slopes`.
    pub(super) fn ask(
        &mut self,
        frame: &Frame,
        trace: &SettledTrace,
        most: usize,
        simd: Simd,
        slopes: &mut Slopes,
    ) -> Query {
        self.first = self.walk.at;
        let points = &trace.points()[self.first..];
        let legs = self.width.min(most).min(points.len() - 1);
        let pivot = self.walk.rope.pivot();
        self.window = Window::fold(simd, pivot, self.walk.start_direction(), &points[..=legs], slopes);
        match &self.window {
            Some(window) => window.query(frame, pivot),
            None => Query::leg(frame, pivot, points[0], points[1]),
        }
    }

    /// Computes the last window's slopes anew, where those of [`ask`](Self::ask) were not kept.
    pub(super) fn recall(&self, trace: &SettledTrace, simd: Simd, slopes: &mut Slopes) {
        if let Some(window) = &self.window {
            let points = &trace.points()[self.first..=self.first + window.legs];
            Window::fold(simd, self.walk.rope.pivot(), self.walk.start_direction(), points, slopes);
        }
    }

    /// Whether it is certain without looking at its slopes that nothing happens in the window, if it has no candidates.
    pub(super) fn is_quiet(&self) -> bool {
        self.walk.start_direction().is_none() && self.window.is_some_and(|window| self.unwrapping(&window).is_none())
    }

    /// Asks for fewer legs next time, since the window held too many candidates; false if there are no fewer.
    pub(super) fn narrow(&mut self) -> bool {
        let legs = self.window.map_or(1, |w| w.legs);
        self.width = 1.max(legs / 4);
        legs > 1
    }

    /// Goes on through the window, whose only candidates are these, to its end or its first event.
    pub(super) fn go_on(
        &mut self,
        model: &Model,
        trace: &SettledTrace,
        candidates: &[u32],
        simd: Simd,
        slopes: &Slopes,
    ) {
        let Some(window) = self.window else {
            self.walk.next(model, trace, candidates.iter().copied());
            return;
        };
        let mut unwrapping = self.unwrapping(&window).map(|line| (line, 0));
        let pivot = self.walk.rope.pivot();
        self.lines.clear();
        self.lines.extend(candidates.iter().filter_map(|&vertex| {
            let line = window.wrapping(model.vertices()[vertex as usize] - pivot)?;
            Some(Wrapping { vertex, line, met: 0 })
        }));
        // Where the rope already turned on the first leg, the slopes do not say what is left of it.
        let turned = self.walk.start_direction().is_some();
        let first_met = |line: Line, leg| line.first_met(simd, slopes, leg, window.legs);
        if !turned {
            unwrapping.iter_mut().for_each(|(line, met)| *met = first_met(*line, 0));
            self.lines.iter_mut().for_each(|w| w.met = first_met(w.line, 0));
        }
        // All legs before `leg` are over; up to point `looked` the rope has been measured.
        let (mut leg, mut looked) = (0, 0);
        loop {
            if leg > 0 || !turned {
                let met = unwrapping.iter().map(|(_, met)| *met).chain(self.lines.iter().map(|w| w.met));
                leg = met.fold(window.legs, usize::min);
            }
            if leg == window.legs {
                break;
            }
            let tried = self.lines.iter().filter(|w| w.line.meets(slopes, leg)).map(|w| w.vertex);
            let happens = (turned && leg == 0)
                || unwrapping.is_some_and(|(line, _)| line.meets(slopes, leg))
                || tried.clone().next().is_some();
            if happens {
                if leg > looked {
                    self.walk.skip(trace, self.first + leg, || slopes.farthest(simd, looked + 1, leg));
                }
                if self.walk.next(model, trace, tried).is_some() {
                    self.width = FIRST_WINDOW.max(leg);
                    return;
                }
                looked = leg + 1;
            }
            leg += 1;
            unwrapping.iter_mut().filter(|u| u.1 < leg).for_each(|(line, met)| *met = first_met(*line, leg));
            self.lines.iter_mut().filter(|w| w.met < leg).for_each(|w| w.met = first_met(w.line, leg));
        }
        if leg > looked {
            self.walk.skip(trace, self.first + leg, || slopes.farthest(simd, looked + 1, leg));
        }
        self.adapt(&window, candidates.len());
    }

    /// Goes on to the end of a window that [`is_quiet`](Self::is_quiet) and has no candidates.
    pub(super) fn pass_by(&mut self, trace: &SettledTrace) {
        if let Some(window) = self.window {
            self.walk.skip(trace, self.first + window.legs, || window.squared);
            self.adapt(&window, 0);
        }
    }

    /// Widens the windows while little is found, narrows them when much is.
    fn adapt(&mut self, window: &Window, candidates: usize) {
        if candidates > ROOM / 2 {
            self.width = 1.max(window.legs / 2);
        } else if window.legs == self.width {
            self.width *= 2;
        }
    }

    /// Goes on to the window's end with all vertices, as the reference does.
    pub(super) fn try_all(&mut self, model: &Model, trace: &SettledTrace) {
        let end = self.first + self.window.map_or(1, |w| w.legs);
        while self.walk.at < end {
            self.walk.next(model, trace, 0..model.vertices().len() as u32);
        }
    }

    /// The line of the unwrapping ray, if it can pass through the window.
    fn unwrapping(&self, window: &Window) -> Option<Line> {
        let rope = &self.walk.rope;
        if rope.contacts().is_empty() {
            return None;
        }
        window.unwrapping(rope.pivot() - rope.prior())
    }
}

/// A vertex that the rope can be wrapped round in a window.
struct Wrapping {
    vertex: u32,
    /// The line that the free end must cross.
    line: Line,
    /// The next leg on which it may.
    met: usize,
}
