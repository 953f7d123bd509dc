#!/usr/bin/env bash
# wgpu-types 30.0.1: a slice of mapped memory that is written to, WriteOnly<[u8]>, cannot go to another thread, though an array
# of it can, and though its own words promise the automatic traits of a reference.
#
# expected: WriteOnly<'_, [u8]> is Send, as &mut [u8] is: its documentation says that it implements automatic traits as a reference
#           does, it can be split in two, and filling the parts of a mapped buffer on several threads is what that is for.
# seen:     error E0277: the size of [u8] cannot be known at compilation time, because Send is implemented for WriteOnly<'_, T> with a T of known size
#           only (Sync is implemented for all). WriteOnly<'_, [u8; 512]> is Send; so into_chunks::<512>() and then one array
#           after the other can be shared out over threads, and halves of split_at cannot.
# Exits with 0 as long as that is so, else with 1.
set -euo pipefail

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p src/bin
cat >Cargo.toml <<'TOML'
[package]
name = "mapped"
version = "0.0.0"
edition = "2021"

[dependencies]
wgpu-types = { version = "=30.0.1", default-features = false }
TOML
cat >src/bin/arrays.rs <<'RUST'
fn needs_send<T: Send>(_: T) {}

fn main() {
    let mut memory = [0u8; 1024];
    let whole = wgpu_types::WriteOnly::from_mut(&mut memory[..]);
    for array in whole.into_chunks::<512>().0 {
        needs_send(array);
    }
}
RUST
cat >src/bin/slices.rs <<'RUST'
fn needs_send<T: Send>(_: T) {}

fn main() {
    let mut memory = [0u8; 1024];
    let whole = wgpu_types::WriteOnly::from_mut(&mut memory[..]);
    let (one, other) = whole.split_at(512);
    needs_send(one);
    needs_send(other);
}
RUST
cargo build --quiet --bin arrays
echo "an array of mapped memory can go to another thread"
if cargo build --quiet --bin slices 2>errors; then
    echo "now a slice can, too"
    exit 1
fi
grep --max-count 1 "E0277" errors
grep --quiet "required for .*WriteOnly<'_, \[u8\]>.* to implement .*Send" errors
echo "a slice of it cannot"
