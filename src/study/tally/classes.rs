//! How common each homotopy class of ropes is.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::common::Common;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::homotopy::{Class, Cut};
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// An anchor's number, and the class of a rope tied there.
type Key = (u32, Class);

/// The tally of classes at the end, if it is asked for.
pub(crate) struct Classes(Option<Known>);

struct Known {
    /// What tells them for each anchor.
    of: Vec<crate::homotopy::Classes>,
    /// How many are told.
    most: usize,
}

impl Tally for Classes {
    /// How many traces ended with each class.
    type Part = HashMap<Key, u64>;
    type Counts = Common<Key>;
    type Answer = Option<ClassAnswer>;

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        let known = || Known {
            of: setting.models.iter().map(crate::homotopy::Classes::new).collect(),
            most: options.classes as usize,
        };
        Ok(Classes((options.classes > 0).then(known)))
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let Some(known) = &self.0 else { return };
        if let Some(class) = known.of[traced.anchor].of_record(traced.trace, traced.record) {
            *part.entry((traced.anchor as u32, class)).or_default() += 1;
        }
    }

    fn finish(&self, part: Self::Part, _: &Size) -> Common<Key> {
        Common::of_block(part)
    }

    fn answer(&self, counts: &Common<Key>, totals: &Totals, setting: &Setting) -> Option<ClassAnswer> {
        let known = self.0.as_ref()?;
        let traces = totals.traces.sum;
        let top = counts.top(known.most);
        let class = |((anchor, class), count, at_most): (&Key, u64, u64)| {
            let at_most = at_most.min(traces);
            // As low as the lower count may be, as high as the higher one.
            let [lower, higher] = [count, at_most].map(|count| setting.confidence.share(count, traces));
            CommonClass {
                class: class.clone().shown(setting.y_down()).to_string(),
                count,
                at_most,
                share: Estimate { high: higher.high, ..lower },
                anchor: setting.models[*anchor as usize].anchor().into(),
            }
        };
        let letters = top.iter().flat_map(|((_, class), ..)| class.word()).map(|letter| letter.0);
        let letters: BTreeSet<u32> = letters.collect();
        let (distinct, is_complete) = counts.distinct();
        Some(ClassAnswer {
            distinct,
            is_complete,
            classes: top.iter().copied().map(class).collect(),
            obstacles: letters.into_iter().filter_map(|obstacle| known.letter(obstacle)).collect(),
        })
    }
}

impl Known {
    /// What a letter stands for: the same for each anchor that has it.
    fn letter(&self, obstacle: u32) -> Option<Letter> {
        let Cut { at, label, .. } =
            self.of.iter().flat_map(crate::homotopy::Classes::cuts).find(|cut| cut.obstacle == obstacle)?;
        Some(Letter { obstacle, at: (*at).into(), label: label.clone() })
    }
}

/// How common each homotopy class of the ropes at the end is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClassAnswer {
    /// How many different classes there were, those of each anchor on their own; at the least, unless `is_complete`.
    pub distinct: u64,
    /// Whether all classes are counted: in each block at most 256 are, the most common ones.
    pub is_complete: bool,
    /// The most common classes, the most common first.
    pub classes: Vec<CommonClass>,
    /// What the letters of these classes stand for.
    pub obstacles: Vec<Letter>,
}

/// A homotopy class and how common it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonClass {
    /// The class as a word, as a picture of the scene shows it.
    pub class: String,
    /// How many traces ended with it, at the least.
    pub count: u64,
    /// How many at the most: classes that are rare in a block are not all counted.
    pub at_most: u64,
    /// The share of all traces that `count` is.
    pub share: Estimate,
    /// Which of the anchors its ropes are tied to.
    pub anchor: [f64; 2],
}

/// An obstacle that stands in words of classes: walls that hang together by common ends, touch or cross.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Letter {
    /// Its number: the lowest of its wall ends' numbers. Its letter is `o` with this number.
    pub obstacle: u32,
    /// Where its cut starts, from where it goes straight up, towards higher y: its wall end with the highest y, and of
    /// several that with the highest x.
    pub at: [f64; 2],
    /// What the scene's file calls it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
}
