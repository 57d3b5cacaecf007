#!/usr/bin/env python3
"""The eleven problems of a dam engineer: rules and first lines of the program beside limits worked out by hand.

    scripts/checks/eleven_problems.py [--binary target/release/voidwalk] [--set network.nx=8 ...]

Writes the soils of each problem as sheets and runs `rules --json`, then `judge` or `design` as somebody would who gives no density. By
hand: D15F (linear in percent over the logarithm of size), the limit of design by category after regrading on 4.75 mm, the boundaries
of no and of continuing erosion, and D15F of an unstable filter without its finer part. A problem is equal where the numbers of the
rules and of the first lines are these within 1 %, where both say "met" or "not met" as the limits have it, where no page is green
although practice is not met, and where `design` has the limit of design. `--set` makes the walks smaller. Exit code 1 where a
row is not equal. Python 3's standard library only.
"""

import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

# Percent finer by mass, by opening (mm), the coarsest first.
SOILS = {
    "No. 8": [(12.5, 100), (9.5, 92), (4.75, 20), (2.36, 5), (1.18, 2)],
    "No. 57": [(37.5, 100), (25, 97), (12.5, 42), (4.75, 5), (2.36, 2)],
    "C33, middle": [(9.5, 100), (4.75, 97), (2.36, 90), (1.18, 68), (0.6, 42), (0.3, 18), (0.15, 4), (0.075, 1)],
    "C33, coarse side": [(9.5, 100), (4.75, 95), (2.36, 80), (1.18, 55), (0.6, 32), (0.3, 9), (0.15, 2), (0.075, 0)],
    "0-32 gravel": [(37.5, 100), (31.5, 95), (16, 70), (8, 48), (4, 36), (2, 27), (1, 20), (0.5, 13), (0.25, 8), (0.125, 4), (0.075, 2)],
    "segregated gravel": [(63, 100), (37.5, 75), (19, 45), (9.5, 25), (4, 8), (2, 3), (0.075, 0)],
    "till": [(37.5, 100), (19, 89), (9.5, 82), (4.75, 74), (2, 64), (0.85, 55), (0.425, 48), (0.15, 37), (0.075, 28)],
    "silty fine sand": [(0.85, 100), (0.6, 99), (0.425, 92), (0.25, 80), (0.15, 52), (0.075, 22)],
    "clay core": [(2, 100), (0.425, 98), (0.15, 94), (0.075, 88), (0.05, 80), (0.02, 62), (0.005, 41), (0.002, 30)],
    "rock toe": [(400, 100), (250, 60), (150, 35), (100, 20), (60, 8), (20, 0)],
    "dredged sand": [(1, 100), (0.5, 97), (0.3, 85), (0.2, 55), (0.1, 8), (0.063, 1)],
    "gap-graded filter": [(19, 100), (9.5, 60), (4.75, 25), (0.6, 25), (0.3, 14), (0.15, 3), (0.075, 0)],
    "fine sand": [(0.25, 100), (0.2, 95), (0.15, 60), (0.1, 20), (0.075, 5)],
    "concrete sand": [(2, 100), (1.18, 92), (0.6, 70), (0.3, 30), (0.15, 6), (0.075, 0)],
}
# Base, filter (of a design none), options. Letters are those of results/rules.md; the last five are told by rules alone.
PROBLEMS = {
    "a": ("clay core", "C33, coarse side", "--dispersive"),
    "b": ("till", "0-32 gravel"),
    "b2": ("till", "segregated gravel"),
    "c": ("silty fine sand", "No. 57"),
    "d": ("dredged sand", "rock toe"),
    "e": ("fine sand", "gap-graded filter"),
    "f1": ("clay core", "C33, middle"),
    "f2": ("C33, middle", "No. 57"),
    "g": ("till", None),
    "h": ("silty fine sand", None),
    "k1": ("silty fine sand", "No. 8"),
    "k2": ("silty fine sand", "No. 57"),
    "k3": ("silty fine sand", "C33, middle"),
    "a2": ("clay core", "C33, middle", "--dispersive"),
    "b3": ("till", "segregated gravel", "--dispersive"),
    "c3": ("silty fine sand", "No. 8", "--dispersive"),
    "s": ("concrete sand", "No. 57"),
}
RULES_ALONE = ("a2", "b3", "c3", "s")
# Lines on stdout, of which notes have one.
MOST_LINES = 12


