//! `tautline adapters`.

use serde_json::json;
use tautline::gpu::{AdapterKind, SOFTWARE_HINT, adapters};

use super::failure::Failure;
use super::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let all = adapters();
    if args.json {
        let list: Vec<_> = all
            .iter()
            .map(|a| json!({"name": a.name, "type": a.kind.to_string(), "backend": a.backend, "driver": a.driver}))
            .collect();
        return print_json(&json!({ "adapters": list }));
    }
    let mut text = String::new();
    if all.is_empty() {
        text += "No GPU adapter was found.\n";
    } else {
        let width = all.iter().map(|a| a.name.chars().count()).max().unwrap_or(0).max(7);
        text += &format!("{:width$}  {:10}  {:7}  driver\n", "adapter", "type", "backend");
        for a in &all {
            text += &format!("{:width$}  {:10}  {:7}  {}\n", a.name, a.kind, a.backend, a.driver);
        }
    }
    if !all.iter().any(|a| a.kind.is_real()) {
        text += "\nThere is no real GPU here: `--engine auto` takes the CPU.\n";
    }
    if !all.iter().any(|a| a.kind == AdapterKind::Software) {
        text += &format!("\n{SOFTWARE_HINT}\n");
    }
    print(&text)
}
