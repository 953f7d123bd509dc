//! Why a study could not go on.

use super::plan_error::PlanError;
use crate::engine::EngineError;

/// Why a study could not go on. What was done before is in its state.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E> {
    /// The traces cannot be had.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The ropes cannot be evaluated, or the job was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The caller had enough.
    #[error(transparent)]
    Caller(E),
}
