//! All integration tests, in one binary.

mod batch;
mod cli;
mod conservative;
mod golden;
mod random;
mod scenes;
mod shader;
mod support;
mod touch;
mod visibility;
