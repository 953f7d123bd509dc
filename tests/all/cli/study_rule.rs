//! Studies that are shared out and end once they are certain enough.

use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use super::Folder;
use super::study::rows;
use super::study_shared::{STUDY, answer, send, start, study};
use super::study_sweep::{SWEEP, column, same};

/// The rows of a study that its rule ends are those of one run, whatever its parts have done, done or not.
#[test]
fn the_rows_of_a_shared_study_end_with_it() {
    let folder = study();
    let text = STUDY.replace("950", "20_000").replace("[outputs]", "[outputs]\ntraces = true");
    folder.write("u.toml", format!("{text}[until]\nrelative_error = 0.05\n"));
    folder.done("study run u.toml --out truth");
    let truth = rows(&folder, "truth");
    assert!((200..10_000).contains(&truth.len()), "{}", truth.len());
    folder.done("study run u.toml --out k1 --shard 1/2");
    // The other is stopped again and again until what it has is enough: it is not done, and has no whole file of rows.
    let stop_at = |milliseconds: u64| {
        let mut child = start(&folder, "study run u.toml --out k0 --shard 0/2 --resume");
        sleep(Duration::from_millis(milliseconds));
        send("TERM", &child);
        child.wait().unwrap();
    };
    for round in 1.. {
        stop_at(round * 50);
        let told = folder.run("study merge k0 k1 --partial --out so-far");
        assert_eq!(told.code, Some(0), "{}", told.stderr);
        if answer(&folder, "so-far").contains("\"stopped\": \"relative_error\"") {
            break;
        }
        assert!(!folder.path("so-far/traces.parquet").exists());
    }
    folder.done("study merge k1 k0 --out all");
    for merged in ["so-far", "all"] {
        assert!(answer(&folder, merged) == answer(&folder, "truth") && rows(&folder, merged) == truth, "{merged}");
    }
    // With what is enough a part has nothing to do any more, and makes no folder; with less it goes on.
    let told = folder.done("study run u.toml --out k2 --shard 0/2 --resume --enough so-far").stdout;
    assert!(told.contains("so-far has the answer already") && !folder.path("k2").exists(), "{told}");
    folder.done("study run u.toml --out few --blocks 0..1");
    folder.done("study merge few --partial --out too-few");
    folder.done("study run u.toml --out k0 --shard 0/2 --resume --enough too-few");
    folder.done("study merge k1 k0 --out again");
    assert!(answer(&folder, "again") == answer(&folder, "truth") && rows(&folder, "again") == truth);
    // An answer of some parts has no rows.
    folder.done(&format!("study run u.toml --out rest --blocks 1..{}", truth.len() / 40 + 1));
    folder.refused(
        2,
        "study merge too-few rest --out no",
        &["too-few has an answer of some parts, without their rows"],
    );
}

/// Parts of a sweep leave alone the points that are certain enough, and do the others.
#[test]
fn points_that_are_certain_enough_are_left_alone() {
    let folder = Folder::new();
    folder.write("u.toml", format!("{}[until]\nrelative_error = 0.05\n{SWEEP}", STUDY.replace("950", "4000")));
    folder.done("study run u.toml --out truth");
    let blocks = column(&folder, "truth/sweep.csv", "blocks");
    let mut counts: Vec<u64> = blocks.iter().map(|count| count.parse().unwrap()).collect();
    counts.sort_unstable();
    let some = counts[2];
    assert!(some < counts[3], "{counts:?}");
    folder.done(&format!("study run u.toml --out early --blocks 0..{some}"));
    folder.done("study merge early --partial --out so-far");
    let told = folder.done(&format!("study run u.toml --out late --blocks {some}..100 --enough so-far")).stderr;
    assert_eq!(told.matches("so-far has the answer already").count(), 3, "{told}");
    let begun = (0..4).filter(|point| folder.path(&format!("late/point-00{point}")).exists()).count();
    assert_eq!(begun, 1);
    folder.done("study merge late early --out both");
    same(&folder, "both", "truth", 4);
}

/// Scripts have each part look now and then whether there is anything left to do, of studies and of sweeps.
#[test]
fn scripts_end_studies_by_their_rule() {
    let folder = Folder::new();
    folder.write("s.toml", STUDY);
    for (name, sweep) in [("one", ""), ("u", SWEEP)] {
        folder.write(&format!("{name}.toml"), format!("{STUDY}[until]\nrelative_error = 0.05\n{sweep}"));
        for scheduler in ["slurm", "parallel"] {
            folder.done(&format!("study script {scheduler} {name}.toml --engine cpu --parts 3"));
            let text = folder.text(&format!("{name}.{scheduler}.sh"));
            let [stops, looks] = ["--stop-after 60s --enough \"$out/so-far\"", "--partial --out \"$out/so-far\""];
            assert!(text.contains(stops) && text.contains(looks), "{text}");
            let check = Command::new("bash").arg("-n").arg(folder.path(&format!("{name}.{scheduler}.sh"))).status();
            let is_left = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_uppercase());
            assert!(check.unwrap().success() && !text.split('@').any(is_left), "{text}");
        }
    }
    // Without a rule there is nothing to look for.
    folder.done("study script parallel s.toml --engine cpu --parts 3");
    assert!(!folder.text("s.parallel.sh").contains("--enough"));
}
