//! Files of CSV as people write them, and what is wrong with them.

use proptest::prelude::*;

use super::*;
use crate::trace::Trace;

fn read_in_blocks(text: &[u8], block: usize) -> Result<Vec<Trace>, String> {
    let mut gatherer = Gatherer::default();
    let mut rows = CsvRows::new(Cursor::new(text), text.len() as u64, Path::new("t.csv")).in_blocks(block);
    while rows.read(&mut gatherer).map_err(|e| e.to_string())? {}
    assert_eq!(rows.position(), rows.size());
    Ok(gatherer.take(usize::MAX, usize::MAX, true).unwrap_or_default())
}

fn read(text: impl AsRef<[u8]>) -> Result<Vec<Trace>, String> {
    let text = text.as_ref();
    let all = read_in_blocks(text, BLOCK);
    if text.len() < 1000 {
        for block in [1, 5, 40] {
            assert_eq!(read_in_blocks(text, block), all);
        }
    }
    all
}

fn shape(traces: &[Trace]) -> Vec<(u64, Vec<[f64; 2]>)> {
    traces.iter().map(|t| (t.id, t.points.iter().map(|p| p.to_array()).collect())).collect()
}

#[test]
fn columns_are_found_by_name() {
    let expected = [(0, vec![[0.1, -2e-7], [1.0, 2.0]]), (5, vec![[3.0, 4.5]])];
    for text in [
        "trace,x,y\n0,0.1,-2e-7\n0,1,2\n5,3,4.5\n",
        "trace,x,y\r\n0,0.1,-2e-7\r\n0,1,2\r\n5,3,4.5",
        "\u{feff}trace, x ,y\n\n 0, 0.1 ,-2e-7\n0,1,2\n\n5,3,+4.50\n\n",
        "note,y,trace,x\n\"a,b\",-2e-7,0,0.1\nc,2,0,1\n,4.5,5,3\n",
        "\"trace\",\"x\",\"y\"\n\"0\",\"0.1\",\"-2e-7\"\n0,1,2\n5,3,4.5\n",
    ] {
        assert_eq!(shape(&read(text).unwrap()), expected, "{text}");
    }
    assert!(read("trace,x,y\n").unwrap().is_empty());
    assert!(read("trace,x,y").unwrap().is_empty());
}

#[test]
fn numbers_are_read_exactly() {
    for x in [0.1 + 0.2, 1e23, 9007199254740993.0, 1.7976931348623157e100, 2.2250738585072014e-100, f64::MIN_POSITIVE] {
        let traces = read(format!("trace,x,y\n18446744073709551615,{x:?},{x}\n"));
        match traces {
            Ok(traces) => {
                assert_eq!(shape(&traces), [(u64::MAX, vec![[x, x]])]);
            }
            Err(e) => assert!(x == f64::MIN_POSITIVE && e.contains("too small"), "{e}"),
        }
    }
}

#[test]
fn a_header_is_needed() {
    let empty = "t.csv: line 1: the file is empty; its first line must be the header trace,x,y";
    assert_eq!(read("").unwrap_err(), empty);
    let rest = "it must name trace, x and y, once each";
    for (text, expected) in [
        ("0,1.5,2\n", format!("line 1: no column trace in the header \"0,1.5,2\"; {rest}")),
        ("trace;X;y\n", format!("line 1: no column trace in the header \"trace;X;y\"; {rest}")),
        (
            "x;trace;y;n\n0;0,5;1\n",
            "line 1: no column trace in the header \"x;trace;y;n\"; it is separated by semicolons: separate columns by \
             commas, and write numbers with a point (1.5)"
                .into(),
        ),
        (
            "trace\tx\ty\r\n0\t0\t0\n",
            "line 1: no column trace in the header \"trace\\tx\\ty\"; it is separated by tabulators: separate columns \
             by commas"
                .into(),
        ),
        ("trace,step,x,y,step\n", format!("line 1: two columns step in the header \"trace,step,x,y,step\"; {rest}")),
        ("\n\ntrace,X,y\n", format!("line 3: no column x in the header \"trace,X,y\"; {rest}")),
        ("y,trace,x,y\n0,0,0,0\n", format!("line 1: two columns y in the header \"y,trace,x,y\"; {rest}")),
    ] {
        assert_eq!(read(text).unwrap_err(), format!("t.csv: {expected}"));
    }
    assert!(read("z".repeat(60_000)).unwrap_err().len() < 250);
    let wide =
        |end: &[u8]| [&b"\xff\xfe"[..], &"trace,x,y\n".bytes().flat_map(|b| [b, 0]).collect::<Vec<_>>(), end].concat();
    assert!(read(wide(b"")).unwrap_err().ends_with("the file is UTF-16: save it as UTF-8 text"));
}

