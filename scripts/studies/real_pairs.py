#!/usr/bin/env python3
"""Judges pairs of a real soil and a common filter, and counts the answers: decided, green, against practice, seconds.

    scripts/studies/real_pairs.py SOILS.json --out pairs.csv [--binary target/release/voidwalk] [--pairs 300]

SOILS.json is a list of {"id", "points_mm_percent"}. The pairs are drawn with a fixed seed; pairs that are in the CSV
already are not judged again. `--summary` prints the table of a CSV alone.
"""

import csv
import json
import math
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import common

# The middle of each band; sizes in mm.
FILTERS = {
    "C33 sand": [(0.15, 6), (0.3, 20), (0.6, 42.5), (1.18, 67.5), (2.36, 90), (4.75, 97.5), (9.5, 100)],
    "No. 8 stone": [(1.18, 2.5), (2.36, 5), (4.75, 20), (9.5, 92.5), (12.5, 100)],
    "No. 57 stone": [(2.36, 2.5), (4.75, 5), (12.5, 42.5), (25, 97.5), (37.5, 100)],
    "fine sand": [(0.075, 2), (0.15, 20), (0.3, 70), (0.6, 100)],
    "2-4 mm gravel": [(2, 0), (4, 100)],
    "4.75-37.5 mm gravel": [(4.75, 0), (37.5, 100)],
}
COLUMNS = [
    "soil", "filter", "fines_percent", "model", "headline", "origin", "eroded_percent", "design_met",
    "no_erosion_limit_mm", "no_erosion_met", "d15f_mm", "first_finding", "seconds", "error",
    "continuing_limit_mm", "dispersion",
]
# Distances from Foster and Fell's boundary of no erosion, as a factor of D15F, in which agreement is counted.
NEAR = (1.5, 2.0, 4.0)


def fines(points):
    """Percent finer than 0.075 mm; nothing where no sieve says."""
    for (a, p), (b, q) in zip(points, points[1:]):
        if a <= 0.075 <= b:
            return p + (q - p) * math.log(0.075 / a) / math.log(b / a)
    return 0.0 if points[0][0] > 0.075 and points[0][1] == 0 else None


def judge(binary, soil, name, extra):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        common.sheet(folder / "base.csv", soil["points_mm_percent"])
        common.sheet(folder / "filter.csv", FILTERS[name])
        command = [binary, "judge", folder / "base.csv", folder / "filter.csv", "--quick", "--json"]
        command += ["--out", folder / "out", *extra]
        began = time.monotonic()
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        seconds = time.monotonic() - began
    row = {"soil": soil["id"], "filter": name, "seconds": round(seconds, 2)}
    row["fines_percent"] = fines(soil["points_mm_percent"])
    if done.returncode != 0:
        said = done.stderr.replace(f"{folder}/", "").strip().splitlines()
        return row | {"error": said[-1][:200] if said else done.returncode}
    out = json.loads(done.stdout)
    rules = {rule["id"]: rule for rule in out["rules"]}
    tests, design = rules.get("foster-fell-no-erosion", {}), rules.get("sherard-dunnigan", {})
    notes = [note["id"] for note in out["notes"]]
    of_dispersion = [note for note in notes if note.startswith("dispers")]
    return row | {
        "model": out["model"]["class"],
        "headline": out.get("headline", ""),
        "origin": out.get("constrictions", {}).get("origin", ""),
        "eroded_percent": 100 * out["summary"][0]["eroded_mass_fraction"]["mean"],
        "design_met": design.get("met"),
        "no_erosion_limit_mm": tests.get("limit"),
        "no_erosion_met": tests.get("met"),
        "d15f_mm": tests.get("value"),
        "first_finding": notes[0] if notes else "",
        "continuing_limit_mm": rules.get("foster-fell-continuing", {}).get("limit"),
        "dispersion": of_dispersion[0] if of_dispersion else "",
    }


def by_distance(known):
    """How often walk and Foster and Fell's boundary of no erosion agree, by the distance of D15F from it."""
    far = [(abs(math.log(float(row["d15f_mm"]) / float(row["no_erosion_limit_mm"]))), row) for row in known]
    is_alike = lambda row: (row["model"] == "no erosion") == (row["no_erosion_met"] == "True")
    is_unsafe = lambda row: row["model"] == "no erosion" and row["no_erosion_met"] == "False"

    def line(what, rows):
        alike = sum(map(is_alike, rows))
        return (f"| {what} | {alike} of {len(rows)} ({100 * alike / max(1, len(rows)):.0f} %); "
                f"less strict {sum(map(is_unsafe, rows))} |")

    within = [line(f"within a factor of {near:g}", [row for f, row in far if f <= math.log(near)]) for near in NEAR]
    return within + [line(f"beyond a factor of {NEAR[-1]:g}", [row for f, row in far if f > math.log(NEAR[-1])])]


def summary(rows):
    """The numbers of `results/real-soils.md`, in Markdown; what is walked was called `verdict` in older CSV files."""
    rows = [row | {"model": row.get("model") or row.get("verdict", "")} for row in rows]
    done = [row for row in rows if row["model"]]
    decided = [row for row in done if row["model"] != "undecided"]
    known = [row for row in decided if row["no_erosion_met"] in ("True", "False")]
    unlike = [row for row in known if (row["model"] == "no erosion") != (row["no_erosion_met"] == "True")]
    less = sum(row["model"] == "no erosion" for row in unlike)
    print(f"| pairs; walked; decided | {len(rows)}; {len(done)}; {len(decided)} |")
    print(f"| soils | {len({row['soil'] for row in rows})} |")
    print(f"| seconds, median | {median(float(row['seconds']) for row in done):.1f} |")
    print(f"| same side of Foster and Fell's boundary of no erosion | {len(known) - len(unlike)} of {len(known)} |")
    print(f"| stricter; less strict | {len(unlike) - less}; {less} |")
    print("\n".join(by_distance(known)))


def refuse_other_columns(path):
    """Ends with 2 where the CSV has other columns: new rows would stand below the wrong names."""
    text = path.read_text() if path.exists() else ""
    header = next(csv.reader(text.splitlines()), None)
    if header not in (None, COLUMNS):
        print(f"{path}: its columns are {','.join(header)}, not {','.join(COLUMNS)}: name another --out", file=sys.stderr)
        sys.exit(2)


def main():
    parser = common.parser(__doc__)
    parser.add_argument("soils", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--pairs", type=int, default=300)
    parser.add_argument("--summary", action="store_true")
    options, extra = parser.parse_known_args()
    rows = list(csv.DictReader(options.out.open())) if options.out.exists() else []
    if not options.summary:
        refuse_other_columns(options.out)
        soils = json.loads(options.soils.read_text())
        draw = random.Random(3600)
        pairs = [(soil, name) for soil in draw.sample(soils, min(len(soils), options.pairs)) for name in FILTERS]
        pairs = draw.sample(pairs, options.pairs)
        there = {(row["soil"], row["filter"]) for row in rows}
        with options.out.open("a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
            if not rows:
                writer.writeheader()
            for soil, name in pairs:
                if (str(soil["id"]), name) not in there:
                    writer.writerow(judge(options.binary, soil, name, extra))
                    file.flush()
        rows = list(csv.DictReader(options.out.open()))
    summary(rows)


if __name__ == "__main__":
    main()
