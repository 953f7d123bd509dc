//! The published schema of `summary.json`, and real summaries against it.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::Folder;

/// What the schema says of values, taken literally: a keyword that is not known here fails, so that nothing goes
/// unchecked; and so does a property that the schema does not describe.
struct Schema {
    root: Value,
}

impl Schema {
    fn check(&self, value: &Value, schema: &Value, at: &str) -> Result<(), String> {
        let Some(rules) = schema.as_object() else {
            return if schema == &Value::Bool(true) { Ok(()) } else { Err(format!("{at}: nothing is allowed")) };
        };
        let fault = |what: &str| Err(format!("{at}: {what}: {value}"));
        for (keyword, rule) in rules {
            match keyword.as_str() {
                "title" | "description" | "$schema" | "$defs" | "default" | "format" => {}
                "properties" | "required" | "additionalProperties" => {}
                "$ref" => self.check(value, self.resolved(rule), at)?,
                "type" => {
                    let is = |name: &Value| match name.as_str().unwrap() {
                        "object" => value.is_object(),
                        "array" => value.is_array(),
                        "string" => value.is_string(),
                        "boolean" => value.is_boolean(),
                        "null" => value.is_null(),
                        "number" => value.is_number(),
                        "integer" => value.is_i64() || value.is_u64(),
                        other => panic!("type {other}"),
                    };
                    if !rule.as_array().map_or_else(|| is(rule), |names| names.iter().any(is)) {
                        return fault(&format!("is no {rule}"));
                    }
                }
                "const" if value != rule => return fault(&format!("is not {rule}")),
                "enum" if !rule.as_array().unwrap().contains(value) => return fault(&format!("is none of {rule}")),
                "const" | "enum" => {}
                "minimum" | "maximum" => {
                    if let (Some(x), Some(limit)) = (value.as_f64(), rule.as_f64())
                        && if keyword == "minimum" { x < limit } else { x > limit }
                    {
                        return fault(&format!("{keyword} {rule}"));
                    }
                }
                "minItems" | "maxItems" => {
                    if let (Some(list), Some(limit)) = (value.as_array(), rule.as_u64())
                        && if keyword == "minItems" { list.len() < limit as usize } else { list.len() > limit as usize }
                    {
                        return fault(&format!("{keyword} {rule}"));
                    }
                }
                "items" => {
                    for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                        self.check(item, rule, &format!("{at}[{i}]"))?;
                    }
                }
                "anyOf" | "oneOf" => {
                    let fits = |one: &&Value| self.check(value, one, at).is_ok();
                    let count = rule.as_array().unwrap().iter().filter(fits).count();
                    if count == 0 || (keyword == "oneOf" && count > 1) {
                        return fault(&format!("{count} of {keyword}"));
                    }
                }
                other => panic!("the keyword {other} is not known here"),
            }
        }
        match value.as_object().filter(|_| rules.contains_key("properties")) {
            Some(object) => self.check_object(object, rules, at),
            None => Ok(()),
        }
    }

    fn check_object(&self, object: &Map<String, Value>, rules: &Map<String, Value>, at: &str) -> Result<(), String> {
        for name in rules.get("required").and_then(Value::as_array).into_iter().flatten() {
            if !object.contains_key(name.as_str().unwrap()) {
                return Err(format!("{at}: {name} is missing"));
            }
        }
        for (name, value) in object {
            match rules["properties"].get(name) {
                Some(schema) => self.check(value, schema, &format!("{at}.{name}"))?,
                None => return Err(format!("{at}: {name} is not described")),
            }
        }
        Ok(())
    }

    fn resolved(&self, reference: &Value) -> &Value {
        let path = reference.as_str().unwrap().strip_prefix('#').unwrap();
        self.root.pointer(path).unwrap_or_else(|| panic!("{path} is not there"))
    }

    fn accepts(&self, value: &Value) -> Result<(), String> {
        self.check(value, &self.root, "summary")
    }
}

