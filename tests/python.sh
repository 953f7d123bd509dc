#!/usr/bin/env bash
# Builds the Python package into a fresh environment and tests it there: its tests, the examples in its documentation, its
# types, and its papers and notebooks. Says so and ends well where there is no Python 3.10 or the packages cannot be had.
# PYTHON names another interpreter; CARGO_TARGET_DIR another place for what is built.
set -euo pipefail
cd "$(dirname "$0")/.."

export NODEVICE_SELECT=1 MPLBACKEND=Agg PIP_DISABLE_PIP_VERSION_CHECK=1
# No notice of a package manager in what tests look at.
export JUPYTER_PLATFORM_DIRS=1

unchecked() { echo "The Python package was not tested: $*" >&2; exit 0; }
say() { printf -- '-- %s (after %d s)\n' "$*" "$SECONDS"; }

python="${PYTHON:-python3}"
command -v "$python" >/dev/null || unchecked "there is no $python"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || unchecked "$("$python" --version) is older than 3.10"

scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
"$python" -m venv "$scratch/venv" 2>"$scratch/venv.log" || unchecked "$(tail -n 1 "$scratch/venv.log")"
pip=("$scratch/venv/bin/python" -m pip --quiet)
needed="$("$python" - <<'PY'
import re
from pathlib import Path

text = Path("python/pyproject.toml").read_text()
print(*re.findall(r'"([^"]+)"', re.search(r"^test = \[(.*?)\]", text, re.M | re.S).group(1)))
PY
)"
say "packages"
# shellcheck disable=SC2086 # a list of names
"${pip[@]}" install maturin numpy $needed 2>"$scratch/pip.log" || unchecked "$(tail -n 1 "$scratch/pip.log")"

# With the library's own builds, so that what both need is built once.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
say "the program that its results are held to"
cargo build --release --quiet --bin tautline
export TAUTLINE_BINARY="$CARGO_TARGET_DIR/release/tautline"
say "formatting and lints"
cargo fmt --check --manifest-path python/Cargo.toml
cargo clippy --release --quiet --manifest-path python/Cargo.toml -- -D warnings
say "the package"
"$scratch/venv/bin/maturin" build --quiet --release --locked --interpreter "$scratch/venv/bin/python" \
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
