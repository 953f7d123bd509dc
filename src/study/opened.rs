//! A study with its scene read and everything checked: ready to draw traces.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::models::models;
use super::plan::Plan;
use super::plan_error::PlanError;
use super::shard::Shard;
use super::tally::{Setting, Tallies};
use super::walk::Walks;
use crate::example::{BuiltIn, NameError};
use crate::geometry::{Shown, number};
use crate::output::Extras;
use crate::read_file::open;
use crate::scene::{Centre, Model, Scene, read_scene_with};
use crate::trace::{SettledTrace, Trace, TraceReader, Walked, settle_owned};

/// A study that can be run.
pub struct Study {
    plan: Plan,
    pub(super) tallies: Tallies,
    /// The scene as it is with each of its anchors.
    given_models: Vec<Arc<Model>>,
    /// For each anchor; none if the traces are given.
    walks: Vec<Walks>,
    /// The file of the scene.
    file: Option<PathBuf>,
    /// The file of given traces.
    given: Option<PathBuf>,
    identity: String,
}

impl Study {
    /// Reads what the plan names, relative to `folder`, and checks it.
    ///
    /// # Errors
    ///
    /// What [`Plan::checked`] says, a scene that cannot be read or has no place for the rope, a walk that cannot be
    /// walked there.
    pub fn open(plan: Plan, folder: &Path) -> Result<Self, PlanError> {
        let plan = counted(plan.checked()?, folder)?;
        let scene = match (&plan.scene.built_in, &plan.scene.file) {
            (Some(name), _) => {
                let built_in: BuiltIn = name.parse().map_err(|e: NameError| PlanError::at_key("scene.built_in", e))?;
                built_in.scene(1)
            }
            (None, Some(file)) => read_scene_with(&folder.join(file), &plan.scene.options())
                .map_err(|e| PlanError::at_key("scene.file", e))?,
            (None, None) => return Err(PlanError::new("scene: give `file` or `built_in`")),
        };
        let models = models(&plan, &scene)?;
        let given = plan.walk.given().map(|file| folder.join(file));
        let walks = match given {
            Some(_) => Vec::new(),
            None => {
                let of = |model: &Arc<Model>| Walks::new(model.clone(), &plan.walk, plan.run.seed);
                models.iter().map(of).collect::<Result<_, _>>()?
            }
        };
        let identity = identity(&plan, &models, given.as_deref())?;
        let bounds = models.iter().map(|m| m.bounds()).reduce(|(l, h), (low, high)| (l.min(low), h.max(high)));
        let bounds = bounds.expect("a study has an anchor");
        let simplified = plan.run.trade().simplified(&models).map_err(|e| PlanError::at_key("run.simplify", e))?;
        let setting = Setting::new(&plan.tallies, simplified, bounds, (plan.walk.steps(), plan.walk.tether()));
        let tallies = Tallies::new(&plan.tallies, setting)?;
        centres(&plan, tallies.setting.models[0].scene())?;
        let file = plan.scene.file.as_ref().map(|file| folder.join(file));
        Ok(Study { plan, tallies, given_models: models, walks, file, given, identity })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The files of its scene and of its traces, where it names them.
    pub fn files(&self) -> [Option<&Path>; 2] {
        [self.file.as_deref(), self.given.as_deref()]
    }

    /// The scene with each of its anchors, as ropes see it: simplified if the plan says so. Trace i has anchor i modulo
    /// their number.
    pub fn models(&self) -> &[Arc<Model>] {
        &self.tallies.setting.models
    }

    /// What is told beside the ropes where every step is written.
    pub fn extras(&self) -> Extras {
        let centres = centres(&self.plan, self.models()[0].scene()).expect("names were looked up before");
        Extras { centres, friction: self.plan.tallies.friction() }
    }

    /// A hash of all that the answer depends on: the plan (but for what is written besides the summary), the scene, and
    /// the traces given.
    pub fn identity(&self) -> &str {
        &self.identity
    }

    /// The identity of the same study with so many traces.
    pub(super) fn identity_with(&self, traces: u64) -> Result<String, PlanError> {
        let mut plan = self.plan.clone();
        plan.run.traces = Some(traces);
        identity(&plan, &self.given_models, self.given.as_deref())
    }

    /// The numbers of the traces of a block.
    pub fn block(&self, block: u64) -> Range<u64> {
        let size = u64::from(self.plan.run.block);
        block * size..((block + 1) * size).min(self.plan.run.count())
    }

    /// How many traces a shard has. They are counted from 0, in the order of its blocks: those are their places.
    pub fn places(&self, shard: Shard) -> u64 {
        let last = shard.count(self.plan.blocks()).checked_sub(1);
        last.map_or(0, |last| {
            let block = self.block(shard.block(last));
            last * u64::from(self.plan.run.block) + (block.end - block.start)
        })
    }

    /// The numbers of the traces at these places of a shard, block by block, each with its place among the shard's
    /// blocks.
    pub(super) fn numbers(
        &self,
        shard: Shard,
        places: Range<u64>,
    ) -> impl Iterator<Item = (u64, Range<u64>)> + use<'_> {
        let size = u64::from(self.plan.run.block);
        let blocks = if places.is_empty() { 0..0 } else { places.start / size..places.end.div_ceil(size) };
        blocks.map(move |index| {
            let block = self.block(shard.block(index));
            let at = |place: u64| (block.start + place.saturating_sub(index * size)).min(block.end);
            (index, at(places.start)..at(places.end))
        })
    }

