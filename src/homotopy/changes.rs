//! The class of a rope on its way.

use super::{Class, Classes};
use crate::rope::{Status, TraceRecord};
use crate::trace::SettledTrace;

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
    /// one before; `None` if the trace crosses a wall. Steps that were left out for speed are not looked at. O(events),
    /// and as [`of`](Self::of) for each step.
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
        let mut nodes = self.tied(std::iter::empty());
        let mut events = record.events.iter().peekable();
        let mut changes: Vec<ClassChange> = Vec::new();
        for point in (0..trace.points().len()).filter(|&point| trace.ends_step(point)) {
            let step = trace.step(point);
            while let Some(event) = events.next_if(|event| event.step as usize <= step) {
                self.play(&mut nodes, event);
            }
            let class = self.of_nodes(&nodes, trace.point(point));
            if changes.last().is_none_or(|last| last.class != class) {
                changes.push(ClassChange { step: step as u64, class });
            }
        }
        Some(changes)
    }
}
