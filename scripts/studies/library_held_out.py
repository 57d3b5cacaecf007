#!/usr/bin/env python3
"""Packs shapes that the library does not hold, and writes them as rows of the library's table.

    scripts/studies/library_held_out.py --out FOLDER [--binary target/release/voidwalk] [--jobs 2]

Writes results/library-held-out.csv: a coarse concave gradation, and the first four shapes of a fixed draw at each distance from the
library's nearest shape, loose and dense. They are never part of the fit: a test in src/core/constrictions/library.rs compares the library
with them. FOLDER keeps every packing, so a run that was stopped goes on.
"""

import math
import random
from pathlib import Path

from fit_library import HEAD, SHAPE, TABLE, by_surface, row_of, table_head
from library_of_packings import arguments, bell, cu_of, gap, kinked, made, pack, power, that_fits

OUT = Path(__file__).parents[2] / "results/library-held-out.csv"
# Distances at which the library states another error.
DISTANCES = [(0.0, 0.2), (0.2, 0.35), (0.35, 0.7)]
OF_EACH = 4
DENSITIES = ["loose", "dense"]
# No draw: an independent reading of the program found its grains per void 31 % off.
CONCAVE = [(1, 0), (3, 10), (5, 40), (6, 80), (6.5, 100)]


def library_shapes():
    """The places of the library's shapes: logarithms of six sizes by the median one, by surface."""
    rows = [row.split(",") for row in TABLE.read_text().splitlines() if row[0].isdigit()]
    return [[math.log(float(size)) for size in row[5 : 5 + len(SHAPE)]] for row in rows]


def distance(points, library):
    """How far the nearest shape of the library is."""
    half = by_surface(points, 50)
    place = [math.log(by_surface(points, percent) / half) for percent in SHAPE]
    return min(math.dist(place, other) for other in library)


def drawn():
    """Shapes of the library's families, by a seed of their own."""
    draw = random.Random(20261129)
    between = lambda low, high: math.exp(draw.uniform(math.log(low), math.log(high)))
    while True:
        for family in ["power", "kinked", "bell", "gap", "kinked"]:
            if family == "power":
                n = draw.uniform(-0.6, 2)
                most = min(30, 0.8 * 6 ** (1 / n)) if n > 0 else 30
                points = power(between(1.05, max(1.1, most)), n)
            elif family == "bell":
                points = bell(between(1.2, 30), draw.uniform(1.5, 2.5))
            elif family == "kinked":
                points = kinked(between(1.3, 400), [draw.expovariate(1) + 0.08 for _ in range(draw.choice([3, 4, 5]))])
            else:
                points = gap(between(1.2, 4), between(1.5, 6), between(1.3, 4), draw.uniform(0.08, 0.7))
            if cu_of(points) <= 30 and that_fits(points):
                yield family, points


def chosen():
    """The shapes that are packed: (family, points, distance)."""
    library = library_shapes()
    yield "concave", CONCAVE, distance(CONCAVE, library)
    missing = {band: OF_EACH for band in DISTANCES}
    for family, points in drawn():
        far = distance(that_fits(points)[0], library)
        band = next((band for band in DISTANCES if band[0] <= far < band[1]), None)
        if missing.get(band):
            missing[band] -= 1
            yield family, points, far
        if not any(missing.values()):
            return


def main():
    options = arguments(__doc__)

    def one(job):
        key, (family, points, far), density, seed = job
        part, grains = that_fits(points)
        about = {"key": key, "family": family, "density": density, "cu": cu_of(points), "distance": far, "points": part}
        return about | pack(options.binary, options.out, key, part, density, grains, seed)

    jobs = [(f"{k:03}-{density}", shape, density, 2001 + k) for k, shape in enumerate(chosen()) for density in DENSITIES]
    packings = made(options, "held-out.jsonl", jobs, one)
    rows = [row_of(packing) for packing in sorted(packings, key=lambda packing: packing["key"]) if "dc" in packing]
    OUT.write_text(HEAD.replace("fit_library.py", "library_held_out.py, never fitted") + "\n".join([table_head(), *rows]) + "\n")
    print(f"{OUT}: {len(rows)} packings; refused: {len(packings) - len(rows)}")


if __name__ == "__main__":
    main()
