//! `[tallies] by_obstacle`, and quantiles of one's own.

use serde_json::Value;

use super::Folder;

/// A round pillar and a beam, and walks that are drawn about them.
const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\"><circle id=\"anchor\" r=\"1\" \
    cx=\"20\" cy=\"50\"/><circle cx=\"50\" cy=\"50\" r=\"15\"/><path d=\"M88,20v30\" stroke=\"#000\" fill=\"none\"/></svg>";

fn study(flatten: f64, tallies: &str) -> String {
    format!(
        "[scene]\nfile = \"p.svg\"\nflatten = {flatten}\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\nblock = 2\n\
         [tallies]\n{tallies}[outputs]\npictures = false\n"
    )
}

fn summary(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.text(&format!("{name}/summary.json"))).unwrap()
}

/// Walks round the pillar: nearly once, once and back, and past it to the beam.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("p.svg", SVG);
    let walks = [
        "20,80 50,85 80,50 50,15 20,20",
        "20,80 50,85 80,60 50,15 80,60 50,85 20,80 20,50",
        "50,15 95,15 95,45 95,70",
        "20,40 20,50 21,50",
    ];
    let mut rows = "trace,x,y\n".to_owned();
    for (trace, walk) in walks.iter().enumerate() {
        walk.split(' ').for_each(|point| rows += &format!("{trace},{point}\n"));
    }
    folder.write("t.csv", rows);
    folder
}

#[test]
fn contacts_by_obstacle_do_not_depend_on_how_closely_curves_are_followed() {
    let folder = folder();
    let mut seen = vec![];
    for (name, flatten) in [("coarse", 2.0), ("fine", 0.01)] {
        folder.write("s.toml", study(flatten, "by_obstacle = true\n"));
        folder.done(&format!("study run s.toml --out {name}"));
        seen.push(summary(&folder, name));
    }
    let wraps = |summary: &Value| summary["scalars"][4]["mean"]["value"].as_f64().unwrap();
    assert!(wraps(&seen[1]) > 3.0 * wraps(&seen[0]), "{} and {}", wraps(&seen[0]), wraps(&seen[1]));
    for summary in &seen {
        let counted = &summary["by_obstacle"];
        // The first comes to touch the pillar, so does the second; the third touches the pillar, then the beam's end.
        assert_eq!(counted["contacts"]["value"].as_f64(), Some(4.0 / 4.0), "{counted}");
        assert_eq!(counted["turns"]["value"].as_f64(), Some(3.0 / 4.0), "{counted}");
        let obstacles = counted["obstacles"].as_array().unwrap();
        let of = |i: usize, key: &str| obstacles[i][key]["value"].as_f64().unwrap();
        assert_eq!((obstacles.len(), of(0, "contacts"), of(1, "contacts")), (2, 0.75, 0.25));
        assert_eq!((of(0, "turns"), of(1, "turns")), (0.5, 0.25));
    }
    // Which share of steps the rope touches the pillar does depend on it, but little here.
    let share = |summary: &Value| summary["by_obstacle"]["obstacles"][0]["share"]["value"].as_f64().unwrap();
    assert_eq!(share(&seen[0]), share(&seen[1]));
}

#[test]
fn what_is_not_asked_for_changes_nothing() {
    let folder = folder();
    folder.write("s.toml", study(0.5, ""));
    folder.write("b.toml", study(0.5, "by_obstacle = true\n"));
    folder.done("study run s.toml --out s");
    folder.done("study run b.toml --out b");
    let [plain, mut asked] = ["s", "b"].map(|name| summary(&folder, name));
    assert!(plain.get("by_obstacle").is_none() && plain["study"]["tallies"].get("by_obstacle").is_none());
    assert!(plain["study"]["tallies"].get("quantiles").is_none());
    asked.as_object_mut().unwrap().remove("by_obstacle");
    asked["study"]["tallies"].as_object_mut().unwrap().remove("by_obstacle");
    asked["identity"] = plain["identity"].clone();
    assert_eq!(asked, plain);
}

#[test]
fn shards_count_as_the_whole_does() {
    let folder = folder();
    folder.write("s.toml", study(0.5, "by_obstacle = true\nquantiles = [0.999, 0.3]\n"));
    folder.done("study run s.toml --out whole");
    for k in 0..2 {
        folder.done(&format!("study run s.toml --out part-{k} --shard {k}/2"));
    }
    folder.done("study merge part-1 part-0 --out merged");
    assert!(folder.read("whole/summary.json") == folder.read("merged/summary.json"));
    let found = summary(&folder, "whole");
    let shares: Vec<f64> = found["scalars"][1]["quantiles"]
        .as_array()
        .unwrap()
        .iter()
        .map(|quantile| quantile["share"].as_f64().unwrap())
        .collect();
    assert_eq!(shares, [0.3, 0.999]);
    let told = folder.done("study show whole").stdout;
    assert!(told.starts_with("99.9 % of the traces need at most "), "{told}");
    assert!(told.contains("by obstacle, a trace: 1.000 "), "{told}");
}

#[test]
fn quantiles_are_shares() {
    let folder = folder();
    for (list, what) in [
        ("[0.5, 1.0]", "tallies.quantiles: 1 is not between 0 and 1"),
        ("[0.0]", "tallies.quantiles: 0 is not between 0 and 1"),
        ("[nan]", "tallies.quantiles: NaN is not between 0 and 1"),
        ("[]", "tallies.quantiles: give 1 to 1000 shares, not 0"),
    ] {
        folder.write("s.toml", study(0.5, &format!("quantiles = {list}\n")));
        folder.refused(2, "study run s.toml --out a", &["line 10", what]);
    }
}
