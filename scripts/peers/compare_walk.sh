#!/bin/sh
# Builds and times the plain walks of benches/baseline beside the library's, in turns, and prints the ratios. NumPy and
# Numba are installed into target/venv-compare.
# Usage: scripts/peers/compare_walk.sh [N ...]   (default 2000000 20000000; 200000000 takes half an hour). Whole runs of engine counts
# are always among them.
set -eu
cd "$(dirname "$0")/../.."
build=target/compare
mkdir -p "$build"
g++ -O3 -march=native -o "$build/walk_cpp" benches/baseline/walk.cpp
rustc --edition 2024 -C opt-level=3 -C target-cpu=native -o "$build/walk_rust" benches/baseline/walk.rs
if [ ! -x target/venv-compare/bin/python ]; then
    python3 -m venv target/venv-compare
    target/venv-compare/bin/pip install --quiet numpy numba
fi
built() { # BENCH: its program
    cargo bench --bench "$1" --no-run --message-format=json 2>/dev/null |
        sed -n 's/.*"name":"'"$1"'".*"executable":"\([^"]*\)".*/\1/p' | tail -1
}
[ $# -gt 0 ] || set -- 2000000 20000000
target/venv-compare/bin/python scripts/peers/compare_walk.py "$build" "$(built compare_walk)" "$(built scale_walk)" "$@"
