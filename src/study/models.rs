//! Where a study's ropes are tied.

use std::sync::Arc;

use glam::DVec2;

use super::free_space::FreeSpace;
use super::plan::{AnchorPlan, Plan};
use super::plan_error::{PlanError, PlanFault};
use super::random::{Purpose, Random};
use crate::scene::{AnchorError, Model, Scene};

/// The scene with each of the plan's anchors.
pub(super) fn models(plan: &Plan, scene: &Scene) -> Result<Vec<Arc<Model>>, PlanError> {
    let wrong = |e: AnchorError| PlanError::at_key("scene.anchor", e);
    let model = |anchor: Option<DVec2>| Model::new(scene.clone(), anchor).map_err(wrong);
    // All share the walls.
    let tied = |first: &Model, at: DVec2| first.tied(at).map(Arc::new).map_err(wrong);
    match &plan.scene.anchor {
        None => Ok(vec![Arc::new(model(None)?)]),
        Some(AnchorPlan::One(at)) => Ok(vec![Arc::new(model(Some((*at).into()))?)]),
        Some(AnchorPlan::Several(all)) => {
            let first = model(all.first().map(|&at| at.into()))?;
            all.iter().map(|&at| tied(&first, at.into())).collect()
        }
        Some(AnchorPlan::Sampled(sampled)) => {
            let whole = Model::new(scene.clone(), None).map_err(|e| match e {
                AnchorError::Missing => PlanError::at_key(
                    "scene.anchor",
                    PlanFault::Value(
                        "anchors are sampled in the free space in which the scene's own anchor lies, and it marks \
                         none: mark one in its file, or give [x, y] or a list of such"
                            .to_owned(),
                    ),
                ),
                other => wrong(other),
            })?;
            let free = FreeSpace::new(&whole)
                .ok_or_else(|| PlanError::new("scene.anchor: no free space can be found to sample anchors from"))?;
            let draw = |i: u32| {
                let mut random = Random::new(plan.run.seed, Purpose::Anchor, u64::from(i));
                tied(&whole, free.draw(&mut random))
            };
            (0..sampled.sample).map(draw).collect()
        }
    }
}
