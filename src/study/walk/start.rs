//! Where traces start.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::Model;
use crate::study::free_space::{Place, Region};
use crate::study::plan_error::PlanError;
use crate::study::random::Random;
use crate::visibility::Visibility;

/// Where a trace starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// At the anchor.
    #[default]
    Anchor,
    /// At a point drawn uniformly over what is visible from the anchor within the scene's bounding box, no further away
    /// than the tether is long, if there is one.
    Visible,
}

/// What is wrong with a scene that cannot be triangulated.
pub(super) const TOO_WIDE: &str = "the scene's coordinates cannot be triangulated: in magnitude the smallest that \
    is not 0 and the largest must lie within 140 powers of two of each other";

/// From where traces start.
pub(super) enum Starts {
    Anchor,
    /// From what is visible from the anchor: it lies in these triangles. No further away than the tether is long.
    Visible(Region, Option<f64>),
}

/// Where a trace starts.
#[derive(Debug, Clone, Copy)]
pub(super) enum From {
    Anchor,
    Place(Place),
}

impl Starts {
    pub(super) fn new(model: &Model, start: Start, tether: Option<f64>) -> Result<Self, PlanError> {
        let seen = |visibility: Visibility| Region::seen(model, &visibility);
        match start {
            Start::Anchor => Ok(Starts::Anchor),
            Start::Visible => Visibility::new(model)
                .and_then(seen)
                .map(|region| Starts::Visible(region, tether))
                .ok_or_else(|| PlanError::new(format!("walk.start: {TOO_WIDE}; or let traces start at the anchor"))),
        }
    }

    /// Where a trace starts: the anchor if nearly nothing is visible from there that the tether lets it reach.
    pub(super) fn draw(&self, model: &Model, random: &mut Random) -> From {
        match self {
            Starts::Anchor => From::Anchor,
            Starts::Visible(region, tether) => {
                let anchor = model.anchor();
                let is_near = |p: DVec2| tether.is_none_or(|length| anchor.distance(p) <= length);
                let start = region.draw(random, |p| is_near(p) && model.is_clear(anchor, p));
                start.map_or(From::Anchor, From::Place)
            }
        }
    }
}

impl From {
    pub(super) fn at(self, model: &Model) -> DVec2 {
        match self {
            From::Anchor => model.anchor(),
            From::Place(place) => place.at,
        }
    }
}
