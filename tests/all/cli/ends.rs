//! `eval` and `draw` where both ends of ropes move.

use std::fs::File;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt64Array};
use parquet::arrow::ArrowWriter;

use super::Folder;

/// Two ropes among the walls of the hand-made scene: in the first the free end goes round the lower end of the first wall,
/// and the anchor follows until the rope is free again; in the second the anchor stays.
const ROWS: &[(u64, [f64; 4])] = &[
    (2, [0.0, -8.0, 0.0, 0.0]),
    (2, [4.5, -8.0, 0.0, 0.0]),
    (2, [4.5, -2.0, 0.0, 0.0]),
    (2, [4.5, -2.0, 0.0, -8.0]),
    (2, [4.5, -2.0, 4.5, -8.0]),
    (3, [0.0, 12.0, 0.0, 0.0]),
    (3, [5.0, 12.0, 0.0, 0.0]),
    (3, [5.0, 4.0, 0.0, 0.0]),
];

fn csv(columns: &str, row: impl Fn(&(u64, [f64; 4])) -> String) -> String {
    ROWS.iter().fold(format!("{columns}\n"), |text, line| text + &row(line) + "\n")
}

fn folder() -> Folder {
    let folder = Folder::hand_made();
    folder.write("both.csv", csv("trace,x,y,bx,by", |(id, [x, y, bx, by])| format!("{id},{x},{y},{bx},{by}")));
    folder.write("free.csv", csv("trace,x,y", |(id, [x, y, ..])| format!("{id},{x},{y}")));
    folder.write("anchor.csv", csv("trace,x,y", |(id, [.., x, y])| format!("{id},{x},{y}")));
    let column = |i: usize| -> ArrayRef { Arc::new(Float64Array::from_iter_values(ROWS.iter().map(|row| row.1[i]))) };
    let ids: ArrayRef = Arc::new(UInt64Array::from_iter_values(ROWS.iter().map(|row| row.0)));
    let columns = [("by", column(3)), ("trace", ids), ("x", column(0)), ("bx", column(2)), ("y", column(1))];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let file = File::create(folder.path("both.parquet")).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    folder
}

