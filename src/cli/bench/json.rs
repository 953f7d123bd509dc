//! A bench as JSON.

use serde_json::{Map, Value, json};
use tautline::engine::Phase;
use tautline::environment::Environment;
use tautline::lab::Spread;
use tautline::lab::bench::{Contender, Measured, Row};

/// The whole document.
pub(super) fn report(environment: &Environment, seed: u64, measured: &Measured) -> Value {
    json!({
        "environment": surroundings(environment, seed),
        "results": measured.rows.iter().map(row).collect::<Vec<_>>(),
        "skipped": measured.skipped.iter().map(|s| json!({"engine": s.contender, "why": s.why})).collect::<Vec<_>>(),
    })
}

/// Where something was measured, and the seed of what was.
pub(in crate::cli) fn surroundings(environment: &Environment, seed: u64) -> Value {
    let adapter = environment.adapter.as_ref();
    json!({
        "adapter": adapter.map(|a| &a.name), "adapter_type": adapter.map(|a| a.kind.to_string()),
        "backend": adapter.map(|a| &a.backend), "driver": adapter.map(|a| &a.driver),
        "processor": environment.processor, "os": environment.os, "threads": environment.threads,
        "version": environment.version, "commit": environment.commit, "seed": seed,
    })
}

fn row(row: &Row) -> Value {
    let (contender, setting) = (row.contender, &row.setting);
    let phases: Map<_, _> = Phase::ALL.iter().zip(row.phases).map(|(p, ns)| (p.name().to_owned(), json!(ns))).collect();
    json!({
        "engine": contender.engine.name, "variant": contender.variant, "precision": contender.precision(),
        "scene": setting.scene.name(), "n": row.n, "remaining": row.remaining, "step": setting.step,
        "traces": row.traces, "batch": setting.traces,
        "steps": row.steps, "window": contender.window(setting.window), "threads": contender.engine.threads(),
        "ns_per_step": spread(row.ns_per_step), "steps_per_second": row.steps_per_second(),
        "tests_per_step": row.tests_per_step, "tests_avoided_per_step": row.tests_avoided_per_step,
        "events_per_step": row.events_per_step, "events_per_second": row.events_per_second(),
        "phases": phases, "wrong_ropes": row.wrong_ropes,
        "relative": row.relative.map(|r| json!({
            "to": Contender::BASELINE.engine.name, "ratio": r.ratio, "paired": spread(r.paired),
        })),
    })
}

pub(in crate::cli) fn spread(s: Spread) -> Value {
    json!({"min": s.min, "median": s.median, "max": s.max})
}
