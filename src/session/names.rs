//! What the files in a study's folder are called.

/// The answer.
pub(super) const SUMMARY: &str = "summary.json";

/// What the run cost and where it ran.
pub(super) const RUN_REPORT: &str = "run.json";

/// The answer as a page.
pub(super) const PAGE: &str = "report.html";

/// How far the study is.
pub(super) const STATE: &str = "state.bin";

/// What the study is.
pub(super) const STUDY: &str = "study.json";

/// One row a trace, once the study is done.
pub(super) const TRACES: &str = "traces.parquet";

/// The rope after every step of some traces.
pub(super) const STEPS: &str = "steps.parquet";

/// The points of some walks.
pub(super) const POINTS: &str = "points.parquet";

/// The folder of the rows until then.
pub(super) const PARTS: &str = "traces";

/// On which the lock lies. It stays there: whoever removed it could not know who waits for it.
pub(super) const LOCK: &str = "lock";

/// What the studies of a sweep are, in the folder that holds those of all of them.
pub(super) const SWEEP: &str = "sweep.json";

/// What all studies of a sweep say, side by side.
pub(super) const SWEEP_CSV: &str = "sweep.csv";

/// The same as Parquet.
pub(super) const SWEEP_PARQUET: &str = "sweep.parquet";
