//! What no choice of engine, window or format of traces may change.

use std::fs::File;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt64Array};
use parquet::arrow::ArrowWriter;
use serde_json::Value;

use super::{Finished, Folder};

/// The results and the events that `eval` writes with `args`, in the format of `extension`.
fn eval(folder: &Folder, args: &str, extension: &str) -> [Vec<u8>; 2] {
    let names = [format!("r.{extension}"), format!("e.{extension}")];
    folder.done(&format!("eval --scene s.geojson --out {} --events {} {args}", names[0], names[1]));
    names.map(|name| folder.read(&name))
}

fn rows(bytes: &[u8]) -> Vec<Value> {
    std::str::from_utf8(bytes).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn reference_cpu_and_gpu_write_the_same_bytes() {
    let folder = Folder::floor_plan(60, 300);
    for extension in ["jsonl", "csv", "parquet"] {
        let expected = eval(&folder, "--traces t.csv --engine reference", extension);
        assert!(expected[1].len() > 5_000, "{extension}: only {} bytes of events", expected[1].len());
        for engine in ["cpu", "gpu --adapter software"] {
            let found = eval(&folder, &format!("--traces t.csv --engine {engine}"), extension);
            assert!(found == expected, "{engine} writes another {extension} than reference");
        }
    }
}

#[test]
fn funnel_gives_the_same_taut_ropes() {
    let folder = Folder::floor_plan(60, 300);
    let [expected, _] = eval(&folder, "--traces t.csv --engine reference", "jsonl");
    let [found, _] = eval(&folder, "--traces t.csv --engine funnel", "jsonl");
    let (expected, found) = (rows(&expected), rows(&found));
    assert_eq!((expected.len(), found.len()), (60, 60));
    for (e, f) in expected.iter().zip(&found) {
        for field in
            ["trace", "status", "steps", "wraps", "sides", "depth", "max_depth", "length", "max_length", "pull"]
        {
            assert_eq!(e[field], f[field], "{field} of {e}");
        }
    }
}

#[test]
fn all_anchors_of_a_study_share_a_device() {
    let folder = Folder::floor_plan(2, 20);
    let walk = "[walk]\nkind = \"uniform\"\nstep = 0.3\nsteps = 30\n[run]\ntraces = 60\nblock = 10\n";
    folder.write("s.toml", format!("[scene]\nfile = \"s.geojson\"\nanchor = {{ sample = 3 }}\n{walk}"));
    let gpu = folder.done("study run s.toml --out gpu --engine gpu --adapter software");
    assert_eq!(gpu.stderr.matches("engine: gpu on ").count(), 1, "{}", gpu.stderr);
    folder.done("study run s.toml --out cpu --engine cpu");
    assert!(folder.read("gpu/summary.json") == folder.read("cpu/summary.json"));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = Folder::floor_plan(60, 100);
    let write = |threads: &str| {
        let mut command =
            folder.command("eval --scene s.geojson --traces t.csv --engine cpu --out r.csv --events e.csv");
        assert_eq!(Finished::of(command.env("RAYON_NUM_THREADS", threads)).code, Some(0));
        ["r.csv", "e.csv"].map(|name| folder.read(name))
    };
    assert!(write("1") == write("7"));
}

#[test]
fn traces_in_parquet_are_the_same_traces() {
    let folder = Folder::floor_plan(20, 200);
    let (mut ids, mut xs, mut ys) = (Vec::<u64>::new(), Vec::<f64>::new(), Vec::<f64>::new());
    for row in folder.text("t.csv").lines().skip(1) {
        let fields: Vec<_> = row.split(',').collect();
        ids.push(fields[0].parse().unwrap());
        xs.push(fields[1].parse().unwrap());
        ys.push(fields[2].parse().unwrap());
    }
    let columns: [(&str, ArrayRef); 3] = [
        ("trace", Arc::new(UInt64Array::from(ids))),
        ("x", Arc::new(Float64Array::from(xs))),
        ("y", Arc::new(Float64Array::from(ys))),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut writer =
        ArrowWriter::try_new(File::create(folder.path("t.parquet")).unwrap(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    assert!(eval(&folder, "--traces t.parquet", "jsonl") == eval(&folder, "--traces t.csv", "jsonl"));
}

#[test]
fn fast_is_named_and_sound() {
    let folder = Folder::floor_plan(30, 200);
    let args = "eval --scene s.geojson --traces t.csv --precision fast --adapter software --out f.jsonl --json";
    let shown = folder.done(args);
    assert!(shown.stderr.contains("f32 decides alone"), "{}", shown.stderr);
    let report: Value = serde_json::from_str(&shown.stdout).unwrap();
    assert_eq!(
        (&report["engine"], &report["precision"], &report["traces"]),
        (&"gpu".into(), &"fast".into(), &30.into())
    );
    for row in rows(&folder.read("f.jsonl")) {
        assert_eq!(row["depth"].as_u64().unwrap() as usize, row["wraps"].as_array().unwrap().len(), "{row}");
    }
    // Without an engine it is one of the GPU, be that a software one.
    assert!(folder.done(&args.replace("--adapter software", "")).stderr.starts_with("engine: gpu on "));
    let table = folder.done("eval --scene s.geojson --traces t.csv --engine gpu --precision certified").stdout;
    assert!(table.contains("engine   gpu (certified) on "), "{table}");
}
