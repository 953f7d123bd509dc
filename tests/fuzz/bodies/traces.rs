//! Readers of traces: in small batches they give the same as at once, and what they take can be dragged.

use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use tautline::ReadError;
use tautline::example::lattice_walls;
use tautline::scene::Model;
use tautline::trace::{Trace, TraceReader, read_traces, settle};

use super::engines::agree;

/// Of longer traces only the start is dragged.
const POINTS_MAX: usize = 200;

/// Reads `input` as the file `name`.
pub(super) fn read(name: &str, input: &[u8], folder: &Path) {
    static MODEL: LazyLock<Arc<Model>> =
        LazyLock::new(|| Arc::new(Model::new(lattice_walls(40, 1), None).expect("it has an anchor")));
    let path = folder.join(name);
    fs::write(&path, input).expect("the folder can be written to");
    match (read_traces(&path), in_batches(&path)) {
        (Ok(all), Ok(traces)) => {
            assert_eq!(all, traces);
            let start = |trace: Trace| Trace { points: trace.points.into_iter().take(POINTS_MAX).collect(), ..trace };
            let settled: Vec<_> = traces.into_iter().take(20).map(|trace| settle(&MODEL, &start(trace))).collect();
            agree(&MODEL, &settled);
        }
        (Err(error), Err(same)) => {
            assert_eq!(error.to_string(), same.to_string());
            assert!(error.to_string().contains(folder.to_str().unwrap()), "{error} names no file");
        }
        (all, batches) => panic!("at once {all:?}, in batches {batches:?}"),
    }
}

fn in_batches(path: &Path) -> Result<Vec<Trace>, ReadError> {
    let mut reader = TraceReader::open(path)?;
    let mut traces = Vec::new();
    while let Some(batch) = reader.next_batch(2, 5)? {
        traces.extend(batch);
    }
    Ok(traces)
}
