//! Named situations, each a tiny scene with a trace, and a picture of a few of its moments.

mod situations;

use std::sync::Arc;

use glam::DVec2;

use super::drawing::{Drawing, Panel};
use crate::engine::{Engine, Job, Reference};
use crate::scene::{Model, Scene};
use crate::trace::{SettledTrace, Trace, settle};

/// A tiny scene with a trace in which one thing can be seen.
///
/// ```
/// use tautline::picture::Situation;
/// let wrap = Situation::all().iter().find(|s| s.name == "wrap").unwrap();
/// let model = wrap.model();
/// assert_eq!(wrap.trace(&model).violation(), None);
/// assert!(wrap.svg().contains(wrap.title));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// A short name, as files have it.
    pub name: &'static str,
    /// The name in words.
    pub title: &'static str,
    /// What is seen, in one sentence.
    pub caption: &'static str,
    walls: &'static [[[f64; 2]; 2]],
    anchor: [f64; 2],
    points: &'static [[f64; 2]],
    /// After which steps the rope is shown.
    steps: &'static [usize],
}

/// How many rays of the pivot are drawn.
const RAYS: usize = 6;

impl Situation {
    /// The walls and the anchor.
    pub fn model(&self) -> Arc<Model> {
        let scene = Scene::new(self.walls.iter().map(|ends| ends.map(DVec2::from))).expect("small numbers");
        Arc::new(Model::new(scene, Some(self.anchor.into())).expect("the anchor stands in no wall"))
    }

    /// The trace, settled against that model; its number is 0.
    pub fn trace(&self, model: &Model) -> SettledTrace {
        settle(model, &Trace { id: 0, points: self.points.iter().copied().map(DVec2::from).collect() })
    }

    /// The picture: the rope after each of the steps that are shown, under the title and the caption.
    pub fn svg(&self) -> String {
        let model = self.model();
        let trace = self.trace(&model);
        let records = Reference::new(model.clone()).evaluate(std::slice::from_ref(&trace), &Job::new());
        let record = records.expect("nobody stops this job").remove(0);
        let drawing = Drawing::new(&model).with(&trace, &record);
        let panels: Vec<Panel> =
            self.steps.iter().map(|&step| drawing.panel_after(step).expect("a step of the trace")).collect();
        drawing.strip(&panels, &format!("{}. {}", self.title, self.caption), RAYS).expect("one trace, all in view")
    }
}
