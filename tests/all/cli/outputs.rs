//! What is written never replaces what is read, nor what is written besides.

use super::Folder;

const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\"><circle id=\"anchor\" r=\"1\"/><path d=\"M3,4v9\"/></svg>";

#[test]
fn a_picture_does_not_replace_its_scene() {
    let folder = Folder::hand_made();
    folder.write("b.svg", SVG);
    folder.write("m.png", "an image");
    let map = "image: m.png\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n";
    folder.write("m.yaml", map);
    folder.refused(2, "check --scene b.svg --picture b.svg", &["--scene and --picture name the same file, b.svg"]);
    folder.refused(2, "draw --scene b.svg --out ./b.svg", &["--scene and --out name the same file, ./b.svg"]);
    folder.refused(2, "tradeoff --scene b.svg --out b.svg", &["--scene and --out name the same file"]);
    folder.refused(2, "draw --scene m.yaml --out m.png", &["the image of --scene and --out name the same file"]);
    folder.refused(2, "convert s.geojson s.geojson", &["IN and OUT name the same file, s.geojson"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("b.svg", folder.path("link.svg")).unwrap();
        folder.refused(2, "draw --scene b.svg --out link.svg", &["--scene and --out name the same file"]);
        folder.refused(2, "draw --scene link.svg --out b.svg", &["--scene and --out name the same file"]);
    }
    folder.done("draw --scene b.svg --out c.svg");
}

#[test]
fn a_replay_replaces_nothing_of_the_study() {
    let folder = Folder::hand_made();
    folder.write("b.svg", SVG);
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,5\n");
    folder.write(
        "s.toml",
        "[scene]\nfile = \"b.svg\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[outputs]\ntraces = true\n",
    );
    folder.done("study run s.toml --out gs");
    let replay = |rest: &str| format!("study replay gs --trace 0 {rest}");
    folder.refused(2, &replay("--draw b.svg"), &["the study's scene.file and --draw name the same file"]);
    folder.refused(2, &replay("--events t.csv"), &["the study's walk.file and --events name the same file"]);
    folder.refused(2, &replay("--points t.csv"), &["the study's walk.file and --points name the same file"]);
    folder.refused(2, &replay("--points u.csv --events u.csv"), &["--events and --points name the same file"]);
    // The study's folder is its own, whether the file is there or not.
    for file in ["y.csv", "../gs/y.csv"] {
        folder.refused(2, &replay(&format!("--points gs/{file}")), &["is in the study's folder"]);
    }
    folder.done(&replay("--points u.csv --events e.csv"));
}

#[test]
fn what_is_wrong_with_a_studys_folder_is_named() {
    let folder = Folder::new();
    folder.done("study run --count 2 --out a");
    std::fs::remove_file(folder.path("a/run.json")).unwrap();
    let told = folder.done("study resume a").stderr;
    assert!(told.contains("note: a/run.json: gone or damaged; what is written now says nothing of"), "{told}");
    assert!(!folder.done("study resume a").stderr.contains("gone or damaged"));
    std::fs::remove_file(folder.path("a/state.bin")).unwrap();
    std::fs::create_dir(folder.path("a/state.bin")).unwrap();
    let finished = folder.run("study show a");
    assert_eq!(finished.code, Some(2));
    assert!(finished.stderr.contains("a/state.bin: ") && !finished.stderr.contains("remove it"), "{}", finished.stderr);
}

#[test]
fn numbers_below_zero_are_answered_as_numbers() {
    let folder = Folder::hand_made();
    for (args, expected) in [
        ("eval --simplify -1", "give a number above 0"),
        ("eval --stride -1", "--stride"),
        ("study replay a --trace -1", "invalid value '-1' for '--trace <I>'"),
        ("draw --out a.svg --trace -1", "invalid value '-1' for '--trace <ID>'"),
        ("bench --count -1", "invalid value '-1' for '--count <N>'"),
        ("tradeoff --simplify -1", "give a number above 0"),
        ("study run --seed -1", "invalid value '-1'"),
    ] {
        let finished = folder.run(args);
        let told = &finished.stderr;
        assert_eq!(finished.code, Some(2), "{args}: {told}");
        assert!(told.contains(expected) && !told.contains("unexpected"), "{args}: {told}");
    }
}

#[test]
fn steps_stand_still_as_given() {
    let folder = Folder::new();
    folder.write("s.geojson", super::SCENE);
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,0\n0,1,0\n0,1,1\n0,1,2\n");
    for stride in [1, 2, 4] {
        let done = folder.done(&format!("eval --scene s.geojson --traces t.csv --stride {stride} --json"));
        let report: serde_json::Value = serde_json::from_str(&done.stdout).unwrap();
        assert!(done.stdout.contains("\"still\": 1"), "{stride}: {report:#}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_printed_is_an_error() {
    let folder = Folder::new();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let status = folder.command("eval --help").stdout(full).stderr(std::process::Stdio::null()).status().unwrap();
    assert_eq!(status.code(), Some(1));
}
