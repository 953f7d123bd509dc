//! Speed against accuracy: every method at every setting on the same traces, against the exact reference.
//!
//! A work-precision diagram in the sense of numerical analysis: what a trace-step costs against what is wrong about its
//! rope. Times are those of the engine alone, per step of the traces as they are, whether or not a setting uses it; what a
//! setting saves in reading and checking comes on top.

mod measure;
mod method;
mod pareto;
mod setting;
mod truth;

use super::bench::Disagreement;
use crate::engine::EngineError;
use crate::trace::Violation;

pub use measure::{Failed, LengthError, Point, Progress, Tradeoff, tradeoff};
pub use method::Method;
pub use setting::{Setting, Work};
pub use truth::Answer;

/// What is to be measured.
#[derive(Clone)]
pub struct Wanted {
    /// The methods.
    pub methods: Vec<Method>,
    /// The settings; [`Setting::EXACT`] is always among them.
    pub settings: Vec<Setting>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum TradeoffError {
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Two exact methods gave different results.
    #[error(transparent)]
    Disagreement(#[from] Disagreement),
    /// A trace crosses a wall, so its rope has no truth.
    #[error(transparent)]
    Violation(#[from] Violation),
}
