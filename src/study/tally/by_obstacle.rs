//! Contacts and turns counted by obstacle: several in a row with one obstacle are one. Curves are made of many walls,
//! of more or fewer as closely as they are followed; what is counted here does not depend on that.

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
use crate::rope::EventKind;
use crate::scene::{Island, all_islands, roots};
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// How many obstacles are listed at the most.
const MOST: usize = 1000;

/// The tally, if it is asked for.
pub(crate) struct Obstacles(Option<Known>);

/// What is known of the scene.
struct Known {
    /// The obstacle of each wall end, by the lowest number among its wall ends.
    of: Vec<u32>,
    islands: BTreeMap<u32, Island>,
}

/// What was counted of an obstacle in a block.
#[derive(Clone, Copy, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Touches {
    contacts: u64,
    turns: u64,
    steps: u64,
}

/// The same over blocks.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Touched {
    /// Over blocks as large as they have traces.
    contacts: Batches,
    turns: Batches,
    /// Over blocks as large as they have steps.
    steps: Batches,
}

impl Merge for Touched {
    fn merge_with(&mut self, other: Touched) {
        self.contacts.merge_with(other.contacts);
        self.turns.merge_with(other.turns);
        self.steps.merge_with(other.steps);
    }
}

/// In the place of an obstacle's number: all of them.
const ALL: u32 = u32::MAX;

impl Tally for Obstacles {
    type Part = HashMap<u32, Touches>;
    type Counts = BTreeMap<u32, Touched>;
    type Answer = Option<ByObstacle>;

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        let scene = setting.models[0].scene();
        Ok(Obstacles(options.by_obstacle.then(|| Known {
            of: roots(scene),
            islands: all_islands(scene).into_iter().map(|island| (island.vertex, island)).collect(),
        })))
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let Some(known) = &self.0 else { return };
        let obstacle = |vertex: u32| known.of[vertex as usize];
        let mut touch = |at: u32, what: Touches| {
            for at in [at, ALL] {
                let touches = part.entry(at).or_default();
                touches.contacts += what.contacts;
                touches.turns += what.turns;
                touches.steps += what.steps;
            }
        };
        const CONTACT: Touches = Touches { contacts: 1, turns: 0, steps: 0 };
        const TURN: Touches = Touches { contacts: 0, turns: 1, steps: 0 };
        let steps = |steps: u64| Touches { contacts: 0, turns: 0, steps };
        let mut rope: Vec<u32> = Vec::new();
        // How many contacts the rope has with each obstacle, and after which step the first of them came.
        let mut held: HashMap<u32, (u32, u64)> = HashMap::default();
        for event in &traced.record.events {
            let (at, step) = (obstacle(event.vertex), u64::from(event.step));
            match event.kind {
                EventKind::Wrap => {
                    if rope.last() != Some(&at) {
                        touch(at, CONTACT);
                    }
                    rope.push(at);
                    held.entry(at).or_insert((0, step)).0 += 1;
                }
                EventKind::Unwrap => {
                    rope.pop();
                    let (contacts, since) = held.get_mut(&at).expect("an unwrap follows a wrap");
                    *contacts -= 1;
                    if *contacts == 0 {
                        touch(at, steps(step - *since));
                        held.remove(&at);
                    }
                }
            }
        }
        let last = traced.record.steps + 1;
        held.into_iter().for_each(|(at, (_, since))| touch(at, steps(last - since)));
        let turn = |&(at, _): &(_, _)| obstacle(traced.model.vertex_at(at).expect("ropes turn at wall ends"));
        let mut turns: Vec<u32> = traced.record.wraps.iter().map(turn).collect();
        turns.dedup();
        turns.into_iter().for_each(|at| touch(at, TURN));
    }

    fn finish(&self, part: Self::Part, block: &Size) -> Self::Counts {
        let touched = |touches: Touches| {
            let mut touched = Touched::default();
            touched.contacts.add(block.traces, touches.contacts);
            touched.turns.add(block.traces, touches.turns);
            touched.steps.add(block.looks, touches.steps);
            touched
        };
        part.into_iter().map(|(obstacle, touches)| (obstacle, touched(touches))).collect()
    }

    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Option<ByObstacle> {
        let known = self.0.as_ref()?;
        let around = |(value, error)| setting.confidence.around(value, error, totals.traces.blocks);
        let all = counts.get(&ALL).copied().unwrap_or_default();
        let mut longest: Vec<_> = counts.iter().filter(|&(&obstacle, _)| obstacle != ALL).collect();
        longest.sort_by(|a, b| b.1.steps.sum.cmp(&a.1.steps.sum).then(a.0.cmp(b.0)));
        longest.truncate(MOST);
        let obstacle = |(vertex, touched): (&u32, &Touched)| {
            let island = known.islands.get(vertex)?;
            Some(ObstacleContacts {
                vertex: *vertex,
                at: island.middle.into(),
                label: setting.label(island.named),
                walls: island.walls,
                contacts: around(touched.contacts.ratio(&totals.traces)),
                turns: around(touched.turns.ratio(&totals.traces)),
                share: around(touched.steps.ratio(&totals.looks)),
            })
        };
        Some(ByObstacle {
            contacts: around(all.contacts.ratio(&totals.traces)),
            turns: around(all.turns.ratio(&totals.traces)),
            obstacles: longest.into_iter().filter_map(obstacle).collect(),
        })
    }
}

/// Contacts and turns counted by obstacle: walls that hang together by common ends. However many wall ends of one
/// obstacle a rope touches in a row, they count as one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ByObstacle {
    /// How often a rope came to touch an obstacle, per trace: wraps but for those that follow a contact with the same
    /// obstacle.
    pub contacts: Estimate,
    /// How many turns the taut rope has at the end, those in a row at one obstacle counting as one, per trace.
    pub turns: Estimate,
    /// The obstacles that were touched, those with the greatest share of steps first, at most a thousand.
    pub obstacles: Vec<ObstacleContacts>,
}

/// How often ropes touched an obstacle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ObstacleContacts {
    /// Its number: the lowest of its wall ends' numbers.
    pub vertex: u32,
    /// The middle of the first of its walls, x and y.
    pub at: [f64; 2],
    /// What the scene's file calls it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// How many walls it has.
    pub walls: u32,
    /// How often a rope came to touch it, per trace.
    pub contacts: Estimate,
    /// How often the taut rope turns at it at the end, per trace.
    pub turns: Estimate,
    /// The share of all steps after which the rope has a contact with it, however many.
    pub share: Estimate,
}
