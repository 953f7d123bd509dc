//! `eval` on input that is small enough to work its ropes out by hand.

use std::fs::File;
use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, RecordBatch};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::{Value, json};

use super::Folder;

const RESULTS_JSONL: &str = r#"{"trace":0,"status":"ok","steps":6,"length":22.0,"max_length":23.0,"depth":2,"max_depth":2,"events":2,"wraps":[[3.0,4.0],[6.0,0.0]],"sides":["right","right"],"pull":[0.0,1.0]}
{"trace":4,"status":"ok","steps":4,"length":12.0,"max_length":13.0,"depth":0,"max_depth":1,"events":2,"wraps":[],"sides":[],"pull":[0.0,-1.0]}
{"trace":5,"status":"ok","steps":2,"length":7.0,"max_length":13.0,"depth":1,"max_depth":1,"events":1,"wraps":[[3.0,-4.0]],"sides":["left"],"pull":[-1.0,0.0]}
{"trace":7,"status":"ok","steps":0,"length":0.0,"max_length":0.0,"depth":0,"max_depth":0,"events":0,"wraps":[],"sides":[],"pull":null}
"#;

const EVENTS_JSONL: &str = r#"{"trace":0,"step":3,"kind":"wrap","vertex":0,"x":3.0,"y":4.0,"side":"right"}
{"trace":0,"step":5,"kind":"wrap","vertex":2,"x":6.0,"y":0.0,"side":"right"}
{"trace":4,"step":2,"kind":"wrap","vertex":0,"x":3.0,"y":4.0,"side":"right"}
{"trace":4,"step":3,"kind":"unwrap","vertex":0,"x":3.0,"y":4.0,"side":"right"}
{"trace":5,"step":2,"kind":"wrap","vertex":1,"x":3.0,"y":-4.0,"side":"left"}
"#;

const RESULTS_CSV: &str = "\
trace,status,steps,length,max_length,depth,max_depth,events,wraps,sides,pull_x,pull_y
0,ok,6,22.0,23.0,2,2,2,3.0 4.0;6.0 0.0,right;right,0.0,1.0
4,ok,4,12.0,13.0,0,1,2,,,0.0,-1.0
5,ok,2,7.0,13.0,1,1,1,3.0 -4.0,left,-1.0,0.0
7,ok,0,0.0,0.0,0,0,0,,,,
";

const EVENTS_CSV: &str = "\
trace,step,kind,vertex,x,y,side
0,3,wrap,0,3.0,4.0,right
0,5,wrap,2,6.0,0.0,right
4,2,wrap,0,3.0,4.0,right
4,3,unwrap,0,3.0,4.0,right
5,2,wrap,1,3.0,-4.0,left
";

/// The one result, as JSON, of `points` of a single trace in the scene and with the other arguments of `args`.
fn result(folder: &Folder, args: &str, points: &str) -> Value {
    folder.write("one.csv", format!("trace,x,y\n{points}"));
    folder.done(&format!("eval --traces one.csv --out one.jsonl {args}"));
    serde_json::from_str(&folder.text("one.jsonl")).unwrap()
}

#[test]
fn json_lines_are_the_ropes_worked_out_by_hand() {
    let folder = Folder::hand_made();
    folder.done("eval --scene s.geojson --traces t.csv --out r.jsonl --events e.jsonl");
    assert_eq!(folder.text("r.jsonl"), RESULTS_JSONL);
    assert_eq!(folder.text("e.jsonl"), EVENTS_JSONL);
}

#[test]
fn csv_holds_the_same() {
    let folder = Folder::hand_made();
    folder.done("eval --scene s.geojson --traces t.csv --out r.csv --events e.csv");
    assert_eq!(folder.text("r.csv"), RESULTS_CSV);
    assert_eq!(folder.text("e.csv"), EVENTS_CSV);
}

