//! What all tallies of a study go by.

use std::sync::Arc;

use glam::DVec2;

use super::TallyPlan;
use crate::geometry::number;
use crate::scene::Model;
use crate::study::estimate::Confidence;
use crate::study::plan_error::PlanError;
use crate::study::walk::Tether;

/// What all tallies of a study go by.
pub(crate) struct Setting {
    /// The scene with each of its anchors; trace i has anchor i modulo their number.
    pub models: Vec<Arc<Model>>,
    /// The corners of the box that holds all traces.
    pub low: DVec2,
    pub high: DVec2,
    /// How many steps each trace has; `None` for given traces, of which that is only known in the end.
    pub steps: Option<u32>,
    /// The tether that holds the walks back, if there is one.
    pub tether: Option<Tether>,
    /// How sure intervals are.
    pub confidence: Confidence,
    /// The label of each wall end; empty if there are none.
    labels: Vec<Option<String>>,
}

impl Setting {
    /// Whether the options that belong to no single tally will do.
    pub(super) fn check(options: &TallyPlan) -> Result<(), PlanError> {
        if options.confidence > 0.0 && options.confidence < 1.0 {
            return Ok(());
        }
        Err(PlanError::new(format!("tallies.confidence: {} is not between 0 and 1", number(options.confidence))))
    }

    /// For ropes in `models`, and traces of so many steps, held back by that tether, between `low` and `high`.
    pub(crate) fn new(
        options: &TallyPlan,
        models: Vec<Arc<Model>>,
        (low, high): (DVec2, DVec2),
        (steps, tether): (Option<u32>, Option<Tether>),
    ) -> Self {
        let labels = models[0].scene().labels().into_iter().map(|label| label.map(str::to_owned)).collect();
        Setting { confidence: Confidence::new(options.confidence), models, low, high, steps, tether, labels }
    }

    pub(crate) fn model(&self, trace: u64) -> &Arc<Model> {
        &self.models[self.anchor(trace)]
    }

    /// The number of the trace's anchor.
    pub(crate) fn anchor(&self, trace: u64) -> usize {
        (trace % self.models.len() as u64) as usize
    }

    /// Whether a picture of the scene has y pointing down.
    pub(super) fn y_down(&self) -> bool {
        self.models[0].scene().y_down()
    }

    /// Where a wall end is.
    pub(super) fn at(&self, vertex: u32) -> [f64; 2] {
        self.models[0].vertices()[vertex as usize].into()
    }

    /// What the scene's file calls the thing to which a wall end belongs.
    pub(super) fn label(&self, vertex: u32) -> Option<String> {
        self.labels.get(vertex as usize).cloned().flatten()
    }

    /// Whether the scene's file calls nothing anything.
    pub(super) fn is_nameless(&self) -> bool {
        self.labels.is_empty()
    }

    /// The greatest power of two that is not above the longer side of the box; 1 for a box of no size.
    pub(super) fn extent(&self) -> f64 {
        power_of_two((self.high - self.low).max_element())
    }

    /// Lengths are summed in whole numbers of this.
    pub(super) fn unit(&self) -> f64 {
        self.extent() / f64::from(1 << 20)
    }
}

/// The greatest power of two that is not above `size`; 1 for 0.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 { f64::from_bits(size.to_bits() & (0x7ff << 52)) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_are_powers_of_two() {
        assert_eq!([0.0, 1.0, 1.5, 0.3, 5.0].map(power_of_two), [1.0, 1.0, 1.0, 0.25, 4.0]);
    }
}
