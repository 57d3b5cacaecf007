#!/bin/sh
# The tests of every module that holds `unsafe`, in Miri, which stops at any access that is not allowed: the kernels of each
# instruction set on plain slices, and the columns (in memory: Miri maps no files).
# Accesses out of bounds, of freed or unset memory, and unaligned ones are found; not borrows that overlap: bitvec, which keeps addresses as
# numbers, passes neither of Miri's models of those. Threads that live as long as the program count as leaks, so leaks are not looked for.
# Needs a nightly toolchain; installs its part `miri` where that is missing.
# Usage: scripts/checks/miri.sh [portable] [avx2] [avx512]
set -eu
cd "$(dirname "$0")/../.."
cargo +nightly miri --version >/dev/null 2>&1 || rustup component add --toolchain nightly miri rust-src
[ $# -gt 0 ] || set -- portable avx2 avx512
for set in "$@"; do
    case $set in
    portable) features= ;;
    avx2) features="-C target-feature=+avx2,+popcnt" ;;
    avx512) features="-C target-feature=+avx2,+popcnt,+avx512f,+avx512bw,+avx512dq,+avx512vl" ;;
    *) echo "$set: portable, avx2 or avx512" >&2 && exit 2 ;;
    esac
    echo "== $set"
    RUSTFLAGS=$features MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-disable-stacked-borrows -Zmiri-permissive-provenance -Zmiri-ignore-leaks" CARGO_TARGET_DIR="target/miri-$set" \
        cargo +nightly miri test -p voidwalk-core --lib -- walk::kernel store::column
done
