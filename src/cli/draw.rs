//! `tautline draw`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::{Cpu, Engine, Job};
use tautline::example::some_walks;
use tautline::output::write_whole;
use tautline::picture::{Drawing, Situation};
use tautline::rope::TraceRecord;
use tautline::scene::Model;
use tautline::stream::Source;
use tautline::trace::{SettledTrace, Trace, TraceReader, settle_owned};

use super::failure::Failure;
use super::input::InputArgs;
use super::look::{Look, Target, write};
use super::paths::keep_apart;
use super::print;

/// How many traces, and points of them, are read at a time.
const TRACES: usize = 8192;
const POINTS: usize = 1 << 22;

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
    look: Look,
    /// Write the gallery of situations into this folder instead
    #[arg(long, value_name = "DIR", conflicts_with_all = ["picture", "scene", "traces", "anchor", "wanted"])]
    gallery: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match (&args.gallery, &args.out) {
        (Some(folder), _) => gallery(folder),
        (None, Some(out)) => {
            keep_apart(&args.input.named(), &[("--out", Some(out))])?;
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
        // A scene is looked at to find a place for the anchor, too.
        let scene = args.input.walls()?;
        return match args.input.anchor.or(scene.anchor()) {
            None => write(target, &Drawing::of_scene(&scene), &args.look),
            Some(_) => write(target, &Drawing::new(&args.input.tie(scene)?), &args.look),
        };
    }
    let model = Arc::new(args.input.model()?);
    let settled = traces(args, &model)?;
    args.input.violations().take(&settled)?;
    let records = Cpu::new(model.clone()).evaluate(&settled, &Job::new())?;
    write(target, &drawing(&model, &settled, &records), &args.look)
}

/// A drawing of these traces.
fn drawing<'a>(model: &'a Model, settled: &[SettledTrace], records: &'a [TraceRecord]) -> Drawing<'a> {
    settled.iter().zip(records).fold(Drawing::new(model), |drawing, (trace, record)| drawing.with(trace, record))
}

/// The traces that are wanted, in the order of their numbers.
fn traces(args: &Args, model: &Model) -> Result<Vec<SettledTrace>, Failure> {
    let mut wanted = args.wanted.clone();
    wanted.sort_unstable();
    wanted.dedup();
    let found = match args.input.source()? {
        Source::File(reader) => find(reader, &wanted, args.input.traces.as_deref().unwrap_or(Path::new("")))?,
        Source::Walks(walker, numbers) => {
            if let Some(id) = wanted.iter().find(|id| !numbers.contains(id)) {
                let last = numbers.end - 1;
                return Err(Failure::input(anyhow!(
                    "the built-in example has traces 0 to {last}, so there is no {id}"
                )));
            }
            let wanted = if wanted.is_empty() { vec![0] } else { wanted };
            wanted.into_iter().flat_map(|id| some_walks(model, walker, id..id + 1)).collect()
        }
    };
    Ok(found.into_iter().map(|trace| settle_owned(model, trace)).collect())
}

/// Reads up to the last trace that is wanted; without any, the first.
fn find(mut reader: TraceReader, wanted: &[u64], path: &Path) -> Result<Vec<Trace>, Failure> {
    let mut found: Vec<Trace> = Vec::new();
    let mut range: Option<(u64, u64)> = None;
    while found.len() < wanted.len().max(1) {
        let Some(batch) = reader.next_batch(TRACES, POINTS)? else { break };
        for trace in batch {
            range = Some((range.map_or(trace.id, |r| r.0), trace.id));
            if wanted.contains(&trace.id) || (wanted.is_empty() && found.is_empty()) {
                found.push(trace);
            }
        }
    }
    let shown = path.display();
    match (range, wanted.iter().find(|&&id| found.iter().all(|t| t.id != id))) {
        (None, _) => Err(Failure::input(anyhow!("{shown}: there are no traces in it"))),
        (Some((first, last)), Some(id)) => Err(Failure::input(anyhow!(
            "{shown}: there is no trace {id}; its traces have numbers from {first} to {last}"
        ))),
        _ => Ok(found),
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
