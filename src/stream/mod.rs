//! Traces in, ropes out: reads traces batch by batch, evaluates them, and writes their ropes, all at the same time and
//! in bounded memory.
//!
//! ```
//! use std::sync::Arc;
//! use tautline::engine::{Cpu, Job};
//! use tautline::scene::{Model, Scene};
//! use tautline::stream::{Batches, Files, OnViolation, Source, evaluate};
//! use tautline::trace::TraceReader;
//! use tautline::trade::{Terms, Trade};
//!
//! let folder = tempfile::tempdir()?;
//! let [traces, out] = ["t.csv", "ropes.jsonl"].map(|name| folder.path().join(name));
//! std::fs::write(&traces, "trace,x,y\n0,0,-1\n0,3,-1\n0,3,1\n0,0,1\n")?;
//! let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
//! let model = Arc::new(Model::new(scene, Some([0.0, -1.0].into()))?);
//!
//! let terms = Terms::new(model.clone(), Trade::default())?;
//! let batches = Batches::start(Source::File(TraceReader::open(&traces)?), terms, 1024);
//! let files = Files::new(Some(&out), None, &model, Vec::new());
//! let mut contacts = 0;
//! evaluate(batches, &mut Cpu::new(model.clone()), files, OnViolation::Error, &Job::new(), |stage| {
//!     contacts += stage.records().iter().map(|record| record.wraps.len()).sum::<usize>();
//! })?;
//! assert_eq!(contacts, 1);
//! assert_eq!(std::fs::read_to_string(out)?.lines().count(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batches;
mod ends;
mod error;
mod evaluate;
mod files;
mod of_class;
mod pick;
mod progress;
mod report;
mod statistics;

pub use batches::{Batch, Batches, Source};
pub use ends::{EndsFiles, EndsSource, EndsStage, evaluate_ends};
pub use error::StreamError;
pub use evaluate::{OnViolation, Stage, Times, evaluate};
pub use files::Files;
pub use of_class::{OfClass, OfClassError};
pub use pick::PickError;
pub use progress::Progress;
pub use report::{Account, Report, SceneReport, Seconds, Touched, TradedReport};
pub use statistics::Statistics;
