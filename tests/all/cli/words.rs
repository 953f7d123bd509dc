//! What is said is one and the same everywhere: left, right and clockwise, and the names of what is counted.

use serde_json::{Value, json};

use super::Folder;

/// A drawing whose y points down, a drag twice clockwise round its table as one sees it, and the same with y upwards.
fn lab() -> Folder {
    let folder = Folder::new();
    folder.write("down.svg", include_str!("../../scenes/messages/lab.svg"));
    folder.write("down.csv", include_str!("../../scenes/messages/cw.csv"));
    folder.done("convert down.svg down.geojson");
    let mut scene: Value = serde_json::from_str(&folder.text("down.geojson")).unwrap();
    assert_eq!(scene.as_object_mut().unwrap().remove("y"), Some(json!("down")));
    fn mirror(value: &mut Value) {
        match value.as_array_mut() {
            Some(pair) if pair.len() == 2 && pair[0].is_number() => pair[1] = json!(-pair[1].as_f64().unwrap()),
            Some(list) => list.iter_mut().for_each(mirror),
            None => panic!("no coordinates: {value}"),
        }
    }
    for feature in scene["features"].as_array_mut().unwrap() {
        mirror(&mut feature["geometry"]["coordinates"]);
    }
    folder.write("up.geojson", scene.to_string());
    let rows = folder.text("down.csv");
    let up = rows.lines().skip(1).map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        format!("{},{},-{}\n", cells[0], cells[1], cells[2])
    });
    folder.write("up.csv", format!("trace,x,y\n{}", up.collect::<String>()));
    folder
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn left_right_and_clockwise_are_what_the_picture_shows() {
    let folder = lab();
    let mut answers = vec![];
    for (scene, traces) in [("down.svg", "down.csv"), ("down.geojson", "down.csv"), ("up.geojson", "up.csv")] {
        let eval = format!("eval --scene {scene} --traces {traces}");
        folder.done(&format!("{eval} --out r.jsonl --events e.jsonl"));
        let result = json_of(&folder.text("r.jsonl"));
        let sides = result["sides"].as_array().unwrap();
        assert!(sides.len() > 8 && sides[sides.len() - 8..].iter().all(|side| side == "right"), "{scene}: {result}");
        folder.done(&format!("{eval} --out r.csv --events e.csv"));
        let row = folder.text("r.csv").lines().nth(1).unwrap().split(',').nth(9).unwrap().to_owned();
        assert_eq!(json!(row.split(';').collect::<Vec<_>>()), result["sides"], "{scene}");
        let events: Vec<Value> = folder.text("e.jsonl").lines().map(json_of).collect();
        let named: Vec<_> = events.iter().map(|e| e["side"].as_str().unwrap().to_owned()).collect();
        let rows = folder.text("e.csv");
        assert!(rows.lines().skip(1).map(|row| row.split(',').nth(6).unwrap()).eq(&named), "{scene}");

        let study = format!(
            "[scene]\nfile = \"{scene}\"\n[walk]\nkind = \"given\"\nfile = \"{traces}\"\n[outputs]\ntraces = true\n"
        );
        folder.write("g.toml", study);
        let out = scene.replace('.', "-");
        folder.done(&format!("study run g.toml --out {out} --engine reference"));
        let summary = json_of(&folder.text(&format!("{out}/summary.json")));
        let table = &summary["obstacles"][0];
        let value = |name: &str| table[name]["value"].as_f64().unwrap();
        assert_eq!([value("wound"), value("left"), value("right")], [1.0, 0.0, 1.0], "{scene}");
        assert!(value("mean") <= -1.0, "{scene}: {table}");
        assert_eq!(summary["ropes"][0]["sides"], result["sides"], "{scene}");
        folder.done(&format!("study replay {out} --trace 0 --events again.jsonl --draw d.svg"));
        let again: Vec<Value> = folder.text("again.jsonl").lines().map(json_of).collect();
        assert_eq!(again, events, "{scene}");
        // The page, and the pictures' keys.
        let page = folder.text(&format!("{out}/report.html"));
        let (head, body) =
            page.split_once("Obstacles that ropes are wound about").unwrap().1.split_once("<tbody>").unwrap();
        assert!(head.contains("counter-clockwise</th><th scope=\"col\">clockwise"), "{head}");
        let cells: Vec<&str> = body
            .split("<td data-head=")
            .skip(1)
            .map(|cell| cell.split_once('>').unwrap().1.split("</td>").next().unwrap())
            .collect();
        assert!(cells[3].starts_with("0 %") && cells[4].starts_with("100 %"), "{cells:?}");
        assert!(folder.text("d.svg").contains("turn, wall end on the right"), "{scene}");
        answers.push((named, result["sides"].clone(), cells[3..6].iter().map(|c| c.to_string()).collect::<Vec<_>>()));
    }
    assert!(answers[0] == answers[1] && answers[0] == answers[2], "{answers:?}");
}

