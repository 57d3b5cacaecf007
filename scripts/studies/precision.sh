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
names = list(studies)
columns = lambda each: " | ".join(f"{name}: {what}" for name in names for what in each)
lines += ["## Scatter of a scene", "", "Eroded mass in percent, and the standard deviation of replicates in points. Time and merit: `sampling.csv`.", "",
          f"| line | {columns(['eroded', 'standard deviation'])} |", "|---|" + "---|---|" * len(names)]
scatter = {name: {f"{line['variant']}, {line['networks']}": line for line in study["sampling"]["lines"]} for name, study in studies.items()}
for key in dict.fromkeys(key for rows in scatter.values() for key in rows):
    cells = []
    for line in (rows.get(key) for rows in scatter.values()):
        cells += [f"{100 * line['mean']:.2f}", f"{100 * line['sd']:.3f} ({100 * line['sd_low']:.3f} to {100 * line['sd_high']:.3f})"] if line else ["", ""]
    lines.append(f"| {key} | {' | '.join(cells)} |")
lines += ["", "## Biases of the eroded mass", "", "Percentage points, with the 95 % interval. Replicates and time: `bias.csv`.", "",
          f"| setting | {' | '.join(names)} |", "|---|" + "---|" * len(names)]
biases = {name: {f"{row['factor']}: {row['level']}": row for row in study["bias"] if not row["reference"]} for name, study in studies.items()}
for key in dict.fromkeys(key for rows in biases.values() for key in rows):
    cells = []
    for row in (rows.get(key) for rows in biases.values()):
        interval = "" if row is None or row["bias_low"] is None else f" ({100 * row['bias_low']:+.2f} to {100 * row['bias_high']:+.2f})"
        cells.append(f"{100 * row['bias']:+.2f}{interval}" if row else "")
    lines.append(f"| {key} | {' | '.join(cells)} |")
lines += ["", "Packings: `built-in/packing.csv`; more grains and settings: `results/packing.md`.", ""]
(results / "README.md").write_text("\n".join(lines))
PY
du -sh "$results"
