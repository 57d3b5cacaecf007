#!/usr/bin/env python3
"""Where arches put the boundary of no erosion: D15F/D85B at which 7.5 % of the base erodes in the first run, by law.

    scripts/studies/arches.py --out results/arches.csv [--law marin-2018] [--binary target/release/voidwalk] [--threads 2]

Filters from the library of packings, bases linear on semi-log paper, 10 x 10 x 60 voids unless the cell says otherwise, five replicates
at each ratio. A ratio is bracketed by a factor of 1.25 and halved to 2 %, up to 16. `no_erosion` is where the mean crosses 7.5 %, `least`
and `most` where the first and the last of the five replicates do, by interpolation between the ratios walked. Cells that are in the CSV
already are not walked again. `--law`: only cells of these laws. `concentration`: of `marin-2018`, the solids fraction of the suspension
that enters the filter.
"""

import csv
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

import common

LAWS = ["none", "marin-2018", "zuriguel-2005", "critical-3"]
FILTERS = [(1.5, "loose"), (1.5, "dense"), (3, "loose"), (3, "dense"), (6, "loose"), (6, "dense")]
BASES = [1.5, 3, 4.5]
# Solids fractions of the suspension that enters the filter.
CONCENTRATIONS = [0.005, 0.02, 0.05, 0.15]
CELL = ["filter_cu", "density", "base_cu", "law", "concentration", "layers", "across"]
COLUMNS = CELL + ["holds_to", "erodes_from", "no_erosion", "least", "most", "arched_percent", "seconds"]
THRESHOLD = 0.075
CLOSE = 1.02
MOST = 16.0
ERODED = ["eroded_percent", "least", "most"]


def concentrations(law):
    """The concentrations that are stated with a law; none with those of dense flow."""
    return CONCENTRATIONS if law == "marin-2018" else [""]


def cells():
    """One pair by thickness and width of the network; then beads, and every filter and base, by law."""
    pairs = [(1.2, "dense", 1.2), *((*of, base_cu) for base_cu in BASES for of in FILTERS)]
    for law in LAWS[:2]:
        for concentration in concentrations(law):
            for layers, across in [(30, 10), (120, 10), (60, 20)]:
                yield 1.5, "loose", 1.5, law, concentration, layers, across
    for pair in pairs:
        for law in LAWS:
            for concentration in concentrations(law):
                yield *pair, law, concentration, 60, 10


class Walks:
    """Walks of cells, whose parts have these names, until a boundary is known so closely."""

    names, close = CELL, CLOSE

    def __init__(self, options):
        self.binary, self.threads = options.binary, options.threads

    def settings(self, cell, ratio):
        """What differs from the built-in scene."""
        filter_cu, density, base_cu, law, concentration, layers, across = cell
        settings = {
            "filter.library": density, "filter.cu": filter_cu, "filter.d0_mm": 1, "base.cu": base_cu,
            "base.d15f_over_d85b": round(ratio, 6), "network.nx": across, "network.ny": across, "network.nz": layers,
            "replicates": 5, "runs": 1, "record.sensitivity": "[]", "record.thickness": "[]", "engine": "expected",
            "walk.arching": law,
        }
        if concentration != "":
            settings["walk.concentration"] = concentration
        return settings

    def outcome(self, settings, threads=None):
        """The outcome of a run of the built-in scene with these settings."""
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "s.toml"
            scene.write_text("")
            command = [self.binary, "run", scene, "--out", Path(folder) / "o", "-q", "--threads", threads or self.threads]
            done = subprocess.run([str(part) for part in command + common.sets(settings)], capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip())
            return json.loads((Path(folder) / "o/outcome.json").read_text())

    def eroded(self, cell, ratio):
        """Shares of the mass that erode in the first runs, and what lies in arches then."""
        outcome = self.outcome(self.settings(cell, ratio))
        runs = [replicate["runs"][0] for replicate in outcome["replicates"]]
        arched = sum(run.get("arched_mass_fraction") or 0 for run in runs) / len(runs)
        return [run["eroded_mass_fraction"] for run in runs], arched

    def boundary(self, cell):
        began = time.monotonic()
        holds, erodes, arched, walked = None, None, 0.0, {}
        # Near where arches of this law may put it, which saves walks of fine bases.
        ratio = 6.0 if cell[3] == "marin-2018" else 4.0
        while holds is None or erodes is None or erodes / holds > self.close:
            shares, of_arches = self.eroded(cell, ratio)
            walked[ratio] = shares
            if sum(shares) / len(shares) < THRESHOLD:
                holds, arched = ratio, of_arches
            else:
                erodes = ratio
            if holds and erodes:
                ratio = math.sqrt(holds * erodes)
            else:
                ratio = ratio * 1.25 if holds else ratio / 1.25
            if ratio > MOST:
                break
        row = dict(zip(self.names, cell)) | {"arched_percent": round(100 * arched, 2)}
        row |= {"holds_to": round(holds, 3), "seconds": round(time.monotonic() - began, 1)}
        single = [crossing({at: shares[k] for at, shares in walked.items()}) for k in range(len(shares))]
        single = [at if at else math.inf for at in single]
        if erodes:
            mean = crossing({at: sum(shares) / len(shares) for at, shares in walked.items()})
            row |= {"erodes_from": round(erodes, 3), "no_erosion": round(mean, 2)}
        if min(single) < math.inf:
            row |= {"least": round(min(single), 2)}
        if max(single) < math.inf:
            row |= {"most": round(max(single), 2)}
        return row


def eroded_of(runs):
    """What erodes in these runs, in percent: mean, least and most."""
    shares = [100 * run["eroded_mass_fraction"] for run in runs]
    values = sum(shares) / len(shares), min(shares), max(shares)
    return {name: round(value, 2) for name, value in zip(ERODED, values)}


def crossing(shares):
    """The least ratio at which what erodes crosses the threshold, between ratios walked; None where it does not."""
    ratios = sorted(shares)
    if shares[ratios[0]] >= THRESHOLD:
        return ratios[0]
    for low, high in zip(ratios, ratios[1:]):
        if shares[high] >= THRESHOLD:
            part = (THRESHOLD - shares[low]) / (shares[high] - shares[low])
            return low * (high / low) ** part
    return None


def each(out, names, columns, cells, row_of):
    """Appends the row of each cell that the CSV does not have yet."""
    rows = list(csv.DictReader(out.open())) if out.exists() else []
    there = {tuple(row[name] for name in names) for row in rows}
    with out.open("a", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="", extrasaction="ignore")
        if not rows:
            writer.writeheader()
        for cell in cells:
            if tuple(str(part) for part in cell) in there:
                continue
            writer.writerow(row_of(cell))
            file.flush()


def main():
    parser = common.parser(__doc__, threads="2")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--law", nargs="*", default=LAWS, choices=LAWS)
    options = parser.parse_args()
    each(options.out, CELL, COLUMNS, (cell for cell in cells() if cell[3] in options.law), Walks(options).boundary)


if __name__ == "__main__":
    main()
