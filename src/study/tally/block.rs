//! Counting a block, trace after trace, so that one that is stopped in the middle can be gone on with.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::merge::Merge;
use super::options::TallyPlan;
use super::setting::Setting;
use super::table::table;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::rope::TraceRecord;
use crate::study::plan_error::PlanError;
use crate::study::tally;
use crate::trace::SettledTrace;

macro_rules! blocks {
    ($($(#[$_:meta])* $name:ident: $Answer:ty = $Tally:ty;)*) => {
        /// All tallies of a study, and what they have in common.
        pub(crate) struct Tallies {
            pub setting: Setting,
            $(pub $name: $Tally,)*
        }

        impl Tallies {
            /// Whether the options will do, as far as can be told without the scene.
            pub(crate) fn check(options: &TallyPlan) -> Result<(), PlanError> {
                Setting::check(options)?;
                $(<$Tally>::check(options)?;)*
                Ok(())
            }

            /// Made ready for a study's scene.
            ///
            /// # Errors
            ///
            /// An option that does not go with the scene.
            pub(crate) fn new(options: &TallyPlan, setting: Setting) -> Result<Self, PlanError> {
                $(let $name = <$Tally>::new(options, &setting)?;)*
                Ok(Tallies { setting, $($name,)* })
            }
        }

        /// A block under way: what was counted of its first traces.
        #[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
        pub(crate) struct Block {
            traces: u64,
            looks: u64,
            totals: Totals,
            $($name: <$Tally as Tally>::Part,)*
        }

        impl Block {
            /// Counts its next trace. O(steps looked at by the map + events + steps up to where limits are exceeded).
            pub(crate) fn add(&mut self, tallies: &Tallies, trace: &SettledTrace, record: &TraceRecord) {
                let traced = Traced::new(&tallies.setting, trace, record);
                self.traces += 1;
                self.looks += record.steps + 1;
                self.totals.add(&traced);
                $(tallies.$name.add(&mut self.$name, &traced);)*
            }

            /// The counts of the block, once it is whole.
            pub(crate) fn finish(self, tallies: &Tallies, number: u64) -> Counts {
                let size = Size { number, traces: self.traces, looks: self.looks };
                Counts {
                    totals: self.totals.finish(&size),
                    $($name: tallies.$name.finish(self.$name, &size),)*
                }
            }
        }

        /// Counts of some blocks.
        #[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
        pub(crate) struct Counts {
            pub totals: Totals,
            $(pub $name: <$Tally as Tally>::Counts,)*
        }

        impl Merge for Counts {
            fn merge_with(&mut self, other: Counts) {
                self.totals.merge_with(other.totals);
                $(self.$name.merge_with(other.$name);)*
            }
        }
    };
}

table!(blocks);

impl Block {
    /// How many of its traces are counted.
    pub(crate) fn traces(&self) -> u64 {
        self.traces
    }
}
