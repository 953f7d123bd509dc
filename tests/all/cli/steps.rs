//! `eval --steps` and `study replay --steps`.

use std::fs::File;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, RecordBatch};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use super::Folder;

/// A wall called `rail, long` from (3, 4) to (3, -4), and a second one without a name.
const NAMED: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"name": "rail, long"},
 "geometry": {"type": "LineString", "coordinates": [[3, 4], [3, -4]]}},
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[6, 0], [5.5, -9]]}},
{"type": "Feature", "properties": {"role": "anchor"}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
]}
"#;

pub(super) fn read(folder: &Folder, name: &str) -> Vec<RecordBatch> {
    let file = File::open(folder.path(name)).unwrap();
    ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap().map(Result::unwrap).collect()
}

#[test]
fn every_step_is_a_row() {
    let folder = Folder::hand_made();
    folder.done("eval --scene s.geojson --traces t.csv --steps s.csv");
    let rows = folder.text("s.csv");
    let expected = "trace,step,x,y,length,contacts,turns,pull_x,pull_y\n\
        0,0,0.0,0.0,0.0,0,0,,\n\
        0,1,0.0,12.0,12.0,0,0,0.0,-1.0\n\
        0,2,5.0,12.0,13.0,0,0,-0.38461538461538464,-0.9230769230769231\n\
        0,3,5.0,4.0,7.0,1,1,-1.0,0.0\n";
    assert!(rows.starts_with(expected), "{rows}");
    assert_eq!(rows.lines().count(), 1 + 7 + 5 + 3 + 1);
    assert!(rows.ends_with("7,0,0.0,0.0,0.0,0,0,,\n"), "{rows}");
    // Nothing else is another for it.
    folder.done("eval --scene s.geojson --traces t.csv --out a.parquet --events a.csv");
    folder.done("eval --scene s.geojson --traces t.csv --out b.parquet --events b.csv --steps s.parquet");
    assert!(folder.read("a.parquet") == folder.read("b.parquet") && folder.read("a.csv") == folder.read("b.csv"));
}

#[test]
fn all_formats_hold_the_same_steps_whatever_computes_them() {
    let folder = Folder::hand_made();
    folder.write("n.geojson", NAMED);
    let eval = "eval --scene n.geojson --traces t.csv";
    for (engine, name) in [("cpu", "s"), ("reference", "r")] {
        for format in ["csv", "jsonl", "parquet"] {
            folder.done(&format!("{eval} --engine {engine} --steps {name}.{format}"));
        }
    }
    for format in ["csv", "jsonl", "parquet"] {
        assert!(folder.read(&format!("s.{format}")) == folder.read(&format!("r.{format}")), "{format}");
    }
    let csv = folder.text("s.csv");
    let batch = read(&folder, "s.parquet").remove(0);
    assert!(csv.starts_with("trace,step,x,y,length,contacts,turns,pull_x,pull_y,\"winding_rail, long\"\n"), "{csv}");
    let json = folder.text("s.jsonl");
    let column = |name: &str| batch.column_by_name(name).unwrap();
    let whole = |name| column(name).as_primitive::<UInt64Type>();
    let small = |name| column(name).as_primitive::<UInt32Type>();
    let float = |name| column(name).as_primitive::<Float64Type>();
    assert_eq!(batch.num_rows(), json.lines().count());
    for (i, (line, row)) in json.lines().zip(csv.lines().skip(1)).enumerate() {
        let object: serde_json::Value = serde_json::from_str(line).unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!(cells.len(), 10);
        let number = |cell: &str| cell.parse::<f64>().ok();
        for (at, name) in ["trace", "step"].into_iter().enumerate() {
            assert_eq!(
                (object[name].as_u64(), cells[at].parse().ok()),
                (Some(whole(name).value(i)), object[name].as_u64())
            );
        }
        for (at, name) in ["x", "y", "length"].into_iter().enumerate() {
            assert_eq!(
                (object[name].as_f64(), number(cells[2 + at])),
                (Some(float(name).value(i)), object[name].as_f64())
            );
        }
        for (at, name) in ["contacts", "turns"].into_iter().enumerate() {
            let value = u64::from(small(name).value(i));
            assert_eq!((object[name].as_u64(), cells[5 + at].parse().ok()), (Some(value), Some(value)));
        }
        for (at, name) in ["pull_x", "pull_y"].into_iter().enumerate() {
            let value = float(name).is_valid(i).then(|| float(name).value(i));
            assert_eq!((object[name].as_f64(), number(cells[7 + at])), (value, value));
        }
        let winding = column("winding_rail, long").as_primitive::<Int64Type>().value(i);
        assert_eq!((object["winding_rail, long"].as_i64(), cells[9].parse().ok()), (Some(winding), Some(winding)));
    }
    // Trace 0 goes nearly round the end (3, 4), clockwise.
    let rail = column("winding_rail, long").as_primitive::<Int64Type>();
    assert!(rail.values().iter().all(|&turns| turns == 0));
}

