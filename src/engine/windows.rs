//! One trace evaluated window by window: asks a query for a window of legs, and goes on exactly once the candidates in
//! it are known.

use super::progress::Progress;
use crate::candidates::{Frame, LEGS, Line, Query, ROOM, Simd, Slopes, Window, Wrapping};
use crate::rope::TraceRecord;
use crate::scene::{Model, Pivot};
use crate::trace::SettledTrace;

/// The most legs that one query covers unless told otherwise: the exact update tries each candidate at each leg, so
/// longer windows gain little.
pub const WINDOW: usize = 256;

/// How many legs the first window of a trace covers at most, and the first after an event.
pub(crate) const FIRST_WINDOW: usize = 16;

/// How far a trace has come, and the window that was asked for last.
pub(super) struct Windows {
    pub(super) progress: Progress,
    /// How many legs the next window should have.
    width: usize,
    /// The window asked for; `None` for a single leg that spreads too far for one.
    window: Option<Window>,
    /// The point at which the window starts.
    first: usize,
    /// The lines that can be met in the window: first that of the unwrapping ray, if it is one, then those of
    /// candidates.
    lines: Vec<Wrapping>,
    /// How many of them are the unwrapping ray's.
    unwrappings: usize,
}

impl Windows {
    pub(super) fn new() -> Self {
        Windows {
            progress: Progress::new(),
            width: FIRST_WINDOW,
            window: None,
            first: 0,
            lines: Vec::new(),
            unwrappings: 0,
        }
    }

    /// Stands at the start of `trace`.
    pub(super) fn start(&mut self, model: &Model, trace: &SettledTrace) {
        self.progress.start(model, trace);
        self.width = FIRST_WINDOW;
    }

    /// The record of a trace that is done.
    pub(super) fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        self.progress.is_done(trace).then(|| self.progress.record(trace))
    }

    /// The settled point at which the free end stands.
    pub(super) fn at(&self) -> usize {
        self.progress.at
    }

    /// The rope's pivot.
    pub(super) fn pivot(&self, model: &Model) -> Pivot {
        model.pivot(self.progress.rope.contacts().last().map(|c| c.vertex))
    }

    /// The query for what comes next, of at most `most` legs; the trace is not done. Leaves the window's slopes in
    /// `slopes`.
    pub(super) fn ask(
        &mut self,
        frame: &Frame,
        trace: &SettledTrace,
        most: usize,
        simd: Simd,
        slopes: &mut Slopes,
    ) -> Query {
        self.first = self.progress.at;
        let points = &trace.points()[self.first..];
        let legs = self.width.min(most).min(points.len() - 1);
        let pivot = self.progress.rope.pivot();
        self.window = Window::fold(simd, pivot, self.progress.start_direction(), &points[..=legs], slopes);
        match &self.window {
            Some(window) => window.query(frame, pivot),
            None => Query::leg(frame, pivot, points[0], points[1]),
        }
    }

    /// The square of the greatest distance from the pivot in the window asked for last, in the scene's unit.
    pub(super) fn squared(&self, trace: &SettledTrace) -> f64 {
        let pivot = self.progress.rope.pivot();
        let leg = || trace.points()[self.first..=self.first + 1].iter().map(|a| a.distance_squared(pivot));
        self.window.map_or_else(|| leg().fold(0.0, f64::max), |window| window.squared)
    }

    /// Computes the last window's slopes anew, where those of [`ask`](Self::ask) were not kept.
    pub(super) fn recall(&self, trace: &SettledTrace, simd: Simd, slopes: &mut Slopes) {
        if let Some(window) = &self.window {
            let points = &trace.points()[self.first..=self.first + window.legs];
            Window::fold(simd, self.progress.rope.pivot(), self.progress.start_direction(), points, slopes);
        }
    }

    /// Whether it is certain without looking at its slopes that nothing happens in the window, if it has no candidates.
    pub(super) fn is_quiet(&self) -> bool {
        self.progress.start_direction().is_none()
            && self.window.is_some_and(|window| self.unwrapping(&window).is_none())
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
            self.progress.next(model, trace, candidates.iter().copied());
            return;
        };
        self.find_lines(model, &window, candidates);
        // Where the rope already turned on the first leg, its slopes do not say what is left of it.
        let turned = self.progress.start_direction().is_some();
        // Up to point `looked` the rope has been measured.
        let mut looked = 0;
        for from in (0..window.legs).step_by(LEGS) {
            let legs = LEGS.min(window.legs - from);
            simd.meet(&mut self.lines, slopes, from, legs);
            let mut met = self.lines.iter().fold(u64::from(turned && from == 0), |met, line| met | line.met);
            met &= (1 << legs) - 1;
            while met != 0 {
                let bit = met & met.wrapping_neg();
                let leg = from + bit.trailing_zeros() as usize;
                met ^= bit;
                if leg > looked {
                    self.progress.skip(trace, self.first + leg, || simd.farthest(slopes, looked + 1, leg));
                }
                let tried =
                    self.lines[self.unwrappings..].iter().filter(|line| line.met & bit != 0 || turned && leg == 0);
                if self.progress.next(model, trace, tried.map(|line| line.vertex)).is_some() {
                    self.width = FIRST_WINDOW.max(leg);
                    return;
                }
                looked = leg + 1;
            }
        }
        if window.legs > looked {
            self.progress.skip(trace, self.first + window.legs, || simd.farthest(slopes, looked + 1, window.legs));
        }
        self.adapt(&window, candidates.len());
    }

    /// Goes on to the end of a window that [`is_quiet`](Self::is_quiet) and has no candidates.
    pub(super) fn pass_by(&mut self, trace: &SettledTrace) {
        if let Some(window) = self.window {
            self.progress.skip(trace, self.first + window.legs, || window.squared);
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
        while self.progress.at < end {
            self.progress.next(model, trace, 0..model.vertices().len() as u32);
        }
    }

    /// Fills `lines` with the unwrapping ray's, if it can be met, and then the candidates'.
    fn find_lines(&mut self, model: &Model, window: &Window, candidates: &[u32]) {
        let pivot = self.progress.rope.pivot();
        self.lines.clear();
        self.lines.extend(self.unwrapping(window).map(|line| Wrapping::new(0, line)));
        self.unwrappings = self.lines.len();
        self.lines.extend(candidates.iter().filter_map(|&vertex| {
            let line = window.wrapping(model.vertices()[vertex as usize] - pivot)?;
            Some(Wrapping::new(vertex, line))
        }));
    }

    /// The line of the unwrapping ray, if it can pass through the window.
    fn unwrapping(&self, window: &Window) -> Option<Line> {
        let rope = &self.progress.rope;
        if rope.contacts().is_empty() {
            return None;
        }
        window.unwrapping(rope.pivot() - rope.prior())
    }
}
