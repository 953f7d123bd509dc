//! `tautline study replay`.

use std::path::PathBuf;

use anyhow::anyhow;
use tautline::engine::{Engine, FastGpu, Job, Precision, Reference};
use tautline::gpu::{AdapterChoice, Device};
use tautline::output::{EventWriter, PointWriter, StepWriter, check_output};
use tautline::picture::Drawing;
use tautline::session::look;

use super::base::BaseArgs;
use crate::cli::failure::Failure;
use crate::cli::look::{Look, Target, write};
use crate::cli::paths::{keep_apart, place};
use crate::cli::print;
use crate::cli::steps::StepArgs;
use crate::cli::words::{counted, plainly, short};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The study's folder
    folder: PathBuf,
    #[command(flatten)]
    base: BaseArgs,
    /// The trace's number
    #[arg(long, allow_negative_numbers = true, value_name = "I")]
    trace: u64,
    /// Where to write its wraps and unwraps: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Where to write the points of the walk, as it was drawn or given: .csv or .parquet, as `tautline eval --traces`
    /// takes them
    #[arg(long, value_name = "FILE", value_parser = of_points)]
    points: Option<PathBuf>,
    #[command(flatten)]
    every: StepArgs,
    /// Where to draw it: .svg, .png, or .html for a page that plays it
    #[arg(id = "picture", long = "draw", value_name = "FILE")]
    draw: Option<PathBuf>,
    #[command(flatten)]
    look: Look,
}

/// The name of a file that `eval --traces` takes.
fn of_points(name: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    let is_taken =
        path.extension().is_some_and(|e| ["csv", "parquet"].iter().any(|known| e.eq_ignore_ascii_case(known)));
    if is_taken { Ok(path) } else { Err("points are written as .csv or .parquet".to_owned()) }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (study, _) = look(&args.folder, args.base.folder())?;
    let plan = study.plan();
    if !plan.is_given() && args.trace >= plan.run.count() {
        let last = plan.run.count() - 1;
        return Err(Failure::input(anyhow!(
            "--trace: the study's traces are 0 to {last}, so there is no {}",
            args.trace
        )));
    }
    if args.every.friction.is_some() && args.every.steps.is_none() {
        return Err(Failure::input(anyhow!("--friction: say with --steps where to write what it makes")));
    }
    let [events, points, steps, draw] =
        [&args.events, &args.points, &args.every.steps, &args.draw].map(Option::as_deref);
    let outputs = [("--events", events), ("--points", points), ("--steps", steps), ("--draw", draw)];
    for (option, path) in outputs {
        if let Some(path) = path.filter(|path| place(path).starts_with(place(&args.folder))) {
            let shown = path.display();
            return Err(Failure::input(anyhow!(
                "{option}: {shown} is in the study's folder, which is its own; write to a place outside it"
            )));
        }
    }
    let [scene, given] = study.files();
    keep_apart(&[("the study's scene.file", scene), ("the study's walk.file", given)], &outputs)?;
    let (trace, model) = (study.trace(args.trace)?, study.model(args.trace));
    [events, points, steps].into_iter().flatten().try_for_each(check_output)?;
    let extras = args.every.extras(model.scene())?;
    let target = args.draw.as_deref().map(|path| Target::new(path, &args.look)).transpose()?;
    let mut engine: Box<dyn Engine> = match plan.run.precision {
        Precision::Certified => Box::new(Reference::new(model.clone())),
        // What the study saw, right or wrong.
        Precision::Fast => Box::new(FastGpu::new(Device::open(&AdapterChoice::Best)?, model.clone())?),
    };
    let record = engine.evaluate(std::slice::from_ref(&trace), &Job::new())?.remove(0);
    if let Some(target) = &target {
        write(target, &Drawing::new(model).with(&trace, &record), &args.look)?;
    }
    if let Some(path) = &args.events {
        let mut events = EventWriter::create(path, model.scene())?;
        events.write(model.scene(), &record)?;
        events.finish()?;
    }
    if let Some(path) = steps {
        let mut steps = StepWriter::create(path, model, &extras)?;
        steps.write_all(std::slice::from_ref(&trace), std::slice::from_ref(&record))?;
        steps.finish()?;
    }
    if let Some(path) = &args.points {
        let mut points = PointWriter::create(path)?;
        points.write(args.trace, &study.whole_trace(args.trace)?.ends())?;
        points.finish()?;
    }
    print(&format!(
        "trace {}: {}, {}, rope length {} at the end, greatest {}, depth {} at the end\n",
        args.trace,
        plainly(record.steps, "step", "steps"),
        plainly(record.events.len() as u64, "event", "events"),
        short(record.length),
        short(record.max_length),
        record.depth
    ))?;
    match trace.crossings() {
        0 => Ok(()),
        steps => print(&format!(
            "among the simplified walls it crosses some, in {}, so its rope is not free of them\n",
            counted(steps as u64, "step", "steps")
        )),
    }
}
