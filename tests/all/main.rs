//! All integration tests, in one binary.

mod golden;
mod random;
mod scenes;
mod support;
