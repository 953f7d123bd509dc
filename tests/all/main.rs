//! All integration tests, in one binary.

mod arithmetic;
mod batch;
mod built_in;
mod cli;
mod conservative;
mod corpus;
mod decide;
mod drawings;
mod examples;
mod extremes;
mod fast;
mod formats;
mod gallery;
mod golden;
mod live;
mod pictures;
mod random;
mod scenes;
mod shader;
mod simplify;
mod stride;
mod study_truth;
mod support;
mod touch;
mod visibility;
