#!/usr/bin/env python3
"""Judges pairs of a real soil and a common filter, and counts the answers: decided, green, against practice, seconds.

    scripts/studies/real_pairs.py SOILS.json --out pairs.csv [--binary target/release/voidwalk] [--pairs 300]

SOILS.json is a list of {"id", "points_mm_percent"}. The pairs are drawn with a fixed seed; pairs that are in the CSV
already are not judged again. `--summary` prints the table of a CSV alone.
"""

import argparse
import csv
import json
import math
import random
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path
from statistics import median

# The middle of each band; sizes in mm.
FILTERS = {
    "C33 sand": [(0.15, 6), (0.3, 20), (0.6, 42.5), (1.18, 67.5), (2.36, 90), (4.75, 97.5), (9.5, 100)],
    "No. 8 stone": [(1.18, 2.5), (2.36, 5), (4.75, 20), (9.5, 92.5), (12.5, 100)],
    "No. 57 stone": [(2.36, 2.5), (4.75, 5), (12.5, 42.5), (25, 97.5), (37.5, 100)],
    "fine sand": [(0.075, 2), (0.15, 20), (0.3, 70), (0.6, 100)],
    "2-4 mm gravel": [(2, 0), (4, 100)],
    "4.75-37.5 mm gravel": [(4.75, 0), (37.5, 100)],
}
WITHIN = "within checked range"
COLUMNS = [
    "soil", "filter", "fines_percent", "verdict", "confidence", "origin", "eroded_percent", "design_met",
    "no_erosion_limit_mm", "no_erosion_met", "d15f_mm", "first_finding", "group", "probability", "seconds", "error",
]


def fines(points):
    """Percent finer than 0.075 mm; nothing where no sieve says."""
    for (a, p), (b, q) in zip(points, points[1:]):
        if a <= 0.075 <= b:
            return p + (q - p) * math.log(0.075 / a) / math.log(b / a)
    return 0.0 if points[0][0] > 0.075 and points[0][1] == 0 else None


def table(path, points):
    path.write_text("size_mm,percent_finer\n" + "".join(f"{d},{p}\n" for d, p in points))


def judge(binary, soil, name, extra):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        table(folder / "base.csv", soil["points_mm_percent"])
        table(folder / "filter.csv", FILTERS[name])
        command = [binary, "judge", folder / "base.csv", folder / "filter.csv", "--quick", "--json"]
        command += ["--out", folder / "out", *extra]
        began = time.monotonic()
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        seconds = time.monotonic() - began
    row = {"soil": soil["id"], "filter": name, "seconds": round(seconds, 2)}
    row["fines_percent"] = fines(soil["points_mm_percent"])
    if done.returncode != 0:
        return row | {"error": done.stderr.strip().splitlines()[-1][:200] if done.stderr.strip() else done.returncode}
    out = json.loads(done.stdout)
    rules = {rule["id"]: rule for rule in out["rules"]}
    tests, design = rules.get("foster-fell-no-erosion", {}), rules.get("sherard-dunnigan", {})
    against = [finding["id"] for finding in out.get("findings", []) if finding["against"]]
    return row | {
        "verdict": out["verdict"],
        "confidence": out["confidence"],
        "origin": out.get("constrictions", {}).get("origin", ""),
        "eroded_percent": out["eroded_percent"]["mean"] if isinstance(out.get("eroded_percent"), dict) else "",
        "design_met": design.get("met"),
        "no_erosion_limit_mm": tests.get("limit"),
        "no_erosion_met": tests.get("met"),
        "d15f_mm": tests.get("value"),
        "first_finding": against[0] if against else "",
        "group": (out.get("evidence") or {}).get("group", ""),
        "probability": (out.get("evidence") or {}).get("probability_no_erosion", ""),
    }


def summary(rows):
    """The table of a CSV, in Markdown."""
    done = [row for row in rows if row["verdict"]]
    decided = [row for row in done if row["verdict"] != "undecided"]
    green = [row for row in done if row["verdict"] == "no erosion" and row["confidence"] == WITHIN]
    holds = [row for row in decided if row["verdict"] == "no erosion"]
    unsafe = [row for row in holds if row["no_erosion_met"] == "False"]
    seconds = sorted(float(row["seconds"]) for row in done)
    lines = [
        ("pairs", len(rows)),
        ("refused", len(rows) - len(done)),
        ("decided", f"{len(decided)} ({100 * len(decided) / max(1, len(done)):.0f} %)"),
        ("no / some / continuing erosion", " / ".join(
            str(sum(row["verdict"] == f"{name} erosion" for row in decided)) for name in ["no", "some", "continuing"])),
        ("within the checked range", sum(row["confidence"] == WITHIN for row in done)),
        ("green (no erosion, within)", len(green)),
        ("green where tests found erosion", sum(row["no_erosion_met"] == "False" for row in green)),
        ("no erosion where tests found erosion, said to be against practice", len(unsafe)),
        ("seconds: median, most", f"{median(seconds):.1f}, {seconds[-1]:.1f}" if seconds else "-"),
    ]
    print("\n".join(f"| {what} | {value} |" for what, value in lines))
    known = [row for row in decided if row["no_erosion_met"] in ("True", "False")]
    alike = sum((row["verdict"] == "no erosion") == (row["no_erosion_met"] == "True") for row in known)
    print(f"| same side of Foster and Fell's boundary of no erosion | {alike} of {len(known)} |")
    within = Counter(row["group"] for row in done if row["confidence"] == WITHIN)
    print("within the checked range, by group:", dict(within))
    print("origins:", dict(Counter(row["origin"] for row in done)))
    undecided = Counter(row["first_finding"] for row in done if row["verdict"] == "undecided")
    print("undecided by:", undecided.most_common(8))
    print("confidence:", Counter(row["confidence"] for row in done).most_common())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("soils", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--pairs", type=int, default=300)
    parser.add_argument("--summary", action="store_true")
    options, extra = parser.parse_known_args()
    rows = list(csv.DictReader(options.out.open())) if options.out.exists() else []
    if not options.summary:
        soils = json.loads(options.soils.read_text())
        draw = random.Random(3600)
        pairs = [(soil, name) for soil in draw.sample(soils, min(len(soils), options.pairs)) for name in FILTERS]
        pairs = draw.sample(pairs, options.pairs)
        there = {(row["soil"], row["filter"]) for row in rows}
        with options.out.open("a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, restval="")
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
