//! Hostile and mistaken input: nothing is obeyed that was only to be read, and what is refused is refused early.

use super::{EVAL, Finished, Folder, SCENE};

/// No character that a terminal obeys, but for line ends, is in what was printed.
fn is_clean(finished: &Finished) {
    for text in [&finished.stdout, &finished.stderr] {
        let bad = text.chars().find(|&c| (c.is_control() && c != '\n') || matches!(c, '\u{202a}'..='\u{202e}'));
        assert_eq!(bad, None, "{text:?}");
    }
}

#[test]
fn what_comes_from_files_is_never_obeyed() {
    let folder = Folder::hand_made();
    let json = |text: &str| text.replace("ESC", "\\u001b[31m").replace("CSI", "\u{9b}31m").replace("BIDI", "\u{202e}");
    let raw = |text: &str| text.replace("ESC", "\x1b[31m").replace("CSI", "\u{9b}31m").replace("BIDI", "\u{202e}");
    let dxf = |kind: &str, layer: &str| {
        format!("0\nSECTION\n2\nENTITIES\n0\n{kind}\n8\n{layer}\n10\n0\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n")
    };
    folder.write("a.geojson", json(r#"{"type":"ESCCSIBIDIred","coordinates":[]}"#));
    folder.write("b.geojson", raw(r#"{"type":"CSIBIDIred","coordinates":[]}"#));
    folder.write("c.dxf", raw(&dxf("TEESCXT", "0")));
    folder.write("d.dxf", raw(&dxf("LINE", "0").replace("10\n0", "10\nESCCSI")));
    folder.write("e.wkt", raw("LINESTRING (0 0, ESC1 1)"));
    folder.write("f.svg", raw("<svg xmlns=\"http://www.w3.org/2000/svg\"><rect id=\"CSIBIDI\" width=\"CSI\"/></svg>"));
    folder.write("g.map", raw("type ESCoctile"));
    folder.write("h.yaml", raw("image: \"a\\eb.png\"\nresolution: CSI\n"));
    folder.write("i\x1b[31m.geojson", "{}");
    for name in ["a.geojson", "b.geojson", "c.dxf", "d.dxf", "e.wkt", "f.svg", "g.map", "h.yaml", "i\x1b[31m.geojson"] {
        let finished = folder.run(&format!("check --scene {name}"));
        is_clean(&finished);
        assert!(
            finished.stderr.contains(if name == "c.dxf" { "note: c.dxf: passed over: 1 TE" } else { "error: " }),
            "{name}"
        );
        is_clean(&folder.run(&format!("check --scene {name} --anchor 5,5 --json")));
    }
    assert!(folder.run("check --scene a.geojson").stderr.contains(r"\u{1b}[31m\u{9b}31m\u{202e}red"));
    folder.write("t.csv", raw("trace,ESCx,y\n"));
    is_clean(&folder.run(EVAL));
    folder.write("t.csv", raw("trace,x,y\n0,CSI1,2\n"));
    is_clean(&folder.run(EVAL));
    folder.write("s.toml", "[\"\\u001b[31m\"]\nx = \"\\u009b\"\n");
    is_clean(&folder.run("study run s.toml"));
    // What is wrong on the command line itself, too.
    for args in ["eval --engine \x1b[31mred", "eval \u{9b}31m", "eval --anchor \x1b[31m,2", "study run \x1b[31m.toml"] {
        let finished = folder.run(args);
        is_clean(&finished);
        assert_eq!(finished.code, Some(2), "{args}");
    }
}

#[test]
fn json_says_the_same_without_being_obeyed() {
    let folder = Folder::new();
    folder.write("\u{9b}31m.geojson", SCENE);
    let done = folder.done("check --scene \u{9b}31m.geojson --json");
    is_clean(&done);
    let report: serde_json::Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(report["scene"]["name"], "\u{9b}31m.geojson");
}

#[test]
fn numbers_are_what_they_say_or_refused() {
    let folder = Folder::new();
    let small = "is too small for a number of 64 bits, and not 0";
    let path = |d: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n<path d=\"{d}\"/></svg>");
    let line = |x: &str| format!("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n{x}\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n");
    let geojson = |x: &str| SCENE.replace("5.5", x);
    for (name, text, expected) in [
        (
            "a.wkt",
            "LINESTRING(0 0,1 1)\nLINESTRING(++1 0,1 1)".to_owned(),
            "line 2: not WKT: \"++1\" stands where a number",
        ),
        ("b.wkt", "LINESTRING(0 0,\n1e-400 1)".to_owned(), &*format!("line 2: \"1e-400\" {small}")),
        ("c.wkt", "LINESTRING(0 0,+-1 1)".to_owned(), "line 1: not WKT: \"+-1\" stands where a number"),
        ("d.geojson", geojson("1e-400"), &*format!("line 3, column 99: 1e-400 {small}")),
        ("e.geojson", geojson("++1"), "not GeoJSON"),
        ("f.dxf", line("-1e-400"), "group code 10 has the value \"-1e-400\", too small"),
        ("g.dxf", line("++1"), "group code 10 has the value \"++1\"; it must be a number"),
        ("h.svg", path("M1e-400,0L1,1"), &*format!("line 2: <path>: d: 1e-400 {small}")),
        ("i.svg", path("M++1,0L1,1"), "line 2: <path>: d: "),
    ] {
        folder.write(name, text);
        folder.refused(2, &format!("check --scene {name} --anchor 5,5"), &[expected]);
    }
    for anchor in ["1e-400,0", "++1,0", "0,1e-320", "1;5,2"] {
        folder.refused(2, &format!("check --anchor {anchor}"), &["--anchor", "such as 1.5,-2"]);
    }
}

#[test]
fn large_numbers_are_short() {
    let folder = Folder::new();
    folder.write(
        "s.wkt",
        "MULTILINESTRING((0 0, 2.9999999999999998e+150 1e+150),(0 1e+150, 1e+150 0))\nPOINT(5e+149 1e+150)",
    );
    let done = folder.done("check --scene s.wkt");
    assert!(done.stdout.contains("anchor (5e149, 1e150)"), "{}", done.stdout);
    folder.write("t.csv", "trace,x,y\n0,5e149,1e150\n0,5e149,9e149\n");
    let done = folder.done("eval --scene s.wkt --traces t.csv");
    assert!(done.stdout.contains("anchor (5e149, 1e150)"), "{}", done.stdout);
    assert!(done.stdout.lines().all(|line| line.len() < 160), "{}", done.stdout);
    assert!(folder.done("convert s.wkt o.geojson").stdout.contains("anchor (5e149, 1e150)"));
}

#[cfg(unix)]
mod unix {
    use std::fs::{self, File, Permissions};
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    use std::process::{Command, Stdio};

    use super::super::{EVAL, Finished, Folder, SCENE, TRACES};

    /// Runs a line of bash in the folder, in which `tautline` is the program, with so many kibibytes of memory.
    fn bash(folder: &Folder, line: &str) -> Finished {
        let program = folder.command("");
        let mut shell = Command::new("bash");
        shell.current_dir(folder.path("")).args(["-c", &format!("tautline() {{ \"$0\" \"$@\"; }}; {line}")]);
        Finished::of(shell.arg(program.get_program()))
    }

    fn fifo(folder: &Folder, name: &str) {
        assert!(Command::new("mkfifo").arg(folder.path(name)).status().unwrap().success());
    }

    #[test]
    fn an_output_keeps_its_mode_and_is_never_split() {
        let folder = Folder::hand_made();
        fs::set_permissions(folder.path("r.jsonl"), Permissions::from_mode(0o604)).unwrap();
        folder.done(EVAL);
        assert_eq!(fs::metadata(folder.path("r.jsonl")).unwrap().mode() & 0o7777, 0o604);
        fs::hard_link(folder.path("e.csv"), folder.path("same.csv")).unwrap();
        folder.refused(2, EVAL, &["cannot write e.csv: the file that stands there has 2 names (hard links)"]);
        let draw = "draw --scene s.geojson --out same.csv";
        fs::rename(folder.path("same.csv"), folder.path("same.svg")).unwrap();
        folder.refused(
            2,
            &draw.replace("csv", "svg"),
            &["cannot write same.svg: the file that stands there has 2 names"],
        );
        fs::rename(folder.path("same.svg"), folder.path("same.wkt")).unwrap();
        folder.refused(2, "convert s.geojson same.wkt", &["cannot write same.wkt: the file that stands there has 2"]);
    }

    #[test]
    fn outputs_that_are_no_files_are_named() {
        let folder = Folder::hand_made();
        fifo(&folder, "pipe.csv");
        fifo(&folder, "pipe.svg");
        symlink("/dev/null", folder.path("null.csv")).unwrap();
        let no = "what stands there is not a regular file but";
        for (name, kind) in [
            ("/dev/stdout", "an open file of this program"),
            ("/dev/fd/1", "an open file of this program"),
            ("/dev/null", "a device"),
            ("null.csv", "a device"),
            ("pipe.csv", "a pipe"),
        ] {
            let expected = format!("cannot write {name}: {no} {kind}; files appear when they are whole");
            folder.refused(2, &EVAL.replace("e.csv", name), &[&expected]);
            folder.refused(2, &format!("convert s.geojson {name}"), &[&expected]);
            folder.refused(2, &format!("draw --scene s.geojson --out {name}"), &[&expected]);
            folder.refused(2, &format!("tradeoff --out {name}"), &[&expected]);
        }
        folder.refused(2, "draw --scene s.geojson --out pipe.svg", &[no, "a pipe"]);
        // What this leads to is not looked at before and after: it may be what tests are told into.
        symlink("/dev/stdout", folder.path("out.svg")).unwrap();
        let line = "draw --scene s.geojson --out out.svg";
        folder.run(line).has_failed(2, line, &[no, "an open file"]);
    }

    #[test]
    fn standard_output_is_not_replaced_behind_its_back() {
        let folder = Folder::hand_made();
        let mut command = folder.command(EVAL);
        command.stdout(Stdio::from(File::options().append(true).open(folder.path("r.jsonl")).unwrap()));
        let finished = Finished::of(&mut command);
        finished.has_failed(2, "onto stdout", &["cannot write r.jsonl: standard output goes into that file"]);
        assert_eq!(folder.text("r.jsonl"), "old results");
    }

    #[test]
    fn traces_come_through_pipes() {
        let folder = Folder::hand_made();
        folder.done(EVAL);
        let expected = folder.text("r.jsonl");
        let eval = "eval --scene s.geojson --engine reference --out p.jsonl --traces";
        for line in [
            format!("tautline {eval} <(cat t.csv)"),
            format!("cat t.csv | tautline {eval} /dev/stdin"),
            format!("mkfifo f.csv; cat t.csv > f.csv & tautline {eval} f.csv"),
        ] {
            let finished = bash(&folder, &line);
            assert_eq!(finished.code, Some(0), "{line}: {}", finished.stderr);
            assert_eq!(folder.text("p.jsonl"), expected, "{line}");
        }
        // What is wrong in them has its line, though they cannot be read again.
        folder.write("t.csv", format!("{TRACES}\n\n8,0,zero\n"));
        let lines = TRACES.lines().count() + 3;
        for quote in ["cat", "sed 's/x/\"x\"/'"] {
            let finished = bash(&folder, &format!("tautline {eval} <({quote} t.csv)"));
            assert!(finished.stderr.contains(&format!(": line {lines}: column y: \"zero\"")), "{}", finished.stderr);
        }
        let finished = bash(&folder, "mkfifo f.parquet; tautline eval --scene s.geojson --traces f.parquet");
        finished.has_failed(2, "parquet", &["f.parquet: this is a pipe; write what it gives to a regular file"]);
    }

    /// With a gigabyte of memory, `check --scene NAME` is refused with `expected`, and what never ends is not waited
    /// for.
    fn refused_early(folder: &Folder, name: &str, expected: &str) {
        let line = format!("ulimit -v 1000000; tautline check --anchor 0,0 --scene {name}");
        bash(folder, &line).has_failed(2, name, &[expected]);
    }

    #[test]
    fn what_never_ends_is_refused_early() {
        let folder = Folder::hand_made();
        symlink("/dev/zero", folder.path("zero.csv")).unwrap();
        for name in ["a.geojson", "a.wkt", "a.svg", "a.dxf", "a.map", "a.yaml"] {
            fifo(&folder, name);
            refused_early(&folder, name, &format!("{name}: this is a pipe; write what it gives to a regular file"));
            fs::remove_file(folder.path(name)).unwrap();
            symlink("/dev/zero", folder.path(name)).unwrap();
            refused_early(&folder, name, &format!("{name}: this is a device; write what it gives to a regular file"));
            fs::remove_file(folder.path(name)).unwrap();
            File::create(folder.path(name)).unwrap().set_len(1 << 40).unwrap();
            refused_early(
                &folder,
                name,
                &format!("{name}: the file has 1099511627776 bytes; one of its kind may have"),
            );
            fs::remove_file(folder.path(name)).unwrap();
        }
        let eval = "eval --scene s.geojson --traces";
        folder.refused(2, &format!("{eval} zero.csv"), &["zero.csv: this is a device; write what it gives to"]);
        File::create(folder.path("large.csv")).unwrap().set_len(1 << 40).unwrap();
        let finished = bash(&folder, &format!("ulimit -v 1000000; tautline {eval} large.csv"));
        finished.has_failed(2, "large.csv", &["large.csv: line 1: a line of more than 65536 bytes"]);
        fs::remove_file(folder.path("large.csv")).unwrap();
        let finished = bash(&folder, &format!("ulimit -v 1000000; tautline {eval} <(cat /dev/zero)"));
        finished.has_failed(2, "zeros", &[": line 1: a line of more than 65536 bytes"]);
        let study = "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"p.csv\"\n";
        folder.write("s.toml", study);
        fifo(&folder, "p.csv");
        fifo(&folder, "f.toml");
        folder.refused(2, "study run s.toml", &["p.csv: this is a pipe"]);
        folder.refused(2, "study run f.toml", &["f.toml: this is a pipe"]);
    }

    #[test]
    fn what_blows_up_is_refused_early() {
        let folder = Folder::new();
        let svg = |head: &str, body: &str| format!("{head}<svg xmlns=\"http://www.w3.org/2000/svg\">{body}</svg>");
        let entity = format!("<!DOCTYPE svg [<!ENTITY a '{}'>]>", "x".repeat(100_000));
        folder.write("entities.svg", svg(&entity, &"&a;".repeat(100_000)));
        refused_early(&folder, "entities.svg", "with &a; the entities, written out, are too long");
        let rules: String = (0..30_000).map(|i| format!(".c{i}{{display:none}}")).collect();
        folder.write("rules.svg", svg("", &format!("<style>{rules}</style>{}", "<g/>".repeat(30_000))));
        refused_early(&folder, "rules.svg", "too many rules for so many elements");
        let yaml =
            "image: a.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n";
        folder.write("m.yaml", yaml);
        for (image, expected) in [
            (&b"P5 30000 30000 255\n"[..], "the image ends after 0 of 900000000 pixels"),
            (b"P2 99999999999 9 255\n", "99999999999 x 9 pixels; each side must have from 1 to 32768"),
            (b"P5 2 1 255\nabc", "the image goes on after the 2 pixels that its header says"),
        ] {
            folder.write("a.pgm", image);
            refused_early(&folder, "m.yaml", expected);
        }
        // All in one line, or as deep as it is long.
        for name in ["a.geojson", "a.wkt", "a.svg", "a.dxf", "a.map", "a.yaml"] {
            let deep = match name {
                "a.geojson" | "a.yaml" => "[".repeat(900_000),
                "a.svg" => svg("", &"<g>".repeat(300_000)),
                _ => "GEOMETRYCOLLECTION(".repeat(50_000),
            };
            folder.write(name, deep);
            refused_early(&folder, name, name);
        }
        folder.write("s.geojson", SCENE);
        folder.done("check --scene s.geojson");
    }
}
