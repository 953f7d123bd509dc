//! Why there is no report.

use crate::engine::EngineError;
use crate::lab::bench::Disagreement;
use crate::trace::Violation;

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
