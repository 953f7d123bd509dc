//! Engines side by side on the same work.
//!
//! All engines run in one process on the same traces, again and again, each time in another order, so that what else
//! the machine does falls on all of them alike. Medians are reported with their spread, and the speed of every engine
//! relative to the note's listing in the same repeat. Engines that are too slow for all the work run on part of it: the
//! first few traces, or the first steps of them where an engine needs many at once.
//!
//! What they give is compared as it comes: engines that promise the same events must have given them, and a bench in
//! which they did not reports nothing.

mod agreement;
mod contender;
mod document;
mod error;
mod measure;
mod report;
mod runner;
mod setting;

pub use agreement::Disagreement;
pub use contender::{CONTENDERS, Contender, Gear};
pub(super) use contender::{CPU, FAST, FUNNEL, FUNNEL_FINAL, GPU, NOTE, NOTE_FURTHEST, REFERENCE};
pub use document::{Document, Line, Ratio};
pub use error::BenchError;
pub(super) use measure::order;
pub use measure::{Measured, Plan, Progress, Relative, Row, Skipped, Stage, measure, measure_all};
pub use report::Report;
pub use setting::{BenchScene, Setting, Sweep, SweepError, Work};