#[test]
fn both_ends_are_taken_from_columns_or_from_a_file_of_their_own() {
    let folder = folder();
    folder.done("eval --scene s.geojson --traces both.csv --out r.csv --events e.csv");
    let rows = folder.text("r.csv");
    let expected = ["2,ok,4,6.0,9.17877987534291,0,1,2,,,0.0,-1.0", "3,ok,2,7.0,13.0,1,1,1,3.0 4.0,right,-1.0,0.0"];
    assert_eq!(rows.lines().skip(1).collect::<Vec<_>>(), expected);
    let events = "trace,step,kind,vertex,x,y,side,end\n\
        2,2,wrap,1,3.0,-4.0,left,free\n\
        2,4,unwrap,1,3.0,-4.0,left,anchor\n\
        3,2,wrap,0,3.0,4.0,right,free\n";
    assert_eq!(folder.text("e.csv"), events);
    for given in ["both.parquet", "both.csv --engine reference", "free.csv --anchor-trace anchor.csv"] {
        folder.done(&format!("eval --scene s.geojson --traces {given} --out o.csv --events f.csv"));
        assert_eq!((folder.text("o.csv"), folder.text("f.csv")), (rows.clone(), events.to_owned()), "{given}");
    }
    let steps = "trace,step,x,y,bx,by,length,contacts,turns,pull_x,pull_y\n\
        2,0,0.0,-8.0,0.0,0.0,8.0,0,0,0.0,1.0\n\
        2,1,4.5,-8.0,0.0,0.0,9.17877987534291,0,0,-0.49026123963255896,0.8715755371245493\n\
        2,2,4.5,-2.0,0.0,0.0,7.5,1,1,-0.6,-0.8\n\
        2,3,4.5,-2.0,0.0,-8.0,7.5,1,0,-0.6,-0.8\n\
        2,4,4.5,-2.0,4.5,-8.0,6.0,0,0,0.0,-1.0\n\
        3,0,0.0,12.0,0.0,0.0,12.0,0,0,0.0,-1.0\n\
        3,1,5.0,12.0,0.0,0.0,13.0,0,0,-0.38461538461538464,-0.9230769230769231\n\
        3,2,5.0,4.0,0.0,0.0,7.0,1,1,-1.0,0.0\n";
    folder.done("eval --scene s.geojson --traces both.csv --steps s.csv");
    assert_eq!(folder.text("s.csv"), steps);
    folder.done("eval --scene s.geojson --traces both.csv --steps s.jsonl --about 1");
    let last = r#"{"trace":3,"step":2,"x":5.0,"y":4.0,"bx":0.0,"by":0.0,"length":7.0,"contacts":1,"turns":1,"pull_x":-1.0,"pull_y":0.0,"winding_vertex 1":0}"#;
    assert_eq!(folder.text("s.jsonl").lines().last(), Some(last));
    folder.done("eval --scene s.geojson --traces both.csv --steps s.parquet");
    let batch = super::steps::read(&folder, "s.parquet").remove(0);
    let names: Vec<_> = batch.schema().fields().iter().map(|field| field.name().clone()).collect();
    assert_eq!(names.join(","), steps.lines().next().unwrap());
    let by = batch.column_by_name("by").unwrap().as_primitive::<Float64Type>().values().to_vec();
    assert_eq!(by, [0.0, 0.0, 0.0, -8.0, -8.0, 0.0, 0.0, 0.0]);
    folder.done("eval --scene s.geojson --traces both.csv --events e.jsonl");
    let first = r#"{"trace":2,"step":2,"kind":"wrap","vertex":1,"x":3.0,"y":-4.0,"side":"left","end":"free"}"#;
    assert_eq!(folder.text("e.jsonl").lines().next(), Some(first));
    folder.done("eval --scene s.geojson --traces both.csv --events e.parquet");
    let batch = super::steps::read(&folder, "e.parquet").remove(0);
    let ends: Vec<_> = batch.column_by_name("end").unwrap().as_string::<i32>().iter().flatten().collect();
    assert_eq!(ends, ["free", "anchor", "free"]);
}

/// With an anchor that stays, the results are those of ropes that are tied there, to the byte, and the events say
/// besides that the free end had them.
#[test]
fn an_anchor_that_stays_gives_the_bytes_of_a_fixed_one() {
    let folder = Folder::hand_made();
    let traces = folder.text("t.csv");
    let both: String = traces
        .lines()
        .map(|line| line.to_owned() + if line.starts_with('t') { ",bx,by\n" } else { ",0,0\n" })
        .collect();
    folder.write("b.csv", &both);
    folder.write("stays.csv", both.replace(",0,0\n", ",0,0,extra\n").replace(",bx,by\n", ",bx,other,extra\n"));
    for format in ["csv", "jsonl", "parquet"] {
        folder.done(&format!("eval --scene s.geojson --traces t.csv --out o.{format} --events te.csv"));
        folder.done(&format!("eval --scene s.geojson --traces b.csv --out p.{format} --events be.csv"));
        assert!(folder.read(&format!("o.{format}")) == folder.read(&format!("p.{format}")), "{format}");
    }
    let without: String =
        folder.text("be.csv").lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    assert_eq!(without, folder.text("te.csv"));
    // A column bx without by is one of many others.
    folder.done("eval --scene s.geojson --traces stays.csv --out s.csv");
    assert!(folder.read("s.csv") == folder.read("o.csv"));
}

