#!/usr/bin/env bash
# Fuzzes each target for so many seconds (60 unless told otherwise), or only the targets named after them:
#   tests/fuzz.sh [SECONDS [TARGET...]]
# What is found is kept in tests/fuzz/artifacts. Inputs that reach new code are kept in tests/fuzz/target/corpus; the next run
# begins with them and with the committed corpus.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || { echo "usage: tests/fuzz.sh [SECONDS [TARGET...]]" >&2; exit 2; }
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls tests/fuzz/corpus)

command -v cargo-fuzz >/dev/null || cargo install --locked cargo-fuzz
# Safe Rust needs no address sanitizer, and without one the stable compiler will do.
fuzz=(--fuzz-dir tests/fuzz --sanitizer none --codegen-units 16)
cargo fuzz build "${fuzz[@]}"

# Fuzzers write each input to a file and never end in an orderly way.
TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo /tmp)")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
# Keeps the layer in which Mesa sorts devices by window system from complaining where there is none.
export NODEVICE_SELECT=1

passed=0
failed=0
for target in "${targets[@]}"; do
    printf '\n== %s\n' "$target"
    found=tests/fuzz/target/corpus/$target
    mkdir -p "$found"
    if cargo fuzz run "${fuzz[@]}" "$target" "$found" "tests/fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
    fi
done
printf '\n%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ]
