//! skeleton
pub mod candidates;
pub mod engine;
pub mod example;
pub mod geometry;
pub mod gpu;
pub mod rope;
pub mod scene;
pub mod trace;
