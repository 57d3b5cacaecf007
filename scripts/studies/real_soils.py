#!/usr/bin/env python3
"""How coarse may a filter be for real soils? The walk's boundaries beside practice and the range of tests.

    scripts/studies/real_soils.py SOILS.json --out FOLDER [--binary voidwalk] [--minutes 60] [--part 1/2]
    scripts/studies/real_soils.py SOILS.json --out FOLDER --minutes 0 --csv results

SOILS.json is a list of {"id", "points_mm_percent"}. Needs the Python package, NumPy, and the program for the
constrictions of the filters. Soils come in a seeded order, stage after stage (`STAGES`), so that a stop at any time
leaves the same share of every kind of soil. FOLDER holds one line a boundary; what is there is not walked again, and
several parts (`--part 1/2`, `--part 2/2`) may work beside each other. `real_soils_tables.py` makes tables of the CSV files.
"""

import argparse
import csv
import json
import math
import random
import subprocess
import tempfile
import time
from pathlib import Path

SEED = 3603
THRESHOLD = 0.075
SHAPE_OF_NETWORK = [20, 20, 60]
# The boundary is looked for between these multiples of the centre of the tests' range.
LEAST, MOST = 1 / 50, 30
# Sizes (mm), percent finer; a number is the Cu of a straight line. They are scaled to every D15F.
FILTERS = {
    "cu1.5": 1.5,
    "cu3": 3.0,
    "c33": [(0.15, 6), (0.3, 20), (0.6, 42.5), (1.18, 67.5), (2.36, 90), (4.75, 97.5), (9.5, 100)],
    "cu12": [(0.5, 0), (1, 10), (2, 22), (4, 36), (8, 51), (12, 60), (20, 75), (40, 100)],
}
# What is walked, in this order: filter, density, boundary, what is done to the base, how many soils, number of the
# replicate whose network it is; 40: that of replicate 1 with 40 x 40 voids across.
STAGES = [
    ("cu1.5", "loose", "no", "", 639, 1),
    ("cu1.5", "dense", "no", "", 639, 1),
    ("c33", "loose", "no", "", 120, 1),
    ("cu12", "loose", "no", "", 120, 1),
    ("cu3", "loose", "no", "", 120, 1),
    ("cu1.5", "loose", "no", "no clay", 120, 1),
    ("cu1.5", "loose", "no", "flocs", 120, 1),
    ("cu1.5", "loose", "no", "crumbs", 120, 1),
    ("cu1.5", "loose", "no", "4 x base", 120, 1),
    ("cu1.5", "loose", "no", "to 2 mm", 120, 1),
    ("cu1.5", "loose", "no", "as sampled", 120, 1),
    ("cu1.5", "loose", "no", "to 4.75 mm", 639, 1),
    ("cu1.5", "loose", "no", "", 100, 2),
    ("cu1.5", "loose", "continuing", "", 120, 1),
    ("cu1.5", "loose", "no", "", 60, 40),
    ("c33", "loose", "no", "", 400, 1),
    ("cu1.5", "loose", "no", "4 x base", 300, 1),
    ("cu12", "loose", "no", "", 400, 1),
    ("cu3", "loose", "no", "", 400, 1),
    ("c33", "loose", "no", "", 639, 1),
    ("cu12", "loose", "no", "", 639, 1),
    ("cu3", "loose", "no", "", 639, 1),
    ("c33", "dense", "no", "", 120, 1),
    ("cu12", "dense", "no", "", 120, 1),
    ("cu3", "dense", "no", "", 120, 1),
    ("cu1.5", "loose", "continuing", "", 639, 1),
    ("cu1.5", "dense", "continuing", "", 200, 1),
]
DECILES = [10, 15, 20, 30, 40, 50, 60, 70, 80]
KEY = ["soil", "filter", "density", "boundary", "base", "network"]


