//! Drives along shortest paths from one random goal to the next.

use std::sync::Arc;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::kind::{Basics, Dice, Draw, Drawn, Kind};
use super::paths::{Paths, Search};
use super::room::Room;
use super::start::{From, Start, TOO_WIDE};
use crate::geometry::{between, orient, point};
use crate::scene::Model;
use crate::study::free_space::Region;
use crate::study::plan_error::PlanError;
use crate::study::random::{Purpose, Random};
use crate::trace::{Trace, first_violation};
use crate::visibility::Visibility;

/// How many goals are drawn in vain, one after the other, before the free end stays where it is.
pub(super) const TRIES: u32 = 64;

/// Drives along shortest collision-free paths from one random goal to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WaypointDrive {
    /// The length of a step along the path.
    pub step: f64,
    /// How many steps a trace has.
    pub steps: u32,
    /// Where traces start.
    #[serde(default)]
    pub start: Start,
}

impl Kind for WaypointDrive {
    fn basics(&self) -> Basics {
        Basics::free(self.step, self.steps, self.start, None)
    }

    fn drawer(&self, room: &Room) -> Result<Box<dyn Draw>, PlanError> {
        Ok(Box::new(Waypoints::new(&room.model, self)?))
    }
}

struct Waypoints {
    step: f64,
    steps: u32,
    space: Region,
    paths: Paths,
}

impl Draw for Waypoints {
    fn draw(&self, room: &Room, start: From, dice: Dice) -> Drawn {
        let points = self.drive(&room.model, start, &mut dice.of(Purpose::Goal));
        Drawn { points, met: 0, held_back: None }
    }

    /// It passes wall ends.
    fn keeps_clear(&self) -> bool {
        false
    }
}

impl Waypoints {
    fn new(model: &Arc<Model>, plan: &WaypointDrive) -> Result<Self, PlanError> {
        let wrong = || PlanError::new(format!("walk.kind: no paths can be searched for, since {TOO_WIDE}"));
        let visibility = Visibility::new(model).ok_or_else(wrong)?;
        let space = Region::reached(model, &visibility).ok_or_else(wrong)?;
        Ok(Waypoints { step: plan.step, steps: plan.steps, space, paths: Paths::new(model, visibility) })
    }

    /// The points of a drive of `steps` steps. Goals and wall ends at which the path bends are points of it, so the
    /// step to one is shorter, and a path that follows a wall has no points between the wall's ends.
    fn drive(&self, model: &Model, start: From, goals: &mut Random) -> Vec<DVec2> {
        let wanted = self.steps as usize + 1;
        let mut points = Vec::with_capacity(wanted + 1);
        points.push(start.at(model));
        let (mut here, mut search) = (start, Search::default());
        while points.len() < wanted {
            let way = (0..TRIES).find_map(|_| {
                let goal = self.space.draw(goals, |p| model.is_clear(p, p) && p != here.at(model))?;
                let path = self.paths.find(here, goal, &mut search)?;
                Some((goal, self.follow(model, &path, wanted - points.len())?))
            });
            let Some((goal, way)) = way else {
                points.resize(wanted, here.at(model));
                break;
            };
            points.extend_from_slice(&way[1..]);
            here = From::Place(goal);
        }
        points
    }

    /// The points of a drive along `path`, its first included and besides that no more than `most`; `None` if it breaks
    /// the rules.
    fn follow(&self, model: &Model, path: &[DVec2], most: usize) -> Option<Vec<DVec2>> {
        // Points between bends are rounded, so near walls they may lie on the wrong side: then they are left out.
        [true, false].into_iter().find_map(|is_spaced| {
            let mut way = Trace { id: 0, points: vec![path[0]] };
            for leg in path.windows(2) {
                let room = (most + 1).saturating_sub(way.points.len());
                if is_spaced {
                    way.points.extend(self.between(model, [leg[0], leg[1]], room));
                }
                way.points.push(leg[1]);
            }
            way.points.truncate(most + 1);
            let points = way.points.clone();
            first_violation(model, way).is_none().then_some(points)
        })
    }

    /// The points between the ends of a leg, from the first on and no more than `most`; none if they would touch a
    /// wall.
    fn between(&self, model: &Model, [a, b]: [DVec2; 2], most: usize) -> Vec<DVec2> {
        let length = a.distance(b);
        let spaced = (1..=most).map(|k| k as f64 * self.step).take_while(|&along| along < length);
        let mut points: Vec<DVec2> = spaced.map(|along| point(a.lerp(b, along / length))).collect();
        let Some(&last) = points.last() else { return points };
        // A way is clear that leaves a wall's end, not one that comes to it.
        let is_clear = model.is_clear(a, points[0])
            && points.windows(2).all(|pair| model.is_clear(pair[0], pair[1]))
            && model.is_clear(b, last);
        if !is_clear || runs_along_wall(model, a, b) {
            points.clear();
        }
        points
    }
}

/// Whether a wall goes from `a` in the direction of `b`.
fn runs_along_wall(model: &Model, a: DVec2, b: DVec2) -> bool {
    model.index().near(a, a).map(|wall| model.scene().ends(wall as usize)).any(|[u, v]| {
        let goes_on = |end: DVec2| end != a && orient(a, b, end) == 0.0 && !between(end, a, b);
        orient(u, v, a) == 0.0 && (goes_on(u) || goes_on(v))
    })
}
