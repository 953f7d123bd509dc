//! `tautline study status`.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use tautline::session::{FolderStatus, Status, StudyStatus, SweepStatus, status};
use tautline::study::Stopped;

use super::answer::duration;
use crate::cli::failure::Failure;
use crate::cli::words::{counted, short};
use crate::cli::{print, print_json};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The studies' folders
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Print all of it as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let status = status(&args.folders);
    if args.json {
        return print_json(&status);
    }
    print(&table(&status))
}

fn table(status: &Status) -> String {
    let mut text = String::new();
    let mut line = |text_of: std::fmt::Arguments<'_>| {
        let _ = text.write_fmt(text_of);
        text.push('\n');
    };
    let of_studies = status.studies.iter().map(|study| &study.folders);
    let folders = || of_studies.clone().chain(status.sweeps.iter().map(|sweep| &sweep.studies)).flatten();
    let width = folders().map(|folder| folder.folder.display().to_string().chars().count()).max().unwrap_or(0).max(6);
    let sweeps = status.sweeps.iter().map(|sweep| (of_sweep(sweep), &sweep.studies));
    let studies = status.studies.iter().map(|study| (of_study(study), &study.folders));
    for (i, (title, folders)) in sweeps.chain(studies).enumerate() {
        if i > 0 {
            line(format_args!(""));
        }
        line(format_args!("{title}"));
        line(format_args!(
            "{:width$}  {:8}{:>16}{:>10}{:>10}  writer",
            "folder", "part", "blocks done", "traces/s", "left"
        ));
        for folder in folders {
            let FolderStatus { done, blocks, shard, .. } = folder;
            let left = match (folder.stopped, folder.seconds_left) {
                (Stopped::Unfinished, left) => left.map_or("?".to_owned(), words),
                _ => "done".to_owned(),
            };
            line(format_args!(
                "{:width$}  {shard:8}{:>16}{:>10}{left:>10}  {}",
                folder.folder.display().to_string(),
                format!("{done} of {blocks}"),
                folder.traces_per_second.map_or(String::new(), short),
                writer(folder)
            ));
        }
    }
    for (_, why) in &status.others {
        line(format_args!("{why}"));
    }
    text
}

fn of_study(study: &StudyStatus) -> String {
    let name = study.identity.as_ref().map_or("not begun".to_owned(), |identity| format!("study {}", &identity[..12]));
    let missing = if study.missing.is_empty() { String::new() } else { format!("; missing: {}", study.missing) };
    let all = counted(study.blocks, "block", "blocks");
    let of = counted(study.folders.len() as u64, "folder", "folders");
    format!("{name}: {} of {all} done, in {of}{missing}", study.done)
}

fn of_sweep(sweep: &SweepStatus) -> String {
    let (name, all) = (sweep.folder.display(), counted(sweep.studies.len() as u64, "study", "studies"));
    let blocks = counted(sweep.blocks, "block", "blocks");
    format!("sweep {name}: {} of {all} done, {} of {blocks}", sweep.studies_done, sweep.done)
}

fn words(seconds: f64) -> String {
    duration(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
}

/// Who writes to a folder, and when that was heard of last, by its clock and this one's.
fn writer(folder: &FolderStatus) -> String {
    folder.holder.as_ref().map_or("-".to_owned(), |holder| {
        let now = SystemTime::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_secs());
        format!("process {} on {}, {} s ago", holder.process, holder.host, now.saturating_sub(holder.renewed))
    })
}
