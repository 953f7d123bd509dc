//! Very many traces, very long ones, very deep ropes, and the last and the first magnitude that is taken and refused.

use std::fmt::Write;

use glam::DVec2;
use serde_json::Value;
use tautline::engine::{Engine, Job, Reference};
use tautline::geometry::{COORDINATE_MAX, COORDINATE_MIN};
use tautline::lab::extremes::FAMILIES;
use tautline::trace::settle;

use super::traces::write_parquet;
use super::{EVAL, Folder};

const MILLION: usize = 1_000_000;

/// Writes these rows as `t.csv` and as `t.parquet`.
fn write_rows(folder: &Folder, rows: impl Iterator<Item = (u32, [f64; 2])>) {
    let (mut text, mut columns) = ("trace,x,y\n".to_owned(), (vec![], vec![], vec![]));
    for (id, [x, y]) in rows {
        writeln!(text, "{id},{x:e},{y:e}").unwrap();
        columns.0.push(id);
        columns.1.push(x);
        columns.2.push(y);
    }
    folder.write("t.csv", text);
    write_parquet(folder, "y", columns.0, columns.1, columns.2);
}

/// The most memory, in KiB, that a run with these arguments was seen to take.
#[cfg(target_os = "linux")]
fn memory(folder: &Folder, args: &str) -> usize {
    let mut child = folder.command(args).stderr(std::process::Stdio::null()).spawn().unwrap();
    let mut most = 0;
    loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB")?.trim().parse().ok());
        most = most.max(peak.unwrap_or(0));
        if let Some(done) = child.try_wait().unwrap() {
            assert!(done.success(), "{args}");
            return most;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

/// Each goes round the first wall's upper end, or passes it far off.
fn one_step(id: usize) -> [[f64; 2]; 2] {
    if id.is_multiple_of(2) { [[5.0, 12.0], [5.0, 4.0]] } else { [[0.0, 12.0], [5.0, 12.0]] }
}

#[test]
fn a_million_traces_of_one_step_stream_through() {
    let folder = Folder::hand_made();
    let rows = |count: usize| (0..count).flat_map(|id| one_step(id).map(|point| (id as u32, point)));
    write_rows(&folder, rows(MILLION));
    for traces in ["t.csv", "t.parquet"] {
        folder.done(&EVAL.replace("t.csv", traces));
        let results = folder.text("r.jsonl");
        assert_eq!(results.lines().count(), MILLION);
        for (line, id) in results.lines().zip(0..) {
            let length = if id % 2 == 0 { "7.0" } else { "13.0" };
            let start = format!(r#"{{"trace":{id},"status":"ok","steps":1,"length":{length},"#);
            assert!(line.starts_with(&start), "{line}");
        }
        assert_eq!(folder.text("e.csv").lines().count(), 1 + MILLION / 2);
    }
    #[cfg(target_os = "linux")]
    {
        let run = |traces: &str| {
            memory(
                &folder,
                &format!("eval --scene s.geojson --traces {traces} --out r.csv --events e.csv --engine cpu --json"),
            )
        };
        let many = [run("t.csv"), run("t.parquet")];
        write_rows(&folder, rows(MILLION / 10));
        let few = [run("t.csv"), run("t.parquet")];
        // A tenth fills all that is held at a time. The records of the others alone would take 200 MiB.
        assert!(few.iter().zip(&many).all(|(few, many)| many - few.min(many) < 64 << 10), "{few:?} and {many:?} KiB");
    }
}

#[test]
fn a_trace_of_a_million_steps() {
    let folder = Folder::hand_made();
    write_rows(&folder, one_step(0).into_iter().cycle().take(MILLION + 1).map(|point| (0, point)));
    for traces in ["t.csv", "t.parquet"] {
        folder.done(&EVAL.replace("t.csv", traces));
        let result: Value = serde_json::from_str(&folder.text("r.jsonl")).unwrap();
        let [steps, events] = ["steps", "events"].map(|key| result[key].as_u64().unwrap() as usize);
        assert_eq!((steps, events, result["length"].as_f64()), (MILLION, MILLION, Some(13.0)), "{traces}");
        // Round the wall's end on every odd step, back on every even one.
        let events = folder.text("e.csv");
        assert_eq!(events.lines().count(), 1 + MILLION);
        for (line, step) in events.lines().skip(1).zip(1..) {
            let kind = if step % 2 == 1 { "wrap" } else { "unwrap" };
            assert_eq!(line, format!("0,{step},{kind},0,3.0,4.0,right"));
        }
    }
}

#[test]
fn a_rope_of_400_000_contacts_is_written_and_read_back() {
    let windings = FAMILIES.iter().find(|family| family.name == "windings").unwrap().cases();
    let case = windings.into_iter().find(|case| case.name == "100000 turns round 4 corners").unwrap();
    let folder = Folder::new();
    let walls: Vec<_> = case.walls.iter().map(|wall| wall.map(|end| end.to_array())).collect();
    folder.write("s.json", serde_json::json!({"type": "MultiLineString", "coordinates": walls}).to_string());
    write_rows(&folder, case.traces[0].points.iter().map(|point| (0, point.to_array())));
    let anchor = format!("{},{}", case.anchor.x, case.anchor.y);
    folder.done(&format!("eval --scene s.json --anchor={anchor} --traces t.parquet --out r.jsonl"));
    let model = case.model();
    let trace = settle(&model, &case.traces[0]);
    let record = Reference::new(model.clone()).evaluate(&[trace], &Job::new()).unwrap().remove(0);
    assert!(record.wraps.len() > 399_990, "{} contacts", record.wraps.len());
    let result: Value = serde_json::from_str(&folder.text("r.jsonl")).unwrap();
    assert_eq!((result["length"].as_f64(), result["depth"].as_u64()), (Some(record.length), Some(record.depth.into())));
    let wraps = result["wraps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|at| DVec2::new(at[0].as_f64().unwrap(), at[1].as_f64().unwrap()));
    let sides = result["sides"].as_array().unwrap().iter().map(|side| side.as_str().unwrap());
    assert!(wraps.zip(sides).eq(record.wraps.iter().map(|(at, side)| (*at, side.name()))));
}

#[test]
fn the_last_magnitude_is_taken_and_the_next_refused_with_its_place() {
    let next = |x: f64, ulps: i64| f64::from_bits(x.to_bits().wrapping_add_signed(ulps));
    let scene = |x: f64| {
        format!(
            "{{\"type\": \"FeatureCollection\", \"features\": [\n{{\"type\": \"Feature\", \"properties\": {{}}, \
            \"geometry\": {{\"type\": \"LineString\", \"coordinates\": [[1, 7], [{x:e}, 8]]}}}}]}}"
        )
    };
    let eval = |traces: &str| format!("eval --scene s.geojson --anchor=0,0 --traces {traces} --out r.jsonl");
    for (last, ulps, what) in [(COORDINATE_MAX, 1, "too large"), (COORDINATE_MIN, -1, "too small")] {
        for sign in [1.0, -1.0] {
            let (last, refused) = (sign * last, sign * next(last, ulps));
            let folder = Folder::new();
            folder.write("s.geojson", scene(last));
            write_rows(&folder, [(0, [0.0, 0.0]), (0, [0.5, last])].into_iter());
            // One after the other, since each engine refuses in its own way what it does not take.
            for engine in ["cpu", "reference", "gpu --adapter software"] {
                for traces in ["t.csv", "t.parquet"] {
                    folder.done(&format!("{} --engine {engine}", eval(traces)));
                }
            }
            folder.refused(2, &format!("{} --engine funnel", eval("t.csv")), &["funnel cannot take this scene"]);
            write_rows(&folder, [(0, [0.0, 0.0]), (0, [0.5, refused])].into_iter());
            let number = format!("{refused:e} is {what}");
            folder.refused(2, &eval("t.csv"), &[&format!("t.csv: line 3: column y: {number}")]);
            folder.refused(2, &eval("t.parquet"), &[&format!("t.parquet: row 1: column y: {number}")]);
            folder.write("s.geojson", scene(refused));
            folder.refused(2, &eval("t.csv"), &[&format!("s.geojson: feature 0, position 1: {number}")]);
        }
    }
}
