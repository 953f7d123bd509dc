#!/usr/bin/env bash
# Builds what is handed out, installs each in a clean place, and runs the first example of its README there: the crate, the
# binary in an archive, the wheel, and the source distribution of the Python package.
#   tests/dist.sh [FOLDER]        leaves them in FOLDER (dist/ without it)
# Takes some fifteen minutes on two cores. PYTHON names another interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."

export NODEVICE_SELECT=1 MPLBACKEND=Agg PIP_DISABLE_PIP_VERSION_CHECK=1
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
say() { printf -- '-- %s (after %d s)\n' "$*" "$SECONDS"; }
fail() { echo "$*" >&2; exit 1; }

mkdir -p "${1:-dist}"
dist="$(cd "${1:-dist}" && pwd)"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
version="$(cargo metadata --no-deps --format-version 1 --locked | sed 's/.*"name":"tautline","version":"\([^"]*\)".*/\1/')"

# The README's first command, by the program itself: a study with its page. It says from which commit the program is.
first_example() { # first_example PROGRAM COMMIT
    mkdir "$scratch/empty"
    (cd "$scratch/empty" && "$1" study run >/dev/null && test -s example-study/report.html)
    grep -q "\"commit\": *\"$2" "$scratch/empty/example-study/run.json" || fail "$1 does not say that it is of commit $2"
    rm -rf "$scratch/empty"
}

say "the crate"
# Files that are not committed may be in it; it then says that it is changed.
cargo package --quiet --locked --allow-dirty --no-verify --package tautline
cp "$CARGO_TARGET_DIR/package/tautline-$version.crate" "$dist"
mkdir "$scratch/crate"
tar -xf "$dist/tautline-$version.crate" -C "$scratch/crate"
cargo install --quiet --locked --path "$scratch/crate/tautline-$version" --root "$scratch/installed"
commit="$(sed -n 's/.*"sha1": "\(.\{12\}\).*/\1/p' "$scratch/crate/tautline-$version/.cargo_vcs_info.json")"
first_example "$scratch/installed/bin/tautline" "$commit"

say "the binary"
name="tautline-$version-$(uname -m)-$(uname -s | tr '[:upper:]' '[:lower:]')"
mkdir "$scratch/$name"
cp "$scratch/installed/bin/tautline" README.md LICENSE-MIT LICENSE-APACHE CITATION.cff docs/CHANGELOG.md "$scratch/$name"
tar -czf "$dist/$name.tar.gz" -C "$scratch" "$name"
mkdir "$scratch/unpacked"
tar -xf "$dist/$name.tar.gz" -C "$scratch/unpacked"
! command -v nm >/dev/null || [ -z "$(nm "$scratch/unpacked/$name/tautline" 2>/dev/null)" ] || fail "the binary is not stripped"
first_example "$scratch/unpacked/$name/tautline" "$commit"

say "the wheel and the source distribution"
python="${PYTHON:-python3}"
"$python" -m venv "$scratch/maturin"
"$scratch/maturin/bin/python" -m pip install --quiet maturin
"$scratch/maturin/bin/maturin" sdist --manifest-path python/Cargo.toml --out "$dist"
# It knows no repository: it carries what the crate does, which says from which commit it is.
sdist="$dist/tautrope-$version.tar"
mkdir "$scratch/tautrope-$version"
cp "$scratch/crate/tautline-$version/.cargo_vcs_info.json" "$scratch/tautrope-$version"
rm -f "$sdist"
gunzip "$sdist.gz"
tar --append -f "$sdist" -C "$scratch" "tautrope-$version/.cargo_vcs_info.json"
gzip -n "$sdist"
# The wheel is built of nothing else.
tar -xf "$sdist.gz" -C "$scratch"
(cd "$scratch/tautrope-$version" && "$scratch/maturin/bin/maturin" build --quiet --release --locked \
    --interpreter "$scratch/maturin/bin/python" --out "$dist")
for handed in "$dist/tautrope-$version"-cp310-abi3-*.whl "$dist/tautrope-$version.tar.gz"; do
    say "installing $(basename "$handed")"
    venv="$scratch/venv-${handed##*.}"
    "$python" -m venv "$venv"
    "$venv/bin/python" -m pip install --quiet "$handed" pandas
    "$venv/bin/python" - python/README.md "$scratch" "$commit" <<'PY'
import json, os, re, sys
from importlib.metadata import distribution

import tautrope

block = re.search(r"```python\n(.*?)```", open(sys.argv[1]).read(), re.DOTALL).group(1)
os.chdir(sys.argv[2])
exec(compile(block, "README.md", "exec"))
files = [str(file) for file in distribution("tautrope").files]
assert sum("LICENSE-" in file for file in files) == 2, files
answer = tautrope.Study(scene="rooms", walk={"kind": "uniform", "step": 0.2, "steps": 9}).run(progress=False)
built_from = json.loads((answer.folder / "run.json").read_text())["commit"]
assert built_from.removesuffix("-changed") == sys.argv[3], built_from
PY
done
say "all are in $dist"
ls -l "$dist"
