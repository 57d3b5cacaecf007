#!/usr/bin/env python3
"""Where arches put the boundary of no erosion: D15F/D85B at which 7.5 % of the base erodes in the first run, by law.

    scripts/studies/arches.py --out results/arches.csv [--binary target/release/voidwalk] [--threads 2]

Filters from the library of packings, bases linear on semi-log paper, 10 x 10 x 60 voids, 5 replicates at each ratio.
Each ratio is bracketed by a factor of 1.25 and halved to 2 %, up to 13. Cells that are in the CSV already are not walked again.
"""

import argparse
import csv
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

FILTERS = [(1.5, "loose"), (3, "loose"), (1.5, "dense"), (3, "dense")]
BASES = [1.5, 3]
LAWS = ["none", "marin-2018", "zuriguel-2005", "critical-3"]
CONCENTRATIONS = [0.006, 0.02, 0.06, 0.2, 0.6]
COLUMNS = ["filter_cu", "density", "base_cu", "law", "concentration", "walked_concentration", "holds_to", "erodes_from",
           "no_erosion", "arched_percent", "seconds"]
THRESHOLD = 0.075
CLOSE = 1.02
MOST = 13.0


def cells():
    """Every filter and base by law at the concentration that is worked out, then one pair by concentration."""
    for filter_cu, density in FILTERS:
        for base_cu in BASES:
            for law in LAWS:
                yield filter_cu, density, base_cu, law, ""
    for base_cu in BASES[:1]:
        for concentration in CONCENTRATIONS:
            yield 1.5, "loose", base_cu, "marin-2018", concentration


class Walks:
    def __init__(self, options):
        self.binary, self.threads = options.binary, options.threads

    def eroded(self, cell, ratio):
        """Share of the mass that erodes in the first run, and what the outcome says of arches."""
        filter_cu, density, base_cu, law, concentration = cell
        settings = {
            "filter.library": density, "filter.cu": filter_cu, "filter.d0_mm": 1, "base.cu": base_cu,
            "base.d15f_over_d85b": round(ratio, 6), "network.nx": 10, "network.ny": 10, "network.nz": 60,
            "replicates": 5, "runs": 1, "record.sensitivity": "[]", "record.thickness": "[]", "engine": "expected",
            "walk.arching": law,
        }
        if concentration != "":
            settings["walk.concentration"] = concentration
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "s.toml"
            scene.write_text("")
            command = [self.binary, "run", scene, "--out", Path(folder) / "o", "-q", "--threads", self.threads]
            command += [part for name, value in settings.items() for part in ("--set", f"{name}={value}")]
            done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip())
            outcome = json.loads((Path(folder) / "o/outcome.json").read_text())
        runs = [replicate["runs"][0] for replicate in outcome["replicates"]]
        arched = sum(run.get("arched_mass_fraction") or 0 for run in runs) / len(runs)
        law = outcome.get("arching") or {}
        return outcome["summary"][0]["eroded_mass_fraction"]["mean"], arched, law.get("concentration")

    def boundary(self, cell):
        began = time.monotonic()
        holds, erodes, arched, walked = None, None, 0.0, None
        ratio = 4.0
        while holds is None or erodes is None or erodes[0] / holds[0] > CLOSE:
            share, of_arches, concentration = self.eroded(cell, ratio)
            if share < THRESHOLD:
                holds, arched = (ratio, share), of_arches
            else:
                erodes = (ratio, share)
            walked = concentration
            if holds and erodes:
                ratio = math.sqrt(holds[0] * erodes[0])
            else:
                ratio = ratio * 1.25 if holds else ratio / 1.25
            if ratio > MOST:
                break
        row = dict(zip(COLUMNS, cell)) | {"walked_concentration": walked, "arched_percent": round(100 * arched, 2)}
        row |= {"holds_to": round(holds[0], 3), "seconds": round(time.monotonic() - began, 1)}
        if erodes:
            low, high = holds[1], erodes[1]
            part = (THRESHOLD - low) / (high - low)
            row |= {"erodes_from": round(erodes[0], 3),
                    "no_erosion": round(holds[0] * (erodes[0] / holds[0]) ** part, 2)}
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--threads", default="2")
    options = parser.parse_args()
    rows = list(csv.DictReader(options.out.open())) if options.out.exists() else []
    there = {tuple(row[name] for name in COLUMNS[:5]) for row in rows}
    walks = Walks(options)
    with options.out.open("a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="")
        if not rows:
            writer.writeheader()
        for cell in cells():
            if tuple(str(part) for part in cell) in there:
                continue
            writer.writerow(walks.boundary(cell))
            file.flush()


if __name__ == "__main__":
    main()
