//! Why a bench reports nothing.

use super::Disagreement;
use crate::engine::EngineError;
use crate::scene::AnchorError;
use crate::trace::Violation;

/// Why a bench reports nothing.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Two engines gave different results.
    #[error(transparent)]
    Disagreement(#[from] Disagreement),
    /// The rope cannot be tied.
    #[error(transparent)]
    Anchor(#[from] AnchorError),
    /// A walk crosses a wall, which none should.
    #[error(transparent)]
    Violation(#[from] Violation),
}
