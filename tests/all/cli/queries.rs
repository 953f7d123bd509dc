//! Queries of path planners' benchmarks, and traces along the borders of cells.

use super::Folder;

const MAP: &str = "type octile\nheight 4\nwidth 6\nmap\n......\n.@@@..\n......\n......\n";

const QUERIES: &str = "version 1\n\
    0\tm.map\t6\t4\t0\t0\t5\t0\t5\n\
    1\tm.map\t6\t4\t1\t0\t1\t2\t4.0\n\
    1\tm.map\t6\t4\t2\t2\t2\t2\t0\n";

/// What a run that ends well prints.
fn stdout(folder: &Folder, args: &str) -> String {
    let run = folder.run(args);
    assert_eq!(run.code, Some(0), "{args}: {}", run.stderr);
    run.stdout
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).unwrap()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("m.map", MAP);
    folder.write("m.map.scen", QUERIES);
    folder
}

#[test]
fn each_query_has_its_rope() {
    let folder = folder();
    let table = stdout(&folder, "eval --scene m.map --queries m.map.scen --out r.jsonl");
    assert!(table.contains("m.map: 6 by 4 cells, 4 walls"), "{table}");
    assert!(table.contains("m.map.scen: 3 queries, 2 driven straight, 0 refused"), "{table}");
    assert!(!table.contains("are not those of shortest ways"), "{table}");
    // From (1.5, 0.5) to (1.5, 2.5), round the block's corner (1, 1) and (1, 2).
    let report: serde_json::Value =
        serde_json::from_str(&stdout(&folder, "eval --scene m.map --queries m.map.scen --json")).unwrap();
    let rope = 2.0 * 0.5f64.hypot(0.5) + 1.0;
    assert_eq!(report["rows"][1]["rope"].as_f64(), Some(rope));
    assert_eq!(report["rows"][1]["planned"], 4.0);
    assert_eq!(report["rows"][0]["rope"], 5.0);
    assert_eq!(report["rows"][2]["rope"], 0.0);
    assert_eq!(report["other_octile"], 0);
    let rows = text(&folder, "r.jsonl");
    assert_eq!(rows.lines().count(), 3);
    assert!(rows.contains("\"wraps\":[[1.0,1.0],[1.0,2.0]]"), "{rows}");
}

#[test]
fn lengths_that_are_not_the_files_are_told() {
    let folder = folder();
    folder.write("m.map.scen", QUERIES.replace("4.0", "3.5"));
    let table = stdout(&folder, "eval --scene m.map --queries m.map.scen");
    assert!(table.contains("1 of the file's lengths are not those of shortest ways"), "{table}");
}

#[test]
fn queries_that_are_none_are_refused() {
    let folder = folder();
    let eval = "eval --scene m.map --queries q.scen";
    for (text, part) in [
        ("", "no queries"),
        ("0 m 6 4 0 0 5 0\n", "line 1: 8 columns; a query has nine"),
        ("version 1\n0 m 6 5 0 0 5 0 5\n", "line 2: a query for a map of 6 by 5 cells; this one has 6 by 4"),
        ("0 m 6 4 1 1 5 0 5\n", "line 1: the start's cell (1, 1) is blocked"),
        ("0 m 6 4 0 0 6 0 5\n", "line 1: the goal's cell (6, 0) lies outside of the map"),
        ("0 m 6 4 0 0 -1 0 5\n", "line 1: goal \"-1\"; it must be a whole number from 0 on"),
        ("0 m 6 4 0 0 1 0 nan\n", "line 1: octile length \"nan\"; it must be a number from 0 on"),
    ] {
        folder.write("q.scen", text);
        folder.refused(2, eval, &["q.scen", part]);
    }
    folder.write("w.map", "type octile\nheight 1\nwidth 3\nmap\n.@.\n");
    folder.write("q.scen", "0 w 3 1 0 0 2 0 2\n");
    folder.refused(
        2,
        "eval --scene w.map --queries q.scen",
        &["query 0: there is no way from cell (0, 0) to cell (2, 0)"],
    );
    folder.write("s.wkt", "LINESTRING (0 0, 1 1)");
    folder.refused(2, "eval --scene s.wkt --queries q.scen", &["s.wkt: --queries needs a .map"]);
}

/// Planners stand on the corners of cells, wherever the walls of a block lie merged.
#[test]
fn traces_along_blocked_cells_go_round_them() {
    let folder = folder();
    folder.write("p.geojson", r#"{"type":"Polygon","coordinates":[[[1,1],[4,1],[4,2],[1,2],[1,1]]]}"#);
    for scene in ["m.map", "p.geojson"] {
        for (anchor, trace, length) in [
            ("1,2", "0,1,1\n0,4,1\n", 4.0),
            ("4,1", "0,1,1\n0,1,2\n", 4.0),
            // In the middle of the block's merged border.
            ("2,1", "0,1,1\n0,1,2\n0,3,2\n", 4.0),
            ("3,2", "0,4,2\n0,4,1\n0,2,1\n", 4.0),
        ] {
            folder.write("t.csv", format!("trace,x,y\n{trace}"));
            stdout(&folder, &format!("eval --scene {scene} --anchor {anchor} --traces t.csv --out r.csv"));
            let row = text(&folder, "r.csv");
            let row = row.lines().nth(1).unwrap();
            assert_eq!(row.split(',').nth(3), Some(format!("{length:?}").as_str()), "{scene} {anchor} {row}");
        }
        folder.write("t.csv", "trace,x,y\n0,2,1\n0,2,1.5\n");
        let into = ["trace 0, step 1", "leads from the anchor into the solid behind wall 0"];
        folder.refused(2, &format!("eval --scene {scene} --anchor 2,1 --traces t.csv"), &into);
    }
}