class Soil:
    """A base as practice sees it, with its limits of D15F (mm)."""

    def __init__(self, vw, one):
        self.id = one["id"]
        sizes, percents = zip(*one["points_mm_percent"])
        self.sampled = vw.Gradation(sizes, percents)
        said = vw.rules(self.sampled, vw.Gradation.linear(1.5, 1.0, percent=15), as_given=True)
        rules, base = {rule["id"]: rule for rule in said["rules"]}, said["base"]
        self.regraded_at = base["regraded_at_mm"]
        self.walked = passing(vw, self.sampled, self.regraded_at) if self.regraded_at else self.sampled
        self.fines, self.d85, self.d95 = base["fines_percent"], base["d85_mm"], base["d95_mm"]
        self.design = rules["sherard-dunnigan"]["limit"]
        self.no_erosion = rules["foster-fell-no-erosion"]["limit"]
        self.continuing = rules["foster-fell-continuing"]["limit"]
        self.finest = sizes[0]
        self.pan = 100 * self.walked.pan_fraction
        self.gravel = 100 - self.sampled.percent_finer(4.75)
        self.clay = self.walked.percent_finer(0.002) if sizes[0] <= 0.0021 else None
        try:
            self.cu = self.walked.cu
        except ValueError:
            self.cu = None
        a, d = self.fines, self.d85
        # Of a base whose D85 lies in an open tail neither practice nor tests give a limit.
        self.has_limit = d is not None
        if not self.has_limit:
            self.tests = (math.nan, math.nan)
        elif a > 85:
            self.tests = (6.4 * d, 13.5 * d)
        elif a >= 35:
            self.tests = (0.7, 1.7)
        elif a >= 15:
            limit = (35 - a) / 20 * (4 * d - 0.7) + 0.7
            self.tests = (1.6 * limit, 2.5 * limit)
        else:
            self.tests = (6.8 * d, 10 * d)
        self.centre = math.sqrt(self.tests[0] * self.tests[1])

    @property
    def group(self):
        a = self.fines
        return "1" if a > 85 else "2 55-85" if a >= 55 else "2 35-55" if a >= 35 else "3" if a >= 15 else "4"


def passing(vw, soil, sieve):
    """The part of a soil that passes a sieve: every percent divided by that passing."""
    sizes, percents = soil.points()
    if sieve >= sizes[-1] or sieve <= sizes[0]:
        return soil
    of = soil.percent_finer(sieve)
    kept = [(a, 100 * (p / of)) for a, p in zip(sizes, percents) if p < of]
    end = next(a for a, p in zip(sizes, percents) if p >= of)
    kept.append((min(sieve, end), 100.0))
    return vw.Gradation(*zip(*kept)) if len(kept) > 1 else soil


def without_clay(vw, soil):
    """A soil without what is finer than 0.002 mm."""
    sizes, percents = soil.points()
    if sizes[0] > 0.0021:
        return None
    least = soil.percent_finer(max(0.002, sizes[0]))
    points = [(max(0.002, sizes[0]), 0.0)]
    kept = [(a, p) for a, p in zip(sizes, percents) if a > points[0][0] and p > least]
    points += [(a, 100 * ((p - least) / (100 - least))) for a, p in kept]
    return vw.Gradation(*zip(*points)) if len(points) > 1 else None


def in_flocs(vw, soil, floc_mm):
    """A soil whose particles finer than this move as flocs of this size."""
    sizes, percents = soil.points()
    if sizes[0] >= floc_mm or sizes[-1] <= floc_mm:
        return None
    points = [(0.999 * floc_mm, 0.0), (floc_mm, soil.percent_finer(floc_mm))]
    return vw.Gradation(*zip(*points, *((a, p) for a, p in zip(sizes, percents) if a > floc_mm)))


