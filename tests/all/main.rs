//! All integration tests, in one binary.

mod cli;
mod golden;
mod random;
mod scenes;
mod support;
