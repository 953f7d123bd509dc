//! How often ropes have contacts with wall ends, and how long.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::batches::Batches;
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// How many wall ends are listed at the most.
const MOST: usize = 1000;

/// How often a wall end was touched in a block.
#[derive(Clone, Copy, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Held {
    wraps: u64,
    /// The steps with the rope about it.
    steps: u64,
}

/// How often a wall end was touched.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Touched {
    /// Over blocks as large as they have traces.
    wraps: Batches,
    /// Steps, over blocks as large as they have steps.
    steps: Batches,
}

impl Merge for Touched {
    fn merge_with(&mut self, other: Touched) {
        self.wraps.merge_with(other.wraps);
        self.steps.merge_with(other.steps);
    }
}

/// The tally of contacts.
pub(crate) struct Contacts;

impl Tally for Contacts {
    type Part = HashMap<u32, Held>;
    type Counts = BTreeMap<u32, Touched>;
    type Answer = Vec<Contact>;

    fn new(_: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        Ok(Contacts)
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        for contact in &traced.lasting.held {
            let held = part.entry(contact.vertex).or_default();
            held.wraps += 1;
            held.steps += contact.steps;
        }
    }

    fn finish(&self, part: Self::Part, block: &Size) -> Self::Counts {
        let touched = |held: Held| {
            let mut touched = Touched::default();
            touched.wraps.add(block.traces, held.wraps);
            touched.steps.add(block.looks, held.steps);
            touched
        };
        part.into_iter().map(|(vertex, held)| (vertex, touched(held))).collect()
    }

    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Vec<Contact> {
        let around = |(value, error)| setting.confidence.around(value, error, totals.traces.blocks);
        let mut longest: Vec<_> = counts.iter().collect();
        longest.sort_by(|a, b| b.1.steps.sum.cmp(&a.1.steps.sum).then(a.0.cmp(b.0)));
        longest.truncate(MOST);
        let contact = |(&vertex, touched): (&u32, &Touched)| Contact {
            vertex,
            at: setting.at(vertex),
            label: setting.label(vertex),
            wraps: around(touched.wraps.ratio(&totals.traces)),
            share: around(touched.steps.ratio(&totals.looks)),
        };
        longest.into_iter().map(contact).collect()
    }
}

/// How often ropes had a contact with a wall end, contacts passed straight included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// Its number in the scene.
    pub vertex: u32,
    /// Where it is.
    pub at: [f64; 2],
    /// What the scene's file calls the thing to which it belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The number of wraps about it per trace.
    pub wraps: Estimate,
    /// The share of all steps after which the rope has a contact with it, however many: a rope wound round it counts
    /// once.
    pub share: Estimate,
}
