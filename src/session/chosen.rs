//! What is written of some traces only: the rope after every step, in `steps.parquet`, and the points, in
//! `points.parquet`. Both are made of the whole study when its answer is, so that they are the same however the work
//! was shared out, stopped and gone on with.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use super::error::SessionError;
use super::folder::{Folder, check};
use super::names::{POINTS, STEPS};
use super::report::origin;
use crate::engine::{Cpu, Engine, Job};
use crate::output::{PointWriter, StepWriter, WholeFile, WriteError};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::study::{Check, Chosen, RunError, State, Study};
use crate::trace::SettledTrace;

/// Which files of this kind the study has.
fn wanted(study: &Study) -> impl Iterator<Item = (&'static str, &Chosen)> {
    let outputs = &study.plan().outputs;
    [(STEPS, &outputs.steps), (POINTS, &outputs.points)].into_iter().filter_map(|(name, of)| Some((name, of.as_ref()?)))
}

/// Writes these files of the traces that `state` counts; tells their check sums.
pub(super) fn write(folder: &Folder, study: &Study, state: &State) -> Result<BTreeMap<String, Check>, SessionError> {
    let mut sums = BTreeMap::new();
    for (name, chosen) in wanted(study) {
        folder.check_place()?;
        let path = folder.file(name);
        let file =
            if name == STEPS { steps(&path, study, state, chosen)? } else { points(&path, study, state, chosen)? };
        file.finish_durably()?;
        let sum = check(&path).map_err(|cause| WriteError::Io { path, cause })?;
        sums.insert(name.to_owned(), sum);
    }
    Ok(sums)
}

/// Whether all these files are in the folder as they were written.
pub(super) fn are_whole(folder: &Folder, study: &Study, state: &State) -> bool {
    wanted(study).all(|(name, _)| {
        let known = state.kept.files.get(name);
        known.is_some() && check(&folder.file(name)).ok().as_ref() == known
    })
}

fn failed(error: WriteError) -> RunError<SessionError> {
    RunError::Caller(error.into())
}

fn steps(path: &Path, study: &Study, state: &State, chosen: &Chosen) -> Result<WholeFile, SessionError> {
    let mut file = StepWriter::create(path, &study.models()[0], &study.extras())?;
    origin(study).iter().for_each(|(key, value)| file.note(key, value));
    // One for each anchor that is needed.
    let mut engines: HashMap<*const Model, Cpu> = HashMap::new();
    study.choose(chosen, state.blocks(), |traces| {
        let traces: Vec<SettledTrace> = traces.into_par_iter().map(|trace| study.traded(trace)).collect();
        let mut records: Vec<Option<TraceRecord>> = vec![None; traces.len()];
        let mut left: Vec<usize> = (0..traces.len()).collect();
        while let Some(&first) = left.first() {
            let model = study.model(traces[first].id());
            let is_tied_there = |&i: &usize| Arc::ptr_eq(study.model(traces[i].id()), model);
            let (here, others): (Vec<usize>, Vec<usize>) = left.into_iter().partition(is_tied_there);
            left = others;
            let own: Vec<SettledTrace> = here.iter().map(|&i| traces[i].clone()).collect();
            let engine = engines.entry(Arc::as_ptr(model)).or_insert_with(|| Cpu::new(model.clone()));
            for (i, record) in here.into_iter().zip(engine.evaluate(&own, &Job::new())?) {
                records[i] = Some(record);
            }
        }
        traces
            .iter()
            .zip(records.iter().flatten())
            .try_for_each(|(trace, record)| file.write_tied(study.model(trace.id()), trace, record).map_err(failed))
    })?;
    Ok(file.complete()?)
}

fn points(path: &Path, study: &Study, state: &State, chosen: &Chosen) -> Result<WholeFile, SessionError> {
    let mut file = PointWriter::create(path)?;
    origin(study).iter().for_each(|(key, value)| file.note(key, value));
    study.choose(chosen, state.blocks(), |traces| {
        traces.iter().try_for_each(|trace| file.write(trace.id(), &trace.ends()).map_err(failed))
    })?;
    Ok(file.complete()?)
}
