//! `[outputs] steps` and `points`: files of chosen traces.

use super::Folder;

const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.3\nsteps = 60\n\
    [run]\ntraces = 95\nblock = 10\n[outputs]\npictures = false\n";

fn numbers(folder: &Folder, csv: &str) -> Vec<String> {
    let text = folder.text(csv);
    let mut all: Vec<String> = text.lines().skip(1).map(|row| row.split(',').next().unwrap().to_owned()).collect();
    all.dedup();
    all
}

#[test]
fn shards_merged_have_the_files_of_the_whole() {
    let folder = Folder::new();
    folder.write("s.toml", format!("{STUDY}steps = [93, 4, 57]\npoints = 12\n"));
    folder.done("study run s.toml --out whole");
    for k in 0..3 {
        folder.done(&format!("study run s.toml --out part-{k} --shard {k}/3"));
    }
    folder.done("study merge part-0 part-1 part-2 --out merged");
    for file in ["steps.parquet", "points.parquet", "summary.json"] {
        assert!(folder.read(&format!("whole/{file}")) == folder.read(&format!("merged/{file}")), "{file}");
    }
}

#[test]
fn chosen_traces_are_those_that_a_replay_tells() {
    let folder = Folder::new();
    folder.write("s.toml", format!("{STUDY}steps = [93, 4, 57]\npoints = [57]\n"));
    folder.write("plain.toml", STUDY);
    folder.done("study run s.toml --out a");
    folder.done("study run plain.toml --out b");
    assert!(!folder.path("b/steps.parquet").exists() && !folder.path("b/points.parquet").exists());
    let table = super::steps::read(&folder, "a/steps.parquet");
    let mut rows = vec![];
    for number in [4, 57, 93] {
        folder.done(&format!("study replay a --trace {number} --steps {number}.parquet --points {number}p.parquet"));
        rows.extend(super::steps::read(&folder, &format!("{number}.parquet")));
    }
    let joined = arrow_select::concat::concat_batches(&rows[0].schema(), &rows).unwrap();
    assert_eq!(arrow_select::concat::concat_batches(&rows[0].schema(), &table).unwrap(), joined);
    assert_eq!(super::steps::read(&folder, "57p.parquet"), super::steps::read(&folder, "a/points.parquet"));
}

#[test]
fn a_file_that_is_gone_or_damaged_is_written_again() {
    let folder = Folder::new();
    folder.write("s.toml", format!("{STUDY}steps = 3\npoints = true\n"));
    folder.done("study run s.toml --out a");
    for file in ["a/steps.parquet", "a/points.parquet"] {
        let whole = folder.read(file);
        for harm in [0, 1] {
            match harm {
                0 => std::fs::remove_file(folder.path(file)).unwrap(),
                _ => folder.write(file, [&whole[..100], b"xyz", &whole[103..]].concat()),
            }
            folder.done("study run s.toml --out a --resume");
            assert!(folder.read(file) == whole, "{file}, {harm}");
        }
    }
}

#[test]
fn given_traces_are_chosen_by_their_numbers() {
    let folder = Folder::hand_made();
    let study = "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\nblock = 2\n\
                 [outputs]\npictures = false\n";
    folder.write("s.toml", format!("{study}steps = [5, 0]\npoints = 3\nabout = [\"0\"]\n"));
    folder.done("study run s.toml --out a");
    folder.done("eval --scene s.geojson --traces a/points.parquet --steps p.csv --about 0");
    assert_eq!(numbers(&folder, "p.csv"), ["0", "4", "5"]);
    let told = super::steps::read(&folder, "a/steps.parquet").remove(0);
    assert_eq!(told.num_rows(), 7 + 3);
    assert_eq!(told.schema().field(9).name(), "winding_vertex 0");
}

#[test]
fn several_anchors_have_their_own_ropes() {
    let folder = Folder::new();
    let anchors = "anchor = [[1.0, 1.0], [5.0, 1.5], [1.0, 2.0]]\n";
    let study = STUDY.replace("built_in = \"rooms\"\n", &format!("built_in = \"rooms\"\n{anchors}"));
    folder.write("s.toml", format!("{study}steps = 7\n"));
    folder.done("study run s.toml --out a");
    let table = super::steps::read(&folder, "a/steps.parquet");
    let mut rows = vec![];
    for number in 0..7 {
        folder.done(&format!("study replay a --trace {number} --steps {number}.parquet"));
        rows.extend(super::steps::read(&folder, &format!("{number}.parquet")));
    }
    let joined = arrow_select::concat::concat_batches(&rows[0].schema(), &rows).unwrap();
    assert_eq!(arrow_select::concat::concat_batches(&rows[0].schema(), &table).unwrap(), joined);
}

#[test]
fn what_cannot_be_chosen_is_refused_before_anything_is_done() {
    let folder = Folder::new();
    let refused = |outputs: &str, run: &str, parts: &[&str]| {
        folder.write("s.toml", format!("{}{outputs}", STUDY.replace("[outputs]", &format!("{run}[outputs]"))));
        folder.refused(2, "study run s.toml --out a", parts);
        assert!(!folder.path("a").exists());
    };
    refused("steps = [3, 95]\n", "", &["outputs.steps: the study's traces are 0 to 94, so there is no 95"]);
    refused("points = [99]\n", "", &["line 12", "outputs.points: the study's traces are 0 to 94, so there is no 99"]);
    refused("steps = -1\n", "", &["outputs.steps: must be true, a number of traces, or a list"]);
    refused("steps = \"all\"\n", "", &["outputs.steps: must be true, a number of traces, or a list"]);
    refused(
        "about = [\"hall\"]\nsteps = 1\n",
        "",
        &["outputs.about: no obstacle is called \"hall\"; the scene has no labels"],
    );
    refused("steps = 1\n", "precision = \"fast\"\n", &["outputs.steps: are those of exact ropes"]);
}
