//! Writes random walks in a scene as a file of traces, to try `tautline eval` on a scene of one's own:
//!
//!     cargo run --release --example walks -- SCENE ANCHOR TRACES STEPS STEP SEED OUT.parquet
//!
//! ANCHOR is X,Y, or `-` to take the one that the scene marks. STEP is a step's length in the scene's unit.

use std::error::Error;
use std::fs::File;
use std::sync::Arc;

use arrow_array::{Array, Float64Array, RecordBatch, UInt64Array};
use parquet::arrow::ArrowWriter;
use tautline::example::{Walker, some_walks};
use tautline::scene::{Model, read_scene};

/// How many points are held at a time, about.
const POINTS: u64 = 1 << 20;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [scene, anchor, traces, steps, step, seed, out] = args.as_slice() else {
        return Err("give SCENE ANCHOR TRACES STEPS STEP SEED OUT.parquet".into());
    };
    let anchor = match anchor.split_once(',') {
        Some((x, y)) => Some([x.parse()?, y.parse()?].into()),
        None => None,
    };
    let model = Model::new(read_scene(scene.as_ref())?, anchor)?;
    let walker = Walker { step: step.parse()?, steps: steps.parse()?, seed: seed.parse()? };
    let count: u64 = traces.parse()?;
    let mut writer = None;
    // Part by part, so that memory does not grow with their number.
    let part = (POINTS / (walker.steps as u64 + 1)).max(1);
    for first in (0..count).step_by(part as usize) {
        for trace in some_walks(&model, walker, first..count.min(first + part)) {
            let ids = UInt64Array::from(vec![trace.id; trace.points.len()]);
            let x = Float64Array::from_iter_values(trace.points.iter().map(|p| p.x));
            let y = Float64Array::from_iter_values(trace.points.iter().map(|p| p.y));
            let columns = [("trace", Arc::new(ids) as Arc<dyn Array>), ("x", Arc::new(x)), ("y", Arc::new(y))];
            let batch = RecordBatch::try_from_iter(columns)?;
            if writer.is_none() {
                writer = Some(ArrowWriter::try_new(File::create(out)?, batch.schema(), None)?);
            }
            if let Some(writer) = &mut writer {
                writer.write(&batch)?;
            }
        }
    }
    writer.ok_or("no traces")?.close()?;
    Ok(())
}
