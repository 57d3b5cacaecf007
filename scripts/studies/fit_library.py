#!/usr/bin/env python3
"""Makes src/core/data/library.csv of the packings of `library_of_packings.py`, without a length: sizes by S50.

Shapes that are in the table and not among the packings stay in it.

    scripts/studies/fit_library.py FOLDER
"""

import math
import sys
from pathlib import Path

from common import lines_of
from library_of_packings import PERCENT

TABLE = Path(__file__).parents[2] / "src/core/data/library.csv"
SHAPE = [5, 20, 30, 70, 80, 95]
DENSITY = {"loose": 0, "medium": 0.5, "dense": 1}
HEAD = """\
# Constrictions of packings, by number: made by scripts/studies/library_of_packings.py and fit_library.py.
# Sizes are in units of the size below which half of the grains' surface lies; density is relative, 0 loose to 1 dense.
"""


def by_surface(points, percent):
    """The size below which this share of the surface lies; mass is even over the logarithm of size between points."""
    rows = [(a, b, (q - p) / math.log(b / a)) for (a, p), (b, q) in zip(points, points[1:]) if b > a and q > p]
    wanted = percent / 100 * sum(mass * (1 / a - 1 / b) for a, b, mass in rows)
    for a, b, mass in rows:
        of_row = mass * (1 / a - 1 / b)
        if wanted <= of_row:
            return 1 / (1 / a - wanted / mass)
        wanted -= of_row
    return rows[-1][1]


def table_head():
    """The names of the table's columns."""
    return ",".join(["shape", "cu", "density", "grains_per_void", "void_ratio", *(f"s{p}" for p in SHAPE), *(f"dc{p}" for p in PERCENT)])


def row_of(packing):
    """A packing's row of the table."""
    half = by_surface(packing["points"], 50)
    sizes = [by_surface(packing["points"], percent) / half for percent in SHAPE] + [size / half for size in packing["dc"]]
    numbers = [packing["grains_per_void"], packing["void_ratio"], *sizes]
    about = [str(int(packing["key"][:3])), f"{packing['cu']:.4g}", str(DENSITY[packing["density"]])]
    return ",".join([*about, *(f"{n:.5g}" for n in numbers)])


def main():
    lines = lines_of(Path(sys.argv[1]) / "packings.jsonl")
    rows = [row_of(packing) for packing in sorted(lines, key=lambda packing: packing["key"]) if "dc" in packing]
    made = {row.split(",")[0] for row in rows}
    kept = [row for row in TABLE.read_text().splitlines() if row[0].isdigit() and row.split(",")[0] not in made]
    both = sorted(kept + rows, key=lambda row: int(row.split(",")[0]))
    TABLE.write_text(HEAD + "\n".join([table_head(), *both]) + "\n")
    print(f"{TABLE}: {len(both)} packings, {TABLE.stat().st_size / 1000:.0f} kB; refused: {len(lines) - len(rows)}")


if __name__ == "__main__":
    main()
