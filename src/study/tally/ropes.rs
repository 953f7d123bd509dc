//! How common each taut rope is.

use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::common::Common;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::rope::Side;
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// A taut rope: its anchor's number, then for each contact twice the wall end's number, and one more if it lies right.
type Key = Vec<u32>;

/// The tally of taut ropes at the end.
pub(crate) struct Ropes {
    /// How many are told.
    most: usize,
}

impl Tally for Ropes {
    /// How many traces ended with each rope.
    type Part = HashMap<Key, u64>;
    type Counts = Common<Key>;
    type Answer = Vec<CommonRope>;

    fn new(options: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        Ok(Ropes { most: options.ropes as usize })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        *part.entry(key(traced)).or_default() += 1;
    }

    fn finish(&self, part: Self::Part, _: &Size) -> Common<Key> {
        Common::of_block(part)
    }

    fn answer(&self, counts: &Common<Key>, totals: &Totals, setting: &Setting) -> Vec<CommonRope> {
        let traces = totals.traces.sum;
        let rope = |(key, count, at_most): (&Key, u64, u64)| {
            let (anchor, contacts) = key.split_first().expect("a rope has an anchor");
            let side = |&contact: &u32| if contact % 2 == 1 { Side::Right } else { Side::Left }.shown(setting.y_down());
            let at_most = at_most.min(traces);
            // As low as the lower count may be, as high as the higher one.
            let [lower, higher] = [count, at_most].map(|count| setting.confidence.share(count, traces));
            CommonRope {
                count,
                at_most,
                share: Estimate { high: higher.high, ..lower },
                anchor: setting.models[*anchor as usize].anchor().into(),
                wraps: contacts.iter().map(|c| setting.at(c / 2)).collect(),
                sides: contacts.iter().map(|c| side(c).name().to_owned()).collect(),
                labels: match setting.is_nameless() {
                    true => Vec::new(),
                    false => contacts.iter().map(|c| setting.label(c / 2)).collect(),
                },
            }
        };
        counts.top(self.most).into_iter().map(rope).collect()
    }
}

/// What tells a trace's taut rope from others.
fn key(traced: &Traced<'_>) -> Key {
    let contact = |&(at, side)| {
        let vertex = traced.model.vertex_at(at).expect("ropes turn at wall ends");
        2 * vertex + u32::from(side == Side::Right)
    };
    std::iter::once(traced.anchor as u32).chain(traced.record.wraps.iter().map(contact)).collect()
}

/// A taut rope and how common it is. Ropes that turn at the same wall ends on the same sides in the same order are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonRope {
    /// How many traces ended with it, at the least.
    pub count: u64,
    /// How many at the most: ropes that are rare in a block are not all counted.
    pub at_most: u64,
    /// The share of all traces that `count` is.
    pub share: Estimate,
    /// Which of the anchors it is tied to.
    pub anchor: [f64; 2],
    /// Its turns, from the anchor: the places of the wall ends at which it bends.
    pub wraps: Vec<[f64; 2]>,
    /// On which side of the rope the wall end of each turn lies, seen from the anchor: `left` or `right`, as a picture
    /// of the scene shows it.
    pub sides: Vec<String>,
    /// What the scene's file calls the things there; left out where it calls nothing anything.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<Option<String>>,
}
