//! Pictures by the command line.

use resvg::tiny_skia::Pixmap;

use super::Folder;

const DRAW: &str = "draw --scene s.geojson --traces t.csv";

#[test]
fn the_extension_says_what_is_written() {
    let folder = Folder::hand_made();
    let told = folder.done(&format!("{DRAW} --out a.svg")).stdout;
    assert_eq!(told, "wrote a.svg\n");
    assert!(folder.text("a.svg").starts_with("<svg ") && folder.text("a.svg").contains("Trace 0 after step 6 of 6"));
    folder.done(&format!("{DRAW} --out a.PNG"));
    assert_eq!(Pixmap::decode_png(&folder.read("a.PNG")).unwrap().width(), 1440);
    folder.done(&format!("{DRAW} --out b.png --width 333 --theme dark"));
    let small = Pixmap::decode_png(&folder.read("b.png")).unwrap();
    assert_eq!((small.width(), small.pixels()[0].red()), (333, 0x16));
    folder.done(&format!("{DRAW} --out a.html"));
    assert!(folder.text("a.html").starts_with("<!DOCTYPE html>") && folder.text("a.html").contains("<script>"));
    folder.done(&format!("{DRAW} --animate --out m.svg"));
    assert!(folder.text("m.svg").contains("<animate "));
    folder.done(&format!("{DRAW} --frames --out f.svg"));
    assert!(folder.text("f.svg").contains("1. wrap in step "));
    folder.done(&format!("{DRAW} --frames 2-2 --out f.html"));
    assert!(folder.text("f.html").contains("events 2 to 2 of "));
}

#[test]
fn traces_steps_and_parts_are_picked() {
    let folder = Folder::hand_made();
    folder.done(&format!("{DRAW} --trace 5 --step 1 --out a.svg"));
    assert!(folder.text("a.svg").contains("Trace 5 after step 1 of 2"));
    folder.done(&format!("{DRAW} --trace 5,0,4 --out b.svg"));
    assert!(folder.text("b.svg").contains("Traces 0, 4, 5 after their last steps"));
    folder.done(&format!("{DRAW} --view -1,-2,3.5,4 --rays 0 --out c.svg"));
    let drawn = folder.text("c.svg");
    assert!(!drawn.contains("rays of the pivot") && !drawn.contains("free end") && drawn.contains("anchor"));
    folder.done("draw --scene s.geojson --view all --out d.svg");
    assert!(!folder.text("d.svg").contains("rope") && folder.text("d.svg").contains("anchor"));
    folder.done("draw --trace 7 --out e.svg");
    assert!(folder.text("e.svg").contains("Trace 7 after step 500 of 500"));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::hand_made();
    let refused = |args: &str, parts: &[&str]| folder.refused(2, args, parts);
    refused(&format!("{DRAW} --trace 6 --out a.svg"), &["t.csv: there is no trace 6", "from 0 to 7"]);
    refused(&format!("{DRAW} --trace 99 --out a.svg"), &["t.csv: there is no trace 99"]);
    refused(&format!("{DRAW} --step 7 --out a.svg"), &["trace 0 ends with step 6", "no step 7"]);
    refused(&format!("{DRAW} --trace 0,4 --step 5 --out a.svg"), &["trace 4 ends with step 4"]);
    refused(&format!("{DRAW} --trace 0,4 --animate --out a.svg"), &["an animation shows one trace; 2 were given"]);
    refused(&format!("{DRAW} --trace 7 --frames --out a.svg"), &["trace 7 has no events"]);
    refused(&format!("{DRAW} --frames 1-99 --out a.svg"), &["trace 0 has events 1 to ", "1 to 99"]);
    refused(&format!("{DRAW} --frames x --out a.svg"), &["--frames", "such as 1-24"]);
    refused(&format!("{DRAW} --out a.gif"), &["a.gif: the extension", ".svg, .png or .html"]);
    refused(&format!("{DRAW} --out no/a.svg"), &["cannot write no/a.svg", "the folder no does not exist"]);
    refused(&format!("{DRAW} --animate --out a.png"), &["a PNG does not move"]);
    refused(&format!("{DRAW} --animate --step 1 --out a.svg"), &["--step and --animate"]);
    refused(&format!("{DRAW} --width 300 --out a.svg"), &["--width goes with a .png"]);
    refused(&format!("{DRAW} --width 0 --out a.png"), &["--width", "0 x"]);
    refused(&format!("{DRAW} --view 0,0,1 --out a.svg"), &["--view", "two opposite corners"]);
    refused(&format!("{DRAW} --view 0,0,1,nan --out a.svg"), &["(0, 0) to (1, NaN)", "not finite"]);
    refused(DRAW, &["--out"]);
    refused("draw --scene s.geojson --trace 1 --out a.svg", &["--trace 1 needs --traces"]);
    refused("draw --traces t.csv --out a.svg", &["--traces needs --scene"]);
    refused("draw --trace 4000 --out a.svg", &["traces 0 to 3999", "no 4000"]);
    folder.write("loose.map", "type octile\nheight 1\nwidth 2\nmap\n.@\n");
    refused("draw --scene loose.map --traces t.csv --out a.svg", &["loose.map: no anchor; give --anchor X,Y"]);
    // Without traces nothing has to be tied.
    folder.done("draw --scene loose.map --out a.svg");
    folder.write("none.csv", "trace,x,y\n");
    folder.refused(2, "draw --scene s.geojson --traces none.csv --out b.svg", &["none.csv: there are no traces"]);
}

