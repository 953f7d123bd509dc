#!/bin/bash
# Runs the study @NAME@ in @PARTS@ parts, @EACH@ each, with GNU parallel, and puts them together once they are certain enough:
#   bash @SCRIPT@ [OPTIONS OF parallel, such as --jobs 8 or --sshloginfile nodes --workdir .]
# Called again, it goes on with what is there. The folder must be one that all machines see.
set -euo pipefail

tautline=${TAUTLINE:-@PROGRAM@}
study=@FILE@
out=@OUT@
parts=@PARTS@

mkdir -p "$out"
trap 'exit 130' INT
trap 'exit 143' TERM
# Each part in turn goes on for a minute; then it is seen whether what all have saved is certain enough. Each has one
# thread, so that as many run as there are cores.
failures=0
while true; do
    seq "$parts" | parallel --quote --joblog "$out/jobs.log" "$@" env RAYON_NUM_THREADS="${THREADS:-1}" \
        "$tautline" study run "$study" --shard "{}@1-$parts" --out "$out/part-{}" --resume --wait @WAIT@s \
        --stop-after 60s --enough "$out/so-far" >/dev/null || true
    # The exit codes, each once: 4 of those that are to go on.
    case $(awk 'NR > 1 { print $7 }' "$out/jobs.log" | sort -nu | tr '\n' ' ') in
    "0 ") break ;;
    "4 " | "0 4 ") ;;
    *)
        failures=$((failures + 1))
        [ "$failures" -lt 3 ] || { echo "some parts fail, see $out/jobs.log" >&2; exit 1; }
        ;;
    esac
    "$tautline" study merge "$out"/part-*/ --partial --out "$out/so-far" >/dev/null
done
"$tautline" study merge "$out"/part-*/ --out "$out/all"
