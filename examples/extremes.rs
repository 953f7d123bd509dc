//! How far `--precision fast` and the note's method are off in extreme cases, as a Markdown table:
//!
//!     cargo run --release --example extremes
//!
//! on the software adapter, so that everybody gets the same.

use tautline::engine::Job;
use tautline::gpu::{AdapterChoice, Device};
use tautline::report::extremes::{HEAD, errors};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{HEAD}");
    for line in errors(&Device::open(&AdapterChoice::Software)?, &Job::new())? {
        println!("{line}");
    }
    Ok(())
}
