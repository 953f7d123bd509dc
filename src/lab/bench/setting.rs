//! What is run: a scene, walks in it, and the values that a sweep goes through.

use std::sync::Arc;

use super::BenchError;
use crate::example::{BuiltIn, Walker, settled_walks};
use crate::scene::{AnchorError, Model};
use crate::trace::SettledTrace;

/// A scene for a bench.
#[derive(Clone)]
pub enum BenchScene {
    /// One that has a name.
    BuiltIn(BuiltIn),
    /// One of the user's own.
    Own {
        /// What reports call it.
        name: String,
        /// The scene and its anchor.
        model: Arc<Model>,
    },
}

impl BenchScene {
    /// What reports call it.
    pub fn name(&self) -> String {
        match self {
            BenchScene::BuiltIn(scene) => scene.to_string(),
            BenchScene::Own { name, .. } => name.clone(),
        }
    }

    /// The length of a step that is walked unless told otherwise, in the scene's unit. In a scene of one's own that is
    /// a tenth of the mean distance between walls, by the area of the scene's box and the number of walls: about what
    /// it is in random scenes.
    pub fn step(&self) -> f64 {
        match self {
            BenchScene::BuiltIn(scene) => scene.step(),
            BenchScene::Own { model, .. } => {
                let (low, high) = model.bounds();
                let (size, walls) = (high - low, model.scene().walls().len().max(1) as f64);
                // A scene in which all lies on one line has no area.
                let step = 0.1 * (size.x / walls).sqrt() * size.y.sqrt();
                if step > 0.0 { step } else { (0.1 * size.max_element() / walls).max(f64::MIN_POSITIVE) }
            }
        }
    }

    /// The scene and its anchor; `seed` decides where random walls lie.
    ///
    /// # Errors
    ///
    /// An anchor in a wall, which should not happen.
    pub fn model(&self, seed: u64) -> Result<Arc<Model>, AnchorError> {
        Ok(match self {
            BenchScene::BuiltIn(scene) => Arc::new(Model::new(scene.scene(seed), None)?),
            BenchScene::Own { model, .. } => Arc::clone(model),
        })
    }
}

/// All that decides what work engines are given.
#[derive(Clone)]
pub struct Setting {
    /// Where the walks lead.
    pub scene: BenchScene,
    /// The length of a step, about, in the scene's unit.
    pub step: f64,
    /// How many steps a trace has.
    pub steps: usize,
    /// How many traces there are; slow engines run on some of them.
    pub traces: u64,
    /// Decides where random walls lie and walks lead.
    pub seed: u64,
    /// The most legs that one query covers.
    pub window: usize,
}

/// Traces ready to be evaluated.
pub struct Work {
    /// From what it was made.
    pub setting: Setting,
    /// The scene.
    pub model: Arc<Model>,
    /// The walks, settled.
    pub traces: Vec<SettledTrace>,
}

impl Setting {
    /// Makes the scene and walks in it, on all cores. Holds about 16 bytes a step.
    ///
    /// # Errors
    ///
    /// An anchor in a wall, or a walk that crosses one, neither of which should happen.
    pub fn work(&self) -> Result<Work, BenchError> {
        let model = self.scene.model(self.seed)?;
        let traces = settled_walks(&model, self.walker(self.steps), self.traces);
        match traces.iter().find_map(|trace| trace.violation()) {
            Some(violation) => Err((*violation).into()),
            None => Ok(Work { setting: self.clone(), model, traces }),
        }
    }

    fn walker(&self, steps: usize) -> Walker {
        Walker { step: self.step, steps, seed: self.seed }
    }
}

impl Work {
    /// The first `steps` steps of the first `traces` traces: walks are the same as far as they go.
    pub(super) fn first_steps(&self, steps: usize, traces: u64) -> Vec<SettledTrace> {
        settled_walks(&self.model, self.setting.walker(steps), traces)
    }
}

/// What a sweep changes from setting to setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sweep {
    /// The number of vertices, in random scenes of 50 to 17,353 walls. The step shrinks as the distances between walls
    /// do.
    Vertices,
    /// The number of traces that are evaluated at once.
    Batch,
    /// The length of a step.
    Step,
    /// The most steps that a query covers.
    Window,
}

/// Why a sweep cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SweepError {
    /// Only random scenes come in all sizes.
    #[error("the scene {0} comes in one size only; a sweep over n goes through scenes random-M")]
    Size(String),
}

impl Sweep {
    /// The numbers of walls of a sweep over n: about half an order of magnitude apart, up to as many as the largest
    /// real scene that the method was tried on has ends, 34,706.
    const WALLS: [u32; 6] = [50, 160, 500, 1600, 5000, 17353];
    const BATCHES: [u64; 7] = [1, 4, 16, 64, 256, 1024, 4096];
    /// In units of the step that was asked for.
    const STEPS: [f64; 4] = [0.1, 0.3, 1.0, 3.0];
    const WINDOWS: [usize; 6] = [1, 4, 16, 64, 256, 1024];

    /// The settings that the sweep goes through, in all else like `base`.
    ///
    /// # Errors
    ///
    /// A sweep over n of a scene that is not random.
    pub fn settings(self, base: &Setting) -> Result<Vec<Setting>, SweepError> {
        Ok(match self {
            Sweep::Vertices => {
                let BenchScene::BuiltIn(BuiltIn::Random(asked)) = base.scene else {
                    return Err(SweepError::Size(base.scene.name()));
                };
                let sized = |walls: u32| Setting {
                    scene: BenchScene::BuiltIn(BuiltIn::Random(walls)),
                    step: base.step * (f64::from(asked) / f64::from(walls)).sqrt(),
                    ..base.clone()
                };
                Self::WALLS.map(sized).into()
            }
            Sweep::Batch => Self::BATCHES.map(|traces| Setting { traces, ..base.clone() }).into(),
            Sweep::Step => Self::STEPS.map(|times| Setting { step: times * base.step, ..base.clone() }).into(),
            Sweep::Window => Self::WINDOWS.map(|window| Setting { window, ..base.clone() }).into(),
        })
    }
}