#[test]
fn what_does_not_go_with_two_ends_is_refused() {
    let folder = folder();
    let both = "eval --scene s.geojson --traces both.csv";
    for (args, says) in [
        (format!("{both} --engine gpu"), "the engine gpu does not take ropes whose anchor moves"),
        (format!("{both} --engine funnel"), "the engines cpu and reference do"),
        (format!("{both} --precision fast"), "the engine gpu does not take"),
        (format!("{both} --stride 2"), "--stride is for ropes that are tied: leave it out"),
        (format!("{both} --simplify 1"), "--simplify is for ropes that are tied"),
        (format!("{both} --anchor 1,1"), "--anchor is for ropes that are tied"),
        (format!("{both} --anchor-trace anchor.csv"), "leave --anchor-trace or these columns out"),
        ("check --scene s.geojson --traces both.csv".into(), "both.csv: it has columns bx and by"),
        ("draw --scene s.geojson --traces both.csv --animate --out p.svg".into(), "give --step K"),
        ("draw --scene s.geojson --traces both.csv --frames --out p.svg".into(), "in trace 2 the anchor moves"),
        ("draw --scene s.geojson --traces both.csv --trace 9 --out p.svg".into(), "there is no trace 9"),
        ("eval --scene s.geojson --traces free.csv --anchor-trace none.csv".into(), "cannot read none.csv"),
    ] {
        folder.refused(2, &args, &[says]);
    }
    let anchors = |name: &str, text: &str, says: &str| {
        folder.write(name, text);
        folder.refused(
            2,
            &format!("eval --scene s.geojson --traces free.csv --anchor-trace {name} --out o.csv"),
            &[says],
        );
        assert!(!folder.path("o.csv").exists());
    };
    let text = folder.text("anchor.csv");
    let few = "trace 2: the free end has 5 points, the anchor 4; both move in every step, so give both as many";
    anchors("few.csv", &text.replace("2,4.5,-8\n", ""), few);
    anchors("other.csv", &text.replace("\n3,", "\n4,"), "other.csv: no path for the anchor of trace 3; give one trace");
    anchors(
        "wall.csv",
        &text.replacen("2,0,0\n", "2,3,-1\n", 1),
        "the anchor starts at (3, -1) on wall 0, from (3, 4)",
    );
    let crosses = "the anchor of trace 2, step 4: the move from (0, -8) to (7, -8) crosses wall 1";
    anchors("through.csv", &text.replace("2,4.5,-8\n", "2,7,-8\n"), crosses);
    folder.write("nan.csv", "trace,x,y,bx,by\n0,1,1,0,0\n0,1,1,0,inf\n");
    folder.refused(2, "eval --scene s.geojson --traces nan.csv", &["nan.csv: line 3: column by: inf is not"]);
    folder.write("two.csv", "trace,x,y,bx,by,by\n0,1,1,0,0,0\n");
    folder.refused(2, "eval --scene s.geojson --traces two.csv", &["two columns by"]);
    folder.write("one.csv", "trace,x,y\n2,0,-1\n");
    folder.refused(
        2,
        "eval --scene s.geojson --traces one.csv --anchor-trace anchor.csv",
        &["trace 2: the free end has 1 point, the anchor 5;"],
    );
}

/// Where no anchor is marked: what is wrong with columns of the anchor's is said, and not that there is none to tie to.
#[test]
fn columns_of_the_anchor_that_will_not_do_are_named_first() {
    let folder = Folder::new();
    folder.write("w.wkt", "LINESTRING (1 1, 2 2)");
    for (name, text, says) in [
        ("less.csv", "trace,x,bx,by\n0,1,0,0\n", "less.csv: line 1: no column y in the header"),
        ("twice.csv", "\ntrace,x,y,bx,by,bx\n0,1,1,0,0,0\n", "twice.csv: line 2: two columns bx in the header"),
        ("large.csv", "trace,x,y,BX,BY\n0,1,1,0,0\n", "large.csv: line 1: the columns BX and BY: write bx and by if"),
        ("mixed.csv", "trace,x,y,bx,By\n0,1,1,0,0\n", "mixed.csv: line 1: the columns bx and By: write bx and by if"),
        ("row.csv", "trace,x,y,bx,by\n0,1,1,0,a\n", "row.csv: line 2: column by: \"a\" is not a number"),
        ("semi.csv", "trace;x;y;bx;by\n0;1;1;0;0\n", "w.wkt: no anchor; give --anchor"),
    ] {
        folder.write(name, text);
        for command in ["eval", "draw --out p.svg"] {
            folder.refused(2, &format!("{command} --scene w.wkt --traces {name}"), &[says]);
        }
    }
    // Where an anchor is given it is no less wrong.
    let given = "eval --scene w.wkt --anchor 0,0 --traces";
    folder.refused(2, &format!("{given} large.csv"), &["the columns BX and BY: write bx and by"]);
    folder.refused(2, &format!("{given} semi.csv"), &["semi.csv: line 1: ", "separated by semicolons"]);
    folder.write("other.csv", "trace,x,y,BX,b\n0,1,1,0,0\n");
    folder.done(&format!("{given} other.csv"));
}

