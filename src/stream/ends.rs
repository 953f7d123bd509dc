//! Traces of ropes whose ends both move, from file to file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use rayon::prelude::*;

use super::{OnViolation, Stage, StreamError, Times};
use crate::engine::{Engine, Job};
use crate::output::{EventWriter, Extras, ForceWriter, ResultWriter, StepWriter, WholeFile, commit};
use crate::read_error::ReadError;
use crate::rope::{EndsRecord, Friction, TraceRecord};
use crate::scene::{Model, Scene};
use crate::trace::{End, EndsTrace, SettledEnds, Trace, TraceReader, read_traces, settle_ends};

/// How many points the free ends of a batch have together at most.
const POINTS: usize = 1 << 21;

/// Where the paths of both ends come from.
pub struct EndsSource {
    reader: TraceReader,
    /// The anchors' paths by trace, and their file, where the traces do not have them in their rows.
    anchors: Option<(PathBuf, BTreeMap<u64, Vec<DVec2>>)>,
    /// What has been read ahead.
    ahead: Option<Vec<EndsTrace>>,
}

impl EndsSource {
    /// Traces whose rows say where the anchor is ([`TraceReader::moves_anchor`]).
    pub fn in_rows(reader: TraceReader) -> Self {
        EndsSource { reader, anchors: None, ahead: None }
    }

    /// Traces whose anchors' paths are the traces in another file: the only one there, for all of them, or those of the
    /// same numbers. That file is held in memory.
    ///
    /// # Errors
    ///
    /// A file of paths that cannot be read.
    pub fn with_paths(reader: TraceReader, paths: &Path) -> Result<Self, ReadError> {
        let anchors = read_traces(paths)?.into_iter().map(|trace| (trace.id, trace.points)).collect();
        Ok(EndsSource { reader, anchors: Some((paths.to_owned(), anchors)), ahead: None })
    }

    /// Where the anchor of the first trace starts; `None` if there are no traces. Reads the first batch of `traces`
    /// ahead.
    ///
    /// # Errors
    ///
    /// Traces that cannot be read, and one without a path for its anchor.
    pub fn start(&mut self, traces: usize) -> Result<Option<DVec2>, StreamError> {
        let first = self.next(traces)?;
        let start = first.as_ref().and_then(|traces| traces.first()?.anchor.first().copied());
        self.ahead = first;
        Ok(start)
    }

    /// How much there is, in rows or bytes; 0 if nobody knows.
    pub fn size(&self) -> u64 {
        self.reader.size()
    }

    /// The next traces.
    pub(super) fn next(&mut self, traces: usize) -> Result<Option<Vec<EndsTrace>>, StreamError> {
        if let Some(ahead) = self.ahead.take() {
            return Ok(Some(ahead));
        }
        let Some((path, anchors)) = &self.anchors else { return Ok(self.reader.next_ends(traces, POINTS)?) };
        let Some(free) = self.reader.next_batch(traces, POINTS)? else { return Ok(None) };
        let both = |trace: Trace| {
            let one = anchors.values().next().filter(|_| anchors.len() == 1);
            match one.or_else(|| anchors.get(&trace.id)) {
                Some(anchor) => Ok(EndsTrace { free: trace, anchor: anchor.clone() }),
                None => Err(StreamError::NoAnchor { path: path.clone(), trace: trace.id }),
            }
        };
        free.into_iter().map(both).collect::<Result<_, _>>().map(Some)
    }
}

/// What is to be written of ropes whose ends both move.
#[derive(Debug, Clone, Copy, Default)]
pub struct EndsFiles<'a> {
    /// One row a trace.
    pub out: Option<&'a Path>,
    /// One row a wrap or unwrap, with the end at which it happened.
    pub events: Option<&'a Path>,
    /// One row a step, and what is told beside the ropes.
    pub steps: Option<(&'a Path, &'a Extras)>,
    /// One row for each turn of the ropes at the end, with that friction.
    pub forces: Option<(&'a Path, Friction)>,
}

