//! What was measured, as JSON.

use serde_json::{Value, json};
use tautline::environment::Environment;
use tautline::lab::tradeoff::{Answer, Failed, Point, Setting, Tradeoff};

use crate::cli::bench::json::{spread, surroundings};

/// The whole document.
pub(super) fn report(environment: &Environment, seed: u64, measured: &Tradeoff) -> Value {
    json!({
        "environment": surroundings(environment, seed),
        "scene": measured.scene, "n": measured.n, "traces": measured.traces, "steps": measured.steps,
        "vouched_by_reference": measured.vouched,
        "points": measured.points.iter().map(point).collect::<Vec<_>>(),
        "failed": measured.failed.iter().map(failed).collect::<Vec<_>>(),
    })
}

fn point(point: &Point) -> Value {
    let (stride, simplify) = match point.setting {
        Setting::Stride(k) => (k, None),
        Setting::Simplify(tolerance) => (1, Some(tolerance)),
    };
    json!({
        "method": point.method, "engine": point.engine, "setting": point.setting.to_string(),
        "stride": stride, "simplify": simplify, "n": point.n, "traces": point.traces, "steps": point.steps,
        "ns_per_step": spread(point.ns_per_step),
        "jumps": point.jumps, "crossing_traces": point.crossing_traces,
        "event_mismatch": point.event_mismatch, "final_mismatch": point.final_mismatch,
        "length_error": {"mean": point.length_error.mean, "max": point.length_error.max},
        "mean_length": answer(point.length), "mean_wraps": point.wraps.map(answer),
        "pareto": point.pareto,
    })
}

fn answer(answer: Answer) -> Value {
    json!({"value": answer.value, "truth": answer.truth, "sampling_error": answer.sampling})
}

fn failed(failed: &Failed) -> Value {
    json!({"method": failed.method, "setting": failed.setting.map(|s| s.to_string()), "why": failed.why})
}
