//! The table of what is measured against each other: one line a row of the report.

use std::sync::Arc;

use crate::engine::{self, Engine, EngineError, EngineKind, Funnel, Note, Options, Precision, Promise};
use crate::fast::MOST_LEGS;
use crate::gpu::Device;
use crate::scene::Model;

/// An engine in one of its variants.
#[derive(Clone, Copy)]
pub struct Contender {
    /// Which engine.
    pub engine: &'static EngineKind,
    /// How it is used, in a few words.
    pub variant: &'static str,
    shape: Shape,
}

/// What engines run on.
#[derive(Clone)]
pub struct Gear {
    /// The GPU; contenders that need one are left out if there is none.
    pub device: Option<Device>,
    /// The most legs that one query covers, at least 1.
    pub window: usize,
}

/// How a contender's engine is made.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    /// As the table has it, in this precision, with the widest window of the gear.
    Usual(Precision),
    /// The funnel that knows the rope at the end only.
    FinalOnly,
    /// The note with its remedy for walls on one line.
    Furthest,
}

const fn usual(engine: &'static EngineKind, variant: &'static str) -> Contender {
    Contender { engine, variant, shape: Shape::Usual(Precision::Certified) }
}

/// The product: traces are taken along on the GPU.
pub(in crate::lab) const GPU: Contender = usual(&engine::GPU, "resident");

/// A candidate pass on the GPU over windows of steps.
pub(in crate::lab) const GPU_WINDOWS: Contender = usual(&engine::GPU_WINDOWS, "windows");

/// The same on threads.
pub(in crate::lab) const CPU: Contender = usual(&engine::CPU, "windows");

/// The note's method as it is written: one test a vertex and step.
pub(in crate::lab) const GPU_RAYS: Contender = usual(&engine::GPU_RAYS, "all vertices");

/// The product in a hurry.
pub(in crate::lab) const FAST: Contender =
    Contender { engine: &engine::GPU, variant: "fast, windows", shape: Shape::Usual(Precision::Fast) };

/// The other method, which knows the rope after every step.
pub(in crate::lab) const FUNNEL: Contender = usual(&engine::FUNNEL, "every step");

/// The other method, which knows the rope at the end only.
pub(in crate::lab) const FUNNEL_FINAL: Contender =
    Contender { engine: &engine::FUNNEL, variant: "final rope only", shape: Shape::FinalOnly };

/// The baseline.
pub(in crate::lab) const NOTE: Contender = usual(&engine::NOTE, "listing 1");

/// The baseline with the note's remedy for walls on one line.
pub(in crate::lab) const NOTE_FURTHEST: Contender =
    Contender { engine: &engine::NOTE, variant: "furthest", shape: Shape::Furthest };

/// The arbiter.
pub(in crate::lab) const REFERENCE: Contender = usual(&engine::REFERENCE, "one by one");

/// All contenders of a bench, in the order of the report. The baseline is one of them.
pub const CONTENDERS: [Contender; 9] = [GPU, CPU, GPU_WINDOWS, GPU_RAYS, FAST, FUNNEL, FUNNEL_FINAL, NOTE, REFERENCE];

impl Contender {
    /// What all others are compared with.
    pub const BASELINE: Contender = NOTE;

    /// Those with one of `engines`, or all where none is given. Of a sweep over windows only those that have them, and
    /// the baseline.
    pub fn of(engines: &[&EngineKind], is_over_windows: bool) -> Vec<Contender> {
        let asked = |c: &Contender| engines.is_empty() || engines.contains(&c.engine);
        let fits = |c: &Contender| !is_over_windows || c.is_windowed() || c.is_baseline();
        CONTENDERS.into_iter().filter(|c| asked(c) && fits(c)).collect()
    }

    /// The engine and its variant, as messages name them.
    pub fn name(&self) -> String {
        format!("{} ({})", self.engine.name, self.variant)
    }

    /// Whether the widest window changes what it does.
    pub fn is_windowed(&self) -> bool {
        self.engine.asks && !self.asks_cpu()
    }

    /// Whether a device takes its traces along, and the CPU decides what that is not certain of.
    pub fn asks_cpu(&self) -> bool {
        self.engine == GPU.engine && self.decides() == Precision::Certified
    }

    /// The most legs that one of its queries covers if the setting allows `legs`; `None` if that changes nothing.
    pub fn window(&self, legs: usize) -> Option<usize> {
        let most = if self.decides() == Precision::Fast { MOST_LEGS } else { usize::MAX };
        self.is_windowed().then_some(legs.min(most))
    }

    /// Whether this is what all others are compared with.
    pub fn is_baseline(&self) -> bool {
        self.engine == Self::BASELINE.engine
    }

    /// Whether it cannot do without a GPU.
    pub fn needs_gpu(&self) -> bool {
        self.engine.needs_gpu()
    }

    /// Whether it writes down what happens on the way.
    pub(in crate::lab) fn has_events(&self) -> bool {
        self.shape != Shape::FinalOnly
    }

    /// What its results must agree with.
    pub(in crate::lab) fn promise(&self) -> Promise {
        self.engine.promise(self.decides())
    }

    /// `certified` for engines whose ropes are exact, `fast` for the GPU that trusts f32, `f64` for the note's listing.
    pub fn precision(&self) -> &'static str {
        if self.engine.precisions.is_empty() { "f64" } else { self.decides().name() }
    }

    fn decides(&self) -> Precision {
        if let Shape::Usual(precision) = self.shape { precision } else { Precision::Certified }
    }

    /// Makes the engine for `model`; `None` if it needs a GPU and there is none.
    pub(in crate::lab) fn open(&self, model: Arc<Model>, gear: &Gear) -> Result<Option<Box<dyn Engine>>, EngineError> {
        let options = match self.shape {
            Shape::Usual(precision) => Options { precision, window: gear.window, ..Options::default() },
            Shape::FinalOnly => return Ok(Some(Box::new(Funnel::new(model).final_only()))),
            Shape::Furthest => return Ok(Some(Box::new(Note::new(model).furthest()))),
        };
        match self.engine.open(model, gear.device.clone(), &options) {
            Ok(opened) => Ok(Some(opened.engine)),
            Err(EngineError::NoDevice { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}
