#!/usr/bin/env bash
# Walks every combination of the paper's campaign with engine particles and with engine counts on the same small networks, and compares
# what erodes, replicate by replicate:
#     scripts/studies/compare_engines.sh [FOLDER]        (default target/engines; what is done there is not walked again)
# Prints a Markdown table.
set -euo pipefail
cd "$(dirname "$0")/../.."
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
count = min(len(pair["counts"]) for pair in figures.values())
print("| figure | run | combinations | t | replicates | mean difference by the mean | largest absolute t of one combination |")
print("|---|---|---|---|---|---|---|")
for name in names:
    for run in (0, 1):
        # Combinations share their networks, so it is the replicates that are independent: one figure each, the mean over the
        # combinations of the difference in units of its own scatter.
        by_replicate, ts, relative = [0.0] * count, [], []
        for pair in figures.values():
            both = zip(pair["particles"], pair["counts"])
            differences = [p["runs"][run][name] - c["runs"][run][name] for p, c in both]
            spread = statistics.stdev(differences)
            mean = statistics.mean(c["runs"][run][name] for c in pair["counts"])
            if spread == 0 or mean == 0:
                continue
            ts.append(statistics.mean(differences) / spread * math.sqrt(count))
            relative.append(statistics.mean(differences) / mean)
            by_replicate = [sum(two) for two in zip(by_replicate, (d / spread for d in differences))]
        error = statistics.stdev(by_replicate) / math.sqrt(count)
        t = statistics.mean(by_replicate) / error
        print(f"| {name} | {run + 1} | {len(ts)} | {t:+.2f} | {count} | {100 * statistics.mean(relative):+.2f} % | {max(map(abs, ts)):.2f} |")
PY