#[test]
fn parquet_holds_the_same() {
    let folder = Folder::hand_made();
    folder.done("eval --scene s.geojson --traces t.csv --out r.parquet --events e.parquet");

    let results = Table::read(&folder.path("r.parquet"));
    assert_eq!(results.u64("trace"), [0, 4, 5, 7]);
    assert_eq!(results.text("status"), ["ok"; 4]);
    assert_eq!(results.u64("steps"), [6, 4, 2, 0]);
    assert_eq!(results.f64("length"), [22.0, 12.0, 7.0, 0.0]);
    assert_eq!(results.f64("max_length"), [23.0, 13.0, 13.0, 0.0]);
    assert_eq!(results.u32("depth"), [2, 0, 1, 0]);
    assert_eq!(results.u32("max_depth"), [2, 1, 1, 0]);
    assert_eq!(results.u64("events"), [2, 2, 1, 0]);
    let wraps = results.0.column_by_name("wraps").unwrap().as_list::<i32>();
    let points: Vec<Vec<[f64; 2]>> = wraps.iter().map(|row| points(&row.unwrap())).collect();
    assert_eq!(points, [vec![[3.0, 4.0], [6.0, 0.0]], vec![], vec![[3.0, -4.0]], vec![]]);
    let sides = results.0.column_by_name("sides").unwrap().as_list::<i32>();
    let sides: Vec<Vec<String>> = sides.iter().map(|row| strings(&row.unwrap())).collect();
    assert_eq!(sides, [vec!["right", "right"], vec![], vec!["left"], vec![]]);
    let pull = results.0.column_by_name("pull").unwrap();
    assert_eq!(self::points(pull)[..3], [[0.0, 1.0], [0.0, -1.0], [-1.0, 0.0]]);
    assert_eq!((0..4).map(|row| pull.is_null(row)).collect::<Vec<_>>(), [false, false, false, true]);

    let events = Table::read(&folder.path("e.parquet"));
    assert_eq!(events.u64("trace"), [0, 0, 4, 4, 5]);
    assert_eq!(events.u64("step"), [3, 5, 2, 3, 2]);
    assert_eq!(events.text("kind"), ["wrap", "wrap", "wrap", "unwrap", "wrap"]);
    assert_eq!(events.u32("vertex"), [0, 2, 0, 0, 1]);
    assert_eq!(events.f64("x"), [3.0, 6.0, 3.0, 3.0, 3.0]);
    assert_eq!(events.f64("y"), [4.0, 0.0, 4.0, 4.0, -4.0]);
    assert_eq!(events.text("side"), ["right", "right", "right", "right", "left"]);
}

#[test]
fn a_grid_map_is_a_scene() {
    let folder = Folder::new();
    folder.write("g.map", "type octile\nheight 3\nwidth 5\nmap\n.....\n..@..\n.....\n");
    // Past the blocked cell's corner (2, 1), which turns the rope by the angle between (3, -4) and (4, -3).
    let result = result(&folder, "--scene g.map --anchor -1,5", "0,-1,0\n0,2,-2\n0,6,-2\n");
    // Rows are counted downwards, so the corner lies right of the rope that goes up past it.
    assert_eq!([&result["wraps"], &result["sides"]], [&json!([[2.0, 1.0]]), &json!(["right"])]);
    assert_eq!([&result["length"], &result["depth"]], [&json!(10.0), &json!(1)]);
}

#[test]
fn the_anchor_given_overrides_the_scenes() {
    let folder = Folder::hand_made();
    let points = "0,5,12\n0,5,4\n";
    let at_the_scenes = result(&folder, "--scene s.geojson", points);
    assert_eq!([&at_the_scenes["length"], &at_the_scenes["wraps"]], [&json!(7.0), &json!([[3.0, 4.0]])]);
    for (anchor, length) in [("--anchor 5,-1", 5.0), ("--anchor=8,0", 5.0), ("--anchor -7,4", 12.0)] {
        let given = result(&folder, &format!("--scene s.geojson {anchor}"), points);
        assert_eq!([&given["length"], &given["depth"]], [&json!(length), &json!(0)], "{anchor}");
    }
}

