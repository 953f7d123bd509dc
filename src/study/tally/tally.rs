//! What a tally is.

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::TallyPlan;
use super::merge::Merge;
use super::setting::Setting;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::study::plan_error::PlanError;

/// Something that is counted of every trace and told in the summary. The value itself is what all blocks have in
/// common.
pub(crate) trait Tally: Sized + Send + Sync {
    /// What is counted of the first traces of a block.
    type Part: Clone + Default + Serialize + DeserializeOwned + JsonSchema + Send;
    /// What is counted of whole blocks.
    type Counts: Clone + Default + Merge + Serialize + DeserializeOwned + JsonSchema + Send;
    /// What the summary says of it.
    type Answer;

    /// Whether its options will do, as far as can be told without the scene.
    fn check(_options: &TallyPlan) -> Result<(), PlanError> {
        Ok(())
    }

    /// Made ready for a study's scene.
    ///
    /// # Errors
    ///
    /// An option that does not go with the scene.
    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError>;

    /// Counts a block's next trace.
    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>);

    /// The counts of a block that is whole.
    fn finish(&self, part: Self::Part, block: &Size) -> Self::Counts;

    /// From counts to the answer.
    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Self::Answer;
}
