#!/usr/bin/env bash
# Walks every combination of the paper's campaign with engine particles and with engine counts on the same small networks, and compares
# what erodes, replicate by replicate:
#     scripts/compare_engines.sh [FOLDER]        (default target/engines; what is done there is not walked again)
# Prints a Markdown table.
set -euo pipefail
cd "$(dirname "$0")/.."
out="${1:-target/engines}"
cargo build --release --quiet
target/release/voidwalk campaign scripts/campaigns/engines.toml --out "$out" >/dev/null
python3 - "$out" <<'PY'
import json, math, statistics, sys

out = sys.argv[1]
cases = [json.loads(line) for line in open(f"{out}/ledger.jsonl")]
figures = {}
for case in cases:
    outcome = json.load(open(f"{out}/{case['folder']}/outcome.json"))
    key = tuple(level for factor, level in case["levels"].items() if factor != "engine")
    figures.setdefault(key, {})[case["levels"]["engine"]] = outcome["replicates"]
names = ["eroded_mass_fraction", "eroded_number_fraction", "blocked_fraction", "retained_per_void", "increments"]
print("| figure | run | combinations | mean of t | its standard deviation | largest absolute t | expected sd | smallest difference seen at 3 sigma, median |")
print("|---|---|---|---|---|---|---|---|")
for name in names:
    for run in (0, 1):
        ts, seen = [], []
        for pair in figures.values():
            both = zip(pair["particles"], pair["counts"])
            differences = [p["runs"][run][name] - c["runs"][run][name] for p, c in both]
            spread = statistics.stdev(differences)
            if spread > 0:
                error = spread / math.sqrt(len(differences))
                ts.append(statistics.mean(differences) / error)
                seen.append(3 * error)
        degrees = len(differences) - 1
        print(f"| {name} | {run + 1} | {len(ts)} | {statistics.mean(ts):+.3f} | {statistics.stdev(ts):.3f} | {max(map(abs, ts)):.2f} "
              f"| {math.sqrt(degrees / (degrees - 2)):.3f} | {statistics.median(seen):.2g} |")
PY
