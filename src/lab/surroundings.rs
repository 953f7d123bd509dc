//! Where something was measured, as reports have it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::environment::Environment;

/// Where something was measured, and the seed of what was.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Surroundings {
    /// The GPU's name; none, as the next three, where there was no GPU.
    pub adapter: Option<String>,
    /// What sort of device it is.
    pub adapter_type: Option<String>,
    /// Through which programming interface it was used.
    pub backend: Option<String>,
    /// Its driver.
    pub driver: Option<String>,
    /// The processor.
    pub processor: String,
    /// The operating system and the kind of processor.
    pub os: String,
    /// How many threads engines on threads used.
    pub threads: usize,
    /// The version of tautline.
    pub version: &'static str,
    /// The commit that it was built from.
    pub commit: &'static str,
    /// What decided where random walls lie and walks lead.
    pub seed: u64,
}

impl Surroundings {
    /// Those of a measurement there.
    pub fn new(environment: &Environment, seed: u64) -> Self {
        let Environment { adapter, processor, os, threads, version, commit } = environment.clone();
        Surroundings {
            adapter: adapter.as_ref().map(|a| a.name.clone()),
            adapter_type: adapter.as_ref().map(|a| a.kind.to_string()),
            backend: adapter.as_ref().map(|a| a.backend.clone()),
            driver: adapter.map(|a| a.driver),
            processor,
            os,
            threads,
            version,
            commit,
            seed,
        }
    }
}

/// The first lines of a report: the machine, and the GPU.
pub(super) fn head(environment: &Environment) -> String {
    let adapter = environment.adapter.as_ref().map_or("none".to_owned(), ToString::to_string);
    let Environment { processor, threads, os, .. } = environment;
    format!("machine   {processor}, {threads} threads; {os}\nadapter   {adapter}\n")
}