#[test]
fn a_trace_that_crosses_a_wall_is_drawn_if_asked_for() {
    let folder = Folder::hand_made();
    folder.write("x.csv", "trace,x,y\n3,1,0\n3,5,0\n");
    let args = "draw --scene s.geojson --traces x.csv --out a.svg";
    folder.refused(2, args, &["x.csv: trace 3, step 1", "crosses wall 0", "--on-violation flag"]);
    let done = folder.done(&format!("{args} --on-violation flag"));
    assert!(done.stderr.contains("crosses wall 0"), "{}", done.stderr);
    assert!(folder.text("a.svg").contains("It crosses a wall in step 1; from there on the rope may be wrong."));
}

/// The block of the tutorial that starts with that line, without its indentation.
fn block(tutorial: &str, first: &str) -> String {
    let lines = tutorial.lines().skip_while(|line| line.trim() != first);
    let lines = lines.take_while(|line| line.starts_with("    ") || line.is_empty());
    lines.map(|line| format!("{}\n", line.trim())).collect()
}

/// What a block of the tutorial is that shows this.
fn block_of(shown: &str) -> String {
    shown.lines().map(|line| format!("{}\n", line.trim())).collect::<String>() + "\n"
}

#[test]
fn the_tutorial_leads_from_a_plan_to_a_moving_picture() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let tutorial = std::fs::read_to_string(root.join("docs/tutorial.md")).unwrap();
    let folder = Folder::new();
    std::fs::copy(root.join("tests/scenes/formats/plan.svg"), folder.path("plan.svg")).unwrap();
    folder.write("drag.csv", block(&tutorial, "trace,x,y").trim_end());
    let study = block(&tutorial, "[scene]");
    folder.write("plan.toml", study.replace("10_000", "2_000"));
    let found = folder.done("check --scene plan.svg").stdout;
    assert_eq!(block(&tutorial, found.lines().next().unwrap()), block_of(&found), "{found}");
    folder.done("draw --scene plan.svg --traces drag.csv --out drag.html");
    assert!(folder.text("drag.html").contains("<script>"));
    folder.done("draw --scene plan.svg --traces drag.csv --out drag.svg");
    let committed = std::fs::read_to_string(root.join("docs/plan.svg")).unwrap();
    assert!(folder.text("drag.svg") == committed, "docs/plan.svg is not what the tutorial's commands draw");
    folder.done("study run plan.toml --engine cpu");
    assert!(folder.path("plan-study/report.html").exists());
    folder.done("study replay plan-study --trace 3 --draw walk.html");
    assert!(folder.text("walk.html").contains("<script>"));
}
