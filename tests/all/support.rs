//! What several test files need: the golden cases and how ropes are compared with them.

use std::sync::Arc;

use glam::DVec2;
use serde::Deserialize;
use tautline::candidates::{LISTS_BUDGET, Lists};
use tautline::engine::GpuWindows;
use tautline::gpu::{AdapterChoice, Device, SWEEP_WGSL};
use tautline::rope::{TraceRecord, replay};
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

/// A golden case: ropes known from another method (triangulation and funnel).
#[derive(Deserialize)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) segments: Vec<[[f64; 2]; 2]>,
    pub(crate) anchor: [f64; 2],
    pub(crate) traces: Vec<CaseTrace>,
}

#[derive(Deserialize)]
pub(crate) struct CaseTrace {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) ropes: Vec<CaseRope>,
    #[serde(default)]
    pub(crate) unjudged: Vec<usize>,
}

/// The taut rope from `step` on, until the next that is listed.
#[derive(Deserialize)]
pub(crate) struct CaseRope {
    pub(crate) step: usize,
    pub(crate) wraps: Vec<[f64; 2]>,
}

/// All golden cases, by name.
pub(crate) fn cases() -> Vec<Case> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    assert_eq!(paths.len(), 16, "golden cases in {folder}");
    paths.iter().map(|p| serde_json::from_str(&std::fs::read_to_string(p).unwrap()).unwrap()).collect()
}

impl Case {
    pub(crate) fn model(&self) -> Arc<Model> {
        let walls = self.segments.iter().map(|s| s.map(DVec2::from));
        Arc::new(Model::new(Scene::new(walls).unwrap(), Some(self.anchor.into())).unwrap())
    }

    pub(crate) fn settled(&self, model: &Model) -> Vec<SettledTrace> {
        let traces = self.traces.iter().zip(0..);
        traces
            .map(|(t, id)| settle(model, &Trace { id, points: t.points.iter().copied().map(DVec2::from).collect() }))
            .collect()
    }

    /// The number of judged steps, and a line for each of them whose rope differs from `records`.
    pub(crate) fn differences(&self, model: &Model, records: &[TraceRecord]) -> (usize, Vec<String>) {
        let (mut judged, mut wrong) = (0, vec![]);
        assert_eq!(records.len(), self.traces.len());
        for (t, (trace, record)) in self.traces.iter().zip(records).enumerate() {
            replay(model.anchor(), model.vertices(), trace.points.len(), &record.events, |k, rope| {
                if trace.unjudged.contains(&k) {
                    return;
                }
                judged += 1;
                let truth = &trace.ropes[trace.ropes.partition_point(|r| r.step <= k) - 1].wraps;
                let ours: Vec<[f64; 2]> = rope.taut(trace.points[k].into()).iter().map(|c| c.at.to_array()).collect();
                if *truth != ours {
                    wrong.push(format!("{} trace {t} step {k}: {ours:?} instead of {truth:?}", self.name));
                }
            });
        }
        (judged, wrong)
    }
}

/// The software adapter. A machine without one fails: the GPU engine is never left untested. So does one on which it is
/// not the one that `TAUTLINE_TEST_ADAPTER` names, if that is set.
pub(crate) fn software() -> Device {
    let device = Device::open(&AdapterChoice::Software).unwrap_or_else(|e| panic!("{e}"));
    if let Ok(name) = std::env::var("TAUTLINE_TEST_ADAPTER") {
        assert!(device.summary().name.contains(&name), "{} is not {name}", device.summary());
    }
    device
}

/// The engine `gpu-windows` on the software adapter, which it asks about every pivot.
pub(crate) fn gpu(model: &Arc<Model>) -> GpuWindows {
    gpu_on(software(), Lists::new(model.clone()).after(0))
}

/// The engine `gpu-windows` on `device` for these lists.
pub(crate) fn gpu_on(device: Device, lists: Lists) -> GpuWindows {
    let tuning = device.tuning();
    GpuWindows::with(device, lists, LISTS_BUDGET, tuning, SWEEP_WGSL).unwrap()
}

/// 20,000 wall ends: more vertices than two uniform buffers hold.
pub(crate) fn posts() -> Arc<Model> {
    let n = 100;
    let walls = (0..n * n).map(|k| {
        let centre = DVec2::new(f64::from(k % n), f64::from(k / n));
        let along = 0.4 * DVec2::from_angle(f64::from(k) * 2.4);
        [centre - along, centre + along]
    });
    Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::new(50.5, 49.5))).unwrap())
}
