#!/usr/bin/env bash
# Looks into the library of the release build: are the wide loops (src/candidates/simd.rs) really vector code for AVX2?
# A build for another processor than x86-64 has nothing to look for.
set -euo pipefail
cd "$(dirname "$0")/.."

[ "$(uname -m)" = x86_64 ] || exit 0

# The binary is stripped of the names that are looked for.
cargo build --release --quiet --lib
library="${CARGO_TARGET_DIR:-target}/release/libtautline.rlib"
code="$(mktemp)"
trap 'rm -f "$code"' EXIT
objdump --disassemble --demangle --no-show-raw-insn "$library" |
    awk '/^[0-9a-f]+ <.*>:$/ { wide = /pulp::.*::vectorize/ } wide' >"$code"

expect() {
    if ! grep --quiet --extended-regexp "$1" "$code"; then
        echo "$library: no $2 in the code for AVX2: the loop was not vectorized" >&2
        exit 1
    fi
    echo "found: $2"
}

expect 'vdivpd .*%ymm' 'division of four f64 (slopes)'
expect 'vmulpd .*%ymm' 'product of four f64 (slopes)'
expect 'vm(ax|in)pd .*%ymm' 'comparison of four f64 (bounds of a window)'
expect 'vcmp[a-z_]*pd .*%ymm' 'test of four f64 (lines met)'
expect 'vmulps .*%ymm' 'product of eight f32 (vertices in a triangle)'
expect 'vcmp[a-z_]*ps .*%ymm' 'test of eight f32 (vertices in a triangle)'
