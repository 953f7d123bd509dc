//! What the table of engines says of each, and how one is opened by it.

use std::sync::Arc;
use std::{fmt, ptr};

use super::windows::WINDOW;
use super::{Engine, EngineError, Precision};
use crate::gpu::{Device, GpuError};
use crate::scene::Model;

/// An engine, as the table has it. There is one of each, in [`ENGINES`](super::ENGINES); two are equal if they are the
/// same one.
pub struct EngineKind {
    /// Its name, as the command line knows it.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// In which precisions it can be opened; none for one whose ropes are wrong by design.
    pub precisions: &'static [Precision],
    /// Whether it asks queries over windows, so that [`Options::window`] changes how it works. What it certifies does
    /// not depend on it.
    pub asks: bool,
    /// Whether it takes ropes whose ends both move ([`Engine::evaluate_ends`]).
    pub both_ends: bool,
    /// What it promises where f32 does not decide alone.
    pub(super) promise: Promise,
    /// How it is made.
    pub(super) open: Open,
}

/// What an engine's records must agree with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Promise {
    /// Every record is that of the reference, event for event.
    Events,
    /// The taut rope after every step is the reference's; events may differ.
    Ropes,
    /// Nothing: its ropes may be wrong.
    Nothing,
}

/// Makes an engine on a device.
type MakeOnDevice = fn(Device, Arc<Model>, &Options) -> Result<Box<dyn Engine>, GpuError>;

/// How an engine is made, by what it runs on.
#[derive(Clone, Copy)]
pub(super) enum Open {
    /// On a device.
    Device(MakeOnDevice),
    /// On all cores.
    Threads(fn(Arc<Model>, &Options) -> Box<dyn Engine>),
    /// On one thread.
    Thread(fn(Arc<Model>) -> Box<dyn Engine>),
}

/// What can be chosen about an engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// How it decides; one of [`EngineKind::precisions`], if it has any.
    pub precision: Precision,
    /// The most legs that one query covers, at least 1.
    pub window: usize,
    /// How many bytes of a device's memory it takes at most, about; `None` for what suits the device
    /// ([`Device::memory`]).
    pub memory: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Options { precision: Precision::default(), window: WINDOW, memory: None }
    }
}

/// An engine that has been opened.
pub struct Opened {
    /// It.
    pub engine: Box<dyn Engine>,
    /// Which it is.
    pub kind: &'static EngineKind,
    /// What it runs on.
    pub on: RunsOn,
    /// Why it was chosen.
    pub why: Why,
    pub(super) options: Options,
}

impl Opened {
    /// The same engine for another model, on the same device. A device takes long to open, and is opened once.
    ///
    /// # Errors
    ///
    /// As [`EngineKind::open`].
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tautline::engine::{Job, Options, open_best};
    /// use tautline::example::{Walker, floor_plan, settled_walks};
    /// use tautline::scene::Model;
    ///
    /// let here = Arc::new(Model::new(floor_plan(), None)?);
    /// let there = Arc::new(here.tied([5.0, 5.0].into())?);
    /// let opened = open_best(here, &Options::default())?;
    /// let walks = settled_walks(&there, Walker { step: 0.3, steps: 50, seed: 1 }, 3);
    /// assert_eq!(opened.another(there)?.evaluate(&walks, &Job::new())?.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn another(&self, model: Arc<Model>) -> Result<Box<dyn Engine>, EngineError> {
        let device = if let RunsOn::Device(device) = &self.on { Some(device.clone()) } else { None };
        Ok(self.kind.open(model, device, &self.options)?.engine)
    }
}

/// What an engine runs on; shown in words.
#[derive(Clone)]
pub enum RunsOn {
    /// A device, and all cores beside it.
    Device(Device),
    /// So many threads: all cores.
    Threads(usize),
    /// One thread.
    Thread,
}

/// Why an engine was chosen.
#[derive(Debug)]
pub enum Why {
    /// It was asked for, or is the only one for what was asked.
    Asked,
    /// There is a real GPU.
    RealGpu,
    /// No real GPU can be used, for this reason.
    NoRealGpu(EngineError),
}

impl EngineKind {
    /// What it promises in a precision.
    pub fn promise(&self, precision: Precision) -> Promise {
        match precision {
            Precision::Certified => self.promise,
            Precision::Fast => Promise::Nothing,
        }
    }

    /// Whether it finds the events that the update has, contacts passed straight among them, and that well or badly:
    /// studies count events, and an answer does not tell what computed it.
    pub fn counts_events(&self) -> bool {
        self.promise == Promise::Events
    }

    /// Whether it can be opened in this precision. One without any takes what is taken unless told otherwise.
    pub fn takes(&self, precision: Precision) -> bool {
        precision == Precision::default() || self.precisions.contains(&precision)
    }

    /// Whether it cannot do without a GPU.
    pub fn needs_gpu(&self) -> bool {
        matches!(self.open, Open::Device(_))
    }

    /// Whether it evaluates many traces at once, on all cores or in rounds of the GPU.
    pub fn takes_many(&self) -> bool {
        !matches!(self.open, Open::Thread(_))
    }

    /// How many threads it computes on; a GPU's own are not counted.
    pub fn threads(&self) -> usize {
        if self.takes_many() { rayon::current_num_threads() } else { 1 }
    }

    /// Opens it for `model`; on `device`, if it needs one.
    ///
    /// # Errors
    ///
    /// A precision that it has not, a device that is missing, and whatever is wrong with the device.
    ///
    /// ```
    /// use tautline::engine::{EngineKind, Job, Options};
    /// use tautline::example::{Walker, floor_plan, settled_walks};
    /// use tautline::scene::Model;
    ///
    /// let model = std::sync::Arc::new(Model::new(floor_plan(), None)?);
    /// let walks = settled_walks(&model, Walker { step: 0.3, steps: 50, seed: 1 }, 3);
    /// let kind = EngineKind::named("cpu").expect("it is in the table");
    /// let mut opened = kind.open(model, None, &Options::default())?;
    /// assert_eq!(opened.engine.evaluate(&walks, &Job::new())?.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(
        &'static self,
        model: Arc<Model>,
        device: Option<Device>,
        options: &Options,
    ) -> Result<Opened, EngineError> {
        if !self.takes(options.precision) {
            return Err(EngineError::Precision { engine: self.name, precision: options.precision });
        }
        let (engine, on) = match (self.open, device) {
            (Open::Device(_), None) => return Err(EngineError::NoDevice { engine: self.name }),
            (Open::Device(make), Some(device)) => {
                let device = options.memory.map_or_else(|| device.clone(), |bytes| device.clone().with_memory(bytes));
                (make(device.clone(), model, options)?, RunsOn::Device(device))
            }
            (Open::Threads(make), _) => (make(model, options), RunsOn::Threads(self.threads())),
            (Open::Thread(make), _) => (make(model), RunsOn::Thread),
        };
        Ok(Opened { engine, kind: self, on, why: Why::Asked, options: *options })
    }
}

impl PartialEq for EngineKind {
    fn eq(&self, other: &Self) -> bool {
        ptr::eq(self, other)
    }
}

impl Eq for EngineKind {}

impl fmt::Debug for EngineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Display for RunsOn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunsOn::Device(device) => device.summary().fmt(f),
            RunsOn::Threads(threads) => write!(f, "{threads} threads"),
            RunsOn::Thread => f.write_str("one thread"),
        }
    }
}