#[test]
fn a_file_without_traces_gives_files_without_rows() {
    let folder = Folder::hand_made();
    folder.write("none.csv", "trace,x,y\n");
    let eval = "eval --scene s.geojson --traces none.csv";
    folder.done(&format!("{eval} --out r.csv --events e.csv"));
    assert_eq!(folder.text("r.csv").lines().collect::<Vec<_>>(), [RESULTS_CSV.lines().next().unwrap()]);
    assert_eq!(folder.text("e.csv").lines().collect::<Vec<_>>(), [EVENTS_CSV.lines().next().unwrap()]);
    folder.done(&format!("{eval} --out r.jsonl --events e.jsonl --engine gpu --adapter software"));
    assert_eq!((folder.text("r.jsonl"), folder.text("e.jsonl")), (String::new(), String::new()));
    let stdout = folder.done(&format!("{eval} --json")).stdout;
    let report: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&report["traces"], &report["length"], &report["max_depth"]), (&json!(0), &Value::Null, &Value::Null));
    let table = folder.done(eval).stdout;
    assert!(table.contains("  rope length at the end             n/a         n/a         n/a\n"), "{table}");
}

#[test]
fn traces_of_one_point_have_a_rope_too() {
    let folder = Folder::hand_made();
    for (point, length, pull) in [("0,0,0\n", 0.0, Value::Null), ("0,0,-2\n", 2.0, json!([0.0, 1.0]))] {
        for engine in ["reference", "cpu", "gpu --adapter software", "funnel"] {
            let result = result(&folder, &format!("--scene s.geojson --engine {engine}"), point);
            assert_eq!([&result["length"], &result["pull"]], [&json!(length), &pull], "{engine}");
            assert_eq!([&result["steps"], &result["wraps"]], [&json!(0), &json!([])], "{engine}");
        }
    }
}

#[test]
fn a_scene_without_walls_has_straight_ropes() {
    let folder = Folder::new();
    folder.write("empty.geojson", r#"{"type": "FeatureCollection", "features": []}"#);
    for engine in ["reference", "cpu", "gpu --adapter software", "funnel"] {
        let args = format!("--scene empty.geojson --anchor 1,1 --engine {engine}");
        let result = result(&folder, &args, "0,2,1\n0,4,5\n0,1,3\n");
        assert_eq!([&result["length"], &result["max_length"]], [&json!(2.0), &json!(5.0)], "{engine}");
        assert_eq!([&result["pull"], &result["events"]], [&json!([0.0, -1.0]), &json!(0)], "{engine}");
    }
}

/// A Parquet file that was read back.
pub(super) struct Table(RecordBatch);

impl Table {
    pub(super) fn read(path: &Path) -> Self {
        let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
        let batches: Vec<_> = builder.build().unwrap().map(Result::unwrap).collect();
        assert_eq!(batches.len(), 1);
        Table(batches[0].clone())
    }

    fn u64(&self, name: &str) -> Vec<u64> {
        self.0.column_by_name(name).unwrap().as_primitive::<UInt64Type>().values().to_vec()
    }

    fn u32(&self, name: &str) -> Vec<u32> {
        self.0.column_by_name(name).unwrap().as_primitive::<UInt32Type>().values().to_vec()
    }

    fn f64(&self, name: &str) -> Vec<f64> {
        self.0.column_by_name(name).unwrap().as_primitive::<Float64Type>().values().to_vec()
    }

    fn text(&self, name: &str) -> Vec<String> {
        strings(self.0.column_by_name(name).unwrap())
    }

    /// The lists of strings of a column.
    pub(super) fn lists(&self, name: &str) -> Vec<Vec<String>> {
        self.0.column_by_name(name).unwrap().as_list::<i32>().iter().map(|row| strings(&row.unwrap())).collect()
    }
}

fn strings(array: &dyn Array) -> Vec<String> {
    array.as_string::<i32>().iter().map(|s| s.unwrap().to_owned()).collect()
}

/// The structs of x and y in `array`.
fn points(array: &dyn Array) -> Vec<[f64; 2]> {
    let [x, y] = ["x", "y"].map(|c| array.as_struct().column_by_name(c).unwrap().as_primitive::<Float64Type>().clone());
    x.values().iter().zip(y.values()).map(|(&x, &y)| [x, y]).collect()
}
