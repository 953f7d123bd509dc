//! Every golden case, rope by rope, without a tolerance.

use crate::support;
use tautline::engine::Reference;

#[test]
fn reference_gives_the_golden_ropes() {
    support::compare_with_cases(&mut Reference);
}
