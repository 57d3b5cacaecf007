#!/bin/sh
# Fuzzes every reader for so many seconds each, one after another, from the seeds in tests/seeds; what was found grows in
# tests/fuzz/corpus. Ends at the first find and names it: a panic, a hang of 10 s, or more than 256 MB of memory.
# Takes the nightly toolchain where there is one, else lets the stable one do what nightly may; installs cargo-fuzz where it
# is missing.
# Usage: scripts/checks/fuzz.sh [SECONDS] [TARGET...]
set -eu
cd "$(dirname "$0")/../../tests/fuzz"
seconds=600
case ${1:-} in [0-9]*) seconds=$1 && shift ;; esac
[ $# -gt 0 ] || set -- scene sieve soil curve network columns arrays packing graph checkpoint ledger request
cargo +nightly --version >/dev/null 2>&1 && toolchain=+nightly || export RUSTC_BOOTSTRAP=1
cargo fuzz --version >/dev/null 2>&1 || cargo install --locked cargo-fuzz
for target in "$@"; do
    mkdir -p "corpus/$target"
    # Threads of the page that are about to begin or end look like a leak.
    [ "$target" != request ] && leaks=1 || leaks=0
    nice cargo ${toolchain:-} fuzz run --fuzz-dir . "$target" "corpus/$target" "../seeds/$target" -- -detect_leaks=$leaks \
        -max_total_time="$seconds" -timeout=10 -malloc_limit_mb=256 -rss_limit_mb=2048 -print_final_stats=1
done
