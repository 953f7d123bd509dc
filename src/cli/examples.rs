//! What the help of each command ends with: examples, the ones that people need most first.

pub(super) const EVAL: &str = "Examples:
  tautline eval                                              the built-in example
  tautline eval --scene plan.geojson --traces drags.csv --out ropes.parquet
  tautline eval --scene plan.geojson --traces drags.csv --events events.jsonl --json
  tautline eval --scene plan.geojson --traces drags.csv --class --out ropes.csv         which way ropes lie
  tautline eval --scene arena.map --anchor 20.5,10.5 --traces drags.csv --engine gpu
  tautline eval --scene coast.geojson --traces drags.csv --stride 4 --simplify 0.5      faster, nearly right";

pub(super) const CHECK: &str = "Examples:
  tautline check --scene plan.geojson
  tautline check --scene plan.dxf --without-layer TEXT --picture plan.svg
  tautline check --scene plan.geojson --traces drags.csv
  tautline check --scene plan.geojson --traces drags.csv --on-violation flag --json";

pub(super) const DRAW: &str = "Examples:
  tautline draw --out rope.svg                               the built-in example
  tautline draw --scene plan.geojson --traces drags.csv --trace 4 --step 37 --out rope.png
  tautline draw --scene plan.geojson --traces drags.csv --trace 4 --out rope.html
  tautline draw --scene plan.geojson --traces drags.csv --frames 1-12 --out events.svg
  tautline draw --scene plan.geojson --traces drags.csv --same-class 4 --out same.svg
  tautline draw --scene plan.geojson --out plan.svg
  tautline draw --gallery gallery";

pub(super) const CONVERT: &str = "Examples:
  tautline convert plan.svg plan.geojson                     a drawing made in Inkscape
  tautline convert --flatten 0.5 plan.dxf plan.wkt           arcs and splines to half a unit
  tautline convert --unknown blocked map.yaml map.geojson    a map of ROS's map_server, in metres

Reading OUT gives the same walls and the same anchor, bit for bit. docs/scenes.md says what becomes a wall.";

pub(super) const BENCH: &str = "Examples:
  tautline bench                                             all engines, on random walls
  tautline bench --scene plan.geojson --step 0.5
  tautline bench --engine cpu --engine funnel --sweep n
  tautline bench --scene rooms --json";

pub(super) const TRADEOFF: &str = "Examples:
  tautline tradeoff                                          all methods, in the floor plan
  tautline tradeoff --scene coast.geojson --out coast.svg    with its diagram
  tautline tradeoff --scene coast.geojson --traces drags.parquet --stride 2,5,10 --simplify 0.1,1
  tautline tradeoff --engine cpu --engine funnel --json";

pub(super) const ADAPTERS: &str = "Examples:
  tautline adapters
  tautline adapters --json";

pub(super) const COMPLETIONS: &str = "Examples:
  mkdir -p ~/.local/share/bash-completion/completions
  tautline completions bash > ~/.local/share/bash-completion/completions/tautline
  mkdir -p ~/.zfunc
  tautline completions zsh > ~/.zfunc/_tautline
  mkdir -p ~/.config/fish/completions
  tautline completions fish > ~/.config/fish/completions/tautline.fish";

pub(super) const MAN: &str = "Examples:
  tautline man ~/.local/share/man/man1          then: man -M ~/.local/share/man tautline";

pub(crate) const STUDY_RUN: &str = "Examples:
  tautline study run                                         the built-in example
  tautline study run mine.toml --dry-run                     is it sound, and what would it cost?
  tautline study run mine.toml --count 1000000
  tautline study run mine.toml --set walk.step=0.5 --set scene.anchor=[2,3]
  tautline study run mine.toml --set sweep.walk.step=[0.2,0.4,0.8]           a study for each of three steps
  tautline study run mine.toml --stride 4 --simplify 0.5     faster, and nearly right
  tautline study run mine.toml --shard 0/4 --out part0
  tautline study run mine.toml --shard 3@1-6 --out part3 --resume --wait 2h --stop-after 55m     task 3 of 1 to 6";

pub(crate) const STUDY_RESUME: &str = "Examples:
  tautline study resume mine-study";

pub(crate) const STUDY_MERGE: &str = "Examples:
  tautline study merge part0 part1 part2 part3 --out all
  tautline study merge part0 part1 --partial --out so-far";

pub(crate) const STUDY_SHOW: &str = "Examples:
  tautline study show mine-study
  tautline study show mine-study --json";

pub(crate) const STUDY_STATUS: &str = "Examples:
  tautline study status mine-study
  tautline study status part0 part1 part2 part3 --json";

pub(crate) const STUDY_SCRIPT: &str = "Examples:
  tautline study script slurm mine.toml
  tautline study script slurm mine.toml --time 4h --parts 500 --out /scratch/mine
  tautline study script dask mine.toml
  tautline study script parallel mine.toml";

pub(crate) const STUDY_REPLAY: &str = "Examples:
  tautline study replay mine-study --trace 7
  tautline study replay mine-study --trace 7 --events events.jsonl --points points.csv
  tautline study replay mine-study --trace 7 --steps steps.csv
  tautline study replay mine-study --trace 7 --draw rope.svg";

pub(crate) const STUDY_INIT: &str = "Examples:
  tautline study init
  tautline study init mine.toml";

pub(crate) const STUDY_SCHEMA: &str = "Examples:
  tautline study schema > study.schema.json
  tautline study schema --of summary > summary.schema.json
  tautline study schema --of sweep > sweep.schema.json";

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory, Parser};

    use crate::cli::Cli;

    /// Each command that does something, with the words that lead to it.
    fn leaves(command: &Command, path: &str) -> Vec<(String, String)> {
        let path = format!("{path} {}", command.get_name()).trim().to_owned();
        if command.has_subcommands() {
            return command.get_subcommands().flat_map(|c| leaves(c, &path)).collect();
        }
        vec![(path, command.get_after_help().map(ToString::to_string).unwrap_or_default())]
    }

    #[test]
    fn every_command_has_examples_and_they_are_right() {
        let all = leaves(&Cli::command(), "");
        assert!(all.len() > 10);
        for (command, help) in all {
            let lines: Vec<&str> = help.lines().skip_while(|line| *line != "Examples:").skip(1).collect();
            assert!(!lines.is_empty(), "{command} has no examples");
            for line in lines.iter().take_while(|line| line.starts_with("  ")) {
                // The folder that it writes to.
                if line.starts_with("  mkdir -p ~/") {
                    continue;
                }
                // What follows is said about it, or done with what comes out.
                let words = line.trim().split("  ").next().unwrap().split(" > ").next().unwrap();
                assert!(words.starts_with(&command), "{command}: {line}");
                Cli::try_parse_from(words.split(' ')).unwrap_or_else(|e| panic!("{words}: {e}"));
            }
        }
    }
}
