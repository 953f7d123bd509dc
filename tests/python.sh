#!/usr/bin/env bash
# Builds the Python package into a fresh environment and tests it there: its tests, the examples in its documentation, its
# types, and its papers and notebooks. Installs python3-venv where it is missing. Says so and ends well where there is no
# Python 3.10 or the packages cannot be had, but not in continuous integration (CI is set there): that must not pass untested.
# PYTHON names another interpreter; CARGO_TARGET_DIR another place for what is built.
set -euo pipefail
cd "$(dirname "$0")/.."

export NODEVICE_SELECT=1 MPLBACKEND=Agg PIP_DISABLE_PIP_VERSION_CHECK=1
# No notice of a package manager in what tests look at.
export JUPYTER_PLATFORM_DIRS=1

unchecked() {
    echo "The Python package was not tested: $*" >&2
    [ -n "${CI:-}" ] && exit 1
    exit 0
}
say() { printf -- '-- %s (after %d s)\n' "$*" "$SECONDS"; }

python="${PYTHON:-python3}"
# Debian's Python comes without what makes environments.
if [ "$python" = python3 ] && ! python3 -c 'import ensurepip, venv' 2>/dev/null && command -v apt-get >/dev/null; then
    say "installing python3-venv"
    root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo -n)
    "${root[@]}" apt-get update -qq >/dev/null 2>&1 || true
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq python3 python3-venv >/dev/null 2>&1 || true
fi
command -v "$python" >/dev/null || unchecked "there is no $python"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || unchecked "$("$python" --version) is older than 3.10"

scratch="$(mktemp -d)"
packages=
trap '[ -z "$packages" ] || kill "$packages" 2>/dev/null || true; rm -rf "$scratch"' EXIT
"$python" -m venv "$scratch/venv" 2>"$scratch/venv.log" || unchecked "$(tail -n 1 "$scratch/venv.log")"
pip=("$scratch/venv/bin/python" -m pip --quiet)
needed="$("$python" - <<'PY'
import re
from pathlib import Path

text = Path("python/pyproject.toml").read_text()
print(*re.findall(r'"([^"]+)"', re.search(r"^test = \[(.*?)\]", text, re.M | re.S).group(1)))
PY
)"
say "packages, while the rest is built"
# shellcheck disable=SC2086 # a list of names
"${pip[@]}" install maturin numpy $needed 2>"$scratch/pip.log" &
packages=$!

# With the library's own builds, so that what both need is built once: with all of the library's features, of which the
# package alone needs fewer.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
same=(--features tautline/default)
crates() {
    cargo tree --locked --edges normal,build --prefix none --format '{p} {f}' "$@" | sed 's/ (\*)$//' | sort -u
}
crates --package tautline >"$scratch/library"
crates --package tautrope "${same[@]}" >"$scratch/package"
if comm -23 "$scratch/library" "$scratch/package" | grep .; then
    echo "The package wants other features of these crates, which would be built twice; see Cargo.toml, \"not used\":" >&2
    comm -13 "$scratch/library" "$scratch/package" >&2
    exit 1
fi
say "the program that its results are held to"
cargo build --release --quiet --bin tautline
export TAUTLINE_BINARY="$CARGO_TARGET_DIR/release/tautline"
say "formatting and lints"
cargo fmt --check --package tautrope
cargo clippy --release --quiet --package tautrope "${same[@]}" -- -D warnings
say "the package"
wait "$packages" || { packages=; unchecked "$(tail -n 1 "$scratch/pip.log")"; }
packages=
"$scratch/venv/bin/maturin" build --quiet --release --locked --interpreter "$scratch/venv/bin/python" "${same[@]}" \
    --manifest-path python/Cargo.toml --out "$scratch/wheels"
[[ "$(ls "$scratch/wheels")" == tautrope-*-cp310-abi3-*.whl ]] || { ls "$scratch/wheels" >&2; exit 1; }
"${pip[@]}" install --no-deps "$scratch"/wheels/*.whl

# A copy, so that what is tested is what was installed, and nothing is left beside the sources.
mkdir -p "$scratch/room/python"
cp -r python/tests python/README.md python/pyproject.toml "$scratch/room/python"
ln -s "$PWD/tests" "$PWD/docs" "$PWD/examples" "$scratch/room"
cd "$scratch/room/python"
say "tests"
"$scratch/venv/bin/python" -m pytest --quiet -p no:cacheprovider
say "examples in its documentation"
"$scratch/venv/bin/python" -m pytest --quiet -p no:cacheprovider --doctest-modules --pyargs tautrope
say "types"
"$scratch/venv/bin/python" -m mypy --package tautrope --cache-dir "$scratch/mypy"
"$scratch/venv/bin/python" -m mypy.stubtest --ignore-disjoint-bases --concise tautrope._tautrope
say "done"
