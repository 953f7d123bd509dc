//! `tautline draw`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::{Cpu, Engine, Job};
use tautline::output::write_whole;
use tautline::picture::{Drawing, Situation};
use tautline::rope::TraceRecord;
use tautline::scene::Model;
use tautline::stream::{PickError, Source, StreamError};
use tautline::trace::{SettledEnds, SettledTrace, TraceReader, settle_ends, settle_owned};

use super::ends::EndsArgs;
use super::failure::Failure;
use super::input::{InputArgs, tie};
use super::look::{Look, Target, write};
use super::of_class::ClassArgs;
use super::paths::keep_apart;
use super::print;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Which of the traces, by their numbers; up to six with commas between them [default: the first]
    #[arg(long = "trace", allow_negative_numbers = true, value_name = "ID", value_delimiter = ',')]
    wanted: Vec<u64>,
    /// The picture: .svg, .png, or .html for a page that plays the trace
    #[arg(id = "picture", long = "out", value_name = "FILE", required_unless_present = "gallery")]
    out: Option<PathBuf>,
    #[command(flatten)]
    class: ClassArgs,
    #[command(flatten)]
    ends: EndsArgs,
    #[command(flatten)]
    look: Look,
    /// Write the gallery of situations into this folder instead
    #[arg(long, value_name = "DIR", conflicts_with_all = ["picture", "scene", "traces", "anchor", "wanted"])]
    gallery: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match (&args.gallery, &args.out) {
        (Some(folder), _) => gallery(folder),
        (None, Some(out)) => {
            let [scene, traces] = args.input.named();
            let inputs = [scene, traces, ("--anchor-trace", args.ends.anchor_trace.as_deref())];
            keep_apart(&inputs, &[("--out", Some(out))])?;
            draw(args, &Target::new(out, &args.look)?)
        }
        (None, None) => Err(Failure::input(anyhow!("--out is missing: where the picture goes"))),
    }
}

fn draw(args: &Args, target: &Target) -> Result<(), Failure> {
    if args.input.scene.is_some() && args.input.traces.is_none() {
        if let Some(id) = args.wanted.first() {
            return Err(Failure::input(anyhow!("--trace {id} needs --traces: a .csv or .parquet of points")));
        }
        if let Some(option) = args.class.given() {
            return Err(Failure::input(anyhow!("{option} needs --traces: a .csv or .parquet of points")));
        }
        // A scene is looked at to find a place for the anchor, too.
        let scene = args.input.walls()?;
        return match args.input.anchor.or(scene.anchor()) {
            None => write(target, &Drawing::of_scene(&scene), &args.look),
            Some(_) => write(target, &Drawing::new(&args.input.tie(scene)?), &args.look),
        };
    }
    let mut source = args.input.source();
    if let Ok(given) = &mut source
        && args.ends.move_in(given)?
        && let Ok(Source::File(traces)) = source
    {
        return draw_ends(args, traces, target);
    }
    let model = Arc::new(args.input.model()?);
    let of_class = args.class.traces(&model, || args.input.source(), |error| not_found(args, error))?;
    if let Some((settled, records)) = of_class {
        return write(target, &drawing(&model, &settled, &records), &args.look);
    }
    let settled = traces(args, source?, &model)?;
    args.input.violations().take(&settled)?;
    let records = Cpu::new(model.clone()).evaluate(&settled, &Job::new())?;
    write(target, &drawing(&model, &settled, &records), &args.look)
}

/// A drawing of these traces.
fn drawing<'a>(model: &'a Model, settled: &[SettledTrace], records: &'a [TraceRecord]) -> Drawing<'a> {
    settled.iter().zip(records).fold(Drawing::new(model), |drawing, (trace, record)| drawing.with(trace, record))
}

/// Draws ropes whose ends both move.
fn draw_ends(args: &Args, traces: TraceReader, target: &Target) -> Result<(), Failure> {
    args.ends.refuse_anchor(&args.input)?;
    if let Some(option) = args.class.given() {
        return Err(Failure::input(anyhow!("{option} is for ropes that are tied, and here the anchor moves")));
    }
    if args.look.animate {
        return Err(Failure::input(anyhow!(
            "--animate is for ropes that are tied, and here the anchor moves: leave it out, and give --step K for the \
             moment after step K"
        )));
    }
    let found = args.ends.source(traces)?.pick(&args.wanted).map_err(|error| not_found(args, error))?;
    let scene = args.input.walls()?;
    let start = found.first().and_then(|both| both.anchor.first().copied()).or(scene.anchor()).unwrap_or_default();
    let model = Arc::new(tie(scene, Some(start), &args.input.name(), &args.input.how_to_tie())?);
    let settled = found.iter().map(|both| settle_ends(&model, &both.free, &both.anchor));
    let settled: Vec<SettledEnds> = settled.collect::<Result<_, _>>().map_err(StreamError::from)?;
    args.input.violations().take_ends(&settled)?;
    let records = Cpu::new(model.clone()).evaluate_ends(&settled, &Job::new())?;
    let all = settled.iter().zip(&records);
    let drawing = all.fold(Drawing::new(&model), |drawing, (trace, record)| drawing.with_ends(trace, record));
    if target.is_page() && settled.len() == 1 {
        say!(
            "note: {} shows the rope after a step and does not play it, since the anchor moves, and pages play ropes \
             that are tied; --step K shows it after another step, one picture for each",
            target.shown()
        );
    }
    write(target, &drawing, &args.look)
}

/// The traces that are wanted, in the order of their numbers.
fn traces(args: &Args, source: Source, model: &Model) -> Result<Vec<SettledTrace>, Failure> {
    let found = source.pick(&args.wanted, model).map_err(|error| not_found(args, error))?;
    Ok(found.into_iter().map(|trace| settle_owned(model, trace)).collect())
}

fn not_found(args: &Args, error: PickError) -> Failure {
    match (error, &args.input.traces) {
        (PickError::Read(error), _) => error.into(),
        (PickError::Ends(error), _) => error.into(),
        (PickError::Missing { trace, last, .. }, None) => {
            Failure::input(anyhow!("the built-in example has traces 0 to {last}, so there is no {trace}"))
        }
        (error, path) => Failure::input(anyhow!("{}: {error}", path.as_deref().unwrap_or(Path::new("")).display())),
    }
}

fn gallery(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::system(e.kind(), anyhow!("cannot make {}: {e}", folder.display())))?;
    for situation in Situation::all() {
        let path = folder.join(format!("{}.svg", situation.name));
        write_whole(&path, situation.svg().as_bytes())?;
    }
    print(&format!("wrote {} pictures into {}\n", Situation::all().len(), folder.display()))
}