/// All paths at which a value has something, list places left out.
fn paths(value: &Value, at: &str, all: &mut BTreeSet<String>) {
    all.insert(at.to_owned());
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| paths(value, &format!("{at}.{name}"), all)),
        Value::Array(list) => list.iter().for_each(|value| paths(value, at, all)),
        _ => {}
    }
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn real_summaries_are_as_the_schema_says() {
    let folder = Folder::hand_made();
    let schema = Schema { root: json_of(&folder.done("study schema --of summary").stdout) };
    let rooms = "[scene]\nbuilt_in = \"rooms\"\n";
    let studies = [
        format!(
            "{rooms}[walk]\nkind = \"persistent\"\nstep = 0.25\nsteps = 300\n[run]\ntraces = 200\nblock = 50\n\
             [tallies]\nlimits = [5.0, 20.0]\n"
        ),
        format!(
            "{rooms}[walk]\nkind = \"gaussian\"\nstep = 0.3\nsteps = 40\nat_walls = \"reject\"\n[run]\ntraces = 1\n"
        ),
        format!(
            "{rooms}anchor = {{ sample = 3 }}\n[walk]\nkind = \"waypoints\"\nstep = 0.5\nsteps = 90\nstart = \"visible\"\n\
             [run]\ntraces = 140\nblock = 7\nstride = 3\nsimplify = 0.1\n[until]\nrelative_error = 0.5\n[tallies]\nmap = 0\n"
        ),
        "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n".to_owned(),
        format!(
            "{rooms}anchor = [[2.0, 2.0], [3.0, 2.0]]\n[walk]\nkind = \"uniform\"\nstep = 0.3\nsteps = 60\n[run]\ntraces = 30\n"
        ),
    ];
    let studies = studies.into_iter().chain(["slide", "turn"].map(|at| {
        format!(
            "{rooms}[walk]\nkind = \"uniform\"\nstep = 0.5\nsteps = 90\ntether = 4\nat_tether = \"{at}\"\n[run]\n\
             traces = 90\nblock = 30\n"
        )
    }));
    let studies: Vec<String> = studies.collect();
    let mut seen = BTreeSet::new();
    for (i, study) in studies.iter().enumerate() {
        folder.write("s.toml", format!("{study}[outputs]\npictures = false\n"));
        folder.done(&format!("study run s.toml --out {i} --engine cpu"));
        let summary = json_of(&folder.text(&format!("{i}/summary.json")));
        schema.accepts(&summary).unwrap_or_else(|e| panic!("{study}: {e}"));
        paths(&summary, "", &mut seen);
        if i == 0 {
            check_changes(&schema, &summary);
        }
    }
    folder.write("s.toml", &studies[0]);
    folder.done("study run s.toml --out shard --shard 1/3 --engine cpu");
    let shard = json_of(&folder.text("shard/summary.json"));
    schema.accepts(&shard).unwrap();
    assert_eq!(shard["shard"], "1/3");
    for path in
        [".obstacles.mean.low", ".map.cells.cell", ".histograms.bins.bin", ".traded.jumps", ".survival.curve.step"]
    {
        assert!(seen.contains(path), "{path} is in none of the summaries");
    }
}

