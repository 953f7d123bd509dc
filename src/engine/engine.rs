//! What every engine does.

use super::error::EngineError;
use super::job::Job;
use super::precision::Precision;
use crate::rope::{EndsRecord, TraceRecord};
use crate::trace::{SettledEnds, SettledTrace};

/// How many traces engines without a device can make use of at once: enough that all threads end at about the same
/// time.
const BATCH: usize = 2048;

/// Turns batches of independent traces into records, for the model that the engine was made for.
pub trait Engine: Send {
    /// The engine's name, as the command line knows it.
    fn name(&self) -> &'static str;

    /// How much its ropes can be trusted; `None` if they are wrong by design, for comparison.
    fn precision(&self) -> Option<Precision> {
        Some(Precision::Certified)
    }

    /// The same as reports name it: `f64` for `None`.
    fn precision_name(&self) -> &'static str {
        self.precision().map_or("f64", Precision::name)
    }

    /// Evaluates all `traces`, settled against the engine's model, and returns their records in the same order.
    ///
    /// Counts finished steps in `job` as it goes, and ends early when the job is stopped.
    ///
    /// # Errors
    ///
    /// [`EngineError::Stopped`] when the job was stopped, and whatever can go wrong with the engine's device.
    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError>;

    /// The same for ropes whose ends both move, settled against the scene of the engine's model; where that ties its
    /// rope is of no matter. An anchor that stays where it is gives the records that [`evaluate`](Self::evaluate) gives
    /// where the model ties the rope there.
    ///
    /// # Errors
    ///
    /// [`EngineError::TwoEnds`] of engines that do not take such ropes, and those of [`evaluate`](Self::evaluate).
    fn evaluate_ends(&mut self, traces: &[SettledEnds], job: &Job) -> Result<Vec<EndsRecord>, EngineError> {
        let _ = (traces, job);
        Err(EngineError::TwoEnds { engine: self.name() })
    }

    /// How many traces, at the most, it can make use of in one evaluation: with fewer it may be slower, with more it is
    /// no faster.
    fn batch(&self) -> usize {
        BATCH
    }

    /// How many of the model's vertices it tries, that is, at how many a rope can turn within reach of the traces
    /// evaluated so far; all with `keep_all`. `None` for engines that try none, or have not asked yet. See
    /// [`Visibility::only_required`](crate::visibility::Visibility::only_required).
    fn remaining(&self) -> Option<usize> {
        None
    }

    /// Forgets what was made of the model on the way, so that the next evaluation makes it anew: for measurements.
    fn forget(&mut self) {}
}