class Filter:
    """One shape and density with D15F = 1 mm: its constrictions from the program's library, and its network."""

    def __init__(self, vw, folder, binary, name, density, network):
        kept = folder / f"filter-{name}-{density}.json"
        if not kept.exists():
            kept.write_text(json.dumps(of_library(vw, binary, FILTERS[name], density)))
        found = json.loads(kept.read_text())
        scale = 1 / found["d15_mm"]
        sizes, percents = zip(*found["gradation"])
        self.gradation = vw.Gradation([size * scale for size in sizes], percents)
        diameters, shares = zip(*found["constrictions"])
        diameters = [diameter * scale for diameter in diameters]
        self.finest, self.grains_per_void = diameters[0], found["grains_per_void"]
        self.shape, replicate = ([40, 40, 60], 1) if network == 40 else (SHAPE_OF_NETWORK, network)
        self.network = vw.Network.cubic(
            self.shape,
            vw.Curve(shares, diameters),
            seed=vw.replicate_seed(1, replicate),
            reference_mm=sizes[0] * scale,
        )

    def eroded(self, vw, base, d15f, runs, tail, amount=1):
        """Share of the mass that each run erodes, with the filter of this D15F (mm)."""
        sizes, percents = base.points()
        sizes, percents = [size / d15f for size in sizes], list(percents)
        if percents[0] > 0 and sizes[0] > self.finest:
            # As the program reads a tail that is open: all passive, or all of the finest sieve's size.
            if tail == "passive":
                passive = 0.99 * self.finest
                sizes, percents = [0.99 * passive, passive] + sizes, [0.0, percents[0]] + percents
            else:
                sizes, percents = [0.999 * sizes[0]] + sizes, [0.0] + percents
        scaled = vw.Gradation(sizes, percents)
        voids = math.prod(self.shape)
        n_base = scaled.base_particles(self.gradation, voids, self.grains_per_void, 0.05 * amount)
        if n_base < 1:
            return None
        said = vw.walk(
            self.network, scaled, n_base=n_base, engine="expected", seed=1, runs=runs, replicates=1,
            series_every=0, size_classes=2, threads=1, as_given=True,
        )
        return [run["eroded_mass_fraction"]["mean"] for run in said.summary]


def of_library(vw, binary, shape, density):
    """Gradation, constrictions and grains per void of a filter, as the program takes them from its library."""
    if not isinstance(shape, list):
        sizes, percents = vw.Gradation.linear(shape, 1.0, percent=15).points()
        shape = list(zip(sizes.tolist(), percents.tolist()))
    with tempfile.TemporaryDirectory() as folder:
        table = lambda points: "size_mm,percent_finer\n" + "".join(f"{a!r},{p!r}\n" for a, p in points)
        (Path(folder) / "filter.csv").write_text(table(shape))
        (Path(folder) / "base.csv").write_text(table([(0.1, 0), (0.3, 100)]))
        command = [binary, "judge", "base.csv", "filter.csv", "--density", density, "--quick", "--as-given", "-q"]
        command += ["--set", "network.nx=6", "--set", "network.ny=6", "--set", "replicates=1", "--out", "out"]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        said = json.loads((Path(folder) / "out" / "outcome.json").read_text())
    if said["constrictions"]["origin"] != "library":
        raise SystemExit(f"{shape}: not of the library")
    of = said["inputs"]["filter"]
    return {key: of[key] for key in ["d15_mm", "gradation", "constrictions"]} | {
        "grains_per_void": said["grains_per_void"]
    }


def boundary(eroded, start, least, most):
    """The D15F (mm) at which `eroded` reaches the threshold: (D15F, which side it is beyond, walks, all of them)."""
    low, high, walks, u, slope = None, None, [], math.log(start), 2.5
    side = [math.log(least), math.log(most)]
    for _ in range(14):
        share = eroded(math.exp(u))
        if share is None:
            # Too few particles: the filter is too fine for this base to be walked.
            return None, "unwalked", walks
        f = math.log(max(share, 1e-4) / THRESHOLD)
        walks.append((round(math.exp(u), 5), round(share, 5)))
        if f < 0 and (low is None or u > low[0]):
            low = (u, f)
        elif f >= 0 and (high is None or u < high[0]):
            high = (u, f)
        if low and high and high[0] < low[0]:
            # Not monotone by scatter: the smallest that erodes counts.
            low = max(((math.log(d), math.log(max(e, 1e-4) / THRESHOLD)) for d, e in walks
                       if e < THRESHOLD and math.log(d) < high[0]), default=None)
        if abs(f) < 0.03 or (low and high and high[0] - low[0] < 0.008):
            break
        if low and high:
            part = -low[1] / (high[1] - low[1])
            u = low[0] + min(max(part, 0.08), 0.92) * (high[0] - low[0])
        else:
            if (f >= 0 and u == side[0]) or (f < 0 and u == side[1]):
                return None, "below" if f >= 0 else "above", walks
            step = -f / slope
            step += math.copysign(0.03, step)
            u = min(max(u + math.copysign(min(abs(step), 0.9), step), side[0]), side[1])
            slope = max(slope * 0.7, 0.5)
    if abs(f) < 0.03:
        # The little that is left, by the usual slope.
        return math.exp(u - f / 2.5), "", walks
    if not (low and high):
        return None, "below" if f >= 0 else "above", walks
    part = -low[1] / (high[1] - low[1])
    return math.exp(low[0] + part * (high[0] - low[0])), "", walks