#[test]
fn turns_are_counted_about_what_is_named() {
    let folder = Folder::hand_made();
    folder.write("n.geojson", NAMED);
    // Twice round both walls clockwise, from (0, 0) on, and from there to the left of the first.
    let round = "0,4,9\n0,9,0\n0,6,-12\n0,0,-9\n0,-1,0\n";
    folder.write("w.csv", format!("trace,x,y\n0,0,0\n{round}{round}"));
    folder.done("eval --scene n.geojson --traces w.csv --steps o.csv --about 2 --about 3 --about 2");
    let text = folder.text("o.csv");
    let mut rows = text.lines().map(|row| row.splitn(10, ',').last().unwrap());
    assert_eq!(rows.next(), Some("winding_vertex 2,winding_vertex 3"));
    // The ray from (5.5, -9) through (0, 0) is reached again only beyond (-1, 0).
    assert_eq!(
        rows.collect::<Vec<_>>(),
        ["0,0", "0,0", "0,0", "0,0", "0,0", "-1,0", "-1,-1", "-1,-1", "-1,-1", "-1,-1", "-2,-1"]
    );
}

#[test]
fn a_wrong_name_is_told_with_what_there_is() {
    let folder = Folder::hand_made();
    folder.write("n.geojson", NAMED.replace("rail, long", "rail"));
    let eval = "eval --scene n.geojson --traces t.csv";
    folder.refused(
        2,
        &format!("{eval} --steps s.csv --about rial"),
        &["--about: no obstacle is called \"rial\"; did you mean \"rail\"?"],
    );
    folder.refused(
        2,
        &format!("{eval} --steps s.csv --about 4"),
        &["no obstacle is called \"4\"; give one of \"rail\", or the number of a wall end, 0 to 3"],
    );
    folder.refused(
        2,
        "eval --scene s.geojson --traces t.csv --steps s.csv --about rail",
        &["no obstacle is called \"rail\"; the scene has no labels, or the number of a wall end, 0 to 3"],
    );
    folder.refused(2, &format!("{eval} --about rail"), &["--steps"]);
    folder.refused(2, &format!("{eval} --steps s.txt"), &["s.txt: the extension does not name a format"]);
    folder.refused(2, &format!("{eval} --steps t.csv"), &["--traces and --steps name the same file"]);
    folder.refused(2, &format!("{eval} --steps a.csv --events a.csv"), &["--events and --steps name the same file"]);
}

#[test]
fn a_trace_longer_than_what_is_held_is_whole() {
    let folder = Folder::floor_plan(2, 70_000);
    folder.done("eval --scene s.geojson --traces t.csv --steps s.parquet");
    let rows: usize = read(&folder, "s.parquet").iter().map(RecordBatch::num_rows).sum();
    assert_eq!(rows, 2 * 70_001);
    let mut next = 0;
    for batch in read(&folder, "s.parquet") {
        let column = |name: &str| batch.column_by_name(name).unwrap().as_primitive::<UInt64Type>().clone();
        for (trace, step) in column("trace").values().iter().zip(column("step").values()) {
            assert_eq!((*trace, *step), (next / 70_001, next % 70_001));
            next += 1;
        }
    }
}

#[test]
fn a_replay_tells_the_steps_that_eval_tells() {
    let folder = Folder::new();
    folder.done("study run --count 5 --out a");
    folder.done("study replay a --trace 3 --steps s.csv --points p.csv");
    folder.write("empty.geojson", "");
    let rows = folder.text("s.csv");
    let points = folder.text("p.csv");
    assert_eq!(rows.lines().count(), points.lines().count());
    for (row, point) in rows.lines().zip(points.lines()).skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |text: &str| text.parse::<f64>().unwrap();
        let point: Vec<&str> = point.split(',').collect();
        assert_eq!([cells[0], point[0]], ["3", "3"]);
        assert_eq!([cells[2], cells[3]].map(number), [point[1], point[2]].map(number));
    }
    folder.refused(2, "study replay a --trace 3 --steps a/s.csv", &["--steps: a/s.csv is in the study's folder"]);
}
