//! That the comparison of the shader with the reference is able to fail.

use std::sync::Arc;

use tautline::candidates::{LISTS_BUDGET, Lists};
use tautline::engine::{Engine, GpuWindows, Job, Reference};
use tautline::example::{Walker, floor_plan, walks};
use tautline::gpu::{GpuError, SWEEP_WGSL, Tuning};
use tautline::scene::Model;
use tautline::trace::settle;

use crate::support::{posts, software};

/// Each changes one operator of the shader, or one number. (A shader that names too many vertices does no harm: its
/// queries overflow and are evaluated in full. These name too few, or the wrong ones.)
const CHANGES: [(&str, &str); 9] = [
    ("query.right.x * p.x + query.right.y", "query.right.x * p.x - query.right.y"),
    ("query.left.y * p.y + query.left.z", "query.left.y * p.y - query.left.z"),
    ("query.far.x * p.x", "query.far.x + p.x"),
    ("far) >= 0.0", "far) == 0.0"),
    ("count < 15u", "count > 15u"),
    ("lane >= span.end", "lane < span.end"),
    ("count, place);", "count, place + 2u);"),
    ("place + 1u < end", "place + 1u > end"),
    ("place += 2u", "place += 3u"),
];

/// Of lists that take several pages.
const PAGED: [(&str, &str); 4] = [
    ("if query.first < page.first", "if query.first > page.first"),
    ("count, place);", "count, place - page.first);"),
    ("(place - page.first) / 2u", "(place - query.first) / 2u"),
    ("query.count, page.first + PAGE", "query.count, query.first + PAGE"),
];

/// Of rounds whose lists lie in several pages.
const SPREAD: [(&str, &str); 1] = [("span.first + id.x", "id.x - span.first")];

#[test]
fn a_shader_with_one_operator_changed_is_found_out() {
    let plan = Arc::new(Model::new(floor_plan(), None).unwrap());
    found_out(&plan, false, Walker { step: 0.3, steps: 300, seed: 3 }, 100, &CHANGES);
    found_out(&posts(), true, Walker { step: 0.8, steps: 200, seed: 2 }, 20, &PAGED);
    found_out(&posts(), false, Walker { step: 0.8, steps: 200, seed: 2 }, 100, &SPREAD);
}

fn found_out(model: &Arc<Model>, keep_all: bool, walker: Walker, count: u64, changes: &[(&str, &str)]) {
    let traces: Vec<_> = walks(model, walker, count).iter().map(|t| settle(model, t)).collect();
    let truth = Reference::new(model.clone()).evaluate(&traces, &Job::new()).unwrap();
    let device = software();
    let agrees = |wgsl: &str| {
        let lists = if keep_all { Lists::new(model.clone()).keep_all() } else { Lists::new(model.clone()).after(0) };
        let tuning = Tuning { queries: 64, workgroup: 64 };
        let mut engine = GpuWindows::with(device.clone(), lists, LISTS_BUDGET, tuning, wgsl).unwrap();
        let mut evaluate = || engine.evaluate(&traces, &Job::new());
        match evaluate() {
            Ok(records) => records == truth,
            // A changed shader may name vertices that it was not given. Rounds are on their way then; the engine is
            // ready for the next evaluation all the same.
            Err(error) => {
                assert!(error.to_string().contains("it named a vertex that it was not given"), "{error}");
                assert_eq!(evaluate().unwrap_err().to_string(), error.to_string());
                false
            }
        }
    };
    assert!(agrees(SWEEP_WGSL));
    for (right, wrong) in changes {
        assert_eq!(SWEEP_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        assert!(!agrees(&SWEEP_WGSL.replace(right, wrong)), "{wrong:?} in the place of {right:?} went unnoticed");
    }
}

#[test]
fn a_device_outlives_a_shader_that_it_refuses() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let device = software();
    let tuning = |queries| Tuning { queries, workgroup: 64 };
    let broken_engine =
        |wgsl| GpuWindows::with(device.clone(), Lists::new(model.clone()), LISTS_BUDGET, tuning(8), wgsl);
    for broken in ["this is no shader", "@compute @workgroup_size(64) fn other() {}"] {
        let Err(error) = broken_engine(broken) else { panic!("{broken} was taken") };
        assert!(matches!(error, GpuError::Failed { .. }), "{error}");
    }
    let traces = [settle(&model, &walks(&model, Walker { step: 0.3, steps: 50, seed: 3 }, 1)[0])];
    // No room at all is room for one.
    let mut engine =
        GpuWindows::with(device.clone(), Lists::new(model.clone()), LISTS_BUDGET, tuning(0), SWEEP_WGSL).unwrap();
    let truth = Reference::new(model.clone()).evaluate(&traces, &Job::new()).unwrap();
    assert_eq!(engine.evaluate(&traces, &Job::new()).unwrap(), truth);
}
