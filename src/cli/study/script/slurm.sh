#!/bin/bash
# Runs the study @NAME@ on Slurm in @PARTS@ parts, @EACH@ each, and puts them together:
#   bash @SCRIPT@
# Called again later, it goes on with what is there. How far it is:
#   tautline study status @OUT@/part-*
# The folder must be one that all nodes see.
set -euo pipefail

tautline=${TAUTLINE:-@PROGRAM@}
study=@FILE@
out=@OUT@
parts=@PARTS@

submit() {
    mkdir -p "$out"
    # A part that stops before its time is over goes back into the queue; so does one whose node fails.
    array=$(sbatch --parsable --job-name=tautline --array="1-$parts" --time=@MINUTES@ --cpus-per-task="${CPUS:-1}" \
        --requeue --open-mode=append --output="$out/part-%a.log" "$1" part)
    # After all of them, however they ended: what is missing is named.
    sbatch --job-name=tautline-merge --dependency="afterany:${array%%;*}" --time=@MINUTES@ --requeue \
        --open-mode=append --output="$out/merge.log" "$1" merge
}

run() {
    code=0
@ENOUGH@    "$tautline" study run "$study" --shard "$SLURM_ARRAY_TASK_ID@1-$parts" --out "$out/part-$SLURM_ARRAY_TASK_ID" \
        --resume --wait @WAIT@s --stop-before @BEFORE@s@SLICE@ || code=$?
}

part() {
    # When the job ends. The number of the last task alone would stand for the whole array.
    local task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
    : "${SLURM_JOB_END_TIME:=$(date -d "$(squeue -h -j "$task" -o %e)" +%s)}"
    export SLURM_JOB_END_TIME
    run
@RULE@    # Exit code 4: all that is done is saved. 6: another still writes there, such as what a lost node left running.
    if [ "$code" -eq 4 ] || [ "$code" -eq 6 ]; then
        [ "${SLURM_RESTART_COUNT:-0}" -lt 100 ] || exit "$code"
        scontrol requeue "$task"
        sleep 600
    fi
    exit "$code"
}

merge() {
    "$tautline" study merge "$out"/part-*/ --out "$out/all"
}

case ${1:-submit} in
submit) submit "$(realpath "$0")" ;;
part) part ;;
merge) merge ;;
esac
