//! What a device makes of f32: the software adapter is fit for exact ropes, and one that is not is refused for them.

use std::sync::Arc;

use tautline::engine::{FastGpu, Gpu};
use tautline::example::floor_plan;
use tautline::gpu::{Arithmetic, Computed, GpuError, PROBE_WGSL};
use tautline::scene::Model;

use crate::support::software;

#[test]
fn the_software_adapter_is_fit_for_exact_ropes() {
    let device = software();
    let found = device.arithmetic().unwrap();
    assert_eq!(found.fault, None);
    assert!(found.largest_error > 0.0 && found.largest_error <= 1.0, "{found:?}");
    assert_eq!(found, &Arithmetic::of(&device, PROBE_WGSL).unwrap());
    // How drivers rewrite sums changes with their versions, but none computes one wrongly.
    assert_eq!(found.shapes.len(), 18);
    assert!(found.shapes.iter().all(|(_, computed)| *computed != Computed::Wrong), "{found:?}");
}

/// Each makes the device another one, and what that is found to be.
const FAULTS: [(&str, &str, &str); 8] = [
    ("let product = s0.normal.x * s0.p.x;", "let product = s0.normal.x * s0.p.x * 1.0000002;", "a product"),
    ("let sum = s0.normal.x + s0.offset;", "let sum = s0.normal.x + s0.offset * 1.000001;", "a sum"),
    ("min(min(", "max(min(", "a minimum must be one of its arguments"),
    // Less than a unit in the last place off.
    (
        "min(min(s0.normal.x, s0.p.x), s0.offset);",
        "min(min(s0.normal.x, s0.p.x), s0.offset) * 1.0000001;",
        "a minimum must be one of its arguments",
    ),
    ("least >= 0.0", "least > 0.0", "a comparison with 0 must hold for 0 and above"),
    // What is subnormal may be taken for 0, but for nothing else.
    (
        "let product = s0.normal.x * s0.p.x;",
        "let product = select(s0.normal.x, 1.0, (bitcast<u32>(s0.normal.x) & 0x7f800000u) == 0u) * s0.p.x;",
        "a product must be one of the two nearest f32",
    ),
    // As with 16 bits.
    ("s0.normal.y * s0.p.y + s0.offset;", "s0.normal.y * s0.p.y + s0.offset + 0.00001;", "half-plane"),
    ("        value, both,", "bitcast<f32>(0x7fc00000u + id.x), both,", "half-plane"),
];

#[test]
fn a_device_with_other_arithmetic_is_refused_for_exact_ropes() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    for (right, wrong, what) in FAULTS {
        assert_eq!(PROBE_WGSL.matches(right).count(), 1, "{right:?}");
        let device = software().probed(&PROBE_WGSL.replace(right, wrong)).unwrap();
        let Err(error) = Gpu::new(device.clone(), model.clone()) else { panic!("{wrong} was taken") };
        assert!(matches!(error, GpuError::Unfit { .. }) && error.to_string().contains(what), "{error}");
        assert!(error.to_string().ends_with("Take another adapter, the engine cpu, or precision fast"), "{error}");
        FastGpu::new(device, model.clone()).unwrap();
    }
}

/// Ways of computing that exact ropes live with are told from each other.
#[test]
fn ways_of_rounding_are_found_out() {
    let device = software();
    let found = |right: &str, wrong: &str| {
        assert_eq!(PROBE_WGSL.matches(right).count(), 1, "{right:?}");
        Arithmetic::of(&device, &PROBE_WGSL.replace(right, wrong)).unwrap()
    };
    let down = "let sum = bitcast<f32>(bitcast<u32>(s0.normal.x + s0.offset) - 1u);";
    let down = found("let sum = s0.normal.x + s0.offset;", down);
    assert!(!down.rounds_to_nearest);
    let of = |found: &Arithmetic, shape| found.shapes.iter().find(|(name, _)| *name == shape).unwrap().1;
    let rewritten = found("(s2.normal.x + s2.offset) - s2.normal.x;", "s2.offset;");
    assert!(of(&rewritten, "((a+b)-a)") == Computed::Rewritten && rewritten.fault.is_none(), "{rewritten:?}");
    // Exact ropes do not rely on these, so they are no fault.
    let wrong = found("cross_of(s6.a, s6.b);", "cross_of(s6.a, s6.b) * 1.001;");
    assert!(of(&wrong, "((a*b)-(c*d))") == Computed::Wrong && wrong.fault.is_none(), "{wrong:?}");
    let tiny = "select(0.0, s0.normal.x * s0.p.x, abs(s0.normal.x * s0.p.x) >= 1.1754944e-38)";
    let flushed = found("let product = s0.normal.x * s0.p.x;", &format!("let product = {tiny};"));
    assert!(flushed.flushes && flushed.fault.is_none(), "{flushed:?}");
    assert!(Arithmetic::of(&device, "this is no shader").is_err());
}
