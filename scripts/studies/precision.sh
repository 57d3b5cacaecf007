#!/usr/bin/env bash
# Error against run time, for the record: measures with `voidwalk precision` and writes results/precision.
#     scripts/studies/precision.sh [BUDGET]
# BUDGET is processor time [default: 12min]; on two quiet cores it takes half of that. Shipped set: the built-in scene in all tiers, and the paper's
# widest base (Cu_b 4.5 at D15F/D85B = 6.5, which is the one with the most particles) for scatter, biases and verdicts.
set -euo pipefail
cd "$(dirname "$0")/../.."
budget="${1:-12min}"
results=results/precision
work="${TMPDIR:-/tmp}/voidwalk-precision-$$"
trap 'rm -rf "$work"' EXIT
cargo build --release --quiet
voidwalk=target/release/voidwalk
wide="--set base.cu=4.5 --set base.d15f_over_d85b=6.5"
"$voidwalk" precision --seed 1 --budget "$budget" --out "$work/built-in"
# shellcheck disable=SC2086 # several words
"$voidwalk" precision --seed 1 --budget "$(python3 - "$budget" <<'PY'
import re, sys
units = {"s": 1, "min": 60, "m": 60, "h": 3600}
number, unit = re.fullmatch(r"([0-9.]+)\s*(s|min|m|h)", sys.argv[1]).groups()
print(f"{int(float(number) * units[unit] / 3) or 1}s")
PY
)" --tier sampling bias decision $wide --out "$work/wide-base"

rm -rf "$results"
mkdir -p "$results"
for study in built-in wide-base; do
    mkdir -p "$results/$study"
    (cd "$work/$study" && cp -r ./*.csv precision.html precision.json figures "$OLDPWD/$results/$study/")
done
python3 - "$results" <<'PY'
import csv, json, pathlib, sys

results = pathlib.Path(sys.argv[1])
studies = {name: json.loads((results / name / "precision.json").read_text()) for name in ["built-in", "wide-base"]}
first = studies["built-in"]
lines = [
    f"# Error against run time, {first['started'][:10]}",
    "",
    f"Made by `scripts/studies/precision.sh`; {first['machine']}; commit {first['commit']}; seed {first['seed']}.",
    "Times are processor time of one thread a run.",
    "",
    "| study | scene | base particles | budget, s | spent, s | wall, s |",
    "|---|---|---|---|---|---|",
]
for name, study in studies.items():
    spent = sum(seconds for _, seconds in study["spent"])
    lines.append(f"| [{name}]({name}/precision.html) | {study['scene']} | {study['n_base']} | {study['budget_s']:.0f} | {spent:.0f} | {study['seconds']:.0f} |")
lines += ["", "## Exact answers", "", "| line | most particles | error | of independent particles | slope | largest abs z of a network |", "|---|---|---|---|---|---|"]
rows = first["exact"]["rows"]
for slope in first["exact"]["slopes"]:
    row = [r for r in rows if (r["quantity"], r["engine"]) == (slope["quantity"], slope["engine"])][-1]
    z = "nothing drawn" if slope["largest_z"] is None else f"{slope['largest_z']:.2f}"
    lines.append(f"| {slope['quantity']}, {slope['engine']} | {row['particles']:.0e} | {row['error']:.2e} | {row['expected_error']:.2e} | {slope['slope']:.3f} | {z} |")
failed = [row["what"] for row in first["exact"]["closed"] if not row["holds"]]
lines += ["", f"{first['exact']['networks']} networks a line. Integers and closed forms: {len(first['exact']['closed'])}, failed: {len(failed)}.", ""]
lines += ["## Scatter of a scene", "", "| study | line | replicates | eroded, % | replicate SD, points | times the binomial | s a replicate | 1/(error^2 time) |", "|---|---|---|---|---|---|---|---|"]
for name, study in studies.items():
    for line in study["sampling"]["lines"]:
        merit = "" if line["merit"] is None else f"{line['merit']:.2e}"
        lines.append(f"| {name} | {line['variant']}, {line['networks']} | {line['replicates']} | {100 * line['mean']:.2f} | {100 * line['sd']:.3f} ({100 * line['sd_low']:.3f} to {100 * line['sd_high']:.3f}) | {line['sd'] / line['binomial']:.1f} | {line['core_seconds']:.3f} | {merit} |")
lines += ["", "## Biases of the eroded mass, percentage points", "", "| study | setting | replicates | bias | 95 % | s a replicate |", "|---|---|---|---|---|---|"]
for name, study in studies.items():
    for row in study["bias"]:
        if row["reference"]:
            continue
        interval = "" if row["bias_low"] is None else f"{100 * row['bias_low']:+.3f} to {100 * row['bias_high']:+.3f}"
        lines.append(f"| {name} | {row['factor']}: {row['level']} | {row['replicates']} | {100 * row['bias']:+.3f} | {interval} | {row['core_seconds']:.3f} |")
lines += ["", "Packings: `built-in/packing.csv`; the study of 21 November 2026 with more grains and settings is `results/packing.md`.", ""]
(results / "README.md").write_text("\n".join(lines))
PY
du -sh "$results"
