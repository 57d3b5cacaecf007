#!/usr/bin/env python3
"""How coarse may a filter be, by four models, beside tests: lattice or the packing's own voids, by area or by water.

    scripts/studies/four_way.py --binary target/release/voidwalk --work FOLDER --out results/four-way --minutes 120

Packs each filter with several seeds into FOLDER (once), walks the cells of PLAN in their order until the time is over, and writes
OUT.csv (every walk), OUT-cells.csv, OUT.svg and OUT.md. What is in OUT.csv is not walked again, so that a study that was stopped goes on; with
--minutes 0 the page alone is written anew, with the version that it names. Replicate r is packing r with seed r.

A replicate's boundary is the smallest D15F/D85B at which its first run (no erosion turns to some) or its second (some turns to
continuing) loses 7.5 % of the mass: bracketed on a ladder of 6 %, halved once, linear in between, with two rungs below walked so
that erosion that comes and goes is seen. Particles that can block nothing are moved as their expectation (engine expected).
"""

import argparse
import csv
import datetime
import json
import math
import pathlib
import platform
import resource
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from four_way_beside import EXPECTED  # noqa: E402
from four_way_cells import FILTERS, THRESHOLD, d50_by_number  # noqa: E402
from four_way_page import date_of_page, version_of_page, write_page  # noqa: E402

RUNG, TOP = 1.06, 47  # D15F/D85B from 1 to 15.5
MODELS = {
    "lattice, area": [],
    "lattice, flux": ['walk.exit="flux"'],
    "graph, flux": ['walk.exit="flux"'],
    "graph, area along flow": ['walk.exit="area-along-flow"'],
}
FOUR = ["Cu 1.5 loose", "Cu 3 loose", "Cu 1.5 dense", "Cu 3 dense"]
# Voids across a lattice, each way.
ACROSS = 20
KEY = ["filter", "model", "base_cu", "layers", "mass_ratio", "replicate", "ratio"]
ENGINE = "expected"
FIELDS = KEY + ["engine", "eroded_1", "eroded_2", "k_over_k0_1", "k_over_k0_2", "voids", "thickness_mm", "cpu_seconds"]


def plan():
    """Cells in the order in which they are walked: filter, model, Cu of the base, layers, mass ratio, replicates."""
    cells = []

    def add(filters, models, bases, layers, replicates, mass_ratio=0.05):
        for base in bases:
            for name in filters:
                for model in models:
                    cells.append((name, model, base, layers, mass_ratio, replicates))

    area, water, loose = ["lattice, area"], ["graph, flux"], ["Cu 1.5 loose"]
    others = ["Cu 1.5 dense", "Cu 3 loose", "Cu 3 dense"]
    add(loose, area, [1.5], 60, 2)
    add(loose, water, [1.5], 60, 1)
    add(loose, area, [1.5], 30, 1)
    add(loose, area, [1.5], 240, 1)
    add(["Cu 1.5 dense"], area, [1.5], 60, 1)
    add(loose, area, [3.0, 4.5], 60, 1)
    add(loose, ["lattice, flux"], [1.5], 60, 1)
    add(["Cu 1.5 dense"], water, [1.5], 60, 1)
    # Particles retained as if 2.155 times as large: a base so many times as large, in the same numbers.
    add(loose, area, [1.5], 60, 1, 0.05 * 2.155**3)
    add(["Cu 3 loose", "Cu 3 dense"], area, [1.5], 60, 1)
    add(loose, area, [1.5], 600, 1)
    add(["Cu 3 loose", "Cu 3 dense"], water, [1.5], 60, 1)
    add(others, area, [3.0, 4.5], 60, 1)
    add(loose, water, [3.0, 4.5], 60, 1)
    add(loose, ["graph, area along flow"], [1.5], 60, 1)
    add(loose, water, [1.5], 240, 1)
    add(["Cu 1.2 dense", "Cu 6 loose"], area, [1.5], 60, 1)
    add(others, area, [1.5], 600, 1)
    add(others, ["lattice, flux"], [1.5], 60, 1)
    add(loose, water, [1.5], 60, 1, 0.05 * 2.155**3)
    add(loose, water, [1.5], 600, 1)
    add(["Cu 1.2 dense", "Cu 6 loose"], water, [1.5], 60, 1)
    add(["Cu 1.2 dense", "Cu 6 loose"], area, [3.0, 4.5], 60, 1)
    add(others, water, [3.0, 4.5], 60, 1)
    add(loose, ["lattice, flux"], [1.5], 600, 1)
    add(loose, area, [1.5], 2400, 1)
    add(others, water, [1.5], 600, 1)
    add(FOUR, ["lattice, flux"], [3.0, 4.5], 60, 1)
    add(["Cu 1.2 dense", "Cu 6 loose"], ["lattice, flux"], [1.5], 60, 1)
    add(loose, water, [1.5], 2400, 1)
    return cells


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--work", required=True, type=pathlib.Path, help="folder for the packings")
    parser.add_argument("--threads", default="1")
    parser.add_argument("--minutes", type=float, default=120.0, help="no walk begins after so many minutes")
    parser.add_argument("--longest", type=float, default=1200.0, help="seconds after which a walk is given up")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    return parser.parse_args()


