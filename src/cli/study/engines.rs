//! What computes a study's ropes.

use anyhow::anyhow;
use tautline::engine::Engine;
use tautline::study::Study;

use crate::cli::engine::EngineArgs;
use crate::cli::failure::Failure;

/// The engines, one for each anchor, and in words what they run on.
pub(super) struct Engines {
    pub(super) engines: Vec<Box<dyn Engine>>,
    pub(super) on: String,
}

impl Engines {
    /// Two engines are refused, since an answer does not tell what computed it: the ropes of `note` are wrong on
    /// purpose, and `funnel` knows no contacts passed straight.
    pub(super) fn open(args: &EngineArgs, study: &Study) -> Result<Self, Failure> {
        let (first, others) = study.models().split_first().expect("a study has an anchor");
        let opened = args.open_for(study.plan().run.precision, first)?;
        if !opened.kind.counts_events() {
            return Err(Failure::input(anyhow!(
                "--engine: {} does not count the same events as the other engines; give one of those for a study",
                opened.kind.name
            )));
        }
        let on = opened.on.to_string();
        let others: Vec<_> = others.iter().map(|model| opened.another(model.clone())).collect::<Result<_, _>>()?;
        Ok(Engines { engines: std::iter::once(opened.engine).chain(others).collect(), on })
    }
}
