#!/usr/bin/env python3
"""Packs the filters of the library: 138 shapes of gradation, three densities, and a second seed of some.

    scripts/studies/library_of_packings.py --binary target/release/voidwalk --out FOLDER [--jobs 2]

Every packing is one line of FOLDER/packings.jsonl. A packing that is there already is not made again, so a run that
was stopped goes on. `scripts/studies/fit_library.py` makes src/core/data/library.csv of them and measures its error.
Sizes are relative: the finest grain of every shape has the size 1.
"""

import concurrent.futures
import itertools
import json
import math
import random
import shutil
import subprocess
from pathlib import Path

import common

FRICTIONS = {"dense": 0.0, "medium": 0.1, "loose": 0.3}
# Fewer grains scatter, more cost hours; the widest shapes end where the cell is this many largest grains wide.
GRAINS = (2000, 5000)
# Of the shapes that are drawn, few are above Cu 10; these come after them, with more grains.
DRAWN = 126
BROAD = {"cu": (20, 31), "shapes": 12, "grains": 12000}
# A part that leaves out more of the grains' surface, or holds less of the mass, says too little of its shape.
SURFACE_LEFT_OUT = 0.1
LEAST_PERCENT = 30
WIDTH = 2.5
FRACTION = 0.65
# Percentages of the constrictions, by number, that are kept.
PERCENT = [0, 1, 2.5, 5, 10, 15, 20, 25, 30, 40, 50, 60, 70, 75, 80, 85, 90, 95, 97.5, 99, 100]
SIZES = 60


def cu_of(points):
    def size(percent):
        for (a, p), (b, q) in zip(points, points[1:]):
            if q >= percent:
                return a * (b / a) ** ((percent - p) / (q - p)) if q > p else b
        return points[-1][0]

    return size(60) / size(10)


def sampled(finer, ratio):
    """Points (size, percent) of a distribution over the logarithm of size, 0 to 1 of ln(ratio)."""
    return [(ratio ** (k / SIZES), 100 * finer(k / SIZES)) for k in range(SIZES + 1)]


def with_cu(points_of_ratio, cu):
    """Points whose Cu is the wanted one, by the ratio of the largest to the finest size."""
    low, high = 0.0, math.log(1e4)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if cu_of(points_of_ratio(math.exp(middle))) < cu:
            low = middle
        else:
            high = middle
    return points_of_ratio(math.exp(high))


def power(cu, n):
    """Mass finer than d by d^n: 1 is linear in size, 0 straight over the logarithm of size."""

    def points(ratio):
        total = ratio**n - 1 if n else 1
        return sampled(lambda x: (ratio ** (n * x) - 1) / total if n else x, ratio)

    return with_cu(points, cu)


def bell(cu, cut):
    """Normal over the logarithm of size, cut off at so many standard deviations."""
    normal = lambda z: 0.5 * (1 + math.erf(z / math.sqrt(2)))
    low, high = normal(-cut), normal(cut)
    return with_cu(lambda r: sampled(lambda x: (normal(cut * (2 * x - 1)) - low) / (high - low), r), cu)


def gap(fine_ratio, jump, coarse_ratio, share):
    """Two parts, each straight over the logarithm of size, with nothing between them."""
    fine = [(fine_ratio ** (k / 20), share * 5 * k) for k in range(21)]
    start = fine_ratio * jump
    coarse = [(start * coarse_ratio ** (k / 20), 100 * share + (1 - share) * 5 * k) for k in range(21)]
    return fine + coarse


def kinked(ratio, weights):
    """Straight between knots that are evenly spaced over the logarithm of size."""
    total = sum(weights)
    sums = [sum(weights[:k]) / total for k in range(len(weights) + 1)]

    def finer(x):
        k = min(int(x * len(weights)), len(weights) - 1)
        return sums[k] + (x * len(weights) - k) * (sums[k + 1] - sums[k])

    return sampled(finer, ratio)


def broad_shapes():
    """The broad shapes, always the same: (family, points)."""
    draw = random.Random(20261126)
    log_uniform = lambda low, high: math.exp(draw.uniform(math.log(low), math.log(high)))
    low, high = BROAD["cu"]
    for k in range(BROAD["shapes"]):
        while True:
            family = ["power", "kinked", "bell"][k % 3]
            if family == "power":
                points = power(log_uniform(low, high), draw.choice([-0.6, -0.3, 0, 0.1, 0.3]))
            elif family == "bell":
                points = bell(log_uniform(low, high), draw.uniform(1.5, 2.5))
            else:
                weights = [draw.expovariate(1) + 0.08 for _ in range(draw.choice([3, 4, 5]))]
                points = kinked(log_uniform(30, 2000), weights)
            if low <= cu_of(points) <= high and that_fits(points, BROAD["grains"]):
                yield family, points
                break


def shapes():
    """The shapes, always the same: (family, points)."""
    draw = random.Random(20261124)
    log_uniform = lambda low, high: math.exp(draw.uniform(math.log(low), math.log(high)))
    k = 0
    while k < DRAWN:
        family = ["power", "kinked", "power", "bell", "kinked", "gap"][k % 6]
        if family == "power":
            n = draw.choice([-0.6, -0.3, 0, 0.3, 0.6, 1, 1.5, 2])
            # Of mass by d^n no Cu is above 6^(1/n).
            most = min(30, 0.8 * 6 ** (1 / n)) if n > 0 else 30
            points = power(log_uniform(1.05, most), n)
        elif family == "bell":
            points = bell(log_uniform(1.2, 30), draw.uniform(1.5, 2.5))
        elif family == "kinked":
            weights = [draw.expovariate(1) + 0.08 for _ in range(draw.choice([3, 4, 5]))]
            points = kinked(log_uniform(1.3, 400), weights)
        else:
            points = gap(log_uniform(1.2, 4), log_uniform(1.5, 6), log_uniform(1.3, 4), draw.uniform(0.08, 0.7))
        if cu_of(points) <= 30 and that_fits(points):
            k += 1
            yield family, points


