#!/usr/bin/env python3
"""What leaving the coarser grains of a filter out does to its constrictions: wholes that can be packed, beside their finer parts.

    python3 scripts/studies/study_cuts.py --binary target/release/voidwalk [--seeds 1,2,3] [--work DIR] [--only NAME,...]

Packs each gradation below with each seed (density "loose", one thread; a packing that is in DIR already is not made again; --only packs
those alone) and prints the tables of results/packing.md from what is there. A linear gradation cut at a percentage of its mass is a linear
gradation of smaller Cu, so Cu 1.5 to 4.5 are the finer parts of Cu 6. Gap-graded filters: so many percent between 1 and 1.5 mm, the
others between 8 and 10 mm. C33: fine aggregate by ASTM C33, the middle of its band, up to 2.36 mm as the whole. Differences are of means over
the seeds, in percent of the whole's size; ± is the standard error of the difference. The last column is the largest difference of Dc5 to
Dc90 by the share of the grains' surface that is left out: the program takes 0.6 for it (src/app/case/cut.rs).
"""

import argparse
import csv
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

C33 = [(0.15, 6.0), (0.3, 20.0), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0)]
LINEAR = {1.5: 6000, 2: 6000, 3: 8000, 4.5: 20000, 6: 60000}  # Cu, grains
GAPS = {60: 7000, 40: 5500, 30: 4500, 20: 4000}  # percent in the finer part, grains
C33_CUTS = {"2.36": (5, 9000), "1.18": (4, 6000), "0.6": (3, 6000)}  # mm, rows of the table, grains
PERCENTS = [5, 25, 50, 75, 90]


def gradations():
    """Name of each gradation: its grains and its points (mm, percent finer)."""
    all_of_them = {f"cu{cu:g}-loose": (grains, [(1.0, 0.0), (cu * cu, 100.0)]) for cu, grains in LINEAR.items()}
    for fines, grains in GAPS.items():
        all_of_them[f"gap{fines}"] = (grains, [(1.0, 0.0), (1.5, fines), (8.0, fines + 1e-6), (10.0, 100.0)])
    all_of_them["gapfine"] = (6000, [(1.0, 0.0), (1.5, 100.0)])
    for name, (rows, grains) in C33_CUTS.items():
        part = C33[:rows]
        all_of_them[f"c33to{name}"] = (grains, [(d, 100.0 * percent / part[-1][1]) for d, percent in part])
    return all_of_them


def pack(binary, work, name, seed):
    """The folder of a packing, which is made unless it is there."""
    grains, points = gradations()[name]
    folder = work / f"{name}-{grains}-{seed}"
    if (folder / "packing.json").exists():
        return folder
    if name.startswith("cu"):
        filter_is = f"cu = {math.sqrt(points[-1][0]):g}"
    else:
        table = work / f"{name}.csv"
        table.write_text("opening_mm,percent_finer\n" + "".join(f"{d:.9g},{percent:.9g}\n" for d, percent in points))
        filter_is = f'sieve = "{table}"'
    scene = work / f"{name}.toml"
    scene.write_text(f'[filter]\n{filter_is}\ndensity = "loose"\n[packing]\ngrains = {grains}\nseed = {seed}\ncoarsest = 100\n')
    subprocess.run([binary, "pack", scene, "--out", folder, "--quiet", "--threads", "1"], check=True)
    return folder


def measured(folder):
    """What is compared of a packing; None where it is not there."""
    if not (folder / "packing.json").exists():
        return None
    record = json.loads((folder / "packing.json").read_text())
    rows = [tuple(map(float, row)) for row in list(csv.reader((folder / "constrictions.csv").open()))[1:]]

    def dc(percent):
        for (p, d), (q, e) in zip(rows, rows[1:]):
            if p <= percent <= q:
                return d if q == p else d + (e - d) * (percent - p) / (q - p)
        raise ValueError(percent)

    after = record["after"]
    return {
        "void ratio": after["void_ratio"], "rattlers": after["rattlers"], "coordination": after["coordination"],
        "grains per void": json.loads((folder / "constrictions.json").read_text())["grains_per_void"],
        "width": record["cell_mm"] / record["gradation"][-1][0],
        **{percent: dc(percent) for percent in PERCENTS},
        "inscribed": {name: [[d, p] for d, p in curve] for name, curve in zip(["dense", "loose"], record["inscribed"])},
    }


