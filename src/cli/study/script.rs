//! `tautline study script`: what has a scheduler run a study, to be read and changed by people.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::anyhow;
use tautline::output::{folder_of, write_whole};
use tautline::study::{Plan, Shard, Study, StudyFile};

use super::answer::duration;
use super::estimate::{check_sweep, measure};
use super::time::time;
use crate::cli::engine::{EngineArgs, of_studies};
use crate::cli::failure::Failure;
use crate::cli::print;
use crate::cli::words::counted;

#[derive(Debug, clap::Args)]
#[command(mut_arg("engine", of_studies))]
pub(crate) struct Args {
    /// For which scheduler
    scheduler: Scheduler,
    /// The study's file (TOML)
    file: PathBuf,
    /// How many parts [default: so many that each takes at least a minute or two, going by the first traces]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    parts: Option<u32>,
    /// For how long a job may run, of schedulers with a limit
    #[arg(long, value_name = "TIME", value_parser = time, default_value = "60m")]
    time: Duration,
    /// The folder for what comes out [default: NAME-study]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Where to write the script; must not be there yet [default: NAME.slurm.sh, NAME.parallel.sh or NAME.dask.py]
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    #[command(flatten)]
    engine: EngineArgs,
}

/// What there are scripts for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Scheduler {
    /// An array of jobs on Slurm, and one after it that merges
    Slurm,
    /// Tasks on Dask's workers
    Dask,
    /// Jobs of GNU parallel
    Parallel,
}

/// How long a part takes at the least, so that starting it costs next to nothing.
const LEAST: f64 = 60.0;

/// How many parts there are at the most unless more are asked for: what Slurm takes as one array.
const MOST: f64 = 1000.0;

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (all, blocks, has_rule) = cost(args)?;
    let parts = args.parts.unwrap_or_else(|| {
        // A part of two minutes or more is one of a minute or more on a machine twice as fast.
        let parts = (all.as_secs_f64() / (2.0 * LEAST)).min(MOST).min(blocks as f64);
        (parts as u32).max(1)
    });
    let name = args.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (suffix, template) = match args.scheduler {
        Scheduler::Slurm => ("slurm.sh", include_str!("script/slurm.sh")),
        Scheduler::Dask => ("dask.py", include_str!("script/dask.py")),
        Scheduler::Parallel if has_rule => ("parallel.sh", include_str!("script/parallel-rule.sh")),
        Scheduler::Parallel => ("parallel.sh", include_str!("script/parallel.sh")),
    };
    let to = args.to.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.{suffix}")));
    if to.symlink_metadata().is_ok() {
        let shown = to.display();
        return Err(Failure::input(anyhow!("cannot write {shown}: it is there already; give another name by --to")));
    }
    let quote = |path: &Path| quoted(args.scheduler, path);
    let here = |path: &Path| std::path::absolute(path).unwrap_or(path.to_owned());
    let out = here(&args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}-study"))));
    let program = std::env::current_exe().unwrap_or_else(|_| PathBuf::from("tautline"));
    let each = format!("about {}", duration(all.div_f64(parts.into())));
    // Room to save in, but no more than a tenth of the job.
    let before = Duration::from_secs(120).min(args.time / 10);
    let seconds = |time: Duration| time.as_secs().max(1).to_string();
    let words = |text: &str| text.replace(['\n', '\r'], " ");
    let [enough, slice, rule] = match has_rule {
        true => [
            include_str!("script/slurm-enough.sh"),
            " --stop-after 60s --enough \"$out/so-far\"",
            include_str!("script/slurm-rule.sh"),
        ],
        false => [""; 3],
    };
    let mut text = template.replace("@RULE@", rule).replace("@ENOUGH@", enough).replace("@SLICE@", slice);
    for (key, value) in [
        ("@NAME@", words(&name)),
        ("@SCRIPT@", words(&to.to_string_lossy())),
        ("@EACH@", each),
        ("@MINUTES@", args.time.as_secs().div_ceil(60).max(1).to_string()),
        ("@BEFORE@", seconds(before)),
        ("@WAIT@", seconds((args.time / 2).min(Duration::from_secs(600)))),
        ("@PARTS@", parts.to_string()),
        ("@PROGRAM@", quote(&program)),
        ("@FILE@", quote(&here(&args.file))),
        ("@OUT@", quote(&out)),
    ] {
        text = text.replace(key, &value);
    }
    write_whole(&to, text.as_bytes())?;
    let parts = counted(parts.into(), "part", "parts");
    let (shown, command) = (to.display(), if args.scheduler == Scheduler::Dask { "python" } else { "bash" });
    print(&format!("wrote {shown}: {parts}; read it, then run it with: {command} {shown}\n"))
}

/// About how long all of it would take here, how many blocks the largest study has, and whether one may end before its
/// last block.
fn cost(args: &Args) -> Result<(Duration, u64, bool), Failure> {
    let (file, folder) = (StudyFile::read(&args.file, &[])?, folder_of(&args.file));
    let has_rule = |plan: &Plan| plan.until.relative_error.is_some();
    if let Some(sweep) = file.sweep()? {
        let plans = || sweep.points().iter().map(|point| &point.plan);
        plans().enumerate().try_for_each(|(i, plan)| plan.check_shared().map_err(|e| sweep.located(e, i)))?;
        let all = check_sweep(&sweep, folder, Some((&args.engine, Shard::WHOLE)))?;
        return Ok((all, plans().map(Plan::blocks).max().unwrap_or(1), plans().any(has_rule)));
    }
    let plan = file.plan()?;
    plan.check_shared().map_err(|e| file.located(e))?;
    let study = Study::open(plan, folder).map_err(|e| file.located(e))?;
    study.check_moves().map_err(|e| file.located(e))?;
    let all = measure(&study, &args.engine, Shard::WHOLE)?.all(&study, Shard::WHOLE).unwrap_or_default();
    Ok((all, study.plan().blocks(), has_rule(study.plan())))
}

/// A path as the script's language has it.
fn quoted(scheduler: Scheduler, path: &Path) -> String {
    let text = path.to_string_lossy();
    match scheduler {
        Scheduler::Dask => serde_json::Value::from(text.as_ref()).to_string(),
        _ if text.bytes().all(|b| b.is_ascii_alphanumeric() || b"/._-+:".contains(&b)) => text.into_owned(),
        _ => format!("'{}'", text.replace('\'', r"'\''")),
    }
}
