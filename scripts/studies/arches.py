#!/usr/bin/env python3
"""Where arches put the boundary of no erosion: D15F/D85B at which 7.5 % of the base erodes in the first run, by law.

    scripts/studies/arches.py --out results/arches.csv [--by-void results/arches-by-void.csv] [--shares results/arches-shares.csv]
                              [--law marin-2018] [--binary target/release/voidwalk] [--threads 2]

Filters from the library of packings, bases linear on semi-log paper, 10 x 10 x 60 voids unless the cell says otherwise, five replicates at each
ratio. A ratio is bracketed by a factor of 1.25 and halved to 2 %, up to 16. `no_erosion` is where the mean crosses 7.5 %, `least` and `most` where
the first and the last of the five replicates do, by interpolation between the ratios walked. Cells that are in the CSV already are not walked again.
`--law`: only cells of these laws.

`--by-void`: what erodes by `marin-2018` where the concentration is that of the first layer and where it is that of each void, by each size that may
count; 10 x 10 voids across, five replicates.

`--shares`: what erodes by `marin-2018` ratio by ratio in the cells whose boundary lies within the range of tests, so that a stricter limit than 7.5 % can
be read; each as 10 x 10 x 60 voids, five replicates.
"""

import argparse
import csv
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

LAWS = ["none", "marin-2018", "zuriguel-2005", "critical-3"]
FILTERS = [(1.5, "loose"), (1.5, "dense"), (3, "loose"), (3, "dense"), (6, "loose"), (6, "dense")]
BASES = [1.5, 3, 4.5]
CONCENTRATIONS = [0.006, 0.02, 0.06, 0.2, 0.6]
CELL = ["filter_cu", "density", "base_cu", "law", "concentration", "layers", "across"]
COLUMNS = CELL + ["walked_concentration", "holds_to", "erodes_from", "no_erosion", "least", "most", "arched_percent", "seconds"]
THRESHOLD = 0.075
CLOSE = 1.02
MOST = 16.0


# Where the concentration comes from, and which size counts.
ARRIVALS = [("first layer", ""), ("by-void", "own"), ("by-void", "void-mean"), ("by-void", "void-d85")]
BY_VOID_CELL = ["filter_cu", "density", "base_cu", "layers", "d15f_over_d85b", "concentration", "arch_size"]
ERODED = ["eroded_percent", "least", "most"]
BY_VOID_COLUMNS = BY_VOID_CELL + ERODED
# Cells within the range of tests, and the ratios at which they are walked, its edges among them.
SHARES_CELL = ["filter_cu", "density", "base_cu", "law", "d15f_over_d85b"]
RATIOS = [4.0, 4.5, 5.0, 5.5, 6.0, 6.4, 6.8, 7.5, 8.2, 9.0, 10.0]


def shares_cells():
    """One filter, three bases, ratio by ratio."""
    return ((1.5, "loose", base_cu, "marin-2018", ratio) for base_cu in BASES for ratio in RATIOS)


def by_void_cells():
    """One filter, two bases, two thicknesses, by where the concentration comes from."""
    for base_cu, layers, ratio in [(1.5, 30, 6), (1.5, 30, 5), (3, 30, 5), (1.5, 60, 9), (3, 60, 8)]:
        for concentration, size in ARRIVALS:
            yield 1.5, "loose", base_cu, layers, ratio, concentration, size


def cells():
    """One pair by thickness and width of the network; then every filter and base by law, beads, and one pair by concentration."""
    for law in LAWS[:2]:
        for layers, across in [(30, 10), (120, 10), (60, 20)]:
            yield 1.5, "loose", 1.5, law, "", layers, across
    for law in LAWS:
        yield 1.2, "dense", 1.2, law, "", 60, 10
    for base_cu in BASES:
        for filter_cu, density in FILTERS:
            for law in LAWS:
                # The void ratio of this filter is not known here; `laboratory.py` sets the concentration.
                if (filter_cu, law) != (6, "marin-2018"):
                    yield filter_cu, density, base_cu, law, "", 60, 10
        if base_cu == BASES[0]:
            for concentration in CONCENTRATIONS:
                yield 1.5, "loose", base_cu, "marin-2018", concentration, 60, 10


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
            command += [part for name, value in settings.items() for part in ("--set", f"{name}={value}")]
            done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip())
            return json.loads((Path(folder) / "o/outcome.json").read_text())

    def eroded(self, cell, ratio):
        """Shares of the mass that erode in the first runs, and what the outcome says of arches."""
        outcome = self.outcome(self.settings(cell, ratio))
        runs = [replicate["runs"][0] for replicate in outcome["replicates"]]
        arched = sum(run.get("arched_mass_fraction") or 0 for run in runs) / len(runs)
        law = outcome.get("arching") or {}
        return [run["eroded_mass_fraction"] for run in runs], arched, law.get("concentration")

    def by_void(self, cell):
        """What erodes, in percent: mean, least and most."""
        *pair, layers, ratio, concentration, size = cell
        settings = self.settings((*pair, "marin-2018", "", layers, 10), ratio)
        if size:
            settings |= {"walk.concentration": concentration, "walk.arch_size": size}
        return self.eroded_row(BY_VOID_CELL, cell, settings)

    def shares(self, cell):
        """What erodes at one ratio, in percent: mean, least and most."""
        *of, ratio = cell
        return self.eroded_row(SHARES_CELL, cell, self.settings((*of, "", 60, 10), ratio))

    def eroded_row(self, names, cell, settings):
        return dict(zip(names, cell)) | eroded_of([replicate["runs"][0] for replicate in self.outcome(settings)["replicates"]])

    def boundary(self, cell):
        began = time.monotonic()
        holds, erodes, arched, walked = None, None, 0.0, {}
        # Near where arches of this law put it, which saves walks of fine bases.
        ratio = 8.0 if cell[3] == "marin-2018" else 4.0
        while holds is None or erodes is None or erodes / holds > self.close:
            shares, of_arches, concentration = self.eroded(cell, ratio)
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
        row = dict(zip(self.names, cell)) | {"walked_concentration": concentration, "arched_percent": round(100 * arched, 2)}
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--by-void", type=Path)
    parser.add_argument("--shares", type=Path)
    parser.add_argument("--law", nargs="*", default=LAWS, choices=LAWS)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--threads", default="2")
    options = parser.parse_args()
    if options.by_void:
        each(options.by_void, BY_VOID_CELL, BY_VOID_COLUMNS, by_void_cells(), Walks(options).by_void)
    if options.shares:
        each(options.shares, SHARES_CELL, SHARES_CELL + ERODED, shares_cells(), Walks(options).shares)
    if options.out:
        each(options.out, CELL, COLUMNS, (cell for cell in cells() if cell[3] in options.law), Walks(options).boundary)


if __name__ == "__main__":
    main()
