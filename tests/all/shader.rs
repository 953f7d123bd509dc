//! That the comparison of the shader with the reference is able to fail.

use tautline::engine::{Engine, Gpu, Job, Reference};
use tautline::example::{Walker, floor_plan, walks};
use tautline::gpu::{GpuError, GpuPass, SWEEP_WGSL};
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
    ("lane >= round.queries", "lane < round.queries"),
    ("chunk.first + 2u * i);", "chunk.first + 1u * i);"),
    ("2u * i + 1u < chunk.count", "2u * i + 1u > chunk.count"),
    ("chunk.count + 1u) / 2u", "chunk.count + 1u) / 4u"),
];

#[test]
fn a_shader_with_one_operator_changed_is_found_out() {
    let plan = Model::new(floor_plan(), None).unwrap();
    found_out(&plan, Walker { step: 0.3, steps: 300, seed: 3 }, &CHANGES);
    let chunked = [
        ("if chunk.first > 0u", "if chunk.first < 0u"),
        ("chunk.first + 2u * i);", "chunk.first - 2u * i + 4u * i - chunk.first);"),
        ("chunk.first + 2u * i + 1u);", "chunk.first / 2u + 2u * i + 1u);"),
    ];
    found_out(&posts(), Walker { step: 0.8, steps: 200, seed: 2 }, &chunked);
}

fn found_out(model: &Model, walker: Walker, changes: &[(&str, &str)]) {
    let traces: Vec<_> = walks(model, walker, 20).iter().map(|t| settle(model, t)).collect();
    let truth = Reference::new(model).evaluate(&traces, &Job::new()).unwrap();
    let device = software();
    let agrees = |wgsl: &str| {
        let pass = GpuPass::with_shader(device.clone(), model, 64, wgsl).unwrap();
        Gpu::with_pass(pass).evaluate(&traces, &Job::new()).unwrap() == truth
    };
    assert!(agrees(SWEEP_WGSL));
    for (right, wrong) in changes {
        assert_eq!(SWEEP_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        assert!(!agrees(&SWEEP_WGSL.replace(right, wrong)), "{wrong:?} in the place of {right:?} went unnoticed");
    }
}

#[test]
fn a_device_outlives_a_shader_that_it_refuses() {
    let model = Model::new(floor_plan(), None).unwrap();
    let device = software();
    for broken in ["this is no shader", "@compute @workgroup_size(64) fn other() {}"] {
        let Err(error) = GpuPass::with_shader(device.clone(), &model, 8, broken) else { panic!("{broken} was taken") };
        assert!(matches!(error, GpuError::Failed { .. }), "{error}");
    }
    let traces = [settle(&model, &walks(&model, Walker { step: 0.3, steps: 50, seed: 3 }, 1)[0])];
    // No room at all is room for one.
    let mut engine = Gpu::with_pass(GpuPass::new(device, &model, 0).unwrap());
    let truth = Reference::new(&model).evaluate(&traces, &Job::new()).unwrap();
    assert_eq!(engine.evaluate(&traces, &Job::new()).unwrap(), truth);
}
