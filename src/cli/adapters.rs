//! `tautline adapters`.

use serde_json::{Value, json};
use tautline::gpu::{AdapterKind, Arithmetic, GpuError, SOFTWARE_HINT, driver_faults, open_all};
use tautline::words::grouped;

use super::failure::Failure;
use super::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let opened: Vec<_> = open_all()
        .into_iter()
        .map(|(summary, device)| {
            let memory = device.as_ref().ok().map(|device| (device.memory() as u64, device.largest_buffer()));
            (summary, memory, device.and_then(|device| device.arithmetic().cloned()))
        })
        .collect();
    if args.json {
        let list: Vec<_> = opened
            .iter()
            .map(|(a, memory, f32)| {
                let (name, kind, backend, driver) = (&a.name, a.kind.to_string(), &a.backend, &a.driver);
                json!({"number": a.number, "name": name, "type": kind, "backend": backend, "driver": driver,
                    "memory": memory.map(|(taken, largest)| json!({"taken": taken, "largest_buffer": largest})),
                    "f32": described(f32)})
            })
            .collect();
        return print_json(&json!({ "adapters": list, "driver_faults": driver_faults() }));
    }
    let all: Vec<_> = opened.iter().map(|(summary, ..)| summary).collect();
    let mut text = String::new();
    if all.is_empty() {
        text += "No GPU adapter was found.\n";
    } else {
        let width = all.iter().map(|a| a.name.chars().count()).max().unwrap_or(0).max(7);
        text += &format!("number  {:width$}  {:10}  {:7}  driver\n", "adapter", "type", "backend");
        for (a, memory, f32) in &opened {
            text += &format!("{:6}  {:width$}  {:10}  {:7}  {}\n", a.number, a.name, a.kind, a.backend, a.driver);
            if let &Some((taken, largest)) = memory {
                let [taken, largest] = [taken, largest].map(|bytes| grouped(bytes >> 20));
                text += &format!(
                    "        memory: traces take at most {taken} MiB at once (--gpu-memory); a buffer has at most \
                     {largest} MiB\n"
                );
            }
            text += &format!("        f32: {}\n", f32.as_ref().map_or_else(ToString::to_string, ToString::to_string));
        }
    }
    for fault in driver_faults() {
        text += &format!("\nWarning: {fault}.\n");
    }
    if all.len() > 1 {
        text += "\n`--adapter` takes part of a name, or a number.\n";
    }
    if !all.iter().any(|a| a.kind.is_real()) {
        text += "\nThere is no real GPU here: `--engine auto` takes the CPU.\n";
    }
    if !all.iter().any(|a| a.kind == AdapterKind::Software) {
        text += &format!("\n{SOFTWARE_HINT}\n");
    }
    print(&text)
}

/// What a device makes of f32, or why that could not be found out.
fn described(found: &Result<Arithmetic, GpuError>) -> Value {
    match found {
        Ok(f32) => json!({
            "certified": f32.fault.is_none(), "fault": f32.fault, "largest_error": f32.largest_error,
            "rounds_to_nearest": f32.rounds_to_nearest, "fuses": f32.fuses, "flushes": f32.flushes,
            "shapes": shapes(f32),
        }),
        Err(error) => json!({"certified": false, "fault": error.to_string()}),
    }
}

/// How each shape of sums and products is computed, by shape.
fn shapes(f32: &Arithmetic) -> Value {
    let all = f32.shapes.iter().map(|(shape, computed)| ((*shape).to_owned(), json!(computed.to_string())));
    Value::Object(all.collect())
}
