//! What is traded, and the work as each setting has it.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use super::TradeoffError;
use crate::geometry::number;
use crate::scene::Model;
use crate::simplify::{SimplifyError, simplify};
use crate::trace::{SettledTrace, Trace, settle};

/// How much accuracy is given for speed, whatever the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// Every so many points of a trace are used, at least 1; 1 gives nothing away.
    Stride(usize),
    /// Walls are simplified by at most that much, in the scene's unit.
    Simplify(f64),
}

impl Setting {
    /// All points of all traces among all walls.
    pub const EXACT: Setting = Setting::Stride(1);

    /// Every so many points are used.
    pub fn stride(self) -> usize {
        match self {
            Setting::Stride(k) => k,
            Setting::Simplify(_) => 1,
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Setting::Stride(k) => write!(f, "stride {k}"),
            Setting::Simplify(tolerance) => write!(f, "simplify {}", number(*tolerance)),
        }
    }
}

/// A scene and traces in it, as they are.
pub struct Work {
    /// What reports call the scene.
    pub scene: String,
    /// The scene and its anchor.
    pub model: Arc<Model>,
    /// The traces; none crosses a wall.
    pub traces: Vec<Trace>,
}

/// The work as a setting has it.
pub(super) struct Variant {
    pub setting: Setting,
    pub model: Arc<Model>,
    pub traces: Vec<SettledTrace>,
}

impl Variant {
    /// The work with all points and walls.
    ///
    /// # Errors
    ///
    /// The first trace that breaks the rules.
    pub(super) fn exact(work: &Work) -> Result<Self, TradeoffError> {
        let traces: Vec<SettledTrace> = work.traces.par_iter().map(|trace| settle(&work.model, trace)).collect();
        match traces.iter().find_map(SettledTrace::violation) {
            Some(violation) => Err((*violation).into()),
            None => Ok(Variant { setting: Setting::EXACT, model: Arc::clone(&work.model), traces }),
        }
    }

    /// Whether it has as many vertices as `other`.
    pub(super) fn is_like(&self, other: &Variant) -> bool {
        self.model.vertices().len() == other.model.vertices().len()
    }

    /// The same as `setting` has it.
    ///
    /// # Errors
    ///
    /// A scene that cannot be simplified.
    pub(super) fn at(&self, setting: Setting) -> Result<Self, SimplifyError> {
        let model = match setting {
            Setting::Stride(_) => Arc::clone(&self.model),
            Setting::Simplify(tolerance) => {
                let anchor = self.model.anchor();
                Arc::new(Model::new(simplify(self.model.scene(), &[anchor], tolerance)?, Some(anchor))?)
            }
        };
        let traces = self.traces.par_iter().map(|trace| trace.clone().coarsened(&model, setting.stride())).collect();
        Ok(Variant { setting, model, traces })
    }
}
