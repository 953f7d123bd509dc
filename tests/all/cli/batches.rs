//! More traces than are held at a time.

use std::fmt::Write;

use serde_json::Value;

use super::{EVAL, Folder};

/// More than two batches.
const TRACES: u64 = 20_000;

/// Traces that go round the first wall's upper end, but `odd` does something else.
fn traces(odd: u64, other: &str) -> String {
    let mut text = "trace,x,y\n".to_owned();
    for id in 0..TRACES {
        let rows = if id == odd { other } else { "0,12\n5,12\n5,4\n" };
        for row in rows.lines() {
            writeln!(text, "{id},{row}").unwrap();
        }
    }
    text
}

#[test]
fn results_of_all_batches_come_in_order() {
    let folder = Folder::hand_made();
    folder.write("t.csv", traces(TRACES - 1, "0,0\n"));
    let report: Value = serde_json::from_str(&folder.done(&format!("{EVAL} --json")).stdout).unwrap();
    assert_eq!((report["traces"].as_u64(), report["wraps"].as_u64()), (Some(TRACES), Some(TRACES - 1)));
    assert_eq!((report["depth"]["median"].as_f64(), report["depth"]["max"].as_f64()), (Some(1.0), Some(1.0)));
    let results = folder.text("r.jsonl");
    assert_eq!(results.lines().count() as u64, TRACES);
    for (line, id) in results.lines().zip(0..) {
        let length = if id == TRACES - 1 { 0.0 } else { 7.0 };
        let result: Value = serde_json::from_str(line).unwrap();
        assert_eq!((result["trace"].as_u64(), result["length"].as_f64()), (Some(id), Some(length)), "{line}");
    }
    let events = folder.text("e.csv");
    let expected = (0..TRACES - 1).map(|id| format!("{id},2,wrap,0,3.0,4.0,right"));
    assert!(events.lines().skip(1).eq(expected));
}

#[test]
fn a_fault_in_a_later_batch_leaves_nothing() {
    let folder = Folder::hand_made();
    let line = 3 * (TRACES - 10) + 3;
    let name = format!("t.csv: trace {}, step 1: ", TRACES - 10);
    for (other, parts) in
        [("0,12\n0,no\n0,12\n", &[format!("t.csv: line {line}: column y: \"no\"")]), ("1,0\n5,0\n5,4\n", &[name])]
    {
        folder.write("t.csv", traces(TRACES - 10, other));
        let parts: Vec<_> = parts.iter().map(String::as_str).collect();
        folder.refused(2, EVAL, &parts);
        folder.refused(2, "check --scene s.geojson --traces t.csv", &parts);
    }
}

#[test]
fn violations_of_all_batches_are_counted() {
    let folder = Folder::hand_made();
    folder.write("t.csv", traces(TRACES - 10, "1,0\n5,0\n5,4\n").replace("\n7,5,12\n", "\n7,5,-12\n"));
    let report = folder.done("check --scene s.geojson --traces t.csv --on-violation flag --json").stdout;
    let report: Value = serde_json::from_str(&report).unwrap();
    let found: Vec<_> =
        report["traces"]["violations"].as_array().unwrap().iter().map(|v| v["trace"].as_u64().unwrap()).collect();
    assert_eq!((report["traces"]["traces"].as_u64(), found), (Some(TRACES), vec![7, TRACES - 10]));
    let shown = folder.done("check --scene s.geojson --traces t.csv --on-violation flag");
    assert!(shown.stdout.contains(&format!("{TRACES}, {} steps; 2 of the traces cross walls", 2 * TRACES)));
}
