#!/usr/bin/env bash
# Runs all tests: formatting, lints, documentation, then the tests themselves.
# Installs two software Vulkan drivers where they are missing, since the GPU engine is tested on both: Mesa's lavapipe, and
# SwiftShader, which comes with Chromium. They are compilers of different make, so each sees what the other may hide.
set -euo pipefail
cd "$(dirname "$0")/.."

# Keeps the layer in which Mesa sorts devices by window system from complaining where there is none.
export NODEVICE_SELECT=1

say() { printf '\n== %s (after %d s)\n' "$*" "$SECONDS"; }

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

# Where SwiftShader is described, for the Vulkan loader.
swiftshader() {
    local file
    for file in "${TAUTLINE_SWIFTSHADER:-}" /usr/lib/chromium /usr/lib64/chromium-browser /usr/lib64/chromium /opt/google/chrome; do
        [ -d "$file" ] && file="$file/vk_swiftshader_icd.json"
        [ -f "$file" ] && { echo "$file"; return; }
    done
    return 1
}

if [ "$(uname)" = Linux ] && ! swiftshader >/dev/null; then
    if command -v apt-get >/dev/null; then
        say "installing SwiftShader (chromium)"
        root=()
        [ "$(id -u)" -eq 0 ] || root=(sudo)
        "${root[@]}" apt-get update -qq
        "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq chromium >/dev/null
    fi
    if ! swiftshader >/dev/null; then
        echo "The tests need the software Vulkan driver SwiftShader: a file vk_swiftshader_icd.json, which Chromium and Chrome bring." >&2
        echo "Install one of them, or name that file in TAUTLINE_SWIFTSHADER, and run this again." >&2
        exit 1
    fi
fi

say "formatting"
cargo fmt --check
cargo fmt --check --manifest-path tests/fuzz/Cargo.toml
say "lints"
cargo clippy --release --all-targets --quiet -- -D warnings
say "lints of the program without what one format or pictures alone need"
cargo clippy --release --no-default-features --features cli --quiet -- -D warnings
say "vector code"
tests/vectors.sh
say "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --document-private-items --quiet
say "documentation's examples"
cargo test --release --doc --quiet
say "tests"
cargo test --release --lib --bins --tests
if [ "$(uname)" = Linux ]; then
    say "tests that need a device, on SwiftShader"
    driver="$(swiftshader)"
    # Older loaders know the second name only. The tests themselves see to it that this is the adapter that they are on.
    # SwiftShader compiles a kernel anew for each engine, a third of a second, so tests that make engines by the hundred, of random
    # scenes, are left to lavapipe.
    VK_DRIVER_FILES="$driver" VK_ICD_FILENAMES="$driver" TAUTLINE_TEST_ADAPTER=SwiftShader cargo test --release --test all -- \
        arithmetic:: batch:: cli::adapters:: cli::engines:: decide:: shader:: \
        drag::a_device drag::most drag::no_sign drag::pieces drag::ropes drag::traces drag::walls \
        engine_table::golden engine_table::what_suits engine_table::windows engine_table::forgetting engine_table::a_stopped \
        fast::a_contact fast::a_fast_engine fast::lists fast::no_trace fast::points \
        filter::devices filter::no_walk filter::without rays::
fi
say "a study's page in a browser"
tests/page.sh
say "a trace that plays in a browser"
tests/animation.sh
say "kills at random system calls, and a full disk"
tests/faults.sh 12
say "the Python package"
tests/python.sh
say "one study over many machines: Slurm, GNU parallel and Dask"
# On Debian all of them can be had, so there none may be left out.
if command -v apt-get >/dev/null; then export SCHEDULERS="slurm parallel dask"; fi
tests/cluster.sh
