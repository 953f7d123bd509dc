//! What is traded, and the work as each setting has it.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::{TradeoffError, WorkError};
use crate::example::{Walker, walks};
use crate::geometry::number;
use crate::lab::bench::BenchScene;
use crate::scene::Model;
use crate::simplify::{SimplifyError, simplify};
use crate::trace::{SettledTrace, Trace, read_traces, settle};

/// Of how many points one is used, unless told otherwise.
const STRIDES: [u32; 4] = [2, 4, 8, 16];

/// By how much walls are simplified unless told otherwise, in steps of the walks that suit the scene.
const TOLERANCES: [f64; 3] = [0.5, 2.0, 8.0];

/// How much accuracy is given for speed, whatever the method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(into = "Written")]
#[schemars(with = "Written")]
pub enum Setting {
    /// Every so many points of a trace are used, at least 1; 1 gives nothing away.
    Stride(usize),
    /// Walls are simplified by at most that much, in the scene's unit.
    Simplify(f64),
}

/// A setting as documents have it.
#[derive(Serialize, JsonSchema)]
struct Written {
    /// The setting, in words.
    setting: String,
    /// Every so many points of a trace were used.
    stride: usize,
    /// By how much walls were simplified at most; null for not at all.
    simplify: Option<f64>,
}

impl From<Setting> for Written {
    fn from(setting: Setting) -> Self {
        let simplify = if let Setting::Simplify(tolerance) = setting { Some(tolerance) } else { None };
        Written { setting: setting.to_string(), stride: setting.stride(), simplify }
    }
}

impl Setting {
    /// All points of all traces among all walls.
    pub const EXACT: Setting = Setting::Stride(1);

    /// What is measured: [`EXACT`](Self::EXACT), then these strides and tolerances, each once. Without strides 2, 4, 8
    /// and 16; without tolerances half, 2 and 8 of the walks' steps, to one digit.
    ///
    /// ```
    /// use tautline::lab::tradeoff::Setting;
    /// let settings = Setting::all(Some(&[4, 1]), None, 0.25);
    /// assert_eq!(settings[..2], [Setting::EXACT, Setting::Stride(4)]);
    /// assert_eq!(settings[2..], [0.1, 0.5, 2.0].map(Setting::Simplify));
    /// ```
    pub fn all(strides: Option<&[u32]>, tolerances: Option<&[f64]>, step: f64) -> Vec<Setting> {
        let usual = TOLERANCES.map(|steps| round(steps * step));
        let strides = strides.unwrap_or(&STRIDES).iter().map(|&k| Setting::Stride(k as usize));
        let tolerances = tolerances.unwrap_or(&usual).iter().map(|&tolerance| Setting::Simplify(tolerance));
        let mut settings = vec![Setting::EXACT];
        for setting in strides.chain(tolerances) {
            if !settings.contains(&setting) {
                settings.push(setting);
            }
        }
        settings
    }

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

impl Work {
    /// Random walks in `scene`; the walker's seed decides where random walls lie, too.
    ///
    /// # Errors
    ///
    /// An anchor in a wall, which should not happen.
    pub fn walked(scene: &BenchScene, walker: Walker, count: u64) -> Result<Self, WorkError> {
        let model = scene.model(walker.seed)?;
        let traces = walks(&model, walker, count);
        Ok(Work { scene: scene.name(), model, traces })
    }

    /// The traces of a file in `scene`; `seed` decides where random walls lie.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and one in which there is no step to be timed.
    pub fn given(scene: &BenchScene, seed: u64, path: &Path) -> Result<Self, WorkError> {
        let model = scene.model(seed)?;
        let traces = read_traces(path)?;
        match traces.iter().map(|trace| trace.points.len()).max() {
            None => Err(WorkError::Empty(path.to_owned())),
            Some(1) => Err(WorkError::Still(path.to_owned())),
            Some(_) => Ok(Work { scene: scene.name(), model, traces }),
        }
    }
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

/// To one digit, 1, 2 or 5.
fn round(x: f64) -> f64 {
    let tens = 10f64.powf(x.log10().floor());
    let unit = [1.0, 2.0, 5.0, 10.0].into_iter().min_by(|a, b| (a - x / tens).abs().total_cmp(&(b - x / tens).abs()));
    // By way of text, so that it is the number that its digits say.
    format!("{:e}", unit.unwrap_or(1.0) * tens).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn tolerances_are_round() {
        let rounded = [0.005, 0.02, 0.43, 1.7, 6.9, 8.0, 96.0, 1e-9].map(round);
        assert_eq!(rounded, [0.005, 0.02, 0.5, 2.0, 5.0, 10.0, 100.0, 1e-9]);
    }
}
