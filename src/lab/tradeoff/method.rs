//! What is compared: every way to turn traces into ropes.

use std::sync::Arc;

use crate::engine::{Engine, EngineError, EngineKind, Promise};
use crate::lab::bench::{CPU, Contender, FAST, FUNNEL, FUNNEL_FINAL, GPU, Gear, NOTE, NOTE_FURTHEST, REFERENCE};
use crate::scene::Model;

/// A way to turn traces into ropes.
#[derive(Clone, Copy)]
pub struct Method {
    /// Its name in reports.
    pub name: &'static str,
    contender: Contender,
}

impl Method {
    /// All methods, in the order of the report.
    pub const ALL: [Method; 8] = [
        Method { name: "gpu certified", contender: GPU },
        Method { name: "gpu fast", contender: FAST },
        Method { name: "cpu certified", contender: CPU },
        Method { name: "funnel, every step", contender: FUNNEL },
        Method { name: "funnel, final rope", contender: FUNNEL_FINAL },
        Method { name: "note, listing 1", contender: NOTE },
        Method { name: "note, furthest", contender: NOTE_FURTHEST },
        Method { name: "reference", contender: REFERENCE },
    ];

    /// Those with one of `engines`, or all where none is given.
    pub fn of(engines: &[&EngineKind]) -> Vec<Method> {
        let asked = |m: &Method| engines.is_empty() || engines.contains(&m.engine());
        Self::ALL.into_iter().filter(asked).collect()
    }

    /// The engine.
    pub fn engine(&self) -> &'static EngineKind {
        self.contender.engine
    }

    /// Whether it cannot do without a GPU.
    pub fn needs_gpu(&self) -> bool {
        self.contender.needs_gpu()
    }

    /// Whether it is what the others are compared with.
    pub(super) fn is_truth(&self) -> bool {
        self.contender.engine == REFERENCE.engine
    }

    /// Whether it writes down what happens on the way.
    pub(super) fn has_events(&self) -> bool {
        self.contender.has_events()
    }

    /// Whether it promises the reference's events.
    pub(super) fn promises_events(&self) -> bool {
        self.contender.promise() == Promise::Events
    }

    /// Whether it promises the reference's taut ropes.
    pub(super) fn promises_ropes(&self) -> bool {
        self.contender.promise() != Promise::Nothing
    }

    /// Whether it evaluates many traces at once.
    pub(super) fn takes_many(&self) -> bool {
        self.contender.engine.takes_many()
    }

    /// Makes the engine for `model`; `None` if it needs a GPU and there is none.
    pub(super) fn open(&self, model: Arc<Model>, gear: &Gear) -> Result<Option<Box<dyn Engine>>, EngineError> {
        self.contender.open(model, gear)
    }
}
