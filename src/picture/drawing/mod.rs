//! Drawings of traces and their ropes: at one moment, event by event, and moving.

mod animation;
mod canvas;
mod error;
mod film;
mod key;
mod marks;
mod page;
mod rays;
mod rope;
mod still;
mod strip;
mod theme;
mod trace;

use glam::DVec2;

use super::plane::View;
use crate::rope::{EndsRecord, Moment, TraceRecord, moments};
use crate::scene::{Model, Scene};
use crate::trace::{End, SettledEnds, SettledTrace};

pub use error::DrawError;
pub use strip::MOST_FRAMES;
pub(super) use strip::Panel;
pub use theme::Theme;

/// Which part of the plane a drawing shows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Part {
    /// The traces, their ropes and what is about them; all walls where that is not much more, or where there is no
    /// trace.
    #[default]
    Near,
    /// All walls, and the traces.
    All,
    /// The rectangle between two opposite corners, in the scene's frame and unit.
    Between(DVec2, DVec2),
}

/// How many rays of the pivot a still picture has unless told otherwise.
const RAYS: usize = 12;

/// A scene with traces and their ropes, to be drawn. The same drawing gives the same bytes.
///
/// The anchor is a filled circle, the points of traces and the free end are hollow ones, walls are solid, ropes dashed,
/// the rays of the pivot dash-dotted and the unwrapping ray dotted. A key below says what occurs in the picture.
///
/// ```
/// use std::sync::Arc;
///
/// use tautline::engine::{Engine, Job, Reference};
/// use tautline::picture::{Drawing, Theme, png};
/// use tautline::scene::{Model, Scene};
/// use tautline::trace::{Trace, settle};
///
/// let scene = Scene::new([[[4.0, -3.0].into(), [4.0, 1.0].into()]])?;
/// let model = Arc::new(Model::new(scene, Some([0.0, 0.0].into()))?);
/// let points = [[2.0, 2.0], [5.0, 3.0], [7.0, -1.0]].map(Into::into).to_vec();
/// let trace = settle(&model, &Trace { id: 0, points });
/// let record = Reference::new(model.clone()).evaluate(&[trace.clone()], &Job::new())?.remove(0);
///
/// let drawing = Drawing::new(&model).with(&trace, &record).theme(Theme::Dark);
/// let last: String = drawing.svg()?;              // after the last step
/// let first = drawing.clone().at_step(0).svg()?;  // after the first
/// let events = drawing.frames(None)?;             // a small picture for each wrap and unwrap
/// let page = drawing.page()?;                     // plays it in a browser
/// let folder = tempfile::tempdir()?;
/// std::fs::write(folder.path().join("rope.png"), png(&last, 1440)?)?;
/// # assert!(first != last && events.contains("wrap") && page.contains("<script"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Drawing<'a> {
    scene: &'a Scene,
    anchor: Option<DVec2>,
    /// What rays are found with.
    model: Option<&'a Model>,
    dragged: Vec<Dragged<'a>>,
    step: Option<usize>,
    part: Part,
    theme: Theme,
    rays: Option<usize>,
}

/// A trace with what its rope did.
#[derive(Clone)]
struct Dragged<'a> {
    record: &'a TraceRecord,
    points: Vec<DVec2>,
    /// The first step that breaks the rules.
    crossing: Option<usize>,
    /// Where the anchor is after every step, and what the rope did at which end, if both move.
    both: Option<(Vec<DVec2>, &'a EndsRecord)>,
}

impl<'a> Drawing<'a> {
    /// A drawing of `model`, without traces yet.
    pub fn new(model: &'a Model) -> Self {
        Drawing { anchor: Some(model.anchor()), model: Some(model), ..Drawing::of_scene(model.scene()) }
    }

    /// A drawing of the scene alone, with its anchor if it marks one.
    pub fn of_scene(scene: &'a Scene) -> Self {
        Drawing {
            scene,
            anchor: scene.anchor(),
            model: None,
            dragged: Vec::new(),
            step: None,
            part: Part::Near,
            theme: Theme::Reader,
            rays: None,
        }
    }

    /// With a trace and its rope. Both must be of the drawing's model. O(points).
    #[must_use]
    pub fn with(mut self, trace: &SettledTrace, record: &'a TraceRecord) -> Self {
        self.dragged.push(Dragged {
            record,
            points: trace.ends().into_owned(),
            crossing: trace.violation().map(|v| v.step),
            both: None,
        });
        self
    }

