//! The traces of a source whose ropes are of one class.

use rayon::prelude::*;

use super::pick::TRACES;
use super::{Source, StreamError};
use crate::engine::{Engine, EngineError, Job};
use crate::homotopy::{Class, Classes};
use crate::rope::TraceRecord;
use crate::trace::{SettledTrace, settle_owned};

/// Traces whose ropes are of one class.
#[derive(Debug)]
pub struct OfClass {
    /// The first of them, in the order of the source.
    pub first: Vec<(SettledTrace, TraceRecord)>,
    /// How many there are.
    pub count: u64,
    /// Of how many traces in all.
    pub of: u64,
}

/// Why the traces of a class cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum OfClassError {
    /// They cannot be read.
    #[error(transparent)]
    Stream(#[from] StreamError),
    /// They cannot be evaluated.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// There are no traces.
    #[error("there are no traces in it")]
    Empty,
    /// None is of that class.
    #[error("none of the {of} traces has a rope of class {class}")]
    None {
        /// The class, as a picture shows it.
        class: Class,
        /// How many traces there are.
        of: u64,
    },
}

impl Source {
    /// Evaluates all traces of the source with `engine` and gives the first `most` of those whose ropes at the end are
    /// of that class. Traces that cross walls have no class. Memory is bounded by a batch and these.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, an engine that fails, and a class that no rope has.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tautline::engine::Cpu;
    /// use tautline::example::{Walker, floor_plan};
    /// use tautline::homotopy::Classes;
    /// use tautline::scene::Model;
    /// use tautline::stream::Source;
    ///
    /// let model = Arc::new(Model::new(floor_plan(), None)?);
    /// let (walks, classes) = (Source::Walks(Walker { step: 0.3, steps: 99, seed: 1 }, 0..20), Classes::new(&model));
    /// let found = walks.of_class(&"e".parse()?, &classes, &mut Cpu::new(model.clone()), 2)?;
    /// assert_eq!((found.first.len(), found.of), (2, 20));
    /// assert!(found.count >= 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_class(
        mut self,
        class: &Class,
        classes: &Classes,
        engine: &mut dyn Engine,
        most: usize,
    ) -> Result<OfClass, OfClassError> {
        let model = classes.model();
        let mut found = OfClass { first: Vec::new(), count: 0, of: 0 };
        while let Some(batch) = self.next(model, TRACES)? {
            let settled: Vec<SettledTrace> = batch.into_par_iter().map(|trace| settle_owned(model, trace)).collect();
            let records = engine.evaluate(&settled, &Job::new())?;
            let all: Vec<_> = settled.into_iter().zip(records).collect();
            let is_one: Vec<bool> = all
                .par_iter()
                .map(|(trace, record)| classes.of_record(trace, record).is_some_and(|found| found == *class))
                .collect();
            found.of += all.len() as u64;
            for (one, _) in all.into_iter().zip(is_one).filter(|(_, is_one)| *is_one) {
                found.count += 1;
                if found.first.len() < most {
                    found.first.push(one);
                }
            }
        }
        match (found.of, found.count) {
            (0, _) => Err(OfClassError::Empty),
            (of, 0) => Err(OfClassError::None { class: class.clone().shown(model.scene().y_down()), of }),
            _ => Ok(found),
        }
    }
}
