//! `tautline check`.

use serde_json::json;
use tautline::trace::{Violation, ViolationKind};

use super::failure::Failure;
use super::input::InputArgs;
use super::{interrupt, print, print_json};

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
    let model = args.input.model()?;
    let scene = model.scene();
    let settled = match args.input.traces {
        None if args.input.scene.is_some() => None,
        _ => Some(args.input.settle(&model, args.input.read_traces(&model)?)?),
    };
    let anchor = model.anchor();
    let counts = settled.map(|settled| {
        let violations: Vec<Violation> = settled.iter().filter_map(|t| t.violation().copied()).collect();
        (settled.len(), settled.iter().map(|t| t.steps() as u64).sum::<u64>(), violations)
    });
    if args.json {
        return print_json(&json!({
            "scene": {
                "name": args.input.name(), "walls": scene.walls().len(), "vertices": scene.vertices().len(),
                "dropped": scene.dropped(), "anchor": [anchor.x, anchor.y],
            },
            "traces": counts.map(|(traces, steps, violations)| {
                let violations: Vec<_> = violations.iter().map(violation).collect();
                json!({"traces": traces, "steps": steps, "violations": violations})
            }),
        }));
    }
    let mut text = format!(
        "scene   {}: {} walls, {} vertices, anchor ({}, {})\n",
        args.input.name(),
        scene.walls().len(),
        scene.vertices().len(),
        anchor.x,
        anchor.y
    );
    if scene.dropped() > 0 {
        text += &format!("        {} walls of zero length were dropped\n", scene.dropped());
    }
    if let Some((traces, steps, violations)) = counts {
        text += &format!("traces  {traces}, {steps} steps; {} of the traces cross walls\n", violations.len());
    }
    print(&text)
}

fn violation(v: &Violation) -> serde_json::Value {
    let kind = match v.kind {
        ViolationKind::Crosses => "crosses",
        ViolationKind::EndsInside => "ends inside",
        ViolationKind::SlipsThrough => "slips through",
    };
    json!({
        "trace": v.trace, "step": v.step, "kind": kind, "wall": v.wall, "ends": v.ends.map(|p| p.to_array()),
        "from": v.from.to_array(), "to": v.to.to_array(),
    })
}
