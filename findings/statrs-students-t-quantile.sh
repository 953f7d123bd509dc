#!/usr/bin/env bash
# statrs 0.19.1: StudentsT::inverse_cdf gives wrong quantiles, without an error, far out with one degree of freedom and with many
# degrees of freedom.
#
# expected: (a) 1 degree, p = 0.999999999: tan(pi (p - 1/2)) = 318309877.5, a closed form.
#           (b) 1,000,000 degrees, p = 0.975: 1.9599663568 (mpmath 1.4.1 at 60 digits; SciPy 1.17.1 gives the same).
#           (c) 10,000,000 degrees, p = 0.975: 1.9599642217, and never less than the normal quantile 1.9599639845.
# seen:     (a) 66744661.9, a fifth of it. (b) 1.9598477, below the normal quantile, off by 6e-5 of itself.
#           (c) 1.8265564, off by 7 %, which makes an interval of 95 % one of 93 %.
# why:      the quantile goes by the inverse of the incomplete beta function, whose argument is then so close to 0 or 1 that
#           its fixed tolerance leaves few digits, or none.
# Exits with 0 as long as that is so, else with 1.
set -euo pipefail

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "quantiles"
version = "0.0.0"
edition = "2021"

[dependencies]
statrs = { version = "=0.19.1", default-features = false }
TOML
cat >src/main.rs <<'RUST'
use statrs::distribution::{ContinuousCDF, StudentsT};

fn main() {
    let wrong = [
        (1.0, 0.999999999, 318309877.51646106, 66744661.91630723),
        (1e6, 0.975, 1.9599663568141067, 1.959847719928278),
        (1e7, 0.975, 1.9599642217672055, 1.8265563836258383),
    ];
    let mut as_before = true;
    for (freedom, p, expected, seen) in wrong {
        let found = StudentsT::new(0.0, 1.0, freedom).unwrap().inverse_cdf(p);
        println!("{freedom} degrees, {p}: {found}, expected {expected}, off by {:.1e}", found / expected - 1.0);
        as_before &= (found / seen - 1.0f64).abs() < 1e-3 * (seen / expected - 1.0f64).abs();
    }
    std::process::exit(if as_before { 0 } else { 1 });
}
RUST
cargo run --quiet
