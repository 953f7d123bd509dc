//! `--friction`, and `[tallies] friction`.

use std::collections::BTreeMap;

use arrow_array::Array;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt64Type};
use serde_json::Value;

use super::Folder;
use super::steps::read;

const COLUMNS: [&str; 5] = ["anchor_pull_x", "anchor_pull_y", "turned", "tension", "work"];

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// A file of CSV: its columns by name.
fn columns(text: &str) -> BTreeMap<String, Vec<String>> {
    let mut lines = text.lines().map(|line| line.split(','));
    let names: Vec<&str> = lines.next().unwrap().collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in lines {
        for (name, cell) in names.iter().zip(line) {
            columns.entry((*name).to_owned()).or_default().push(cell.to_owned());
        }
    }
    columns
}

fn numbers(columns: &BTreeMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    columns[name].iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn friction_adds_columns_in_all_formats() {
    let folder = Folder::hand_made();
    let eval = "eval --scene s.geojson --traces t.csv";
    for format in ["csv", "jsonl", "parquet"] {
        folder.done(&format!("{eval} --steps a.{format} --friction 0.5"));
    }
    folder.done(&format!("{eval} --steps plain.csv"));
    let csv = folder.text("a.csv");
    assert!(csv.starts_with(
        "trace,step,x,y,length,contacts,turns,pull_x,pull_y,anchor_pull_x,anchor_pull_y,turned,tension,work\n"
    ));
    // What else there is stays as it is.
    for (with, without) in csv.lines().zip(folder.text("plain.csv").lines()) {
        assert!(with.starts_with(&format!("{without},")), "{with} {without}");
    }
    // By hand: round (3, 4), where the rope comes up from (0, 0) and goes on level to (5, 4).
    let columns = columns(&csv);
    let turned = libm::atan2(4.0, 3.0);
    assert_eq!([0, 3].map(|row| numbers(&columns, "turned")[row]), [0.0, turned]);
    assert_eq!(numbers(&columns, "tension")[3], libm::exp(0.5 * turned));
    assert_eq!(["anchor_pull_x", "anchor_pull_y"].map(|name| columns[name][3].as_str()), ["0.6", "0.8"]);
    assert_eq!((columns["anchor_pull_x"][0].as_str(), columns["work"][0].as_str()), ("", "0.0"));
    let batch = read(&folder, "a.parquet").remove(0);
    for (row, line) in folder.text("a.jsonl").lines().enumerate() {
        let object = json(line);
        for name in COLUMNS {
            let column = batch.column_by_name(name).unwrap().as_primitive::<Float64Type>();
            let there = column.is_valid(row).then(|| column.value(row));
            assert_eq!(object[name].as_f64(), there, "{name} in row {row}");
            assert_eq!(columns[name][row].parse().ok(), there, "{name} in row {row}");
        }
    }
    // Where f64 has no number as great.
    let mut wound = "trace,x,y\n".to_owned();
    (0..20).for_each(|_| wound += "0,0,5\n0,4,5\n0,4,-5\n0,0,-5\n");
    folder.write("wound.csv", wound);
    for format in ["csv", "jsonl", "parquet"] {
        folder.done(&format!("eval --scene s.geojson --traces wound.csv --steps w.{format} --friction 10"));
    }
    let infinite = self::columns(&folder.text("w.csv"));
    let rows: Vec<usize> = (0..80).filter(|&row| infinite["tension"][row] == "inf").collect();
    let column = read(&folder, "w.parquet").remove(0);
    let column = column.column_by_name("tension").unwrap().as_primitive::<Float64Type>();
    let text = folder.text("w.jsonl");
    let objects: Vec<Value> = text.lines().map(json).collect();
    assert!(!rows.is_empty());
    assert_eq!(objects.len(), 80);
    for (row, object) in objects.iter().enumerate() {
        let is_infinite = rows.contains(&row);
        assert_eq!((column.value(row).is_infinite(), object["tension"].is_null()), (is_infinite, is_infinite));
    }
}

/// Forces against the steps, in all formats, with names and with both ends.
#[test]
fn forces_are_those_of_the_last_ropes() {
    let folder = Folder::floor_plan(40, 200);
    let eval = "eval --scene s.geojson --traces t.csv --friction 0.3";
    for format in ["csv", "jsonl", "parquet"] {
        folder.done(&format!("{eval} --forces f.{format} --out r.jsonl --steps s.csv"));
    }
    let forces = columns(&folder.text("f.csv"));
    assert!(folder.text("f.csv").starts_with("trace,vertex,x,y,angle,before,beyond,force_x,force_y\n"));
    let steps = columns(&folder.text("s.csv"));
    let batch = read(&folder, "f.parquet").remove(0);
    let lines = folder.text("f.jsonl");
    let objects: Vec<Value> = lines.lines().map(json).collect();
    assert_eq!((batch.num_rows(), objects.len()), (forces["trace"].len(), forces["trace"].len()));
    for name in ["x", "y", "angle", "before", "beyond", "force_x", "force_y"] {
        let values = numbers(&forces, name);
        assert_eq!(batch.column_by_name(name).unwrap().as_primitive::<Float64Type>().values(), &values[..]);
        assert!(objects.iter().zip(&values).all(|(object, value)| object[name].as_f64() == Some(*value)), "{name}");
    }
    let mut row = 0;
    for line in folder.text("r.jsonl").lines().map(json) {
        let trace = line["trace"].as_u64().unwrap() as usize;
        let of = |name: &str| numbers(&steps, name)[201 * trace + 200];
        let (mut sum, mut angles) = ([0.0; 2], 0.0);
        let turns = line["wraps"].as_array().unwrap();
        for at in turns {
            let values = ["x", "y", "force_x", "force_y", "angle"].map(|name| numbers(&forces, name)[row]);
            assert_eq!([&at[0], &at[1]].map(|x| x.as_f64().unwrap()), [values[0], values[1]]);
            sum = [sum[0] + values[2], sum[1] + values[3]];
            angles += values[4];
            row += 1;
        }
        assert!((angles - of("turned")).abs() < 1e-13, "{angles}");
        if !turns.is_empty() {
            assert!((numbers(&forces, "beyond")[row - 1] / of("tension") - 1.0).abs() < 1e-13);
            // With the pulls of both ends they are in balance.
            for (sum, axis) in sum.into_iter().zip(["x", "y"]) {
                let pulls = of(&format!("anchor_pull_{axis}")) + of("tension") * of(&format!("pull_{axis}"));
                assert!((sum + pulls).abs() < 1e-12 * of("tension"), "{sum} {pulls}");
            }
        }
    }
    assert!(row == forces["trace"].len() && row > 40);
    // Where both ends move the rope is that between where they are at last.
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples");
    folder.done(&format!("eval --scene {docs}/harbour.geojson --traces {docs}/tow.csv --forces tow.csv"));
    // Round the mole's end at (8, 2.5), from the barge at (5, 4.4) to the tug at (10.5, 4.5).
    let (back, on) = ((-3.0f64, 1.9f64), (2.5f64, 2.0f64));
    let [x, y] =
        [(back.0, on.0), (back.1, on.1)].map(|(one, other)| one / back.0.hypot(back.1) + other / on.0.hypot(on.1));
    let tow = columns(&folder.text("tow.csv"));
    assert!((numbers(&tow, "force_x")[0] - x).abs() < 1e-15 && (numbers(&tow, "force_y")[0] - y).abs() < 1e-15);
    assert_eq!((tow["label"][0].as_str(), tow["vertex"][0].as_str(), tow["beyond"][0].as_str()), ("mole", "2", "1.0"));
}

#[test]
fn what_is_no_coefficient_is_refused() {
    let folder = Folder::hand_made();
    let eval = "eval --scene s.geojson --traces t.csv";
    for (bad, says) in
        [("-1", "-1 is no coefficient"), ("10.5", "from 0 to 10"), ("NaN", "NaN is no"), ("x", "0 to 10")]
    {
        folder.refused(2, &format!("{eval} --steps s.csv --friction {bad}"), &["--friction", says]);
    }
    folder.refused(2, &format!("{eval} --friction 0.2"), &["--friction: say with --steps or --forces"]);
    folder.refused(2, &format!("{eval} --forces t.csv"), &["t.csv"]);
    folder.refused(2, &format!("{eval} --forces f.txt"), &["f.txt", ".parquet"]);
    folder.write(
        "a.toml",
        "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.4\nsteps = 9\n[run]\ntraces = 9\n",
    );
    let run = "study run a.toml --out a --set";
    folder.refused(
        2,
        &format!("{run} tallies.friction=-0.5"),
        &["tallies.friction: -0.5 is no coefficient of friction"],
    );
    folder.refused(2, &format!("{run} tallies.tensions=[0.9]"), &["tallies.tensions: 0.9 is below 1"]);
    folder.refused(2, &format!("{run} tallies.tensions=[3.0]"), &["tallies.tensions goes with tallies.friction"]);
}

const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\nanchor = { sample = 2 }\n\
    [walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n[run]\ntraces = 200\nblock = 40\n\
    [tallies]\nfriction = 0.25\ntensions = [3.0, 1.5, 1e9]\n[outputs]\npictures = false\nsteps = true\n";

/// The tally, from the file of all steps.
#[test]
fn a_study_counts_what_its_steps_say() {
    let folder = Folder::new();
    folder.write("s.toml", STUDY);
    let told = folder.done("study run s.toml --out whole --engine cpu").stdout;
    let (mut most, mut work, mut above, mut all) = ([1.0f64; 200], [0.0; 200], [0.0; 3], 0.0);
    for batch in read(&folder, "whole/steps.parquet") {
        let trace = batch.column_by_name("trace").unwrap().as_primitive::<UInt64Type>();
        let [tension, done] =
            ["tension", "work"].map(|name| batch.column_by_name(name).unwrap().as_primitive::<Float64Type>());
        for row in 0..batch.num_rows() {
            let (trace, tension) = (trace.value(row) as usize, tension.value(row));
            most[trace] = most[trace].max(tension);
            work[trace] = done.value(row);
            all += 1.0;
            let of = [1.5, 3.0, 1e9].map(|limit| if tension > limit { 1.0 } else { 0.0 });
            above.iter_mut().zip(of).for_each(|(above, one)| *above += one);
        }
    }
    let summary = json(&folder.text("whole/summary.json"));
    let friction = &summary["friction"];
    assert_eq!(friction["coefficient"], 0.25);
    for (name, mut values) in [("tension", most.to_vec()), ("work", work.to_vec())] {
        let scalar = &friction[name];
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / 200.0;
        assert!((scalar["mean"]["value"].as_f64().unwrap() / mean - 1.0).abs() < 1e-12, "{name}");
        assert_eq!([&scalar["min"], &scalar["max"]].map(|x| x.as_f64().unwrap()), [values[0], values[199]]);
        let medians = scalar["quantiles"].as_array().unwrap().iter().filter(|q| q["share"] == 0.5);
        let median = medians.map(|q| q["value"]["value"].as_f64().unwrap()).next().unwrap();
        assert!((median / values[99] - 1.0).abs() < 0.004, "{name} {median} {}", values[99]);
    }
    for (i, (told, count)) in friction["above"].as_array().unwrap().iter().zip(above).enumerate() {
        assert_eq!(told["tension"].as_f64().unwrap(), [1.5, 3.0, 1e9][i]);
        assert!((told["share"]["value"].as_f64().unwrap() - count / all).abs() < 1e-15, "{told} {}", count / all);
    }
    assert!(above[0] > above[1] && above[1] > 0.0 && above[2] == 0.0, "{above:?}");
    assert!(told.contains("friction 0.25, a rope hauled at the free end") && told.contains("of the steps"), "{told}");
    // The same bytes, however the work is shared out.
    for shard in ["0/2", "1/2"] {
        folder.done(&format!("study run s.toml --engine cpu --shard {shard} --out part-{}", &shard[..1]));
    }
    folder.done("study merge part-0 part-1 --out merged");
    assert!(folder.read("merged/summary.json") == folder.read("whole/summary.json"));
    // Without it nothing is said of it.
    folder.write("n.toml", STUDY.replace("friction = 0.25\n", "").replace("tensions = [3.0, 1.5, 1e9]\n", ""));
    folder.done("study run n.toml --out none --engine cpu");
    let text = folder.text("none/summary.json");
    assert!(!text.contains("friction") && !text.contains("tension"));
    let plain = json(&text);
    for (name, value) in
        plain.as_object().unwrap().iter().filter(|(name, _)| !["study", "identity"].contains(&name.as_str()))
    {
        assert_eq!(*value, summary[name], "{name}");
    }
}

/// Points of a sweep side by side: more friction, more tension, by as much as the means differ.
#[test]
fn a_sweep_tells_the_tensions_of_its_points() {
    let folder = Folder::new();
    folder
        .write("s.toml", format!("{}[sweep]\ntallies.friction = [0.1, 0.3]\n", STUDY.replace("friction = 0.25\n", "")));
    let told = folder.done("study run s.toml --out sweep --engine cpu").stdout;
    assert!(told.contains("greatest tension with friction"), "{told}");
    let sheet = columns(&folder.text("sweep/sweep.csv"));
    let means = numbers(&sheet, "tension_mean");
    for (point, mean) in means.iter().enumerate() {
        let summary = json(&folder.text(&format!("sweep/point-00{point}/summary.json")));
        assert_eq!(summary["friction"]["tension"]["mean"]["value"].as_f64().unwrap(), *mean);
    }
    let differences = numbers(&sheet, "tension_mean_difference");
    assert!(means[1] > means[0] && (differences[1] - (means[1] - means[0])).abs() < 1e-12 * means[1]);
    assert!(differences[0] == 0.0 && numbers(&sheet, "tension_mean_difference_low")[1] > 0.0);
    // Work without friction is the length at the end, and with it, more.
    assert!(
        numbers(&sheet, "work_mean").iter().zip(numbers(&sheet, "length_mean")).all(|(work, length)| *work > length)
    );
    assert!(sheet.contains_key("steps_above_tension_1.5"));
}

/// The worked example: its commands, its table, its words and its pictures.
#[test]
fn the_climbers_rope_is_as_its_page_says() {
    let docs = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples"));
    let kept = |name: &str| std::fs::read_to_string(docs.join(name)).unwrap();
    let folder = Folder::new();
    ["climbing-short.geojson", "climbing-long.geojson", "climbing.csv"]
        .iter()
        .for_each(|name| folder.write(name, kept(name)));
    let page = kept("climbing.md");
    let commands: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    tautline ")).collect();
    assert_eq!(commands.len(), 5);
    commands.iter().for_each(|command| drop(folder.done(command)));
    let [short, long] = ["short.csv", "long.csv"].map(|name| columns(&folder.text(name)));
    let heights: Vec<usize> =
        page.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" m |")?.0.parse().ok()).collect();
    assert_eq!(heights, [4, 8, 12, 16, 20, 24, 28]);
    for height in heights {
        let of = |columns: &BTreeMap<String, Vec<String>>| {
            assert_eq!(numbers(columns, "y")[height], height as f64);
            let [turned, tension] = ["turned", "tension"].map(|name| numbers(columns, name)[height]);
            format!("{turned:.3} | {tension:.2}")
        };
        let row = format!("| {height} m | {} | {} |", of(&short), of(&long));
        assert!(page.contains(&row), "docs/examples/climbing.md does not say {row}");
    }
    let forces = columns(&folder.text("forces.csv"));
    let [angles, x, y] = ["angle", "force_x", "force_y"].map(|name| numbers(&forces, name));
    assert_eq!(angles.len(), 6);
    for (i, label) in forces["label"].iter().enumerate() {
        let row = format!("| {label} | {:.3} | {:.2} |", angles[i], x[i].hypot(y[i]));
        assert!(page.contains(&row), "docs/examples/climbing.md does not say {row}");
    }
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let joules = [&short, &long].map(|columns| {
        let [work, length] = ["work", "length"].map(|name| 10.0 * numbers(columns, name)[28]);
        [work, length, work - length].map(|joules| format!("{joules:.0}"))
    });
    let degrees = numbers(&short, "turned")[28].to_degrees();
    for says in [
        format!("{degrees:.0} degrees"),
        format!("takes {} joules on short slings and {} on long ones", joules[0][0], joules[1][0]),
        format!("{} and {} of these", joules[0][1], joules[1][1]),
        format!("{} and {} joules, warmed", joules[0][2], joules[1][2]),
    ] {
        assert!(words.contains(&says), "docs/examples/climbing.md does not say {says}");
    }
    for name in ["climbing-short.svg", "climbing-long.svg"] {
        assert!(folder.text(name) == kept(name), "docs/examples/{name} is not what its command draws");
    }
}
