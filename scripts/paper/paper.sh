#!/usr/bin/env bash
# Regenerates every figure and number of the paper's reproduction:
#     scripts/paper/paper.sh [FOLDER]
# Walks the plans of scripts/campaigns, and those that plans.py makes of them, into FOLDER (default target/paper; what is done there is not
# walked again), writes FOLDER/report.html, figures/*.svg and statements.csv, and copies what lasts to results/paper; results/paper.md is written by hand.
# PAGE_ONLY=1 walks nothing and takes what FOLDER holds; NO_COPY=1 leaves results/paper alone.
set -euo pipefail
cd "$(dirname "$0")/../.."
out="${1:-target/paper}"
plans="paper paper-hull paper-inverse kenney table3 progress one-size paper-2.5 paper-capped paper-2.5-capped paper-published"
plans="$plans paper-published-2.5 overlap-0.5"
cargo build --release --workspace --bins --quiet
voidwalk=target/release/voidwalk
mkdir -p "$out"
scripts/paper/plans.py "$out/plans"
cp scripts/campaigns/*.toml "$out/plans/"
if [ -z "${PAGE_ONLY:-}" ]; then
    for plan in $plans; do
        echo "$plan" >&2
        "$voidwalk" campaign "$out/plans/$plan.toml" --out "$out/$plan" --packings "$out/packings" >/dev/null
    done
    if ! grep -q 40x40x60 "$out/percolation/percolation.csv" 2>/dev/null; then
        # the paper's sizes, the lattice that the paper walks, and 100 realisations of each
        "$voidwalk" percolation --sizes 10,20,30,40,40x40x60,50,60,70,80 --realisations 100 --seed 1 --quiet --overwrite --out "$out/percolation"
    fi
    if [ ! -f "$out/constrictions/constrictions.json" ]; then
        # the grains that overlap-0.5 packed, with voids merged at our own overlap
        "$voidwalk" constrictions "$out"/packings/cu1.5-*/grains.csv --out "$out/constrictions" >/dev/null
    fi
fi
scripts/paper/page.py "$out"
[ -n "${NO_COPY:-}" ] && exit 0

results=results/paper
rm -rf "$results"
mkdir -p "$results/figures" "$results/cases"
cp "$out/report.html" "$out/statements.csv" "$results/"
cp "$out"/figures/*.svg "$results/figures/"
{
    echo "plan,cases_walked,of,replicates,minutes,commit"
    for plan in $plans; do
        [ -f "$out/$plan/ledger.jsonl" ] || continue
        cp "$out/$plan/cases.csv" "$results/cases/$plan.csv"
        python3 - "$plan" "$out/$plan/ledger.jsonl" "$("$voidwalk" campaign "$out/plans/$plan.toml" --list | wc -l)" <<'PY'
import csv, json, sys
lines = [json.loads(line) for line in open(sys.argv[2])]
minutes = sum(line["made"]["seconds"] for line in lines) / 60
commits = ", ".join(sorted({str(line["commit"]) for line in lines}))
row = [sys.argv[1], len(lines), sys.argv[3], min(line["replicates"] for line in lines), f"{minutes:.1f}", commits]
csv.writer(sys.stdout, lineterminator="\n").writerow(row)
PY
    done
} >"$results/plans.csv"
echo "results/paper.md names day and machine: $(date -u +%F), $(nproc) cores, $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs)"
cp "$out/percolation/percolation.csv" "$results/cases/percolation.csv" 2>/dev/null || true
du -sh "$results"
