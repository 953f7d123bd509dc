//! Another method altogether: the shortest path homotopic to the trace, by triangulation, crossing word and funnel.
//!
//! The trace's crossing word over a triangulation of the vertices, with neighbouring crossings of one edge back and forth
//! cancelled, names its homotopy class; the funnel algorithm finds the shortest path through the triangles that the
//! word leads through (Hershberger and Snoeyink, "Computing minimum length paths of a given homotopy class", Comput.
//! Geom. 4, 1994; Lee and Preparata, Networks 14, 1984). It shares the exact predicates with the ray method and nothing
//! else, so the two check each other. It keeps no contacts passed straight: events may differ from the reference's, taut
//! ropes may not.

mod mesh;
mod path;
mod word;

use glam::DVec2;

use self::mesh::Mesh;
use self::path::Path;
use self::word::Word;
use super::walk::Walk;
use super::{Engine, EngineError, Job};
use crate::rope::{EventKind, Side, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// A contact of the taut rope: vertex and side.
type Contact = (u32, Side);

/// The engine that finds the taut rope anew from the trace's crossing word after every step.
///
/// O(triangles crossed + length of the word) a step, on one thread.
#[derive(Clone, Copy)]
pub struct Funnel<'m> {
    model: &'m Model,
}

impl<'m> Funnel<'m> {
    /// An engine for `model`.
    pub fn new(model: &'m Model) -> Self {
        Funnel { model }
    }
}

impl Engine for Funnel<'_> {
    fn name(&self) -> &'static str {
        "funnel"
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        let model = self.model;
        let mesh = Mesh::new(model, traces)?;
        let mut walk = Walk::new();
        let mut word = Word::default();
        let mut path = Path::default();
        let mut records = Vec::with_capacity(traces.len());
        for trace in traces {
            walk.start(model, trace);
            word.start(&mesh, trace.point(0));
            while !walk.is_done(trace) {
                job.go_on()?;
                let to = walk.at + 1;
                word.go(&mesh, trace.point(to - 1), trace.point(to));
                if trace.ends_step(to) {
                    let taut = path.tighten(&mesh, model.anchor(), word.portals(), trace.points()[to]);
                    change(&mut walk, trace, model.vertices(), taut);
                }
                let before = trace.step(walk.at);
                walk.arrive(trace);
                job.count(trace.step(walk.at) - before);
            }
            records.push(walk.record(trace));
        }
        Ok(records)
    }
}

/// Turns the rope into `taut`: unwraps what it no longer touches and wraps what is new.
fn change(walk: &mut Walk, trace: &SettledTrace, vertices: &[DVec2], taut: &[Contact]) {
    let contacts = walk.rope.contacts();
    let kept = contacts.iter().zip(taut).take_while(|(c, t)| (c.vertex, c.side) == **t).count();
    while walk.rope.contacts().len() > kept {
        if let Some(c) = walk.rope.pop() {
            walk.note(trace, EventKind::Unwrap, c.vertex, c.side);
        }
    }
    for &(vertex, side) in &taut[kept..] {
        walk.rope.push(vertex, vertices[vertex as usize], side);
        walk.note(trace, EventKind::Wrap, vertex, side);
    }
}
