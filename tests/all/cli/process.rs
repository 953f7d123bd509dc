//! What happens to the process from outside: a full disk, Ctrl-C, a reader that has seen enough.

use std::process::Stdio;

use super::{Finished, Folder};

#[test]
fn a_reader_that_has_seen_enough_is_no_fault() {
    let folder = Folder::hand_made();
    let eval = "eval --scene s.geojson --traces t.csv --engine reference";
    for args in [eval, &format!("{eval} --json"), "check --scene s.geojson", "adapters", "--help", "--version"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let finished = Finished::of(folder.command(args).stdout(Stdio::from(writer)));
        assert_eq!((finished.code, finished.stderr.as_str()), (Some(0), ""), "{args}");
    }
}

#[cfg(unix)]
mod unix {
    use std::fs::{DirEntry, File};
    use std::process::{Child, Command, Stdio};
    use std::sync::mpsc::{RecvTimeoutError, channel};
    use std::time::Duration;

    use super::super::{EVAL, Finished, Folder};

    /// Runs `eval` in a shell that lets no file grow beyond 2 KiB (4 KiB where the shell counts otherwise): growing
    /// further fails as on a full disk, and the signal that comes with it ends nothing.
    fn eval_on_full_disk(folder: &Folder, args: &[&str]) -> Finished {
        let program = folder.command("");
        let mut shell = Command::new("sh");
        shell.current_dir(folder.path("")).args(["-c", r#"ulimit -f 4; exec "$0" "$@""#]);
        shell.arg(program.get_program()).args(["eval", "--scene", "s.geojson", "--traces", "t.csv", "--engine", "cpu"]);
        Finished::of(shell.args(args))
    }

    #[test]
    fn a_full_disk_is_reported_and_changes_nothing() {
        let folder = Folder::floor_plan(60, 300);
        let outputs = [
            ["--out", "r.jsonl"],
            ["--out", "r.csv"],
            ["--out", "r.parquet"],
            ["--events", "e.jsonl"],
            ["--events", "e.csv"],
            ["--events", "e.parquet"],
        ];
        outputs.iter().for_each(|[_, name]| folder.write(name, "old"));
        let before = folder.files();
        for args @ [_, name] in outputs {
            let expected = format!("error: cannot write {name}: File too large");
            eval_on_full_disk(&folder, &args).has_failed(1, name, &[&expected]);
            assert!(folder.files() == before, "{name}: there are {:?}", folder.files().keys());
        }
    }

    #[test]
    fn results_for_whose_events_no_room_is_left_do_not_appear() {
        let folder = Folder::hand_made();
        // There and back behind the first wall: one result, 200 events.
        folder.write("t.csv", format!("trace,x,y\n{}", "0,5,12\n0,5,4\n".repeat(100)));
        folder.write("r.csv", "old");
        let before = folder.files();
        let finished = eval_on_full_disk(&folder, &["--out", "r.csv", "--events", "e.csv"]);
        finished.has_failed(1, "both", &["error: cannot write e.csv: File too large"]);
        assert!(folder.files() == before, "there are {:?}", folder.files().keys());
        // The results alone have room.
        assert_eq!(eval_on_full_disk(&folder, &["--out", "r.csv"]).code, Some(0));
    }

    /// Starts the program with its output piped.
    fn start(folder: &Folder, args: &str) -> Child {
        folder.command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn interrupt(child: &Child) {
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    }

    fn finish(child: Child) -> Finished {
        child.wait_with_output().unwrap().into()
    }

    /// Fails if the program has ended before it was interrupted.
    fn assert_runs(child: &mut Child) {
        let status = child.try_wait().unwrap();
        assert!(status.is_none(), "ended with {status:?} already");
    }

    #[test]
    fn ctrl_c_while_traces_are_read_leaves_everything_as_it_was() {
        let folder = Folder::hand_made();
        let before = folder.files();
        let pipe = folder.path("pipe.csv");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let mut child = start(&folder, &EVAL.replace("t.csv", "pipe.csv"));
        // The pipe opens for writing when the program opens it for reading, and then it waits for rows.
        let (opened, waiting) = channel();
        std::thread::spawn(move || opened.send(File::options().write(true).open(pipe).unwrap()));
        let held = loop {
            match waiting.recv_timeout(Duration::from_millis(20)) {
                Ok(file) => break file,
                Err(RecvTimeoutError::Timeout) => assert_runs(&mut child),
                Err(RecvTimeoutError::Disconnected) => panic!("the pipe cannot be opened"),
            }
        };
        interrupt(&child);
        finish(child).has_failed(130, "reading", &["error: stopped; nothing was written"]);
        drop(held);
        assert!(folder.files() == before, "there are {:?}", folder.files().keys());
    }

    /// Waits until the program handles Ctrl-C.
    #[cfg(target_os = "linux")]
    fn wait_until_it_listens(child: &mut Child) {
        // SIGINT is bit 1 of the signals that the program handles.
        let path = format!("/proc/{}/status", child.id());
        let handles = || {
            let status = std::fs::read_to_string(&path).unwrap();
            let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
            u64::from_str_radix(caught.trim(), 16).unwrap() & 2 != 0
        };
        while !handles() {
            assert_runs(child);
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn ctrl_c_ends_a_bench() {
        let folder = Folder::new();
        // The reference alone would take minutes.
        let mut child = start(&folder, "bench --engine reference --seconds 1000 --count 4000");
        wait_until_it_listens(&mut child);
        interrupt(&child);
        finish(child).has_failed(130, "benching", &["error: stopped; nothing was written"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn ctrl_c_during_a_long_evaluation_leaves_everything_as_it_was() {
        let folder = Folder::hand_made();
        let before = folder.files();
        let mut child = start(&folder, "eval --engine reference --out r.jsonl --events e.csv");
        wait_until_it_listens(&mut child);
        interrupt(&child);
        finish(child).has_failed(130, "evaluating", &["error: stopped; nothing was written"]);
        assert!(folder.files() == before, "there are {:?}", folder.files().keys());
    }

    /// A block of these walks takes minutes to draw.
    const SLOW: &str = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"waypoints\"\nstep = 0.001\nsteps = 1_000_000\n\
        [run]\ntraces = 4000\nblock = 100\n";

    #[cfg(target_os = "linux")]
    #[test]
    fn ctrl_c_ends_a_study_while_walks_are_drawn() {
        let folder = Folder::new();
        folder.write("slow.toml", SLOW);
        for args in ["study run slow.toml --out a", "study run slow.toml --out a", "study resume a"] {
            let mut child = start(&folder, args);
            wait_until_it_listens(&mut child);
            // Once the state is there traces are drawn.
            while !folder.path("a/state.bin").exists() {
                assert_runs(&mut child);
            }
            interrupt(&child);
            let finished = finish(child);
            // It may have come before the study was gone on with.
            assert!([4, 130].map(Some).contains(&finished.code), "{}", finished.stderr);
            assert!(finished.stderr.contains("error: stopped"), "{}", finished.stderr);
        }
        assert!(folder.done("study show a").stdout.contains("not finished"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn ctrl_c_ends_what_is_tried_out_for_long() {
        let folder = Folder::new();
        folder.write("slow.toml", SLOW);
        let before = folder.files();
        for args in ["tradeoff --traces 4000 --seconds 1000 --out t.svg", "study run slow.toml --dry-run"] {
            let mut child = start(&folder, args);
            wait_until_it_listens(&mut child);
            interrupt(&child);
            finish(child).has_failed(130, args, &["error: stopped; nothing was written"]);
            assert!(folder.files() == before, "{args} left {:?}", folder.files().keys());
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_signal_that_was_ignored_before_is_ignored() {
        let folder = Folder::new();
        folder.write("slow.toml", SLOW);
        let program = folder.command("");
        let mut shell = Command::new("sh");
        shell.current_dir(folder.path("")).args(["-c", r#"trap '' HUP; exec "$0" "$@""#]).arg(program.get_program());
        shell.args(["study", "run", "slow.toml", "--out", "a"]).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = shell.spawn().unwrap();
        while !folder.path("a/state.bin").exists() {
            assert_runs(&mut child);
        }
        assert!(Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap().success());
        std::thread::sleep(Duration::from_millis(300));
        assert_runs(&mut child);
        assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
        assert_eq!(finish(child).code, Some(4));
    }

    #[test]
    fn ctrl_c_while_files_are_written_leaves_all_or_nothing() {
        let folder = Folder::hand_made();
        let before = folder.files();
        let mut child = start(&folder, "eval --engine cpu --out r.jsonl --events e.jsonl");
        // The new file is there under a passing name, with something in it.
        let grows = |entry: DirEntry| {
            entry.file_name().to_string_lossy().starts_with(".r.jsonl.") && entry.metadata().is_ok_and(|m| m.len() > 0)
        };
        while child.try_wait().unwrap().is_none() {
            if std::fs::read_dir(folder.path("")).unwrap().any(|entry| grows(entry.unwrap())) {
                interrupt(&child);
                break;
            }
        }
        let finished = finish(child);
        if finished.code == Some(0) {
            // It was too late.
            assert_eq!(folder.text("r.jsonl").lines().count(), 4000);
            assert_eq!(folder.files().len(), before.len() + 1);
        } else {
            finished.has_failed(130, "writing", &["error: stopped; nothing was written"]);
            assert!(folder.files() == before, "there are {:?}", folder.files().keys());
        }
    }
}