def surface(points):
    """Surface of the grains of each segment, by the mass of all."""
    return [((q - p) / math.log(b / a) * (1 / a - 1 / b), b) for (a, p), (b, q) in zip(points, points[1:])]


def left_out(whole, largest):
    """Shares of the surface and of the mass of the grains coarser than `largest`."""
    cut = []
    for (a, p), (b, q) in zip(whole, whole[1:]):
        if a < largest < b:
            cut.append((largest, p + (q - p) * math.log(largest / a) / math.log(b / a)))
    points = sorted({*whole, *cut})
    of = surface(points)
    percent = next((p for d, p in points if d == largest), points[-1][1])
    first = points[0][1]
    return (sum(s for s, b in of if b > largest * (1 + 1e-9)) / sum(s for s, _ in of), (100 - percent) / (100 - first))


def mean_and_sd(values):
    return statistics.fmean(values), statistics.stdev(values) if len(values) > 1 else math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--only", help="gradations to pack, separated by commas; none packs nothing")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()) / "study-cuts")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    seeds = [int(seed) for seed in options.seeds.split(",")]
    known, to_pack = gradations(), options.only.split(",") if options.only else list(gradations())
    found = {}
    for name, (grains, _) in known.items():
        for seed in seeds:
            if name in to_pack:
                pack(options.binary, options.work, name, seed)
            one = measured(options.work / f"{name}-{grains}-{seed}")
            if one:
                found.setdefault(name, []).append(one)

    print("| gradation | grains | seeds | cell by largest grain | void ratio | rattlers | coordination | grains per void |",
          *(f" Dc{percent} (D0) |" for percent in PERCENTS), sep="")
    print("|---" * (8 + len(PERCENTS)) + "|")
    for name, ones in found.items():
        unit = known[name][1][0][0]
        cells = [name, known[name][0], len(ones), f"{ones[0]['width']:.1f}"]
        for key, digits in [("void ratio", 4), ("rattlers", 3), ("coordination", 2), ("grains per void", 3)]:
            cells.append("{:.{d}f} ± {:.{d}f}".format(*mean_and_sd([one[key] for one in ones]), d=digits))
        for percent in PERCENTS:
            cells.append("{:.4f} ± {:.4f}".format(*mean_and_sd([one[percent] / unit for one in ones])))
        print("|", " | ".join(map(str, cells)), "|")

    pairs = [(f"cu{whole:g}-loose", f"cu{cut:g}-loose") for whole in (3, 4.5, 6) for cut in LINEAR if cut < whole]
    pairs += [("c33to2.36", "c33to1.18"), ("c33to2.36", "c33to0.6"), *((f"gap{fines}", "gapfine") for fines in GAPS)]
    print("\n| whole | finer part | of its mass | surface left out |",
          *(f" Dc{percent} |" for percent in PERCENTS), " grains per void | largest by surface |", sep="")
    print("|---" * (6 + len(PERCENTS)) + "|")
    for whole, cut in pairs:
        if whole not in found or cut not in found:
            continue
        share, mass = left_out(known[whole][1], known[cut][1][-1][0])
        cells, largest = [whole, cut, f"{100 - 100 * mass:.1f} %", f"{100 * share:.1f} %"], 0.0
        for key in [*PERCENTS, "grains per void"]:
            (a, sa), (b, sb) = (mean_and_sd([one[key] for one in found[name]]) for name in (whole, cut))
            error = math.hypot(sa / math.sqrt(len(found[whole])), sb / math.sqrt(len(found[cut]))) / a
            cells.append(f"{100 * (b / a - 1):+.1f}" + ("" if math.isnan(error) else f" ± {100 * error:.1f}"))
            if key in PERCENTS:
                largest = max(largest, 1 - b / a)
        print("|", " | ".join(cells), f"| {largest / share:.2f} |")

    print("\n| gradation | estimate | Dc5: estimated by measured | Dc50 | Dc90 |")
    print("|---|---|---|---|---|")
    for name, ones in found.items():
        for density, curve in ones[0]["inscribed"].items():
            cells = []
            for percent in (5, 50, 90):
                guess = min(curve, key=lambda row: abs(row[1] - percent))[0]
                cells.append(f"{guess / statistics.fmean(one[percent] for one in ones):.2f}")
            print(f"| {name} | {1 if density == 'dense' else 0} |", " | ".join(cells), "|")


if __name__ == "__main__":
    main()
