#!/usr/bin/env python3
"""How often a point of a study that stops early is wrong.

    scripts/studies/study_stops.py --binary target/release/voidwalk [--values FILE]

Walks 16 replicates of small scenes and of six points of each (a quarter to four times the base, half and twice the thickness) on the
same random numbers, and applies the rule of src/app/outcome/early_stop.rs to every window of 5, 6, 8 and 10 replicates of the scene (cyclic)
and the first one, two or three of the point. A class counts as right where it is that of the mean of all 16. Beside it: three replicates
judged by their own scatter, as all points were before; and those that stopped though they scatter more than twice as much as their scene. `--values` keeps what was walked, and takes it from there. Python 3 alone.
"""

import argparse
import collections
import functools
import itertools
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

THRESHOLD, REPLICATES, OWN, ERROR = 0.075, 16, [5, 6, 8, 10], 0.05
FILTERS = ["shire2016-cu1.5-loose", "cu3-loose"]
CU = [1.5, 3]
DC = [2, 5, 10, 15, 20, 25, 30, 40, 50]
BASES, LAYERS, DEPTH = [0.25, 0.5, 2, 4], [10, 40], 20


def within(degrees, angle):
    """The share of Student's distribution between -t and t, t = sqrt(degrees) tan(angle)."""
    cosine, odd = math.cos(angle), degrees % 2
    term, k = (cosine, 2) if odd else (1.0, 1)
    total = 0.0 if degrees == 1 else term
    while k + 1 < degrees:
        term *= k / (k + 1) * cosine * cosine
        total += term
        k += 2
    return 2 / math.pi * (angle + math.sin(angle) * total) if odd else math.sin(angle) * total


def student(degrees, error):
    low, high = 0.0, math.pi / 2
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if within(degrees, middle) < 1 - error else (low, middle)
    return math.sqrt(degrees) * math.tan(low)


def class_of(first, second):
    if first is None or (not first and second is None):
        return "undecided"
    return "no" if first else "some" if second else "continuing"


def run_of(replicates, run):
    return [replicate[run] for replicate in replicates]


def half(values, error):
    return factor(len(values) - 1, error) * statistics.stdev(values) / math.sqrt(len(values))


def by_own_scatter(replicates):
    def below(values):
        mean, reach = statistics.mean(values), half(values, ERROR)
        return True if mean + reach < THRESHOLD else False if mean - reach >= THRESHOLD else None
    return class_of(*[below(run_of(replicates, run)) for run in (0, 1)])


@functools.lru_cache(None)
def factor(degrees, error):
    return student(degrees, error)


def doubled(own, point, error):
    reach = 2 * factor(len(own) - 1, error) * statistics.stdev(own)
    if len(point) > 1:
        reach = max(reach, factor(len(point) - 1, error) * statistics.stdev(point))
    return reach / math.sqrt(len(point))


def is_above(own, point):
    keeps = all(o >= THRESHOLD and p >= THRESHOLD and p - THRESHOLD >= (o - THRESHOLD) / 3 for o, p in zip(own, point))
    return keeps and statistics.mean(point) - doubled(own, point, ERROR / 4) >= THRESHOLD


def by_rule(own, point):
    """How many replicates of the point are walked, and its class."""
    for count in [1, 2] if by_own_scatter(own) == "continuing" else []:
        if all(is_above(run_of(own, run), run_of(point[:count], run)) for run in (0, 1)):
            return count, "continuing"
    return 3, by_own_scatter(point[:3])


def walked(binary, folder, settings):
    all_settings = [f"replicates={REPLICATES}", "record.sensitivity=[]", "record.series_every=0", "record.size_curves=[]", *settings]
    words = [word for setting in all_settings for word in ("--set", setting)]
    subprocess.run([binary, "run", "-q", "--out", folder, "--overwrite", "--threads", "1", *words], check=True, capture_output=True)
    outcome = json.loads((folder / "outcome.json").read_text())
    return outcome["n_base"], [[run["eroded_mass_fraction"] for run in replicate["runs"]] for replicate in outcome["replicates"]]


def values(binary):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "run"
        for curve, cu, dc in itertools.product(FILTERS, CU, DC):
            scene = [f"filter.curve={curve}", f"base.cu={cu}", f"base.d85_at_dc={dc}", "network.nx=10", "network.ny=10"]
            n_base, own = walked(binary, out, [*scene, f"network.nz={DEPTH}"])
            points = [[f"network.nz={DEPTH}", f"base.n_base={max(1, round(n_base * factor))}"] for factor in BASES]
            points += [[f"network.nz={layers}"] for layers in LAYERS]
            yield {"main": own, "points": {" ".join(point): walked(binary, out, [*scene, *point])[1] for point in points}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=pathlib.Path, required=True)
    parser.add_argument("--values", type=pathlib.Path)
    options = parser.parse_args()
    if options.values and options.values.is_file():
        scenes = [json.loads(line) for line in options.values.read_text().splitlines()]
    else:
        scenes = list(values(options.binary.resolve()))
        if options.values:
            options.values.write_text("".join(json.dumps(scene) + "\n" for scene in scenes))
    print(f"{len(scenes)} scenes, six points each\n")
    print("| replicates of the scene | replicates walked | class right | undecided | wrong | intervals that hold the mean of all "
          "| scatter more than twice as much |\n|---|---|---|---|---|---|---|")
    for replicates in OWN:
        table(scenes, replicates)


def table(scenes, replicates):
    rule, before, covered, scattered = (collections.Counter() for _ in range(4))
    for scene in scenes:
        for point in scene["points"].values():
            means = [statistics.mean(run_of(point, run)) for run in (0, 1)]
            true = class_of(*[mean < THRESHOLD for mean in means])
            said = lambda found: "undecided" if found == "undecided" else "right" if found == true else "wrong"
            times = max(statistics.stdev(run_of(point, run)) / statistics.stdev(run_of(scene["main"], run)) for run in (0, 1))
            for start in range(REPLICATES):
                window = [(start + k) % REPLICATES for k in range(replicates)]
                own, here = [scene["main"][k] for k in window], [point[k] for k in window]
                count, found = by_rule(own, here)
                rule[count, said(found)] += 1
                scattered[count] += times > 2
                before[said(by_own_scatter(here[:3]))] += 1
                for run in (0, 1):
                    few = run_of(here[:count], run)
                    reach = half(few, ERROR) if count == 3 else doubled(run_of(own, run), few, ERROR)
                    covered[count, abs(statistics.mean(few) - means[run]) <= reach + 1e-12] += 1
    for count in (1, 2, 3):
        seen = covered[count, True] + covered[count, False]
        inside = f"{100 * covered[count, True] / seen:.1f} %" if seen else ""
        print(f"| {replicates} | {count} | {rule[count, 'right']} | {rule[count, 'undecided']} | {rule[count, 'wrong']} | {inside} | {scattered[count]} |")
    print(f"| {replicates} | before: always 3 | {before['right']} | {before['undecided']} | {before['wrong']} | | |")


if __name__ == "__main__":
    main()
