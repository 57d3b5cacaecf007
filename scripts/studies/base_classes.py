#!/usr/bin/env python3
"""Largest eroded particle over ten networks for a base of size classes, beside a continuous one: the table of `results/paper.md`.

    scripts/studies/base_classes.py [--binary target/release/voidwalk] [--threads 2]

Prints for each run the greatest less the least largest particle, in percent of the mean, and the mass that erodes.
"""

import argparse
import math
import tempfile
from pathlib import Path

from arches import Walks

BASES = [(3, 5), (1.5, 25)]
CLASSES = [10, 20, 50]
# A class is this narrow, relative to its size: a sieve table has no vertical step.
WIDTH = 1e-4
COMMON = {"filter.curve": '"cu1.5-loose"', "replicates": 10, "seed": 2016, "record.sensitivity": "[]", "record.thickness": "[]"}


def classes(curve, count):
    """A sieve table of so many classes, even over the logarithm of size, with the mass that the curve has between their edges."""

    def finer(size):
        pair = next((pair for pair in zip(curve, curve[1:]) if pair[0][0] <= size <= pair[1][0]), None)
        if pair is None:
            return 0.0 if size < curve[0][0] else 100.0
        (a, p), (b, q) = pair
        return p + (q - p) * math.log(size / a) / math.log(b / a)

    low, high = curve[0][0], curve[-1][0]
    edges = [low * (high / low) ** (k / count) for k in range(count + 1)]
    rows = [(math.sqrt(a * b), finer(a), finer(b)) for a, b in zip(edges, edges[1:])]
    return "size_mm,percent_finer\n" + "".join(f"{d * (1 - WIDTH):.9g},{p:.9g}\n{d:.9g},{q:.9g}\n" for d, p, q in rows)


def show(name, found):
    for run in (0, 1):
        largest = [replicate["runs"][run]["largest_eroded_mm"] for replicate in found["replicates"]]
        eroded = [100 * replicate["runs"][run]["eroded_mass_fraction"] for replicate in found["replicates"]]
        moved = 100 * (max(largest) - min(largest)) / (sum(largest) / len(largest))
        print(f"{name}, run {run + 1}: largest moves by {moved:.1f} %, eroded {sum(eroded) / len(eroded):.2f} %", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--threads", default="2")
    options = parser.parse_args()
    outcome = lambda settings: Walks(options).outcome(COMMON | settings)
    with tempfile.TemporaryDirectory() as scratch:
        for cu, percent in BASES:
            base = f"base Cu {cu} at Dc{percent}"
            settings = {"base.cu": cu, "base.d85_at_dc": percent, "base.dc_curve": '"cu1.5-loose"'}
            continuous = outcome(settings)
            show(f"{base}, continuous", continuous)
            for count in CLASSES:
                sheet = Path(scratch) / f"{count}.csv"
                sheet.write_text(classes(continuous["inputs"]["base"]["gradation"], count))
                show(f"{base}, {count} classes", outcome({"base.sieve": f'"{sheet}"'}))


if __name__ == "__main__":
    main()