    /// With the paths of both ends of a rope, and the rope; for pictures of one moment. Both must be of the drawing's
    /// scene. O(points).
    #[must_use]
    pub fn with_ends(mut self, trace: &SettledEnds, record: &'a EndsRecord) -> Self {
        self.dragged.push(Dragged {
            record: &record.record,
            points: trace.path(End::Free).ends().into_owned(),
            crossing: trace.violation().map(|(_, v)| v.step),
            both: Some((trace.path(End::Anchor).ends().into_owned(), record)),
        });
        self
    }

    /// Shows the moment after step `step`, the move from point `step - 1` to point `step`, rather than after the last.
    #[must_use]
    pub fn at_step(mut self, step: usize) -> Self {
        self.step = Some(step);
        self
    }

    /// Shows that part of the plane.
    #[must_use]
    pub fn part(mut self, part: Part) -> Self {
        self.part = part;
        self
    }

    /// On that ground.
    #[must_use]
    pub fn theme(mut self, theme: Theme) -> Self {
        self.theme = theme;
        self
    }

    /// With at most so many rays of the pivot, those nearest to the free end, and its unwrapping ray; with 0 without
    /// any.
    ///
    /// Unless told otherwise the still picture of one trace has 12 and small ones have none. Pictures of several traces
    /// and moving ones never have any.
    #[must_use]
    pub fn rays(mut self, most: usize) -> Self {
        self.rays = Some(most);
        self
    }

    /// The one trace that `what` shows.
    fn one(&self, what: &'static str) -> Result<&Dragged<'a>, DrawError> {
        match self.dragged.as_slice() {
            [] => Err(DrawError::NoTrace { what }),
            [one] if one.both.is_some() => Err(DrawError::AnchorMoves { what, trace: one.record.trace }),
            [one] => Ok(one),
            more => Err(DrawError::OneTrace { what, traces: more.len() }),
        }
    }

    /// Where ropes are tied; nowhere if the anchors of all move.
    fn tied(&self) -> Option<DVec2> {
        self.anchor.filter(|_| self.dragged.is_empty() || self.dragged.iter().any(|d| d.both.is_none()))
    }

    /// The moment of a trace that is shown.
    fn moment(&self, dragged: &Dragged<'_>) -> Result<Moment, DrawError> {
        let steps = dragged.points.len() - 1;
        let step = self.step.unwrap_or(steps);
        if step > steps {
            return Err(DrawError::Step { trace: dragged.record.trace, step, steps });
        }
        if let Some((anchors, record)) = &dragged.both {
            let rope = record.rope_after(self.scene.vertices(), anchors[step], step);
            return Ok(Moment { step, share: 1.0, at: dragged.points[step], event: None, rope });
        }
        let mut shown = None;
        self.moments(dragged, &dragged.points[..=step], |m| {
            if m.event.is_none() && m.step == step {
                shown = Some(m.clone());
            }
        });
        Ok(shown.expect("every step has an end"))
    }

    /// All moments of the first points of a trace.
    fn moments(&self, dragged: &Dragged<'_>, points: &[DVec2], each: impl FnMut(&Moment)) {
        let anchor = self.anchor.expect("a trace's scene has an anchor");
        moments(anchor, self.scene.vertices(), points, &dragged.record.events, each);
    }

    /// The rectangle that is shown, with no side more than `aspect` times the other; the picture of nothing shows the
    /// unit square.
    fn view(&self, aspect: f64) -> Result<View, DrawError> {
        if let Part::Between(a, b) = self.part {
            let (low, high) = (a.min(b), a.max(b));
            let size = high - low;
            if !(size.min_element() > 0.0 && size.is_finite()) {
                return Err(DrawError::Part { corners: [a.x, a.y, b.x, b.y].map(|x| x.to_string()) });
            }
            return Ok(View { low, high }.widened(0.0, 12.0));
        }
        // A taut rope does not leave the box around its trace and the anchor.
        let near = || {
            let both = |d: &Dragged<'_>| d.both.iter().flat_map(|b| b.0.clone()).collect::<Vec<_>>();
            let dragged = self.dragged.iter().flat_map(move |d| d.points.iter().copied().chain(both(d)));
            dragged.chain(self.tied())
        };
        let all = || self.scene.vertices().iter().copied().chain(near());
        let unit = View { low: DVec2::ZERO, high: DVec2::ONE };
        let view = match self.part {
            Part::Near if !self.dragged.is_empty() => View::of_what_matters(near(), all(), aspect),
            _ => View::of_what_matters(all(), all(), aspect),
        };
        Ok(view.unwrap_or(unit))
    }
}