#[test]
fn traces_of_which_an_end_crosses_a_wall_can_be_marked() {
    let folder = folder();
    let text = folder.text("both.csv").replace("2,4.5,-2,4.5,-8", "2,4.5,-2,7,-8");
    folder.write("marked.csv", &text);
    let args = "eval --scene s.geojson --traces marked.csv --on-violation flag --out r.csv";
    let output = folder.done(args).stdout;
    assert!(output.contains("1 trace crosses a wall and is marked"), "{output}");
    let rows = folder.text("r.csv");
    assert!(rows.contains("\n2,violation,") && rows.contains("\n3,ok,"), "{rows}");
}

#[test]
fn one_path_serves_all_traces_and_no_traces_are_no_fault() {
    let folder = folder();
    folder.write("one.csv", "trace,x,y\n9,0,-1\n9,0,-2\n");
    folder.write("two.csv", "trace,x,y\n0,1,1\n0,2,2\n1,-1,1\n1,-2,2\n");
    folder.done("eval --scene s.geojson --traces two.csv --anchor-trace one.csv --out r.csv");
    assert_eq!(folder.text("r.csv").lines().count(), 3);
    folder.write("none.csv", "trace,x,y,bx,by\n");
    folder.done("eval --scene s.geojson --traces none.csv --out r.csv --events e.csv");
    assert_eq!(
        (folder.text("r.csv").lines().count(), folder.text("e.csv").as_str()),
        (1, "trace,step,kind,vertex,x,y,side,end\n")
    );
}

#[test]
fn pictures_show_both_ends() {
    let folder = folder();
    folder.done("draw --scene s.geojson --traces both.csv --step 3 --out a.svg");
    let picture = folder.text("a.svg");
    for says in ["Trace 2 after step 3 of 4", ">trace of the anchor<", ">anchor<", ">free end<"] {
        assert!(picture.contains(says), "{says}");
    }
    folder.done("draw --scene s.geojson --traces free.csv --anchor-trace anchor.csv --step 3 --out b.svg");
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    folder.done("draw --scene s.geojson --traces both.csv --trace 2,3 --out c.html");
    assert!(folder.text("c.html").contains("trace 3 and its rope"));
    // A page that does not play says so, and what there is instead.
    let told = folder.done("draw --scene s.geojson --traces both.csv --out d.html").stderr;
    assert!(
        told.contains("note: d.html shows the rope after a step and does not play it") && told.contains("--step K")
    );
    assert!(!folder.text("d.html").contains("<script>"));
}

/// The worked example: its commands, what it says of the events and of the rope, and its pictures.
#[test]
fn the_tow_is_as_its_page_says() {
    let docs = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples"));
    let kept = |name: &str| std::fs::read_to_string(docs.join(name)).unwrap();
    let folder = Folder::new();
    ["harbour.geojson", "tow.csv"].iter().for_each(|name| folder.write(name, kept(name)));
    let page = kept("tow.md");
    let commands: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    tautline ")).collect();
    assert_eq!(commands.len(), 3);
    commands.iter().for_each(|command| drop(folder.done(command)));
    for line in folder.text("events.csv").lines() {
        assert!(page.contains(&format!("\n    {line}\n")), "docs/examples/tow.md does not say {line}");
    }
    assert!(folder.text("ropes.jsonl").contains(r#""length":6.7526"#) && page.contains("6.753 long"));
    for name in ["tow-4.svg", "tow-6.svg"] {
        assert!(folder.text(name) == kept(name), "docs/examples/{name} is not what its command draws");
    }
}
