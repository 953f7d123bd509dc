//! skeleton
pub mod engine;
pub mod geometry;
pub mod rope;
pub mod scene;
pub mod trace;
