#!/usr/bin/env bash
# Regenerates every figure and number of the paper's reproduction:
#     scripts/paper.sh [FOLDER]
# Walks the plans of scripts/campaigns into FOLDER (default target/paper; what is done there is not walked again), writes FOLDER/report.html,
# figures/*.svg and statements.csv, and copies what lasts to results/paper. NO_COPY=1 leaves results/paper alone.
set -euo pipefail
cd "$(dirname "$0")/.."
out="${1:-target/paper}"
plans="paper paper-2.5 paper-capped paper-2.5-capped paper-published paper-published-2.5 overlap-0.5 kenney table3 one-size progress"
VOIDWALK_COMMIT=$(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
export VOIDWALK_COMMIT
cargo build --release --quiet
voidwalk=target/release/voidwalk
mkdir -p "$out"
begun=$(date +%s)
for plan in $plans; do
    echo "$plan" >&2
    "$voidwalk" campaign "scripts/campaigns/$plan.toml" --out "$out/$plan" --packings "$out/packings" >/dev/null
done
if [ ! -f "$out/percolation/percolation.json" ]; then
    # the paper's sizes and 100 realisations of each
    "$voidwalk" percolation --sizes 10,20,30,40,50,60,70,80 --realisations 100 --seed 1 --out "$out/percolation" >/dev/null
fi
"$voidwalk" report "$out"
minutes=$((($(date +%s) - begun + 59) / 60))
[ -n "${NO_COPY:-}" ] && exit 0

results=results/paper
rm -rf "$results"
mkdir -p "$results/figures" "$results/cases"
cp "$out/report.html" "$out/statements.csv" "$results/"
cp "$out"/figures/*.svg "$results/figures/"
for plan in $plans; do cp "$out/$plan/cases.csv" "$results/cases/$plan.csv"; done
cp "$out/percolation/percolation.csv" "$results/cases/percolation.csv"
{
    echo "# The paper's reproduction, $(date -u +%F)"
    echo
    echo "Made by \`scripts/paper.sh\` at commit $VOIDWALK_COMMIT on $(nproc) cores, $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs),"
    echo "in $minutes minutes (0 or 1: only the page was written again). Seeds: in the plans, scripts/campaigns; each case's own in cases/*.csv."
    echo
    echo "- \`report.html\`: the page, with every figure and statement."
    echo "- \`statements.csv\`: every number that the paper states, ours in every campaign, and the judgement."
    echo "- \`figures/\`: the figures. \`cases/\`: the ledger of each plan as a table."
} >"$results/README.md"
echo "$results"