def numbers(points):
    """Grains by unit of mass, and the same of each row, with mass even over the logarithm of size between points."""
    rows = []
    for (a, p), (b, q) in zip(points, points[1:]):
        mass = q - p
        # Mean of d^-3 over the logarithm of size.
        mean = (a**-3 - b**-3) / (3 * math.log(b / a)) if b > a * (1 + 1e-12) else a**-3
        rows.append(mass * mean * 6 / math.pi)
    return rows


def surface(points):
    """Surface of the grains by unit of mass, but for a factor."""
    rows = [(a, b, q - p) for (a, p), (b, q) in zip(points, points[1:])]
    return sum(mass * (1 / a - 1 / b) / math.log(b / a) if b > a * (1 + 1e-12) else mass / a for a, b, mass in rows)


def that_fits(points, most=GRAINS[1]):
    """The finer part of which so many grains at most make a cell wide enough, and the grains to take."""
    for end in range(len(points), 2, -1):
        part = points[:end]
        if part[-1][1] <= part[-2][1]:
            continue
        volume = part[-1][1] / FRACTION / sum(numbers(part))
        least = (WIDTH * part[-1][0]) ** 3 / volume
        if least <= most:
            left_out = 1 - surface(part) / surface(points)
            if part[-1][1] < LEAST_PERCENT or left_out > SURFACE_LEFT_OUT:
                return None
            return [(d, 100 * p / part[-1][1]) for d, p in part], max(GRAINS[0], math.ceil(least))
    return None


def pack(binary, folder, key, points, density, grains, seed):
    work = folder / "work" / key
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    common.sheet(work / "sieve.csv", [(f"{d:.9g}", f"{p:.9g}") for d, p in points])
    (work / "filter.toml").write_text(f'[filter]\nsieve = "sieve.csv"\nfriction = {FRICTIONS[density]}\n')
    command = [binary, "pack", work / "filter.toml", "--out", work / "packing", "--threads", "1", "--quiet"]
    command += ["--seed", str(seed), *common.sets({"packing.grains": grains, "packing.hold_steps": 1000, "packing.coarsest": 100})]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        return {"refused": done.stderr.strip()}
    record = json.loads((work / "packing" / "packing.json").read_text())
    found = json.loads((work / "packing" / "constrictions.json").read_text())
    curve = [line.split(",") for line in (work / "packing" / "constrictions.csv").read_text().split()]
    curve = [(float(row[1]), float(row[0])) for row in curve if row[0][0].isdigit()]
    shutil.rmtree(work)
    return {
        "void_ratio": record["after"]["void_ratio"],
        "grains_per_void": found["grains_per_void"],
        "constrictions": found["constrictions"],
        "cell_by_largest": record["cell_mm"] / points[-1][0],
        "seconds": record["seconds"],
        "dc": [at(curve, percent) for percent in PERCENT],
    }


def at(curve, percent):
    for (a, p), (b, q) in zip(curve, curve[1:]):
        if q >= percent:
            return a if q == p or percent <= p else a + (b - a) * (percent - p) / (q - p)
    return curve[-1][0]


def arguments(doc):
    parser = common.parser(doc)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    return parser.parse_args()


def made(options, name, jobs, one):
    """The packings of these jobs, whose first parts are their keys: from FOLDER/name, which gets a line for each that is made now."""
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / name
    packings = common.lines_of(kept)
    there = {packing["key"] for packing in packings}
    jobs = [job for job in jobs if job[0] not in there]
    print(f"{len(there)} packings are there, {len(jobs)} to make", flush=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as workers:
        for packing in workers.map(one, jobs):
            packings.append(packing)
            common.keep(kept, packing)
            print(packing["key"], packing["family"], packing.get("refused", ""), flush=True)
    return packings


def main():
    options = arguments(__doc__)

    def one(job):
        key, family, points, density, seed = job
        part, grains = that_fits(points, BROAD["grains"] if int(key[:3]) >= DRAWN else GRAINS[1])
        about = {"key": key, "family": family, "density": density, "seed": seed, "cu": cu_of(points), "grains": grains}
        about |= {"percent": 100 * points_share(points, part), "points": part}
        return about | pack(options.binary, options.out, key, part, density, grains, seed)

    jobs = []
    for k, (family, points) in enumerate(itertools.chain(shapes(), broad_shapes())):
        for density in FRICTIONS:
            seeds = [1 + k, 1001 + k] if k % 12 == 0 else [1 + k]
            jobs += [(f"{k:03}-{density}-{seed}", family, points, density, seed) for seed in seeds]
    made(options, "packings.jsonl", jobs, one)


def points_share(whole, part):
    """Share of the mass of the whole that the part is."""
    return next((p for d, p in whole if d >= part[-1][0] * (1 - 1e-9)), 100) / 100


if __name__ == "__main__":
    main()
