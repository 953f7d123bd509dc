#!/bin/bash
# Runs the study @NAME@ in @PARTS@ parts, @EACH@ each, with GNU parallel, and puts them together:
#   bash @SCRIPT@ [OPTIONS OF parallel, such as --jobs 8 or --sshloginfile nodes --workdir .]
# Called again, it goes on with what is there. The folder must be one that all machines see.
set -euo pipefail

tautline=${TAUTLINE:-@PROGRAM@}
study=@FILE@
out=@OUT@
parts=@PARTS@

mkdir -p "$out"
# Each part has one thread, so that as many run as there are cores.
seq "$parts" | parallel --quote --retries 3 "$@" env RAYON_NUM_THREADS="${THREADS:-1}" \
    "$tautline" study run "$study" --shard "{}@1-$parts" --out "$out/part-{}" --resume --wait @WAIT@s >/dev/null
"$tautline" study merge "$out"/part-*/ --out "$out/all"
