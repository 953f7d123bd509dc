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
