//! The rope after every step, out of a trace's one replay.

use glam::DVec2;

use super::replay::Replay;
use super::stack::LastLeg;
use super::strain::Straining;
use super::{Friction, Rope, Rounds, Strain, TraceRecord};
use crate::scene::{Centre, Model};
use crate::trace::SettledTrace;

/// The rope after a step. Lengths are in the scene's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeStep {
    /// The step: the move from point `step - 1` to point `step`; 0 is the move from the anchor to the first point.
    pub step: u64,
    /// Where the free end is after it.
    pub at: DVec2,
    /// The taut rope's length.
    pub length: f64,
    /// The number of contacts, those included that the rope passes straight or ends on.
    pub contacts: u32,
    /// The number of turns: contacts at which the taut rope bends.
    pub turns: u32,
    /// The unit vector along which the rope pulls the free end; `None` for a rope of no length.
    pub pull: Option<DVec2>,
}

/// The rope after every step of a trace, in order: one more than it has steps. After a step that was left out for speed
/// the free end still is where it was.
///
/// O(points + events) in all, and O(1) for each point and centre; memory for one rope.
///
/// ```
/// use std::sync::Arc;
/// use tautline::engine::{Cpu, Engine, Job};
/// use tautline::rope::Steps;
/// use tautline::scene::{Centre, Model, Scene};
/// use tautline::trace::{Trace, settle};
///
/// let scene = Scene::new([[[0.0, 0.0].into(), [1.0, 0.0].into()]])?;
/// let model = Arc::new(Model::new(scene, Some([0.5, -1.0].into()))?);
/// let round = [[0.5, -1.0], [2.0, 0.0], [0.5, 1.0], [-1.0, 0.0], [0.5, -1.0]].map(Into::into).to_vec();
/// let trace = settle(&model, &Trace { id: 0, points: round });
/// let record = Cpu::new(model.clone()).evaluate(std::slice::from_ref(&trace), &Job::new())?.remove(0);
///
/// let wall = Centre { name: "wall".into(), vertex: 0 };
/// let mut steps = Steps::new(&model, &trace, &record, &[wall]);
/// let mut turns = vec![];
/// while let Some(step) = steps.next() {
///     turns.push((step.turns, steps.windings().next()));
/// }
/// assert_eq!(turns, [(0, Some(0)), (0, Some(0)), (1, Some(0)), (1, Some(0)), (2, Some(1))]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Steps<'a> {
    trace: &'a SettledTrace,
    replay: Replay<'a>,
    rope: Rope,
    leg: LastLeg,
    rounds: Vec<Rounds>,
    y_down: bool,
    /// Where friction is asked for.
    straining: Option<Straining>,
    /// The settled point to which the free end goes next.
    point: usize,
    /// Where it was after the last step that was walked, and the next step that is walked.
    at: DVec2,
    walked: usize,
    /// The next step that is told.
    next: usize,
}

impl<'a> Steps<'a> {
    /// Of `trace` in `model`, with the events of its `record`; turns are counted about each of `centres`.
    ///
    /// # Panics
    ///
    /// If a centre is no wall end of the scene; later on, if the events are not a rope's: a vertex that is not there,
    /// or an unwrap of an empty rope.
    pub fn new(model: &'a Model, trace: &'a SettledTrace, record: &'a TraceRecord, centres: &[Centre]) -> Self {
        let rope = Rope::new(model.anchor());
        let rounds = centres.iter().map(|centre| Rounds::about(model.vertices()[centre.vertex as usize])).collect();
        let replay = Replay::new(model.vertices(), &record.events);
        let y_down = model.scene().y_down();
        let (leg, at) = (rope.last_leg(), model.anchor());
        let straining = None;
        let mut steps = Steps { trace, replay, rope, leg, rounds, y_down, straining, point: 0, at, walked: 0, next: 0 };
        steps.look_ahead();
        steps
    }

    /// The same with the [`strain`](Self::strain) of the rope, if there is friction. To be asked before the first step.
    #[must_use]
    pub fn with_friction(mut self, friction: Option<Friction>) -> Self {
        self.straining = friction.map(Straining::new);
        self
    }

    /// The rope after the next step; `None` after the last. O(1) but for events, and for points that were added within
    /// the step.
    #[allow(clippy::should_implement_trait)] // what is counted about the centres is asked in between
    #[inline]
    pub fn next(&mut self) -> Option<RopeStep> {
        if self.next == self.walked {
            if self.point == self.trace.points().len() {
                return None;
            }
            self.walk();
        }
        let (length, turns, pull) = self.leg.look(self.at);
        let step = self.next as u64;
        self.next += 1;
        let contacts = self.rope.contacts().len() as u32;
        Some(RopeStep { step, at: self.at, length, contacts, turns, pull })
    }

    /// How often the free end has gone all the way round each of the centres since the trace began, after the step that
    /// was told last: counter-clockwise as a picture shows it counts as positive, clockwise as negative, and going back
    /// takes back.
    pub fn windings(&self) -> impl Iterator<Item = i64> + use<'_, 'a> {
        self.rounds.iter().map(|rounds| if self.y_down { -rounds.whole() } else { rounds.whole() })
    }

    /// What friction makes of the rope after the step that was told last; `None` where it was not
    /// [asked for](Self::with_friction). O(1).
    pub fn strain(&self) -> Option<Strain> {
        self.straining.as_ref().map(|straining| straining.look(&self.rope, self.at))
    }

    /// Walks to the end of the next step that has not been left out.
    fn walk(&mut self) {
        let step = self.walked;
        let mut happened = false;
        if let Some(straining) = &mut self.straining {
            let ends_step = |&point: &usize| self.trace.ends_step(point);
            let end = (self.point..self.trace.points().len()).find(ends_step).expect("a step ends");
            let ends = [self.at, self.trace.points()[end]];
            happened = straining.walk(&mut self.replay, &mut self.rope, step, ends);
        }
        while self.replay.due(step).is_some() {
            self.replay.play(&mut self.rope);
            happened = true;
        }
        if happened {
            self.leg = self.rope.last_leg();
        }
        loop {
            let point = self.point;
            if !self.rounds.is_empty() {
                let to = self.trace.point(point);
                self.rounds.iter_mut().for_each(|rounds| rounds.go_on(to));
            }
            self.point += 1;
            if self.trace.ends_step(point) {
                self.at = self.trace.points()[point];
                break;
            }
        }
        self.look_ahead();
    }

    /// Finds the next step that is walked; past the last there is none to be told.
    fn look_ahead(&mut self) {
        let is_there = self.point < self.trace.points().len();
        self.walked = if is_there { self.trace.step(self.point) } else { self.walked + 1 };
    }
}
