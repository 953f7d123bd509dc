#!/usr/bin/env bash
# Runs all tests: formatting, lints, documentation, then the tests themselves.
# Installs the software Vulkan driver where it is missing, since the GPU engine is tested on it.
set -euo pipefail
cd "$(dirname "$0")/.."

# Keeps the layer in which Mesa sorts devices by window system from complaining where there is none.
export NODEVICE_SELECT=1

say() { printf '\n== %s\n' "$*"; }

has_driver() {
    compgen -G '/usr/share/vulkan/icd.d/lvp_icd*.json' >/dev/null || compgen -G '/etc/vulkan/icd.d/lvp_icd*.json' >/dev/null
}

has_loader() {
    { ldconfig -p 2>/dev/null || /sbin/ldconfig -p; } | grep 'libvulkan\.so\.1' >/dev/null
}

if [ "$(uname)" = Linux ] && ! { has_driver && has_loader; }; then
    if command -v apt-get >/dev/null; then
        say "installing the software Vulkan driver (mesa-vulkan-drivers, libvulkan1)"
        root=()
        [ "$(id -u)" -eq 0 ] || root=(sudo)
        "${root[@]}" apt-get update -qq
        "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq mesa-vulkan-drivers libvulkan1
    else
        echo "The tests need a software Vulkan driver, Mesa's lavapipe. Install it and run this again:" >&2
        echo "  Fedora: dnf install mesa-vulkan-drivers vulkan-loader" >&2
        echo "  Arch:   pacman -S vulkan-swrast vulkan-icd-loader" >&2
        echo "  Alpine: apk add mesa-vulkan-swrast vulkan-loader" >&2
        exit 1
    fi
fi

say "formatting"
cargo fmt --check
cargo fmt --check --manifest-path tests/fuzz/Cargo.toml
say "lints"
cargo clippy --release --all-targets --quiet -- -D warnings
say "vector code"
tests/vectors.sh
say "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --document-private-items --quiet
say "documentation's examples"
cargo test --release --doc --quiet
say "tests"
cargo test --release --lib --bins --tests
say "a study's page in a browser"
tests/page.sh
say "a trace that plays in a browser"
tests/animation.sh
say "kills at random system calls, and a full disk"
tests/faults.sh 12
