//! The class of a rope on its way.

use std::collections::VecDeque;

use super::classes::Node;
use super::{Class, Classes};
use crate::geometry::TracePoint;
use crate::rope::{EventKind, Status, TraceRecord};
use crate::trace::SettledTrace;

/// For how many of the last contacts the word up to them is kept.
const KEPT: usize = 64;

/// A rope under way, with its words up to the last contacts, so that a step costs no more than its last leg.
struct Way<'a> {
    classes: &'a Classes,
    nodes: Vec<Node>,
    /// Up to each of the last nodes; up to the anchor there is none.
    words: VecDeque<Class>,
}

impl Way<'_> {
    /// A contact has been pushed.
    fn wrapped(&mut self, end: TracePoint) {
        let mut word = match self.words.back() {
            Some(word) => word.clone(),
            None => self.classes.begin(&self.nodes, end),
        };
        self.classes.reach(&mut word, &self.nodes);
        self.keep(word);
    }

    /// A contact has been popped.
    fn unwrapped(&mut self, end: TracePoint) {
        self.words.pop_back();
        if self.words.is_empty() && self.nodes.len() > 1 {
            let mut word = self.classes.begin(&self.nodes, end);
            for n in 2..=self.nodes.len() {
                self.classes.reach(&mut word, &self.nodes[..n]);
                if n + KEPT > self.nodes.len() {
                    self.keep(word.clone());
                }
            }
        }
    }

    fn keep(&mut self, word: Class) {
        self.words.push_back(word);
        if self.words.len() > KEPT {
            self.words.pop_front();
        }
    }

    fn class(&self, end: TracePoint) -> Class {
        let mut class = self.words.back().cloned().unwrap_or_else(|| self.classes.begin(&self.nodes, end));
        self.classes.finish(&mut class, &self.nodes, end);
        class
    }
}

/// A step with which the class of a rope becomes another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClassChange {
    /// The step: the move from point `step - 1` to point `step`; 0 is the move from the anchor to the first point.
    pub step: u64,
    /// The class after it.
    pub class: Class,
}

impl Classes {
    /// The class of a trace's rope after its first step, and after each step after which it is another than after the
    /// one before; `None` if the trace crosses a wall. Steps that were left out for speed are not looked at. For each
    /// step and event O(letters + obstacles in the columns over which the rope's last leg goes); memory for 64 words.
    ///
    /// # Panics
    ///
    /// As [`of_record`](Self::of_record).
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tautline::engine::{Cpu, Engine, Job};
    /// use tautline::homotopy::Classes;
    /// use tautline::scene::{Model, Scene};
    /// use tautline::trace::{Trace, settle};
    ///
    /// let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
    /// let model = Arc::new(Model::new(scene, Some([0.0, -1.0].into()))?);
    /// let points = [[0.0, -2.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0], [3.0, 2.0]].map(Into::into).to_vec();
    /// let trace = settle(&model, &Trace { id: 0, points });
    /// let record = Cpu::new(model.clone()).evaluate(std::slice::from_ref(&trace), &Job::new())?.remove(0);
    ///
    /// let changes = Classes::new(&model).changes(&trace, &record).expect("no wall is crossed");
    /// let changes: Vec<_> = changes.into_iter().map(|change| (change.step, change.class.to_string())).collect();
    /// assert_eq!(changes, [(0, "e".to_owned()), (3, "o0".to_owned()), (4, "e".to_owned())]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn changes(&self, trace: &SettledTrace, record: &TraceRecord) -> Option<Vec<ClassChange>> {
        if record.status == Status::Violation {
            return None;
        }
        let mut way = Way { classes: self, nodes: self.tied(std::iter::empty()), words: VecDeque::new() };
        let mut events = record.events.iter().peekable();
        let mut changes: Vec<ClassChange> = Vec::new();
        for point in (0..trace.points().len()).filter(|&point| trace.ends_step(point)) {
            let (step, end) = (trace.step(point), trace.point(point));
            while let Some(event) = events.next_if(|event| event.step as usize <= step) {
                self.play(&mut way.nodes, event);
                match event.kind {
                    EventKind::Wrap => way.wrapped(end),
                    EventKind::Unwrap => way.unwrapped(end),
                }
            }
            let class = way.class(end);
            if changes.last().is_none_or(|last| last.class != class) {
                changes.push(ClassChange { step: step as u64, class });
            }
        }
        Some(changes)
    }
}
