#!/usr/bin/env bash
# Kills the program at random system calls and repeats the command in the same place until it ends: what comes out must be, byte
# for byte, what comes out undisturbed, and nothing else may be left. Then fills a disk.
#   tests/faults.sh [KILLS [SEED]]     200 kills unless told otherwise; TAUTLINE names another binary than the release build
set -euo pipefail
cd "$(dirname "$0")/.."
kills=${1:-200}
seed=${2:-$RANDOM}
RANDOM=$seed

if ! command -v strace >/dev/null; then
    root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo)
    "${root[@]}" apt-get update -qq
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq strace
fi
strace -o /dev/null true 2>/dev/null || { echo "processes must not be traced here, so none is killed at a system call" >&2; exit 1; }

if [ -z "${TAUTLINE:-}" ]; then
    cargo build --release --quiet --bin tautline
    TAUTLINE=target/release/tautline
fi
program=$(realpath "$TAUTLINE")
plan=$(realpath tests/scenes/formats/plan.svg)
work=$(mktemp -d)
trap 'mountpoint -q "$work/disk" && umount "$work/disk"; rm -rf "$work"' EXIT
cd "$work"
say() { printf '%s\n' "$*" >&2; }

# What is killed: a study with rows, its second half, its shards put together, and ropes of given traces.
cat >s.toml <<'END'
[scene]
built_in = "rooms"
[walk]
kind = "persistent"
step = 0.4
steps = 10
[run]
traces = 20_000
block = 500
[outputs]
traces = true
pictures = false
END
{
    echo trace,x,y
    for ((i = 0; i < 300; i++)); do
        printf "$i,%s\n" 20,15 40,30 46,40 54,40 70,22 88,20 95,30 85,42 62,34
    done
} >t.csv
run=(study run s.toml --out out --engine cpu)
resume=(study resume out --engine cpu)
merge=(study merge k0 k1 --out out)
eval=(eval --scene "$plan" --traces t.csv --out out/r.csv --events out/e.parquet --engine cpu)

mkdir truth-run clean-run clean-resume clean-merge clean-eval
cp s.toml truth-run
cp s.toml clean-run
cp s.toml clean-resume
mkdir clean-eval/out
cp t.csv clean-eval
(cd clean-run && "$program" "${run[@]}" && mv out ../truth-run/) >/dev/null 2>&1
cp -a truth-run truth-resume
for k in 0 1; do
    (cd clean-merge && "$program" study run ../s.toml --out "k$k" --shard "$k/2" --engine cpu) >/dev/null 2>&1
done
cp -a clean-merge truth-merge
(cd truth-merge && "$program" "${merge[@]}") >/dev/null 2>&1
cp -a clean-eval truth-eval
(cd truth-eval && "$program" "${eval[@]}") >/dev/null 2>&1
cmp truth-run/out/summary.json truth-merge/out/summary.json

# A study stopped on the way, by a request to end while it locks a file of rows that is under way.
for n in 3 4 5 6 7 8 none; do
    [ "$n" != none ] || { say "no study could be stopped on the way"; exit 1; }
    rm -rf clean-resume/out
    code=0
    (cd clean-resume && strace -f -qq -o /dev/null -e trace=flock -e "inject=flock:signal=TERM:when=$n" "$program" "${run[@]}") \
        >/dev/null 2>&1 || code=$?
    [ "$code" -ne 4 ] || [ -z "$(ls -A clean-resume/out/traces)" ] || break
done

# The calls of the thread that makes the most of a kind, among which one is drawn.
kinds=(all %file write,fsync,rename,unlink,ftruncate,flock,close)
declare -A calls
for case in run resume merge eval; do
    for kind in "${kinds[@]}"; do
        rm -rf place log && mkdir log && cp -a "clean-$case" place
        declare -n words=$case
        (cd place && strace -ff -qq -o ../log/t -e trace="$kind" "$program" "${words[@]}") >/dev/null 2>&1
        calls[$case,$kind]=$(wc -l log/t.* | awk '$2 != "total" && $1 > most { most = $1 } END { print most + 0 }')
    done