    /// Trace `number`, the same on every machine. O(its steps) where it is drawn; where the traces come from a file,
    /// that is read up to the one that it numbers so.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or has no such trace.
    pub fn trace(&self, number: u64) -> Result<SettledTrace, PlanError> {
        self.whole_trace(number).map(|trace| self.traded(trace))
    }

    /// The same as it was drawn or given, before anything was left out of it for speed.
    ///
    /// # Errors
    ///
    /// As [`trace`](Self::trace).
    pub fn whole_trace(&self, number: u64) -> Result<SettledTrace, PlanError> {
        let Some(path) = &self.given else {
            return Ok(self.drawn(number));
        };
        let none = || PlanError::new(format!("there is no trace {number}")).at(path);
        let mut reader = TraceReader::open(path)?;
        loop {
            let traces = reader.next_batch(1 << 10, 1 << 22)?;
            if let Some(trace) = traces.ok_or_else(none)?.into_iter().find(|trace| trace.id == number) {
                return Ok(self.settled(trace));
            }
        }
    }

    /// The scene with the anchor of trace `number`.
    pub fn model(&self, number: u64) -> &Arc<Model> {
        self.tallies.setting.model(number)
    }

    /// A trace that is drawn, as it is drawn.
    fn drawn(&self, number: u64) -> SettledTrace {
        self.walks[self.tallies.setting.anchor(number)].trace(number)
    }

    /// A trace of the file, as it stands there.
    fn settled(&self, trace: Trace) -> SettledTrace {
        let model = &self.given_models[self.tallies.setting.anchor(trace.id)];
        let settled = settle_owned(model, trace);
        let still = settled.still();
        settled.with_walked(Walked { still, ..Walked::default() })
    }

    /// A trace as ropes see it: what the plan leaves out of it for speed is left out.
    pub fn traded(&self, trace: SettledTrace) -> SettledTrace {
        let model = self.model(trace.id());
        self.plan.run.trade().coarsened(trace, model)
    }

    /// Refuses a study whose walks all stand still: no step of the first traces, one at least from each anchor and five
    /// in all, leads anywhere. O(steps) of the first trace that moves, and all that was tried for those that do not.
    ///
    /// # Errors
    ///
    /// How many traces were drawn in vain, from where, and how long their steps are.
    pub fn check_moves(&self) -> Result<(), PlanError> {
        let Some(step) = self.plan.walk.step() else { return Ok(()) };
        let few = self.plan.run.count().min(5.max(self.models().len() as u64));
        let mut steps = 0;
        for number in 0..few {
            let trace = self.drawn(number);
            if trace.walked().still < trace.steps() {
                return Ok(());
            }
            steps += trace.steps();
        }
        let start = *self.drawn(0).ends().last().expect("a trace has points");
        let (tethered, longer) = match self.plan.walk.tether() {
            Some(tether) => (format!(" or strain the tether of {}", number(tether.length)), ", a longer tether"),
            None => Default::default(),
        };
        Err(PlanError::new(format!(
            "walk: all walks stand still: none of the {steps} steps of the first {few} traces leads anywhere, that of \
             trace 0 from {}, since each would meet a wall or the border of the scene{tethered}; give a step shorter \
             than {}{longer}, or another anchor",
            Shown(start),
            number(step)
        )))
    }

    /// How many wall ends there are before any are left out.
    pub(super) fn vertices(&self) -> usize {
        self.given_models[0].vertices().len()
    }

    /// From where to take traces, from that of number `first` on.
    pub(super) fn source(&self, first: u64) -> Result<Source<'_>, PlanError> {
        let reader = match &self.given {
            None => None,
            Some(path) => {
                let mut reader = TraceReader::open(path)?;
                let there = skip(&mut reader, first)?;
                if there < first {
                    return Err(self.too_few(there));
                }
                Some(reader)
            }
        };
        Ok(Source { study: self, reader, next: first })
    }

    /// What is wrong with the file of traces.
    fn in_file(&self, what: String) -> PlanError {
        let error = PlanError::new(what);
        self.given.iter().fold(error, |error, path| error.at(path))
    }

    /// What is said of a file of so many traces.
    fn too_few(&self, there: u64) -> PlanError {
        let asked = self.plan.run.count();
        self.in_file(format!("run.traces: {asked} are asked for, but the file holds {there}"))
    }
}