def d(soil, percent):
    """The size that `percent` are finer than; None in an open finest tail."""
    rows = sorted(soil)
    if percent < rows[0][1]:
        return None
    for (a, p), (b, q) in zip(rows, rows[1:]):
        if p <= percent <= q and q > p:
            return a * (b / a) ** ((percent - p) / (q - p))
    return rows[0][0] if percent == rows[0][1] else None


def finer(soil, size):
    rows = sorted(soil)
    for (a, p), (b, q) in zip(rows, rows[1:]):
        if a <= size <= b:
            return p + (q - p) * math.log(size / a) / math.log(b / a)
    return 100.0 if size >= rows[-1][0] else None


def regraded(soil):
    """On No. 4, as the manual of the Corps asks where 15 % or more are fines or the soil is broadly graded."""
    fines = finer(soil, 0.075) if min(size for size, _ in soil) <= 0.075 else min(p for _, p in soil)
    d10, d60 = d(soil, 10), d(soil, 60)
    gravel = 100 - finer(soil, 4.75) if max(size for size, _ in soil) > 4.75 else 0
    least = 4 if gravel > (100 - fines) / 2 else 6
    broad = d10 is None or d60 / d10 >= least
    if max(size for size, _ in soil) <= 4.75 or fines < 15 and not broad:
        return soil
    part = finer(soil, 4.75)
    return [(4.75, 100.0)] + [(size, p * 100 / part) for size, p in soil if size < 4.75]


def limits_of(base, dispersive):
    """Sherard and Dunnigan's limit of design (of a dispersive base the most that it can be), Foster and Fell's boundaries of no and of
    continuing erosion (None for 15 to 85 % fines and a D95B above 2 mm, where tests found no clear one), in mm."""
    soil = regraded(base)
    fines, d85, d95 = finer(soil, 0.075), d(soil, 85), d(soil, 95)
    clay, silt = (6.4 if dispersive else 9) * d85, 0.5 if dispersive else 0.7
    if fines > 85:
        design, no_erosion = max(clay, 0.2), clay
    else:
        design = silt if fines >= 40 else (40 - fines) / 25 * (4 * d85 - 0.7) + 0.7 if fines >= 15 else 4 * d85
        no_erosion = silt if fines >= 35 else 1.6 * ((35 - fines) / 20 * (4 * d85 - 0.7) + 0.7) if fines >= 15 else 7 * d85
    return design, no_erosion, None if d95 > 2 and 15 <= fines <= 85 else 9 * d95


def is_unstable(soil):
    """By Li and Fannin: less than min(F, 15 %) between D and 4 D, for F up to 20 % (Cu > 3) or 30 %."""
    rows = sorted(soil)
    if d(soil, 10) is None:
        return False
    sizes = [rows[0][0] * (rows[-1][0] / rows[0][0]) ** (at / 4000) for at in range(4001)]
    shares = [(finer(soil, size), finer(soil, 4 * size)) for size in sizes]
    most = 20 if d(soil, 60) > 3 * d(soil, 10) else 30
    return any(above - below < min(below, 15) for below, above in shares if 0 < below <= most)


def without_finest(soil):
    """D15F without the part finer than Kezdi's greatest split above 4 up to 20 % (that of the greatest ratio where none is), where the
    filter is not internally stable; else None."""
    if not is_unstable(soil):
        return None
    ratios = [(d(soil, at / 100 + 15) / d(soil, at / 100), at / 85) for at in range(1500, 5501) if d(soil, at / 100)]
    above = [split for ratio, split in ratios if ratio > 4 and split <= 20]
    split = above[-1] if above else max(ratios)[1]
    return d(soil, split + 0.15 * (100 - split))


def near(said, limit):
    """Whether a number, as it is printed, is this one within 1 % and half of its last digit."""
    decimals = len(said.split(".")[1]) if "." in said else 0
    return abs(float(said) - limit) <= 0.01 * limit + 0.5 * 10 ** -decimals


