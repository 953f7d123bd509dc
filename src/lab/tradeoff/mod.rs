//! Speed against accuracy: every method at every setting on the same traces, against the exact reference.
//!
//! A work-precision diagram in the sense of numerical analysis: what a trace-step costs against what is wrong about its
//! rope. Times are those of the engine alone, per step of the traces as they are, whether or not a setting uses it;
//! what a setting saves in reading and checking comes on top.

mod document;
mod error;
mod measure;
mod method;
mod pareto;
mod point;
mod report;
mod setting;
mod truth;

pub use document::{Document, Failure};
pub use error::{TradeoffError, WorkError};
pub use measure::{Failed, Progress, Tradeoff, tradeoff};
pub use method::Method;
pub use point::{LengthError, Point};
pub use report::Report;
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