#[test]
fn rows_of_shards_say_the_same_when_merged() {
    let folder = lab();
    folder.write(
        "w.toml",
        "[scene]\nfile = \"down.svg\"\n[walk]\nkind = \"persistent\"\nstep = 4.0\nsteps = 300\n[run]\ntraces = 60\n\
         block = 10\n[outputs]\ntraces = true\npictures = false\n",
    );
    folder.done("study run w.toml --out whole");
    for k in 0..2 {
        folder.done(&format!("study run w.toml --out k{k} --shard {k}/2"));
    }
    folder.done("study merge k0 k1 --out merged");
    assert!(folder.read("merged/summary.json") == folder.read("whole/summary.json"));
    let sides = |run: &str| {
        let rows = super::results::Table::read(&folder.path(&format!("{run}/traces.parquet")));
        rows.lists("sides")
    };
    assert_eq!(sides("merged"), sides("whole"));
    // Each trace by itself, given to eval, has the sides of its row.
    for trace in [0, 7, 33] {
        folder.done(&format!("study replay whole --trace {trace} --points p.csv"));
        folder.done("eval --scene down.svg --traces p.csv --out r.jsonl");
        let result = json_of(&folder.text("r.jsonl"));
        assert_eq!(result["sides"], json!(sides("whole")[trace]), "trace {trace}");
    }
    assert!(sides("whole").iter().any(|s| s.contains(&"left".to_owned())));
}

#[test]
fn turns_are_counted_about_the_place_that_is_told() {
    // A square of side 2 about the origin, and a rope that goes about it between its lower wall's middle and its
    // corner.
    let folder = Folder::new();
    folder.write("s.wkt", "LINESTRING (-1 -1, 1 -1, 1 1, -1 1, -1 -1)\nPOINT (-3 0)\n");
    let round = [[-3, 0], [-3, -3], [3, -3], [3, 3], [-3, 3], [-3, -3], [3, -3], [3, 3], [-3, 3], [-3, 0]];
    let rows: String = round.iter().map(|[x, y]| format!("0,{x},{y}\n")).collect();
    folder.write("t.csv", format!("trace,x,y\n{rows}"));
    folder.write("g.toml", "[scene]\nfile = \"s.wkt\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n");
    let shown = folder.done("study run g.toml --out a").stdout;
    let obstacle = json_of(&folder.text("a/summary.json"))["obstacles"][0].take();
    assert_eq!((&obstacle["vertex"], &obstacle["at"]), (&json!(0), &json!([0.0, -1.0])), "{obstacle}");
    assert_eq!(obstacle["left"]["value"], 1.0);
    assert!(shown.contains("(the point about which that is counted)\n  (0, -1.000)"), "{shown}");
}

#[test]
fn one_name_is_used_everywhere() {
    let folder = Folder::hand_made();
    folder.write("g.toml", "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n");
    let by_study = folder.done("study run g.toml --out a").stdout;
    let by_eval = folder.done("eval --scene s.geojson --traces t.csv").stdout;
    let (shown, page) = (folder.done("study show a").stdout, folder.text("a/report.html"));
    let glossary = include_str!("../../../docs/studies.md");
    for (field, name) in [
        ("length", "rope length at the end"),
        ("max_length", "greatest rope length"),
        ("depth", "depth at the end"),
        ("max_depth", "greatest depth"),
    ] {
        for text in [&by_study, &by_eval, &shown, &page] {
            assert!(text.contains(name), "{name} is missing in\n{text}");
        }
        assert!(glossary.contains(&format!("`{field}`: {name}")), "{name}");
    }
    assert!(by_study.contains("2 turns") && page.contains("turns at"), "{by_study}");
    let told = folder.done("study replay a --trace 0").stdout;
    assert_eq!(told, "trace 0: 6 steps, 2 events, rope length 22.00 at the end, greatest 23.00, depth 2 at the end\n");
}

#[test]
fn curves_are_said_to_decide_contacts() {
    let folder = lab();
    let eval = "eval --scene down.svg --traces down.csv --json";
    let [coarse, fine] = ["3", "0.001"].map(|tolerance| {
        let finished = folder.done(&format!("{eval} --flatten {tolerance}"));
        assert!(finished.stderr.contains("(--flatten), and contacts there depend on it"), "{}", finished.stderr);
        json_of(&finished.stdout)["depth"]["max"].as_f64().unwrap()
    });
    assert!(fine > 2.0 * coarse, "{coarse} {fine}");
}
