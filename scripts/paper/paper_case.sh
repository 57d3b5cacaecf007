#!/usr/bin/env bash
# The one erosion figure that the paper gives in numbers: loose Cu 1.5 filter, Cu_b 4.5, D15F/D85B = 6.5, at most 2e8
# base particles: 43 % of the base eroded in the first run, 18 % in the second. Walks it on the full network, with and
# without the cap, at the packing's grains per void and at 2.5, and on a narrow network with the same base per start
# node by both engines. Writes a table to results/.
set -euo pipefail
cd "$(dirname "$0")/../.."
date=$(date -u +%F)
out=results/paper-case-$date.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo build --release --quiet

walk() { # name, settings ...
    local name=$1; shift
    local set=()
    for s in "$@"; do set+=(--set "$s"); done
    target/release/voidwalk run --quiet --json --out "$work/$name" --set base.cu=4.5 --set base.d15f_over_d85b=6.5 \
        --set 'record.sensitivity=[]' --set record.series_every=0 --set 'record.size_curves=[]' "${set[@]}" \
        >"$work/$name.json" 2>"$work/$name.err"
    python3 - "$name" "$work/$name.json" >>"$work/rows" <<'PY'
import json, sys
o = json.load(open(sys.argv[2]))
cell = lambda s: f"{100 * s['mean']:.1f}" + (f" ({100 * s['low']:.1f} to {100 * s['high']:.1f})" if s["low"] is not None else "")
runs = [cell(r["eroded_mass_fraction"]) for r in o["summary"]]
print(f"| {sys.argv[1]} | {o['engine']} | {o['grains_per_void']} | {o['n_base']:.4g} | {o['n_base_eq2']:.4g} | {len(o['replicates'])} | {runs[0]} | {runs[1]} | {o['verdict']} | {o['seconds']:.1f} |")
PY
    tail -1 "$work/rows"
}

walk full-capped-0.61 base.cap=2e8 replicates=5
walk full-capped-2.5 base.cap=2e8 filter.grains_per_void=2.5 replicates=5
walk full-0.61 replicates=5
walk full-2.5 filter.grains_per_void=2.5 replicates=5
walk narrow-counts network.nx=12 network.ny=12 base.cap=1.8e7 replicates=10
walk narrow-particles network.nx=12 network.ny=12 base.cap=1.8e7 replicates=2 engine=particles

{
    echo "# Cu_b 4.5 at D15F/D85B = 6.5, loose Cu 1.5 filter: the paper's 43 % then 18 %"
    echo
    echo "Made by \`scripts/paper/paper_case.sh\` on $date; commit $(git rev-parse --short=12 HEAD); seed 1;" \
        "$(nproc) cores, $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs)."
    echo "Eroded mass in % with the 95 % interval of the mean over replicates (new network and new walk each)."
    echo "Narrow: 12 x 12 x 60 voids, and as many base particles a start node as 2e8 on 40 x 40 x 60."
    echo
    echo "| case | engine | grains per void | N_base | Eq. (2) | replicates | first run | second run | verdict | seconds |"
    echo "|---|---|---|---|---|---|---|---|---|---|"
    cat "$work/rows"
} >"$out"
echo "$out"
