//! Which traces are drawn by the classes of their ropes.

use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::{Cpu, Engine, Job};
use tautline::homotopy::{Class, Classes};
use tautline::rope::TraceRecord;
use tautline::scene::Model;
use tautline::stream::{OfClassError, PickError, Source};
use tautline::trace::{SettledTrace, settle_owned};

use super::failure::Failure;
use super::words::counted;

/// The most traces in one picture.
const MOST: usize = 6;

/// Traces by the classes of their ropes.
#[derive(Debug, clap::Args)]
pub(crate) struct ClassArgs {
    /// Trace ID, and of the others the first five whose ropes are of the same class at the end: that lie the same way
    /// among the obstacles
    #[arg(long, allow_negative_numbers = true, value_name = "ID", conflicts_with_all = ["wanted", "gallery"])]
    same_class: Option<u64>,
    /// The first six traces whose ropes are of this class, a word as `eval --class` writes it, such as "o12 o7^-1"
    #[arg(long, value_name = "WORD", conflicts_with_all = ["wanted", "gallery", "same_class"])]
    class: Option<Class>,
}

/// Traces with what became of them.
type Evaluated = (Vec<SettledTrace>, Vec<TraceRecord>);

impl ClassArgs {
    /// The option that is given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let class = self.class.as_ref().map(|_| "--class");
        self.same_class.map(|_| "--same-class").or(class)
    }

    /// The traces of the class asked for, out of sources that `source` opens; `None` if none is asked for. Says how
    /// many there are.
    pub(crate) fn traces(
        &self,
        model: &Arc<Model>,
        source: impl Fn() -> Result<Source, Failure>,
        not_found: impl Fn(PickError) -> Failure,
    ) -> Result<Option<Evaluated>, Failure> {
        if self.given().is_none() {
            return Ok(None);
        }
        let (classes, mut engine) = (Classes::new(model), Cpu::new(model.clone()));
        let y_down = model.scene().y_down();
        let mut one = None;
        let class = match (self.same_class, &self.class) {
            (Some(id), _) => {
                let trace = source()?.pick(&[id], model).map_err(&not_found)?.remove(0);
                let settled = settle_owned(model, trace);
                let record = engine.evaluate(std::slice::from_ref(&settled), &Job::new())?.remove(0);
                let class = classes.of_record(&settled, &record);
                let no_class = || match settled.violation() {
                    Some(violation) => Failure::input(anyhow!("--same-class {id}: {violation}, so it has no class")),
                    None => Failure::input(anyhow!("--same-class {id}: the trace has no class")),
                };
                let class = class.ok_or_else(no_class)?;
                one = Some((settled, record));
                class
            }
            // Words are as pictures show them.
            (None, class) => class.clone().unwrap_or_default().shown(y_down),
        };
        let found = source()?.of_class(&class, &classes, &mut engine, MOST).map_err(|error| match error {
            OfClassError::Stream(error) => error.into(),
            OfClassError::Engine(error) => error.into(),
            OfClassError::Empty => not_found(PickError::Empty),
            OfClassError::None { .. } => Failure::input(anyhow!("--class: {error}")),
        })?;
        let mut first = found.first;
        if let Some(one) = one
            && first.iter().all(|(trace, _)| trace.id() != one.0.id())
        {
            first.truncate(MOST - 1);
            first.push(one);
        }
        let of = counted(found.of, "trace", "traces");
        let drawn = first.len() as u64;
        let shown = if found.count > drawn { format!(", of which {drawn} are drawn") } else { String::new() };
        say!("class {}: {} of {of}{shown}", class.shown(y_down), found.count);
        Ok(Some(first.into_iter().unzip()))
    }
}
