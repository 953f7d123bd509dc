//! Traces that cannot be read, or that no rope among solid walls can follow.

use std::fs::File;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt32Array};
use parquet::arrow::ArrowWriter;

use super::{EVAL, Folder};

/// Evaluation of a CSV file with this text in the hand-made scene is refused.
fn refused(text: &str, parts: &[&str]) {
    let folder = Folder::hand_made();
    folder.write("t.csv", text);
    folder.refused(2, EVAL, parts);
}

/// A file of columns trace, x and `name`.
pub(super) fn write_parquet(folder: &Folder, name: &str, trace: Vec<u32>, x: Vec<f64>, y: Vec<f64>) {
    let columns: [(&str, ArrayRef); 3] = [
        ("trace", Arc::new(UInt32Array::from(trace))),
        ("x", Arc::new(Float64Array::from(x))),
        (name, Arc::new(Float64Array::from(y))),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let file = File::create(folder.path("t.parquet")).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
}

#[test]
fn files_that_are_not_there_or_not_known() {
    let folder = Folder::hand_made();
    let eval = |traces: &str| EVAL.replace("t.csv", traces);
    folder.refused(2, &eval("no.csv"), &["cannot read no.csv", "No such file"]);
    folder.refused(2, &eval("no.parquet"), &["cannot read no.parquet", "No such file"]);
    for name in ["t.txt", "t"] {
        folder.write(name, "0,0,0");
        folder.refused(2, &eval(name), &[&format!("{name}: the extension"), "traces", ".csv, .parquet"]);
    }
    std::fs::create_dir(folder.path("folder.csv")).unwrap();
    folder.refused(2, &eval("folder.csv"), &["cannot read folder.csv", "directory"]);
}

#[test]
fn faults_in_csv_name_line_and_column() {
    for (text, parts) in [
        ("", &["t.csv: line 1: ", "empty", "trace,x,y"][..]),
        ("trace,x\n0,1\n", &["t.csv: line 1: no column y", "trace,x", "trace, x and y"]),
        ("0,1,2\n", &["t.csv: line 1: no column trace", "0,1,2"]),
        ("trace,x,y,x\n", &["t.csv: line 1: two columns x", "once each"]),
        ("trace,x,y\n0,1,2\n0,1,two\n", &["t.csv: line 3: column y: \"two\"", "a number such as"]),
        ("trace,x,y\n-1,1,2\n", &["t.csv: line 2: column trace: \"-1\"", "a whole number from 0"]),
        ("trace,x,y\n0,1\n", &["t.csv: line 2: 2 fields", "header has 3"]),
        ("trace,x,y\n0,1,2\n2,1,2\n1,1,2\n", &["t.csv: line 4: trace 1 after trace 2", "numbers increase"]),
        ("trace,x,y\n0,NaN,2\n", &["t.csv: line 2: column x: NaN is not a finite number"]),
        ("trace,x,y\n0,0,0\n0,1,-inf\n", &["t.csv: line 3: column y: -inf is not a finite number"]),
        ("trace,x,y\n0,0,1e200\n", &["t.csv: line 2: column y: 1e200 is too large", "within 2^500"]),
        ("trace,x,y\n0,1e-200,0\n", &["t.csv: line 2: column x: 1e-200 is too small", "at least 2^-450"]),
        ("trace,x,y\r\n\r\n0,0,0\r\n0,a,0\r\n", &["t.csv: line 4: column x: \"a\""]),
    ] {
        refused(text, parts);
    }
}

#[test]
fn faults_in_parquet_name_row_and_column() {
    let folder = Folder::hand_made();
    let eval = EVAL.replace("t.csv", "t.parquet");
    for garbage in [&b""[..], b"PAR1", b"PAR1 is what such files start with, and end with: PAR1", TRACES_TEXT] {
        folder.write("t.parquet", garbage);
        folder.refused(2, &eval, &["t.parquet: not Parquet, or damaged"]);
    }
    write_parquet(&folder, "z", vec![0], vec![1.0], vec![1.0]);
    folder.refused(2, &eval, &["t.parquet: no column y among trace, x, z"]);
    write_parquet(&folder, "y", vec![0; 2], vec![1.0; 2], vec![0.0, f64::NAN]);
    folder.refused(2, &eval, &["t.parquet: row 1: column y: NaN is not a finite number"]);
    write_parquet(&folder, "y", vec![0, 2, 1], vec![1.0; 3], vec![0.0; 3]);
    folder.refused(2, &eval, &["t.parquet: row 2: trace 1 after trace 2", "numbers increase"]);
    // A file that was cut off.
    let whole = folder.read("t.parquet");
    folder.write("t.parquet", &whole[..whole.len() / 2]);
    folder.refused(2, &eval, &["t.parquet: not Parquet, or damaged"]);
}

const TRACES_TEXT: &[u8] = super::TRACES.as_bytes();

#[test]
fn steps_through_walls_name_trace_step_and_wall() {
    let wall = "wall 0, from (3, 4) to (3, -4)";
    let crosses = [
        "error: t.csv: trace 3, step 2: the move from (1, 0) to (5, 0) crosses",
        wall,
        "visible",
        "--on-violation flag",
    ];
    refused("trace,x,y\n2,0,1\n3,0,0\n3,1,0\n3,5,0\n3,1,0\n", &crosses);
    // To the middle of a wall, which is legal, and away from it on the other side.
    let across = ["t.csv: trace 0, step 2: the move from (3, 1) to (5, 1) crosses", wall];
    refused("trace,x,y\n0,1,0\n0,3,1\n0,5,1\n", &across);
    let hidden = ["t.csv: trace 0, step 0: the move from (0, 0) to (5, 1) crosses", wall, "the first from the anchor"];
    refused("trace,x,y\n0,5,1\n0,6,1\n", &hidden);
    // The first of several, by trace.
    refused("trace,x,y\n1,1,0\n1,2,0\n4,5,1\n8,5,1\n", &["trace 4, step 0"]);
}

#[test]
fn no_trace_slips_through_the_corner_of_a_closed_box() {
    let folder = Folder::hand_made();
    let ring = "[[[2, 2], [4, 2], [4, 4], [2, 4], [2, 2]]]";
    folder.write("s.geojson", format!(r#"{{"type": "Polygon", "coordinates": {ring}}}"#));
    let eval = format!("{EVAL} --anchor 0,0");
    let wall = "wall 0, from (2, 2) to (4, 2)";
    let straight = ["trace 0, step 1: the move from (1, 1) to (3, 3) slips between", wall];
    folder.write("t.csv", "trace,x,y\n0,1,1\n0,3,3\n");
    folder.refused(2, &eval, &straight);
    let resting = ["trace 0, step 2: the move from (2, 2) to (3, 3) slips between", wall];
    folder.write("t.csv", "trace,x,y\n0,1,1\n0,2,2\n0,3,3\n");
    folder.refused(2, &eval, &resting);
    // Touching the corner from outside is no fault.
    folder.write("t.csv", "trace,x,y\n0,1,1\n0,2,2\n0,1,3\n");
    folder.done(&eval);
}

#[test]
fn a_violation_that_is_flagged_leaves_the_others_as_they_are() {
    let folder = Folder::hand_made();
    folder.done(EVAL);
    let expected = folder.text("r.jsonl");
    folder.write("t.csv", super::TRACES.replace("\n7,0,0\n", "\n6,1,0\n6,5,0\n7,0,0\n"));
    let done = folder.done(&format!("{EVAL} --on-violation flag --engine reference"));
    let warnings: Vec<_> = done.stderr.lines().collect();
    assert_eq!(warnings.len(), 1, "{}", done.stderr);
    assert!(warnings[0].starts_with("warning: t.csv: trace 6, step 1: the move from (1, 0) to (5, 0) crosses wall 0"));
    assert!(done.stdout.contains("crossing 1 trace crosses a wall"), "{}", done.stdout);
    let text = folder.text("r.jsonl");
    let (flagged, others): (Vec<_>, Vec<_>) = text.lines().partition(|l| l.starts_with(r#"{"trace":6,"#));
    assert_eq!(others, expected.lines().collect::<Vec<_>>());
    assert_eq!(flagged.len(), 1);
    assert!(flagged[0].starts_with(r#"{"trace":6,"status":"violation","steps":1,"#), "{}", flagged[0]);
    // Many are counted rather than listed.
    let many: String = (0..1002).map(|trace| format!("{trace},5,0\n")).collect();
    folder.write("t.csv", format!("trace,x,y\n{many}"));
    let done = folder.done(&format!("{EVAL} --on-violation flag --engine reference"));
    assert_eq!(done.stderr.matches("crosses wall 0").count(), 1000, "{}", done.stderr);
    assert!(done.stderr.contains("and 2 more traces that cross walls"), "{}", done.stderr);
}
