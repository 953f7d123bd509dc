//! The programs in `examples/` run and say what they are for.

use std::process::Command;

use assert_cmd::cargo::cargo_bin;

fn said(example: &str) -> String {
    said_of(example, &[])
}

fn said_of(example: &str, args: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--release", "--quiet", "--example", example, "--"]).args(args);
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{example}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn examples_say_what_they_are_for() {
    let quarters = said("in_memory");
    assert_eq!(quarters.lines().count(), 9);
    assert!(
        quarters.contains("8 quarters") && quarters.contains("(-1, -1) (1, -1) (1, 1) (-1, 1) (-1, -1)"),
        "{quarters}"
    );
    let live = said("haptic_loop");
    assert!(live.starts_with("100000 moves") && live.contains("pulls along"), "{live}");
    let steps = said("rope_at_every_step");
    assert_eq!(steps.lines().count(), 62);
    assert!(steps.lines().any(|line| line.contains("[") && !line.contains("[]")), "{steps}");
    let study = said("tether_study");
    assert!(study.starts_with("the mean of the greatest length: ") && study.contains("% of the walks"), "{study}");
}

/// What a program of one's own writes is what the command line writes, to the byte.
#[test]
fn a_program_of_ones_own_does_what_the_command_line_does() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let plan = r#"{"type": "LineString", "coordinates": [[3, 4], [3, -4]]}"#;
    let anchored = format!(
        r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{}}, "geometry": {plan}}},
        {{"type": "Feature", "properties": {{"role": "anchor"}}, "geometry": {{"type": "Point", "coordinates": [0, 0]}}}}]}}"#
    );
    std::fs::write(at("plan.geojson"), anchored).unwrap();
    std::fs::write(at("t.csv"), "trace,x,y\n0,0,0\n0,0,9\n0,5,9\n0,5,0\n1,0,0\n1,1,1\n").unwrap();
    let study = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.5\nsteps = 30\n\
        [run]\ntraces = 90\nblock = 20\n[outputs]\ntraces = true\npictures = false\n";
    std::fs::write(at("s.toml"), study).unwrap();
    let line = |args: &[&str]| {
        let output = Command::new(cargo_bin("tautline")).args(args).output().unwrap();
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    let (plan, traces, study) = (at("plan.geojson"), at("t.csv"), at("s.toml"));
    said_of("own_program", &["eval", &plan, &traces, &at("r.csv"), &at("e.csv")]);
    line(&["eval", "--scene", &plan, "--traces", &traces, "--out", &at("R.csv"), "--events", &at("E.csv")]);
    let told = said_of("own_program", &["study", &study, &at("own")]);
    assert_eq!(told, "90 traces are in the answer\n");
    line(&["study", "run", &study, "--out", &at("line")]);
    for (own, theirs) in [("r.csv", "R.csv"), ("e.csv", "E.csv"), ("own/summary.json", "line/summary.json")] {
        let [own, theirs] = [own, theirs].map(|name| std::fs::read(at(name)).unwrap());
        assert!(own == theirs && !own.is_empty(), "{}", String::from_utf8_lossy(&own));
    }
    assert!(folder.path().join("own/traces.parquet").exists());
}