class TimeIsOver(Exception):
    pass


class Study:
    def __init__(self, options):
        self.options = options
        self.until = time.time() + 60.0 * options.minutes
        path = pathlib.Path(f"{options.out}.csv")
        self.rows = list(csv.DictReader(path.open())) if path.exists() else []
        self.known = {tuple(row[name] for name in KEY): row for row in self.rows}
        self.file = path.open("a", newline="")
        self.writer = csv.DictWriter(self.file, FIELDS)
        if self.rows and self.rows[0].get("engine") != ENGINE:
            sys.exit(f"{path}: was not walked with engine {ENGINE}: give another --out")
        if not self.rows:
            self.writer.writeheader()
            self.file.flush()
        self.found = {}

    def command(self, *arguments):
        """Runs the program; what it says where it fails, else None."""
        if time.time() > self.until:
            raise TimeIsOver
        command = [self.options.binary, *map(str, arguments), "--threads", self.options.threads, "--quiet"]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=self.options.longest)
        except subprocess.TimeoutExpired:
            return f"not done after {self.options.longest:g} s"
        return None if done.returncode == 0 else done.stderr

    def packing(self, name, replicate):
        cu, friction, grains = FILTERS[name]
        folder = self.options.work / f"cu{cu:g}-mu{friction:g}-seed{replicate}"
        if not (folder / "packing.json").exists():
            self.options.work.mkdir(parents=True, exist_ok=True)
            scene = self.options.work / "filter.toml"
            scene.write_text(f"[filter]\ncu = {cu}\nfriction = {friction}\n[packing]\ngrains = {grains}\n")
            if problem := self.command("pack", scene, "--seed", replicate, "--out", folder):
                raise SystemExit(problem)
        return folder

    def scene(self, cell, replicate, ratio):
        name, model, base, layers, mass_ratio, _ = cell
        packing = self.packing(name, replicate).resolve()
        measured = json.loads((packing / "constrictions.json").read_text())
        cu = FILTERS[name][0]
        lines = ["replicates = 1", f"seed = {replicate}", f'engine = "{ENGINE}"', "[filter]", f"cu = {cu}"]
        if model.startswith("lattice"):
            lines += ["d0_mm = 1", f'curve = "{packing / "constrictions.csv"}"']
            lines += [f"grains_per_void = {measured['grains_per_void']}"]
            network = [f"nx = {ACROSS}", f"ny = {ACROSS}", f"nz = {layers}"]
        else:
            lines += ["d0_mm = 1"]
            network = ['kind = "graph"', f'packing = "{packing / "grains.csv"}"', f"thickness_mm = {layers * d50_by_number(cu)}"]
        lines += ["[base]", f"cu = {base}", f"d15f_over_d85b = {ratio:.6f}", f"mass_ratio = {mass_ratio:.6f}"]
        lines += ["[network]", *network, "[walk]", *(line.removeprefix("walk.") for line in MODELS[model])]
        return "\n".join(lines + ["[record]", "sensitivity = []", "series_every = 0", ""])

    def walk(self, cell, replicate, ratio):
        """Eroded shares of both runs; walked where they are not known."""
        key = tuple(map(str, (*cell[:4], f"{cell[4]:.6f}", replicate, f"{ratio:.6f}")))
        if key not in self.known:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            with tempfile.TemporaryDirectory() as scratch:
                path, out = pathlib.Path(scratch) / "scene.toml", pathlib.Path(scratch) / "run"
                path.write_text(self.scene(cell, replicate, ratio))
                if problem := self.command("run", path, "--out", out):
                    raise RuntimeError(problem)
                outcome = json.loads((out / "outcome.json").read_text())
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            runs, network = outcome["replicates"][0]["runs"], outcome.get("network", {})
            row = dict(zip(KEY, key)) | {f"eroded_{run['run']}": f"{run['eroded_mass_fraction']:.6f}" for run in runs}
            row |= {f"k_over_k0_{run['run']}": f"{run['k_over_k0']:.4f}" for run in runs if run.get("k_over_k0") is not None}
            row |= dict(engine=ENGINE, voids=network.get("voids", ACROSS * ACROSS * cell[3]), cpu_seconds=f"{seconds:.2f}")
            if "thickness_mm" in network:
                row |= dict(thickness_mm=f"{network['thickness_mm']:.4f}")
            self.writer.writerow(row)
            self.file.flush()
            self.known[key] = row
            print(*key, row["eroded_1"], row["eroded_2"], row["cpu_seconds"], flush=True)
        row = self.known[key]
        return float(row["eroded_1"]), float(row["eroded_2"])

    def boundary(self, cell, replicate, run, guess):
        """Where a run begins to lose 7.5 %: the ratio; infinite where the top of the ladder holds, 0 where its foot erodes."""
        eroded = lambda rung: self.walk(cell, replicate, RUNG**rung)[run]
        fails = lambda rung: eroded(rung) >= THRESHOLD
        # Strides of four rungs until the boundary lies between two, then halves.
        high = guess
        while high < TOP and not fails(high):
            high = min(high + 4, TOP)
        if not fails(high):
            return math.inf
        low = max(high - 4, 0)
        while low > 0 and fails(low):
            high, low = low, max(low - 4, 0)
        if fails(low):
            return 0.0
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if fails(middle) else (middle, high)
        # Erosion that comes and goes: where a rung below erodes too, the boundary is there.
        while low > 0 and fails(low - 1):
            high, low = low - 1, low - 2
            while low > 0 and fails(low):
                high, low = low, low - 1
        if fails(max(low, 0)):
            return 0.0
        points = [(RUNG**rung, eroded(rung)) for rung in (low, low + 0.5, high)]
        before, after = (points[0], points[1]) if points[1][1] >= THRESHOLD else (points[1], points[2])
        return before[0] + (THRESHOLD - before[1]) / (after[1] - before[1]) * (after[0] - before[0])

    def beside_the_prototype(self):
        """The ratios of which it was said beforehand what to expect."""
        for model, ratio in EXPECTED:
            self.walk(("Cu 1.5 loose", model, 1.5, 60, 0.05, 1), 1, ratio)

    def cell(self, cell):
        """Both boundaries of every replicate."""
        found = self.found.setdefault(cell, [])
        for replicate in range(1, cell[5] + 1):
            last = found[-1] if found else self.beside(cell)
            rung = lambda ratio: min(TOP, max(0, math.ceil(math.log(ratio) / math.log(RUNG)))) if 0 < ratio < math.inf else 20
            first = self.boundary(cell, replicate, 0, rung(last[0]))
            second = self.boundary(cell, replicate, 1, rung(first))
            found.append((first, second))

    def beside(self, cell):
        """Boundaries of a cell that differs from this one the least."""
        alike = lambda other: sum(a == b for a, b in zip(cell[1:5], other[1:5])) + (cell[1] == other[1]) + (cell[4] == other[4])
        near = max((other for other in self.found if self.found[other]), key=alike, default=None)
        # Where nothing like it was walked, from below: a finer base has fewer particles and costs less.
        alone = (2.5, 2.2) if cell[1] != "lattice, area" else (4.4, 4.9)
        return self.found[near][0] if near and near[1] == cell[1] else alone


def main():
    options = arguments()
    study = Study(options)
    refused = {}
    # Beside what was expected, after the first cells.
    walks = [*plan()[:7], None, *plan()[7:]]
    for cell in walks if options.minutes > 0 else []:
        try:
            if cell is None:
                study.beside_the_prototype()
                continue
            study.cell(cell)
            print("==", *cell, study.found[cell], flush=True)
        except TimeIsOver:
            # Cells that are known wholly need no walk.
            continue
        except RuntimeError as problem:
            refused[cell] = str(problem).strip().splitlines()[-1]
            print("!!", *cell, problem, flush=True)
    version = version_of_page(options.out) if options.minutes <= 0 else None
    date = date_of_page(options.out) if options.minutes <= 0 else None
    if version is None:
        version = subprocess.run([options.binary, "--version"], capture_output=True, text=True).stdout.strip()
        version = f"`{version}`, {platform.machine()}"
    write_page(options.out, plan(), list(study.known.values()), refused, version, date or str(datetime.date.today()))


if __name__ == "__main__":
    main()
