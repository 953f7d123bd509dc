//! Every golden case, rope by rope, without a tolerance.

use crate::support;
use tautline::engine::{Cpu, Funnel, Reference};

#[test]
fn reference_gives_the_golden_ropes() {
    support::compare_with_cases(|model| Box::new(Reference::new(model.clone())));
}

#[test]
fn funnel_gives_the_golden_ropes() {
    support::compare_with_cases(|model| Box::new(Funnel::new(model.clone())));
}

#[test]
fn cpu_gives_the_golden_ropes() {
    support::compare_with_cases(|model| Box::new(Cpu::new(model.clone())));
}

#[test]
fn gpu_gives_the_golden_ropes() {
    support::compare_with_cases(|model| Box::new(support::gpu(model)));
}
