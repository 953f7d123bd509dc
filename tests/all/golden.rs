//! Every golden case, rope by rope, without a tolerance.

use crate::support;
use tautline::engine::{Cpu, Engine, Funnel, Reference};
use tautline::scene::Model;

#[test]
fn reference_gives_the_golden_ropes() {
    support::compare_with_cases(|_| Box::new(Reference));
}

#[test]
fn funnel_gives_the_golden_ropes() {
    support::compare_with_cases(|_| Box::new(Funnel));
}

#[test]
fn cpu_gives_the_golden_ropes() {
    support::compare_with_cases(|model| Box::new(Cpu::new(model)));
}

#[test]
fn gpu_gives_the_golden_ropes() {
    support::compare_with_cases(|model: &Model| -> Box<dyn Engine> { Box::new(support::gpu(model)) });
}