def base_of(vw, soil, what):
    """The base to walk; nothing where this is no other than the usual."""
    if what == "no clay":
        return without_clay(vw, soil.walked)
    if what in ("flocs", "crumbs"):
        return in_flocs(vw, soil.walked, {"flocs": 0.03, "crumbs": 0.1}[what])
    if what == "as sampled":
        return soil.sampled if soil.regraded_at else None
    if what in ("to 2 mm", "to 4.75 mm"):
        sieve = float(what.split()[1])
        at = soil.walked.points()[0][-1]
        if at <= sieve or soil.walked.percent_finer(sieve) < 5:
            return None
        return passing(vw, soil.walked, sieve)
    return soil.walked


def walk_all(vw, options, soils, done):
    began, (part, parts) = time.monotonic(), map(int, options.part.split("/"))
    order = [soil for soil in random.Random(SEED).sample(soils, len(soils)) if soil.has_limit]
    filters, there = {}, {tuple(row[key] for key in KEY) for row in done}
    found = {tuple(row[key] for key in KEY): row for row in done}
    with (options.out / f"rows-{part}.jsonl").open("a") as file:
        for name, density, which, what, count, network in STAGES:
            ratios = []
            for soil in order[part - 1 : count : parts]:
                key = (soil.id, name, density, which, what, network)
                if key in there:
                    continue
                if time.monotonic() - began > 60 * options.minutes:
                    return
                try:
                    base = base_of(vw, soil, what)
                except ValueError as error:
                    print(f"soil {soil.id}, {what}: {error}", flush=True)
                    continue
                if base is None:
                    continue
                place = (name, density, network)
                if place not in filters:
                    filters[place] = Filter(vw, options.out, options.binary, *place)
                filter = filters[place]
                # From what is known of this soil, and of the others of this stage.
                first = found.get((soil.id, "cu1.5", "loose", "no", "", 1), {}).get("d15f_mm")
                reference = first or 0.6 * soil.centre
                usual = math.exp(sorted(ratios)[len(ratios) // 2]) if ratios else {"no": 1, "continuing": 2}[which]
                side = (LEAST * soil.centre, MOST * soil.centre)
                start = min(max(usual * reference, side[0]), side[1])
                run = 1 if which == "no" else 2
                seconds = time.monotonic()
                row = dict(zip(KEY, key))

                def eroded(d15f, tail="passive"):
                    shares = filter.eroded(vw, base, d15f, run, tail, 4 if what == "4 x base" else 1)
                    return None if shares is None else shares[-1]

                try:
                    d15f, beyond, walks = boundary(eroded, start, *side)
                    row |= {"d15f_mm": d15f, "beyond": beyond, "walks": walks, "tail": "known"}
                    at = d15f or side[0]
                    if base.pan_fraction > 0 and base.points()[0][0] / at > filter.finest:
                        row["tail"] = "open"
                        row["d15f_passive_mm"], row["beyond_passive"] = d15f, beyond
                        other, other_beyond, more = boundary(lambda d: eroded(d, "coarse"), at, *side)
                        row["d15f_coarse_mm"], row["beyond_coarse"] = other, other_beyond
                        row["walks_coarse"] = more
                        # As the program did by then: the reading that erodes more counts.
                        rank = {"below": 0.0, "unwalked": 0.0, "above": math.inf}
                        value = lambda d, b: d if d else rank[b]
                        if value(other, other_beyond) < value(d15f, beyond):
                            row["d15f_mm"], row["beyond"] = other, other_beyond
                    if row["d15f_mm"]:
                        ratios.append(math.log(row["d15f_mm"] / reference))
                except (ValueError, vw.VoidwalkError) as error:
                    row["error"] = str(error)[:200]
                row["seconds"] = round(time.monotonic() - seconds, 2)
                found[key] = row
                file.write(json.dumps(row) + "\n")
                file.flush()


def rows_of(folder):
    """Every boundary that was found, once."""
    paths = sorted(folder.glob("rows-*.jsonl"))
    rows = [json.loads(line) for path in paths for line in path.read_text().splitlines()]
    return list({tuple(row[key] for key in KEY): row for row in rows}.values())


def said(row):
    """A boundary (mm), or on which side of what was tried it lies."""
    if row is None:
        return ""
    return f"{row['d15f_mm']:.4g}" if row.get("d15f_mm") else row.get("beyond") or "refused"


def write(soils, rows, folder):
    """`real-soils.csv`, the boundaries, and `real-soils-bases.csv`, what practice says of each soil."""
    by = {tuple(row[key] for key in KEY): row for row in rows}
    with (folder / "real-soils.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["soil", "filter", "density", "base", "network", "no_erosion_mm", "continuing_mm", "tail"])
        places = sorted({(key[0], key[1], key[2], key[4], key[5]) for key in by})
        for soil, name, density, what, network in places:
            of = [by.get((soil, name, density, which, what, network)) for which in ("no", "continuing")]
            tails = ["" if row is None or row.get("tail") != "open" else open_tail(row) for row in of]
            line = [soil, name, density, what, network, said(of[0]), said(of[1]), tails[0] or tails[1]]
            writer.writerow(line)
    names = ["fines", "d85_mm", "d95_mm", "cu", "gravel", "clay", "pan", "finest_mm", "regraded_mm", "design_mm"]
    names += ["tests_low_mm", "tests_high_mm", "continuing_9_d95_mm"]
    names += [f"d{percent}_mm" for percent in DECILES]
    with (folder / "real-soils-bases.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["soil", "group", *names])
        for soil in sorted(soils, key=lambda soil: soil.id):
            line = [soil.fines, soil.d85, soil.d95, soil.cu, soil.gravel, soil.clay, soil.pan, soil.finest]
            line += [soil.regraded_at, soil.design, *soil.tests, soil.continuing]
            line += [size_of(soil.walked, percent) for percent in DECILES]
            if not soil.has_limit:
                line[9:13] = [None] * 4
            writer.writerow([soil.id, soil.group, *("" if x is None else f"{x:.4g}" for x in line)])


def open_tail(row):
    """Which reading of an open tail set the boundary."""
    coarse = row.get("d15f_coarse_mm") == row.get("d15f_mm") and row.get("beyond_coarse") == row.get("beyond")
    passive = row.get("d15f_passive_mm") == row.get("d15f_mm") and row.get("beyond_passive") == row.get("beyond")
    return "passive" if passive else "finest sieve" if coarse else "open"


def size_of(soil, percent):
    try:
        return soil.d(percent)
    except ValueError:
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("soils", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--binary", default="voidwalk")
    parser.add_argument("--minutes", type=float, default=75)
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--csv", type=Path, help="folder for real-soils.csv and real-soils-bases.csv")
    options = parser.parse_args()
    import voidwalk as vw

    options.out.mkdir(parents=True, exist_ok=True)
    soils = [Soil(vw, one) for one in json.loads(options.soils.read_text())]
    walk_all(vw, options, soils, rows_of(options.out))
    if options.csv:
        write(soils, rows_of(options.out), options.csv)


if __name__ == "__main__":
    main()
