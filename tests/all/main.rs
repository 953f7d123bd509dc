//! All integration tests, in one binary.

mod arithmetic;
mod batch;
mod built_in;
mod cli;
mod conservative;
mod decide;
mod fast;
mod golden;
mod pictures;
mod random;
mod scenes;
mod shader;
mod study_truth;
mod support;
mod touch;
mod visibility;
