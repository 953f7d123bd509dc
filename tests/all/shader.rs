//! That the comparison of the shader with the reference is able to fail.

use tautline::candidates::Frame;
use tautline::engine::{Engine, Gpu, Job, Reference};
use tautline::example::{Walker, floor_plan, walks};
use tautline::gpu::{GpuPass, SWEEP_WGSL};
use tautline::scene::Model;
use tautline::trace::settle;

use crate::support::software;

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
    let model = Model::new(floor_plan(), None).unwrap();
    let walks = walks(&model, Walker { step: 0.3, steps: 300, seed: 3 }, 20);
    let traces: Vec<_> = walks.iter().map(|t| settle(&model, t)).collect();
    let truth = Reference.evaluate(&model, &traces, &Job::new()).unwrap();
    let frame = Frame::new(&model);
    let adapter = software();
    let agrees = |wgsl: &str| {
        let pass = GpuPass::with_shader(adapter.clone(), &model, &frame, 64, wgsl).unwrap();
        Gpu::with_pass(pass, frame).evaluate(&model, &traces, &Job::new()).unwrap() == truth
    };
    assert!(agrees(SWEEP_WGSL));
    for (right, wrong) in CHANGES {
        assert_eq!(SWEEP_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        assert!(!agrees(&SWEEP_WGSL.replace(right, wrong)), "{wrong:?} in the place of {right:?} went unnoticed");
    }
}