/// Traces, one after the other.
pub(super) struct Source<'s> {
    study: &'s Study,
    reader: Option<TraceReader>,
    next: u64,
}

impl Source<'_> {
    /// The traces with these numbers, in order, as ropes see them; those before them are passed over.
    pub(super) fn take(&mut self, numbers: Range<u64>) -> Result<Vec<SettledTrace>, PlanError> {
        let study = self.study;
        self.take_with(numbers, |trace| study.traded(trace))
    }

    /// The same as they were drawn or given.
    pub(super) fn take_whole(&mut self, numbers: Range<u64>) -> Result<Vec<SettledTrace>, PlanError> {
        self.take_with(numbers, |trace| trace)
    }

    fn take_with(
        &mut self,
        numbers: Range<u64>,
        then: impl Fn(SettledTrace) -> SettledTrace + Sync,
    ) -> Result<Vec<SettledTrace>, PlanError> {
        let Some(reader) = &mut self.reader else {
            return Ok(numbers.into_par_iter().map(|number| then(self.study.drawn(number))).collect());
        };
        let there = self.next + skip(reader, numbers.start - self.next)?;
        if there < numbers.start {
            return Err(self.study.too_few(there));
        }
        self.next = numbers.end;
        let mut settled: Vec<SettledTrace> = Vec::new();
        let count = (numbers.end - numbers.start) as usize;
        while settled.len() < count {
            let more = reader.next_batch(count - settled.len(), 1 << 22)?;
            let Some(more) = more else {
                return Err(self.study.too_few(there + settled.len() as u64));
            };
            settled.par_extend(more.into_par_iter().map(|trace| then(self.study.settled(trace))));
        }
        match settled.iter().find_map(|t| t.violation()) {
            Some(violation) => Err(self.study.in_file(violation.to_string())),
            None => Ok(settled),
        }
    }
}

fn centres(plan: &Plan, scene: &Scene) -> Result<Vec<Centre>, PlanError> {
    match plan.outputs.about.as_slice() {
        [] => Ok(scene.labelled()),
        names => scene.called(names).map_err(|e| PlanError::at_key("outputs.about", e)),
    }
}

/// Passes over so many traces, or all that there are; tells how many.
fn skip(reader: &mut TraceReader, count: u64) -> Result<u64, PlanError> {
    let mut skipped = 0;
    while skipped < count {
        let most = (count - skipped).min(1 << 16) as usize;
        match reader.next_batch(most, 1 << 22)? {
            Some(more) => skipped += more.len() as u64,
            None => break,
        }
    }
    Ok(skipped)
}

/// The plan with the number of its traces: where it does not say how many of a file it takes, all that there are. Reads
/// the file to its end for that.
fn counted(mut plan: Plan, folder: &Path) -> Result<Plan, PlanError> {
    let count = match (plan.walk.given(), plan.run.traces) {
        (Some(file), None) => {
            let path = folder.join(file);
            // It is read again for its traces, so it can be no pipe.
            open(&path, false)?;
            let mut reader = TraceReader::open(&path)?;
            match skip(&mut reader, u64::MAX)? {
                0 => return Err(PlanError::new("there are no traces in it").at(&path)),
                count => count,
            }
        }
        _ => plan.run.count(),
    };
    plan.run.traces = Some(count);
    plan.checked()
}

/// Part of every study's identity. The number is to be raised whenever traces are drawn, counted or estimated in
/// another way, so that no study goes on with what came out before; a test of this module notices.
pub(super) const ANSWERS: u32 = 3;

fn identity(plan: &Plan, models: &[Arc<Model>], given: Option<&Path>) -> Result<String, PlanError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(format!("tautline study {ANSWERS}\n").as_bytes());
    let plan = Plan { outputs: Default::default(), ..plan.clone() };
    hasher.update(&serde_json::to_vec(&plan).expect("a plan can be written"));
    let mut point = |p: DVec2| {
        hasher.update(&p.x.to_bits().to_le_bytes());
        hasher.update(&p.y.to_bits().to_le_bytes());
    };
    models.iter().for_each(|m| point(m.anchor()));
    let scene = models[0].scene();
    (0..scene.walls().len()).flat_map(|wall| scene.ends(wall)).for_each(point);
    if let Some(path) = given {
        // It is read twice, here and for its traces.
        let mut file = open(path, false)?;
        hasher.update_reader(&mut file).map_err(|e| PlanError::from(e).at(path))?;
    }
    Ok(hasher.finalize().to_hex().to_string())
}