#[test]
fn sweeps_are_as_their_schemas_say() {
    let folder = Folder::new();
    let sweep = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.5\nsteps = 20\n[run]\ntraces = 40\n\
        block = 10\n[tallies]\nlimits = [2.0]\nanchors = true\n[outputs]\npictures = false\n\
        [sweep]\nscene.anchor = [[1, 1], [[1, 1], [2, 2]], { sample = 2 }]\nwalk.start = [\"anchor\", \"visible\"]\n";
    folder.write("s.toml", sweep);
    folder.done("study run s.toml --out a");
    let shown = folder.done("study show a --json").stdout;
    let one = folder.text("a/point-002/summary.json");
    for (of, text) in [("sweep", folder.text("a/sweep.json")), ("sweep-answer", shown), ("summary", one)] {
        let schema = Schema { root: json_of(&folder.done(&format!("study schema --of {of}")).stdout) };
        schema.accepts(&json_of(&text)).unwrap_or_else(|e| panic!("{of}: {e}"));
        for (name, definition) in schema.root["$defs"].as_object().unwrap() {
            for (field, rules) in definition["properties"].as_object().into_iter().flatten() {
                assert!(rules["description"].is_string() || rules["const"].is_string(), "{name}.{field}");
            }
        }
    }
    // The file's own says what a sweep is.
    let schema = json_of(&folder.done("study schema").stdout);
    assert!(schema["properties"]["sweep"]["properties"]["against"]["description"].is_string());
}

/// A summary with a change is not taken.
fn check_changes(schema: &Schema, summary: &Value) {
    for (path, value) in [
        ("/traces", Value::from(-1)),
        ("/stopped", Value::from("soon")),
        ("/scalars/0/mean/value", Value::from("much")),
        ("/map/cells/0/cell", Value::from(0.5)),
        ("/study/walk/kind", Value::from("flying")),
        ("/contacts/0/at", Value::from(vec![1.0])),
        ("/histograms/0/bins", Value::Null),
    ] {
        let mut changed = summary.clone();
        *changed.pointer_mut(path).unwrap() = value;
        assert!(schema.accepts(&changed).is_err(), "{path}");
    }
    let mut changed = summary.clone();
    changed.as_object_mut().unwrap().remove("identity");
    assert!(schema.accepts(&changed).unwrap_err().contains("identity"));
    changed["more"] = Value::Null;
    changed["identity"] = Value::from("");
    assert!(schema.accepts(&changed).unwrap_err().contains("more"));
}

#[test]
fn the_schema_says_how_cells_and_bins_are_numbered_and_it_is_so() {
    let folder = Folder::new();
    let schema = json_of(&folder.done("study schema --of summary").stdout);
    let described = |of: &str, field: &str| {
        let text = schema["$defs"][of]["properties"][field]["description"].as_str().unwrap().to_owned();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert!(described("Cell", "cell").contains("column + columns * row"));
    assert!(described("Bin", "bin").contains("bin i holds the lengths from i times `width` up to i + 1 times `width`"));
    assert!(described("Obstacle", "at").contains("about which the times round are counted"));
    for (name, definition) in schema["$defs"].as_object().unwrap() {
        for (field, rules) in definition["properties"].as_object().into_iter().flatten() {
            assert!(rules["description"].is_string() || rules["const"].is_string(), "{name}.{field} is not described");
        }
    }
    // One trace that stands in two places, one step each, in a box of 8 by 4 in cells of 1.
    folder.write("s.wkt", "LINESTRING (0 0, 8 0, 8 4, 0 4, 0 0)\nPOINT (0.5 0.5)\n");
    folder.write("t.csv", "trace,x,y\n0,0.5,0.5\n0,5.5,2.25\n0,8,4\n");
    folder.write(
        "g.toml",
        "[scene]\nfile = \"s.wkt\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[tallies]\nmap = 8\nmap_every = 1\nbin = 2.0\n",
    );
    folder.done("study run g.toml --out a");
    let summary = json_of(&folder.text("a/summary.json"));
    assert_eq!(summary["map"]["columns"], 8);
    let cells: Vec<u64> =
        summary["map"]["cells"].as_array().unwrap().iter().map(|cell| cell["cell"].as_u64().unwrap()).collect();
    // (0.5, 0.5) is column 0 of row 0, (5.5, 2.25) column 5 of row 2, and the upper corner belongs to the last cell.
    assert_eq!(cells, [0, 5 + 8 * 2, 7 + 8 * 3]);
    // The rope is the root of 7.5^2 + 3.5^2 = 8.28 long at the end.
    assert_eq!(summary["histograms"][0]["bins"][0]["bin"], 4);
}