def faults_of_line(line, d15f, limits, washed_out):
    """What of a line of practice is not as by hand."""
    design, no_erosion, continuing = limits
    strictest = min(design, no_erosion)
    if line.startswith("meets") != (d15f <= design and (washed_out is None or washed_out <= strictest)):
        yield "met or not"
    washed = re.search(r"D15F ([\d.]+) mm without its finest", line)
    if "too coarse without it" in line and not (washed and near(washed[1], washed_out)):
        yield f"D15F after washout is {washed_out:.3g} mm"
    sizes = re.search(r"D15F ([\d.]+) mm, limit ([\d.]+) mm", line)
    if not sizes:
        yield "no D15F beside a limit"
        return
    if not near(sizes[1], d15f):
        yield f"D15F {sizes[1]}"
    if not near(sizes[2], design) and not near(sizes[2], strictest):
        yield f"limit {sizes[2]}"
    beyond = "at least some erosion" if continuing is None or d15f <= continuing else "continuing erosion"
    wanted = "no erosion" if d15f <= no_erosion else beyond
    said = "no-erosion criterion met" if wanted == "no erosion" else wanted
    # The limit of a dispersive base is that of no erosion, and taken for design, too; what may wash out leaves no class.
    if f"Foster and Fell: {said}" not in line and "note b" not in line and "lose its finer part" not in line:
        yield f"Foster and Fell: not {wanted}"
    if wanted.startswith("at least") and "not excluded" not in line:
        yield "nothing of excessive erosion"
    for word, limit in (("up to", no_erosion), ("beyond", continuing)):
        for number in re.findall(rf"{word} ([\d.]+) mm", line):
            if limit is None or not near(number, limit):
                yield f"{word} {number}"


def faults_of_rules(rules, d15f, limits):
    """What of the rules is not as by hand."""
    for rule, limit in zip(("sherard-dunnigan", "foster-fell-no-erosion"), limits):
        got = rules[rule]
        if got["limit"] is None or not math.isclose(got["limit"], limit, rel_tol=0.01) or not math.isclose(got["value"], d15f, rel_tol=0.01):
            yield f"{rule}: {got['value']} to {got['limit']} mm"
        if (got["met"] is False) != (d15f > limit):
            yield f"{rule}: met is {got['met']}"


def solved(name, options, folder):
    """The limits by hand, what the program says, and the faults of a problem."""
    base, filter_, *flags = PROBLEMS[name]
    limits = limits_of(SOILS[base], "--dispersive" in flags)
    for role, soil in (("base", base), ("filter", filter_)):
        rows = "".join(f"{size:g},{percent:g}\n" for size, percent in SOILS.get(soil, []))
        (folder / f"{role}.csv").write_text(f"Opening (mm),% passing\n{rows}")

    def program(*words):
        done = subprocess.run([options.binary, *words, *flags], cwd=folder, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{name}: exit code {done.returncode}: {done.stderr[-300:]}")
        return done.stdout

    if filter_ is None:
        program("design", "base.csv", "--out", name)
        greatest = json.loads((folder / name / "specification.json").read_text())["d15f_max_mm"]
        faults = [] if math.isclose(greatest, limits[0], rel_tol=0.01) else ["not the limit of design"]
        return limits, None, f"D15F at most {greatest:.3g} mm", faults
    d15f, washed_out = d(SOILS[filter_], 15), without_finest(SOILS[filter_])
    rules = {rule["id"]: rule for rule in json.loads(program("rules", "base.csv", "filter.csv", "--json"))["rules"]}
    faults = list(faults_of_rules(rules, d15f, limits))
    if name in RULES_ALONE:
        return limits, d15f, "rules alone", faults
    said = program("judge", "base.csv", "filter.csv", "--out", name, *(word for one in options.set for word in ("--set", one)))
    practice, model = (re.search(rf"^{line}: (.*)$", said, re.MULTILINE)[1] for line in ("Practice", r"Model \(research\)"))
    faults += faults_of_line(practice, d15f, limits, washed_out)
    page = (folder / name / "report.html").read_text()
    if re.search(r'<section class="verdict ([a-z]+)', page)[1] == "none" and not practice.startswith("meets"):
        faults.append("a green page")
    if len(said.splitlines()) > MOST_LINES:
        faults.append(f"{len(said.splitlines())} lines on stdout")
    return limits, d15f, f"{practice}<br>*{model}*", faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="target/release/voidwalk", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="settings of every walk")
    options = parser.parse_args()
    equal = 0
    print("| problem | D15F; design; no erosion; continuing (mm), by hand | practice and model | |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in PROBLEMS:
            limits, d15f, said, faults = solved(name, options, pathlib.Path(folder))
            equal += not faults
            numbers = "; ".join("-" if number is None else f"{number:.3g}" for number in (d15f, *limits))
            words = " on ".join(filter(None, reversed(PROBLEMS[name][:2])))
            print(f"| {name}: {words} | {numbers} | {said.replace('|', '/')} | {'; '.join(faults) or 'equal'} |", flush=True)
    print(f"{equal} of {len(PROBLEMS)} equal")
    return 0 if equal == len(PROBLEMS) else 1


if __name__ == "__main__":
    sys.exit(main())