done
say "seed $seed; calls: $(for key in "${!calls[@]}"; do printf '%s %s; ' "$key" "${calls[$key]}"; done)"

# Runs a command that is killed at a random call of a random kind, if it makes so many.
killed() {
    local case=$1 kind=${kinds[RANDOM % ${#kinds[@]}]}
    local n=$((1 + (RANDOM * 32768 + RANDOM) % calls[$case,$kind])) code=0
    declare -n words=$case
    (cd place && strace -f -qq -o /dev/null -e "trace=$kind" -e "inject=$kind:signal=KILL:when=$n" "$program" "${words[@]}") \
        >/dev/null 2>&1 || code=$?
    how="$case, killed at call $n of $kind"
    [ "$code" -eq 137 ]
}

# What of a place must be as it is undisturbed: times and machines are not.
listing() { (cd "$1" && find . ! -name lock ! -name run.json ! -name state.bin ! -name study.json -type f -exec sha256sum {} + | sort -k2); }
names() { (cd "$1" && find . | sort); }

done=0 passed=0 failed=0
while [ "$done" -lt "$kills" ]; do
    for case in run resume merge eval; do
        [ "$done" -lt "$kills" ] || break
        rm -rf place && cp -a "clean-$case" place
        hows=
        while killed "$case" 2>/dev/null; do
            done=$((done + 1))
            hows+="$how; "
            # One in three is killed once more.
            ((RANDOM % 3 == 0)) || break
        done
        [ -n "$hows" ] || continue
        count=$(grep -o ';' <<<"$hows" | wc -l)
        declare -n words=$case
        code=0
        (cd place && "$program" "${words[@]}") >/dev/null 2>message || code=$?
        why=
        [ "$code" -eq 0 ] || why="a dead end: exit code $code, $(tail -n 1 message)"
        [ -n "$why" ] || [ "$(listing place)" = "$(listing "truth-$case")" ] || why="another answer"
        [ -n "$why" ] || [ "$(names place)" = "$(names "truth-$case")" ] ||
            why="left: $(diff <(names "truth-$case") <(names place) | grep '^[<>]' | tr '\n' ' ')"
        if [ -z "$why" ]; then
            passed=$((passed + count))
        else
            failed=$((failed + count))
            say "FAILED: $hows$why"
        fi
    done
done

# A file system that is full: exit code 1 and what cannot be written; with room it goes on.
disk() {
    mkdir -p disk
    mount -t tmpfs -o "size=$1" tautline-faults disk 2>/dev/null
}
if disk 128k; then
    for size in 4k 16k 48k 96k; do
        rm -rf disk/*
        mount -o "remount,size=128k" disk
        head -c "$((131072 - ${size%k} * 1024))" /dev/zero >disk/filler
        code=0
        "$program" study run s.toml --out disk/out --engine cpu >/dev/null 2>message || code=$?
        why=
        { [ "$code" -eq 1 ] && grep -q 'error: cannot write disk/out.*No space left' message; } ||
            why="exit code $code, $(tail -n 1 message)"
        rm disk/filler
        mount -o "remount,size=64m" disk
        [ -n "$why" ] || "$program" study run s.toml --out disk/out --engine cpu >/dev/null 2>message ||
            why="no way on: $(tail -n 1 message)"
        [ -n "$why" ] || cmp -s disk/out/summary.json truth-run/out/summary.json || why="another answer"
        [ -n "$why" ] || cmp -s disk/out/traces.parquet truth-run/out/traces.parquet || why="other rows"
        if [ -z "$why" ]; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            say "FAILED: a full disk with $size left: $why"
        fi
    done
    umount disk
else
    say "no file system may be mounted here, so none was filled"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
