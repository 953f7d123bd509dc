//! `tautline check`.

use serde_json::json;
use tautline::trace::{Violation, ViolationKind};

use super::batches::Batches;
use super::failure::Failure;
use super::input::InputArgs;
use super::summary::{counted, dropped, place};
use super::trade::Terms;
use super::{interrupt, print, print_json};

/// How many traces are checked at a time.
const TRACES: usize = 8192;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    interrupt::listen()?;
    let terms = Terms::exact(args.input.model()?);
    let model = &terms.given;
    let scene = model.scene();
    let counts = match args.input.traces {
        None if args.input.scene.is_some() => None,
        _ => Some(count(args, &terms)?),
    };
    let anchor = model.anchor();
    if args.json {
        return print_json(&json!({
            "scene": {
                "name": args.input.name(), "walls": scene.walls().len(), "vertices": scene.vertices().len(),
                "dropped": scene.dropped(), "anchor": [anchor.x, anchor.y], "notes": scene.notes(),
            },
            "traces": counts.map(|c| {
                let violations: Vec<_> = c.violations.iter().map(violation).collect();
                json!({"traces": c.traces, "steps": c.steps, "violations": violations})
            }),
        }));
    }
    let mut text = format!(
        "scene   {}: {}, {}, anchor {}\n",
        args.input.name(),
        counted(scene.walls().len() as u64, "wall", "walls"),
        counted(scene.vertices().len() as u64, "vertex", "vertices"),
        place(anchor)
    );
    if scene.dropped() > 0 {
        text += &format!("        {}\n", dropped(scene.dropped()));
    }
    if let Some(Counts { traces, steps, crossing, .. }) = counts {
        text += &format!("traces  {traces}, {steps} steps; {crossing} of the traces cross walls\n");
    }
    print(&text)
}

/// What there is in a file of traces.
#[derive(Default)]
struct Counts {
    traces: usize,
    steps: u64,
    crossing: usize,
    /// All of them, where they are to be listed.
    violations: Vec<Violation>,
}

/// Reads all traces, batch by batch.
fn count(args: &Args, terms: &Terms) -> Result<Counts, Failure> {
    let mut batches = Batches::start(args.input.source()?, terms.clone(), TRACES);
    let mut violations = args.input.violations();
    let mut counts = Counts::default();
    while let Some(batch) = batches.next()? {
        let found = violations.take(&batch.settled)?;
        counts.traces += batch.settled.len();
        counts.steps += batch.settled.iter().map(|t| t.steps() as u64).sum::<u64>();
        if args.json {
            counts.violations.extend(found);
        }
    }
    counts.crossing = violations.finish();
    Ok(counts)
}

fn violation(v: &Violation) -> serde_json::Value {
    let kind = match v.kind {
        ViolationKind::Crosses => "crosses",
        ViolationKind::EntersSolid => "enters a solid",
        ViolationKind::SlipsThrough => "slips through",
    };
    json!({
        "trace": v.trace, "step": v.step, "kind": kind, "wall": v.wall, "ends": v.ends.map(|p| p.to_array()),
        "from": v.from.to_array(), "to": v.to.to_array(),
    })
}
