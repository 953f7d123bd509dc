//! What writing the rope after every step costs beside a plain Arrow writer of the same columns, whose values lie ready
//! in memory:
//!
//!     cargo run --release --example step_cost -- [MILLIONS OF ROWS] [PAIRS]
//!
//! Both write the same rows to files, one after the other, several times. What is told is the time on the processor,
//! where the system tells that (Linux), else the time that went by.

use std::error::Error;
use std::fs::File;
use std::sync::Arc;
use std::time::Instant;

use arrow_array::RecordBatch;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use tautline::engine::{Cpu, Engine, Job};
use tautline::example::{Walker, floor_plan, walks};
use tautline::output::StepWriter;
use tautline::scene::Model;
use tautline::trace::settle;

/// Steps a trace.
const STEPS: u64 = 500;

/// Seconds since the program began: on the processor, all threads together, if that is known.
fn clock(start: Instant) -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // After the name, which may hold anything, the 12th is the time of the program itself in hundredths of a second.
    let ticks = stat.rsplit_once(')').and_then(|(_, rest)| rest.split_whitespace().nth(11)?.parse::<f64>().ok());
    ticks.map_or(start.elapsed().as_secs_f64(), |ticks| ticks / 100.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let number = |i: usize, otherwise: u64| std::env::args().nth(i).map_or(Ok(otherwise), |text| text.parse());
    let (rows, pairs) = (number(1, 10)? * 1_000_000, number(2, 5)?);
    let model = Arc::new(Model::new(floor_plan(), None)?);
    let walked = walks(&model, Walker { step: 0.25, steps: STEPS as usize, seed: 1 }, 2000);
    let settled: Vec<_> = walked.iter().map(|trace| settle(&model, trace)).collect();
    let records = Cpu::new(model.clone()).evaluate(&settled, &Job::new())?;
    let extras = model.scene().called(&["0".to_owned(), "200".to_owned(), "400".to_owned()])?.into();
    let times = rows.div_ceil(settled.len() as u64 * (STEPS + 1)).max(1);

    let folder = tempfile::tempdir()?;
    let ours = folder.path().join("steps.parquet");
    let write_steps = |times: u64| -> Result<(), Box<dyn Error>> {
        let mut writer = StepWriter::create(&ours, &model, &extras)?;
        for _ in 0..times {
            writer.write_all(&settled, &records)?;
        }
        Ok(writer.finish()?)
    };
    write_steps(1)?;
    let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&ours)?)?.with_batch_size(1 << 16).build()?;
    let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>()?;
    let plain = folder.path().join("plain.parquet");
    let write_plainly = |times: u64| -> Result<(), Box<dyn Error>> {
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let mut writer = ArrowWriter::try_new(File::create(&plain)?, batches[0].schema(), Some(properties))?;
        for _ in 0..times {
            batches.iter().try_for_each(|batch| writer.write(batch))?;
        }
        writer.close()?;
        Ok(())
    };
    let rows = times * settled.len() as u64 * (STEPS + 1);
    println!("{rows} rows of {} columns", batches[0].num_columns());
    let mut ratios = Vec::new();
    for _ in 0..pairs.max(1) {
        let begun = clock(start);
        write_steps(times)?;
        let between = clock(start);
        write_plainly(times)?;
        let (every, plain) = (between - begun, clock(start) - between);
        println!("every step {every:.2} s, plain writer {plain:.2} s: {:.2} times", every / plain);
        ratios.push(every / plain);
    }
    ratios.sort_by(f64::total_cmp);
    let sizes = [&ours, &plain].map(|path| std::fs::metadata(path).map_or(0, |file| file.len()) as f64 / rows as f64);
    println!("median {:.2} times; {:.1} and {:.1} bytes a row", ratios[ratios.len() / 2], sizes[0], sizes[1]);
    Ok(())
}