/// How far such a stream is.
pub type EndsStage<'a> = Stage<'a, SettledEnds, EndsRecord>;

/// Evaluates all traces of a source among the walls of `model` and writes their ropes to `files`, which appear at the
/// end, all or none. `watch` is told of each batch. Memory is bounded by a batch and the anchors' paths.
///
/// # Errors
///
/// What can go wrong with the traces, the engine or the files; the first trace that breaks the rules, if it is to end
/// the run; [`EngineError::Stopped`](crate::engine::EngineError::Stopped) when the job was stopped.
pub fn evaluate_ends(
    mut source: EndsSource,
    model: &Arc<Model>,
    engine: &mut dyn Engine,
    files: EndsFiles<'_>,
    on_violation: OnViolation,
    job: &Job,
    mut watch: impl FnMut(EndsStage<'_>),
) -> Result<Times, StreamError> {
    let mut times = Times::default();
    let mut writers = Writers::create(files, model)?;
    loop {
        let start = Instant::now();
        let Some(traces) = source.next(engine.batch())? else { break };
        let settled = traces.par_iter().map(|trace| settle_ends(model, &trace.free, &trace.anchor));
        let settled: Vec<SettledEnds> = settled.collect::<Result<_, _>>()?;
        if let (OnViolation::Error, Some((end, first))) = (on_violation, settled.iter().find_map(|t| t.violation())) {
            return Err(match end {
                End::Free => StreamError::Violation(Box::new(*first)),
                End::Anchor => StreamError::AnchorViolation(Box::new(*first)),
            });
        }
        watch(Stage::Read { settled: &settled, position: source.reader.position() });
        times.prepared += start.elapsed();
        let start = Instant::now();
        let records = engine.evaluate_ends(&settled, job)?;
        times.evaluated += start.elapsed();
        watch(Stage::Evaluated { settled: &settled, records: &records });
        times.written += writers.write(model.scene(), &settled, records)?;
    }
    times.written += writers.finish()?;
    Ok(times)
}

/// The files of a run.
struct Writers {
    out: Option<ResultWriter>,
    events: Option<EventWriter>,
    steps: Option<StepWriter>,
    forces: Option<ForceWriter>,
}

impl Writers {
    fn create(files: EndsFiles<'_>, model: &Arc<Model>) -> Result<Self, StreamError> {
        let scene = model.scene();
        let out = files.out.map(|path| ResultWriter::create(path, scene)).transpose()?;
        let events = files.events.map(|path| EventWriter::of_ends(path, scene)).transpose()?;
        let steps = files.steps.map(|(path, extras)| StepWriter::of_ends(path, model, extras)).transpose()?;
        let forces = files.forces.map(|(path, friction)| ForceWriter::create(path, model, friction)).transpose()?;
        Ok(Writers { out, events, steps, forces })
    }

    fn write(
        &mut self,
        scene: &Scene,
        settled: &[SettledEnds],
        records: Vec<EndsRecord>,
    ) -> Result<Duration, StreamError> {
        let start = Instant::now();
        if let Some(steps) = &mut self.steps {
            steps.write_ends(settled, &records)?;
        }
        if let Some(forces) = &mut self.forces {
            forces.write_ends(settled, &records)?;
        }
        if let Some(events) = &mut self.events {
            events.write_ends(scene, &records)?;
        }
        if let Some(out) = &mut self.out {
            let records: Vec<TraceRecord> = records.into_iter().map(|record| record.record).collect();
            out.write_all(scene, &records)?;
        }
        Ok(start.elapsed())
    }

    /// Gives all files their names.
    fn finish(self) -> Result<Duration, StreamError> {
        let start = Instant::now();
        let out = self.out.map(ResultWriter::complete).transpose()?;
        let events = self.events.map(EventWriter::complete).transpose()?;
        let steps = self.steps.map(StepWriter::complete).transpose()?;
        let forces = self.forces.map(ForceWriter::complete).transpose()?;
        let _together = commit();
        [out, events, steps, forces].into_iter().flatten().try_for_each(WholeFile::finish)?;
        Ok(start.elapsed())
    }
}