#[test]
fn faults_name_line_column_and_text() {
    let order = "the rows of one trace must follow each other, and the numbers increase";
    let id = "is not a whole number from 0";
    let coordinate = "is not a number such as -1.25 or 3e-7";
    for (rows, expected) in [
        ("0,0,0\n0,1.2.3,0\n", format!("line 3: column x: \"1.2.3\" {coordinate}")),
        ("0,0,0\n\n\n0,0,\n", format!("line 5: column y: \"\" {coordinate}")),
        ("-1,0,0\n", format!("line 2: column trace: \"-1\" {id}")),
        ("0.0,0,0\n", format!("line 2: column trace: \"0.0\" {id}")),
        ("18446744073709551616,0,0\n", format!("line 2: column trace: \"18446744073709551616\" {id}")),
        ("0,0,0\n0,nan,0\n", "line 3: column x: NaN is not a finite number".into()),
        ("0,0,-inf\n", "line 2: column y: -inf is not a finite number".into()),
        ("0,0,1e999\n", "line 2: column y: inf is not a finite number".into()),
        ("0,0,0\n1,0,0\n0,0,0\n", format!("line 4: trace 0 after trace 1; {order}")),
        ("7,0,0\n3,0,0\n", format!("line 3: trace 3 after trace 7; {order}")),
        ("0,0,0\n0,0\n", "line 3: 2 fields; the header has 3".into()),
        (
            "0,0,0\n0,0,5,2,5\n",
            "line 3: 5 fields; the header has 3; a decimal comma makes two fields of a number, so write 1.5, not \
             1,5"
            .into(),
        ),
        (
            "0;1;2\n",
            "line 2: 1 field; the header has 3; the fields are separated by semicolons here: write commas, and 1.5, \
             not 1,5"
                .into(),
        ),
        ("0,\"1,5\",2\n", format!("line 2: column x: \"1,5\" {coordinate}; its decimal comma must be a point")),
        ("0,\"1,5,\",2\n", format!("line 2: column x: \"1,5,\" {coordinate}")),
        ("0,++1,0\n", format!("line 2: column x: \"++1\" {coordinate}")),
        (
            "0,0,1e-400\n",
            "line 2: column y: \"1e-400\" is too small for a number of 64 bits, and not 0; write 0 if that is \
             meant"
                .into(),
        ),
        (
            "0,1e-310,0\n",
            "line 2: column x: \"1e-310\" is too small for a number of 64 bits, and not 0; write 0 if \
            that is meant"
                .into(),
        ),
    ] {
        for start in ["", "\u{feff}"] {
            let text = format!("{start}trace,x,y\n{rows}");
            assert_eq!(read(&text).unwrap_err(), format!("t.csv: {expected}"));
            assert_eq!(read(text.replace('\n', "\r\n")).unwrap_err(), format!("t.csv: {expected}"));
        }
    }
    let e = read(b"trace,x,y\n0,\xff\xfe,0\n").unwrap_err();
    assert_eq!(e, format!("t.csv: line 2: column x: \"\u{fffd}\u{fffd}\" {coordinate}"));
}

