//! How often the note's listing goes wrong.

use std::sync::Arc;

use crate::engine::{Cpu, Engine, EngineError, Job, Note};
use crate::example::{Walker, settled_walks};
use crate::rope::{Side, TraceRecord, replay};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// What a form of the note's listing got wrong on some walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoteErrors {
    /// After how many steps the taut rope is a wrong one.
    pub steps: u64,
    /// In how many traces it is wrong after some step.
    pub traces: u64,
    /// In how many it is wrong at the end.
    pub ends: u64,
}

/// What listing 1 gets wrong on the first `traces` walks of `walker`, and what it does with the note's remedy for walls
/// on one line ([`Note::furthest`]). Compares the taut rope after every step with that of the engine `cpu`, which is
/// exact. O(vertices) a step.
///
/// # Errors
///
/// None that can be foreseen: these engines take every scene.
///
/// ```
/// use tautline::example::{BuiltIn, Walker};
/// use tautline::lab::note_errors;
/// use tautline::scene::Model;
///
/// let model = Model::new(BuiltIn::Lattice(60).scene(1), None)?.into();
/// let [listing, _] = note_errors(&model, Walker { step: 0.5, steps: 100, seed: 1 }, 20)?;
/// assert!(listing.traces > 0 && listing.traces <= 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn note_errors(model: &Arc<Model>, walker: Walker, traces: u64) -> Result<[NoteErrors; 2], EngineError> {
    let walks = settled_walks(model, walker, traces);
    let right = Cpu::new(model.clone()).evaluate(&walks, &Job::new())?;
    let mut errors = [NoteErrors::default(); 2];
    for (mut engine, errors) in
        [Note::new(model.clone()), Note::new(model.clone()).furthest()].into_iter().zip(&mut errors)
    {
        let given = engine.evaluate(&walks, &Job::new())?;
        for ((walk, right), given) in walks.iter().zip(&right).zip(&given) {
            let (right, given) = (ropes(model, walk, right), ropes(model, walk, given));
            let wrong = right.iter().zip(&given).filter(|(right, given)| right != given).count() as u64;
            errors.steps += wrong;
            errors.traces += u64::from(wrong > 0);
            errors.ends += u64::from(right.last() != given.last());
        }
    }
    Ok(errors)
}

/// The taut rope after every step of a walk that starts at the anchor and touches nothing.
fn ropes(model: &Model, walk: &SettledTrace, record: &TraceRecord) -> Vec<Vec<(u32, Side)>> {
    let mut ropes = Vec::with_capacity(walk.points().len());
    replay(model.anchor(), model.vertices(), walk.points().len(), &record.events, |k, rope| {
        ropes.push(rope.taut(walk.points()[k]).iter().map(|c| (c.vertex, c.side)).collect());
    });
    ropes
}
