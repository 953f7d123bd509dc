//! The table of what is measured against each other: one line a row of the report.

use std::sync::Arc;

use crate::engine::{Cpu, Engine, EngineError, FastGpu, Funnel, Gpu, Note, Precision, Reference};
use crate::fast::MOST_LEGS;
use crate::gpu::Device;
use crate::scene::Model;

/// An engine in one of its variants.
#[derive(Clone, Copy)]
pub struct Contender {
    /// The engine's name, as the command line knows it.
    pub engine: &'static str,
    /// How it is used, in a few words.
    pub variant: &'static str,
    /// What its results must agree with.
    pub(in crate::report) promise: Promise,
    /// Whether the widest window changes what it does.
    pub windowed: bool,
    open: Open,
}

/// What engines run on.
#[derive(Clone)]
pub struct Gear {
    /// The GPU; contenders that need one are left out if there is none.
    pub device: Option<Device>,
    /// The most legs that one query covers, at least 1.
    pub window: usize,
}

/// What a contender's results must agree with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report) enum Promise {
    /// Every record is that of the reference, event for event.
    Events,
    /// The taut rope at the end is the reference's; events may differ.
    Ropes,
    /// Nothing: its ropes may be wrong, and how many are is reported.
    Nothing,
}

/// How a contender's engine is made.
#[derive(Clone, Copy)]
enum Open {
    /// On a GPU.
    Gpu(fn(Gpu, usize) -> Gpu),
    /// On a GPU that decides alone.
    FastGpu,
    /// On all cores.
    Threads(fn(Arc<Model>, usize) -> Box<dyn Engine>),
    /// On one thread.
    Thread(fn(Arc<Model>) -> Box<dyn Engine>),
}

/// The product: a candidate pass on the GPU over windows of steps.
pub(in crate::report) const GPU: Contender = Contender {
    engine: "gpu",
    variant: "windows",
    promise: Promise::Events,
    windowed: true,
    open: Open::Gpu(|gpu, window| gpu.window(window)),
};

/// The same on threads.
pub(in crate::report) const CPU: Contender = Contender {
    engine: "cpu",
    variant: "windows",
    promise: Promise::Events,
    windowed: true,
    open: Open::Threads(|model, window| Box::new(Cpu::new(model).window(window))),
};

/// The shape of the note's method: one test a vertex and step.
const GPU_ALL: Contender = Contender {
    engine: "gpu",
    variant: "window 1, all vertices",
    promise: Promise::Events,
    windowed: false,
    open: Open::Gpu(|gpu, _| gpu.window(1).keep_all()),
};

/// The product in a hurry.
pub(in crate::report) const FAST: Contender = Contender {
    engine: "gpu",
    variant: "fast, windows",
    promise: Promise::Nothing,
    windowed: true,
    open: Open::FastGpu,
};

/// The other method, which knows the rope after every step.
pub(in crate::report) const FUNNEL: Contender = Contender {
    engine: "funnel",
    variant: "every step",
    promise: Promise::Ropes,
    windowed: false,
    open: Open::Threads(|model, _| Box::new(Funnel::new(model))),
};

/// The other method, which knows the rope at the end only.
pub(in crate::report) const FUNNEL_FINAL: Contender = Contender {
    engine: "funnel",
    variant: "final rope only",
    promise: Promise::Ropes,
    windowed: false,
    open: Open::Threads(|model, _| Box::new(Funnel::new(model).final_only())),
};

/// The baseline.
pub(in crate::report) const NOTE: Contender = Contender {
    engine: "note",
    variant: "listing 1",
    promise: Promise::Nothing,
    windowed: false,
    open: Open::Thread(|model| Box::new(Note::new(model))),
};

/// The baseline with the note's remedy for walls on one line.
pub(in crate::report) const NOTE_FURTHEST: Contender = Contender {
    engine: "note",
    variant: "furthest",
    promise: Promise::Nothing,
    windowed: false,
    open: Open::Thread(|model| Box::new(Note::new(model).furthest())),
};

/// The arbiter.
pub(in crate::report) const REFERENCE: Contender = Contender {
    engine: "reference",
    variant: "one by one",
    promise: Promise::Events,
    windowed: false,
    open: Open::Thread(|model| Box::new(Reference::new(model))),
};

/// All contenders of a bench, in the order of the report. The baseline is one of them.
pub const CONTENDERS: [Contender; 8] = [GPU, CPU, GPU_ALL, FAST, FUNNEL, FUNNEL_FINAL, NOTE, REFERENCE];

impl Contender {
    /// The engine and its variant, as messages name them.
    pub fn name(&self) -> String {
        format!("{} ({})", self.engine, self.variant)
    }

    /// The most legs that one of its queries covers if the setting allows `legs`; `None` if that changes nothing.
    pub fn window(&self, legs: usize) -> Option<usize> {
        let most = if matches!(self.open, Open::FastGpu) { MOST_LEGS } else { usize::MAX };
        self.windowed.then_some(legs.min(most))
    }

    /// Whether this is what all others are compared with.
    pub fn is_baseline(&self) -> bool {
        self.engine == "note"
    }

    /// Whether it cannot do without a GPU.
    pub fn needs_gpu(&self) -> bool {
        matches!(self.open, Open::Gpu(_) | Open::FastGpu)
    }

    /// Whether it evaluates many traces at once, on all cores or in rounds of the GPU.
    pub(in crate::report) fn takes_many(&self) -> bool {
        !matches!(self.open, Open::Thread(_))
    }

    /// How many threads it computes on; a GPU's own are not counted.
    pub fn threads(&self) -> usize {
        match self.open {
            Open::Gpu(_) | Open::FastGpu | Open::Threads(_) => rayon::current_num_threads(),
            Open::Thread(_) => 1,
        }
    }

    /// `certified` for engines whose ropes are exact, `fast` for the GPU that trusts f32, `f64` for the note's listing.
    pub fn precision(&self) -> &'static str {
        match (self.open, self.promise) {
            (Open::FastGpu, _) => Precision::Fast.name(),
            (_, Promise::Nothing) => "f64",
            _ => Precision::Certified.name(),
        }
    }

    /// Makes the engine for `model`; `None` if it needs a GPU and there is none.
    pub(in crate::report) fn open(
        &self,
        model: Arc<Model>,
        gear: &Gear,
    ) -> Result<Option<Box<dyn Engine>>, EngineError> {
        Ok(Some(match (self.open, &gear.device) {
            (Open::Gpu(_) | Open::FastGpu, None) => return Ok(None),
            (Open::Gpu(shape), Some(device)) => Box::new(shape(Gpu::new(device.clone(), model)?, gear.window)),
            (Open::FastGpu, Some(device)) => Box::new(FastGpu::new(device.clone(), model)?.window(gear.window)),
            (Open::Threads(make), _) => make(model, gear.window),
            (Open::Thread(make), _) => make(model),
        }))
    }
}