#[test]
fn steps_are_looked_at_where_there_are_any() {
    assert_eq!(read("step,trace,x,y\n0,0,1,1\n3,0,2,2\n1,5,3,3\n").unwrap().len(), 2);
    let rule = "the rows of one trace must stand in the order of their steps, each once";
    for quote in ["", "\""] {
        let text = format!("trace,x,{quote}y{quote},step\n0,1,1,0\n0,2,2,3\n\n0,3,3,1\n");
        assert_eq!(read(text).unwrap_err(), format!("t.csv: line 5: trace 0: step 1 after step 3; {rule}"));
        let text = format!("trace,x,{quote}y{quote},step\n0,1,1,0.5\n");
        assert_eq!(read(text).unwrap_err(), "t.csv: line 2: column step: \"0.5\" is not a whole number from 0");
    }
}

#[test]
fn lines_without_an_end_are_refused() {
    let long = "1".repeat(LINE_MAX + 1);
    let expected = |line: usize| format!("t.csv: line {line}: {LINE_TOO_LONG}");
    let start = "trace,x,y\n0,0,0\n";
    for (text, line) in [
        (long.clone(), 1),
        (long.replace('1', "\0"), 1),
        (format!("{start}0,0,{long}\n0,0,0\n"), 3),
        (format!("{start}\n\n0,0,\"{long}\"\n"), 5),
        // A quote that never ends takes up all lines to come.
        (format!("{start}0,\"0,0\n{}", "1,2,3\n".repeat(1_000_000)), 3),
        (format!("{start}{}0,\"0,0\n{}", "0,0,\"0\"\r\n".repeat(300_000), "1,2,3\n".repeat(20_000)), 300_003),
    ] {
        for block in [PIPE_BLOCK, BLOCK] {
            assert_eq!(read_in_blocks(text.as_bytes(), block).unwrap_err(), expected(line));
        }
    }
    // Up to that length lines are read, and empty ones are as many as one likes.
    let spaces = " ".repeat(LINE_MAX - 5);
    let text = format!("{start}0,{spaces}1,0\n{}0,2,0\n", "\n".repeat(100_000));
    assert_eq!(shape(&read(&text).unwrap()), [(0, vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])]);
    assert_eq!(read(text.replacen("0,0,0", "\"0\",0,0", 1)), read(&text));
    // Line ends of old Macs.
    let mac = format!("{}{}", start.replace('\n', "\r"), "0,1,1\r".repeat(100_000));
    assert_eq!(read(&mac).unwrap()[0].points.len(), 100_001);
}

#[test]
fn lines_are_right_far_into_the_file() {
    let text = format!("trace,x,y\r\n{}0,x,0\r\n", "0,0.5,0.5\r\n".repeat(100_000));
    assert!(read(text).unwrap_err().starts_with("t.csv: line 100002: column x"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever a file holds, its lines are read as the parser reads them.
    #[test]
    fn lines_are_read_as_by_the_parser(
        parts in prop::collection::vec(prop::sample::select(vec![
            "0", "1", "2.5", ",", ",", ",", "\n", "\n", "\r\n", "\r", " ", "x", "\"", "\"\"", "\u{feff}", "0,1,2\n",
            "1,1,1\r\n", "\"1\",2,3\n", "2,-1e-7,nan\n",
        ]), 0..40),
        start in prop::sample::select(vec!["trace,x,y\n", "\u{feff}trace,x,y\r\n", "x,trace,y,n\n"]),
        block in 1..50usize,
    ) {
        let text = format!("{start}{}", parts.concat());
        let lines = read_in_blocks(text.as_bytes(), block);
        // A quoted field in front changes nothing but makes the parser read all.
        let quoted = text.replacen("trace", "\"trace\"", 1);
        prop_assert_eq!(lines, read_in_blocks(quoted.as_bytes(), BLOCK));
    }
}
