#!/usr/bin/env python3
"""Models of filters beside tests: where the base begins to erode, with and without water, arches and openings; the largest particle that passes.

    scripts/studies/laboratory.py --work FOLDER [--out results/laboratory] [--increments results/laboratory-increments.csv]
        [--experiment results/laboratory-experiment.csv] [--binary target/release/voidwalk] [--minutes 40]

Walks the cells of `plan` in their order into OUT.csv until so many minutes of processor time are used; cells that are there already are
not walked again. `laboratory_page.py` draws OUT.svg from it and prints what OUT.md says. FOLDER keeps the packings of the graphs.

Filters from the library of packings, bases linear on semi-log paper (Cu 1: one size), two runs, five replicates. Lattice: 10 x 10 x 60
voids. Graph: the voids of five packings, one a replicate, as thick as 60 layers, rounded up to whole copies of the packing. A
constriction of a graph has no direction, so that area alone leads nowhere: "by area" exits are chosen by area among those that water
leaves by, and the first run alone is walked. Of a packing that is the finer part of its filter the base is that of the whole.

Boundaries are D15F/D85B at which 7.5 % of the mass erodes in the first run and in the second, bracketed to 4 %: where the mean crosses,
and where the first and the last replicate do, by interpolation. Ratios are walked until every replicate holds at the least and erodes at
the greatest, or the cell has used its time. `k_over_k0`: at the end of the first run, at the greatest ratio below its boundary. Rows
`largest`: the largest eroded particle by D0F, over bases of Cu 1.2 in steps of 3 %, of those bases whose own largest particle did not
pass.

`--experiment`: what each law predicts for uniform beads on beads (mass passed in the first run, k/k0), into this CSV and nothing else.

`--increments`: what erodes on graphs by area just below the boundary, by the share of the base that an increment inserts, into this CSV
and nothing else.
"""

import concurrent.futures
import json
import math
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

import common
from arches import ERODED, THRESHOLD, Walks, concentrations, crossing, each, eroded_of

CELL = ["measure", "filter_cu", "density", "base_cu", "network", "exit", "law", "concentration", "blocked"]
RUNS = ["first", "second"]
FOUND = ["", "_least", "_most", "_holds_to", "_erodes_from"]
COLUMNS = CELL + [run + what for run in RUNS for what in FOUND] + ["k_over_k0", "replicates", "cpu_seconds"]
REPLICATES, LAYERS, CLOSE, LONGEST = 5, 60, 1.04, 160.0
# How far the next ratio lies outwards.
STEP, STEP_BY_AREA = 1.15, 1.08
FARTHEST = 16.1
# Friction, as in the library, and number of grains of the packings of the graphs. With 10,000 grains of Cu 6 the cell takes the finer 78 % of the mass.
FRICTIONS, GRAINS = {"loose": 0.3, "dense": 0.0}, {"1.5": 3000, "3": 6000, "6": 10000}
MASS_RATIO = 0.05
NONE, MARIN, ZURIGUEL, CRITICAL = "none", "marin-2018", "zuriguel-2005", "critical-3"
SANDS = [("1.5", "loose"), ("1.5", "dense"), ("3", "loose"), ("3", "dense")]
LOOSE, BEADS, BROAD, BROAD_DENSE = ("1.5", "loose"), ("1.2", "dense"), ("6", "loose"), ("6", "dense")
BASES = ["1.5", "3", "4.5"]
# How a particle chooses its exit on a graph where water does not choose it.
BY_AREA = "area-along-flow"


def plan():
    """The cells of the page, each once."""
    return dict.fromkeys(cells())


def cells():
    """Largest particles, then boundaries: by area on the lattice, with water, and by area on graphs."""
    def walked(filters, bases, network="lattice", exit="area", law=NONE, blocked="closed", measure="boundary"):
        for of in filters:
            for base in bases:
                for concentration in concentrations(law):
                    yield measure, *of, base, network, exit, law, concentration, blocked

    for law in (NONE, MARIN):
        yield from walked([BEADS, ("3", "loose"), BROAD], ["1.2"], law=law, measure="largest")
    yield from walked([*SANDS, BROAD], BASES)
    yield from walked([BEADS], ["1", "1.2"])
    yield from walked(SANDS, ["3", "4.5"], law=MARIN)
    yield from walked([BROAD], BASES, law=MARIN)
    for of, base in ((("1.5", "dense"), "1.5"), (("3", "loose"), "3"), (BEADS, "1.2")):
        yield from walked([of], [base], blocked="open")
    for blocked in ("closed", "open"):
        yield from walked([LOOSE], ["1.5", "3"], exit="flux", blocked=blocked)
        yield from walked([LOOSE], ["1.5"], "graph", "flux", blocked=blocked)
    yield from walked([BEADS], ["1.2"], exit="flux")
    yield from walked([LOOSE], ["3"], "graph", "flux")
    yield from walked([("3", "loose")], ["3"], "graph", "flux")
    for network in ("lattice", "graph"):
        yield from walked([LOOSE], ["1.5"], network, "flux", MARIN)
    yield from walked([*SANDS, BROAD, BROAD_DENSE], BASES, "graph", BY_AREA)
    for law in (CRITICAL, ZURIGUEL):
        yield from walked(SANDS[:2], BASES, "graph", BY_AREA, law)
    # Of laws and Cu 3 those that there was time for.
    yield from walked(SANDS[2:], ["1.5"], "graph", BY_AREA, CRITICAL)
    yield from walked(SANDS[2:3], ["3"], "graph", BY_AREA, CRITICAL)
    yield from walked(SANDS[2:], ["4.5"], "graph", BY_AREA, ZURIGUEL)


INCREMENTS_CELL = ["filter_cu", "density", "base_cu", "law", "concentration", "d15f_over_d85b", "inject_share"]


def increments_cells():
    """One filter just below four of its boundaries on graphs by area, by the share of the base in an increment."""
    for base, law, concentration, ratio in [("3", NONE, "", 3.1), ("1.5", NONE, "", 2.8), ("1.5", MARIN, 0.05, 5.5), ("1.5", CRITICAL, "", 8.0)]:
        for share in ("0.01", "0.003", "0.001"):
            yield *LOOSE, base, law, concentration, ratio, share


EXPERIMENT_CELL = ["d15f_over_d85b", "law", "concentration", "blocked", "inject_share"]
EXPERIMENT_RATIOS = [6.5, 8.0, 10.0]


def experiment_cells():
    """Uniform beads on beads of Cu 1.2, dense: every law at every concentration, blocked constrictions closed and open, by the share of an increment."""
    laws = [(law, concentration) for law in (NONE, MARIN, CRITICAL, ZURIGUEL) for concentration in concentrations(law)]
    rows = [(0.01, blocked, ratio, laws) for blocked in ("closed", "open") for ratio in EXPERIMENT_RATIOS]
    rows += [(0.001, "closed", 8.0, laws), (0.001, "open", 8.0, laws), (0.001, "closed", 6.5, laws), (0.001, "closed", 10.0, laws[:2])]
    for share, blocked, ratio, walked in rows:
        for law, concentration in walked:
            yield ratio, law, concentration, blocked, share


class Models(Walks):
    """Walks of cells: boundaries of two runs, and largest particles."""

    names, close = CELL, CLOSE

    def __init__(self, options):
        super().__init__(options)
        self.work, self.until = options.work, 60.0 * options.minutes
        self.used = 0.0

    def outcomes(self, cell, settings):
        """One outcome with five replicates; of a graph, five with one, several at a time."""
        if cell[4] == "lattice":
            return [self.outcome(settings)]
        seeds = range(1, REPLICATES + 1)
        with concurrent.futures.ThreadPoolExecutor(int(self.threads)) as workers:
            one = lambda of: self.outcome(settings | of, threads=1)
            return list(workers.map(one, [self.packing(cell, seed) | {"seed": seed} for seed in seeds]))

    def packing(self, cell, seed):
        """The settings of a packing of the cell's filter, made where it is not there yet."""
        cu, density = cell[1:3]
        friction, grains = FRICTIONS[density], GRAINS[cu]
        folder = self.work / f"cu{cu}-{density}-seed{seed}"
        if not (folder / "packing.json").exists():
            with tempfile.TemporaryDirectory() as scratch:
                scene = Path(scratch) / "filter.toml"
                scene.write_text(f"[filter]\ncu = {cu}\nfriction = {friction}\n[packing]\ngrains = {grains}\n")
                command = [self.binary, "pack", scene, "--seed", seed, "--out", folder, "--threads", self.threads, "--quiet"]
                subprocess.run([str(part) for part in command], check=True)
        part = json.loads((folder / "packing.json").read_text()).get("part")
        share = part["percent"] / 100 if part else 1.0
        return {"network.packing": f'"{(folder / "grains.csv").resolve()}"', "base.mass_ratio": MASS_RATIO / share}

    def settings(self, cell, ratio):
        """What differs from the built-in scene."""
        measure, filter_cu, density, base_cu, network, exit, law, concentration, blocked = cell
        settings = {
            "filter.cu": filter_cu, "filter.d0_mm": 1, "base.cu": base_cu, "base.d15f_over_d85b": round(ratio, 6),
            "runs": 1 if exit == BY_AREA else 2,
            "record.sensitivity": "[]", "record.thickness": "[]", "walk.arching": law, "walk.blocked": blocked,
            "engine": "particles" if blocked == "open" else "expected",
        }
        if network == "lattice":
            settings |= {"filter.library": density, "replicates": REPLICATES, "network.nx": 10, "network.ny": 10, "network.nz": LAYERS}
        else:
            settings |= {"network.kind": '"graph"', "network.thickness_mm": LAYERS * d50_by_number(float(filter_cu)), "replicates": 1}
        if exit != "area":
            settings["walk.exit"] = f'"{exit}"'
        if concentration != "":
            settings["walk.concentration"] = concentration
        return settings

    def row(self, cell):
        """A cell's row of the CSV."""
        if self.used > self.until:
            raise SystemExit("the time is over; the cells that follow are not walked")
        if cell[4] == "graph":
            # Made before the cell's time begins.
            for seed in range(1, REPLICATES + 1):
                self.packing(cell, seed)
        before = self.time()
        row = self.largest(cell) if cell[0] == "largest" else self.boundaries(cell, before)
        seconds = self.time() - before
        self.used += seconds
        print(*cell, row, f"{seconds:.0f} s", flush=True)
        return dict(zip(CELL, cell)) | row | {"cpu_seconds": round(seconds, 1)}

    def first_runs(self, cell, ratio, share):
        """What erodes in the first runs with this share of the base in an increment, and how much water flows at their end."""
        outcomes = self.outcomes(cell, self.settings(cell, ratio) | {"runs": 1, "inject_share": share})
        runs = [replicate["runs"][0] for outcome in outcomes for replicate in outcome["replicates"]]
        return eroded_of(runs) | {"k_over_k0": f"{statistics.mean(run['k_over_k0'] for run in runs):.3g}"}

    def experiment(self, of):
        """What one test of the experiment would give."""
        ratio, law, concentration, blocked, share = of
        cell = ("boundary", *BEADS, "1", "lattice", "flux", law, concentration, blocked)
        return dict(zip(EXPERIMENT_CELL, of)) | self.first_runs(cell, ratio, share)

    def increments(self, of):
        """What erodes just below a boundary with this share of the base in an increment."""
        *pair, law, concentration, ratio, share = of
        cell = ("boundary", *pair, "graph", BY_AREA, law, concentration, "closed")
        return dict(zip(INCREMENTS_CELL, of)) | self.first_runs(cell, ratio, share)

    @staticmethod
    def time():
        """Processor time of all walks so far."""
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    def boundaries(self, cell, before):
        """The boundaries of its runs, the first run's first."""
        walked, kept = {}, {}
        runs = RUNS[: self.settings(cell, guess(cell))["runs"]]
        step = STEP_BY_AREA if cell[5] == BY_AREA else STEP
        shares = lambda run: {ratio: of[run] for ratio, of in walked.items()}
        while self.time() - before < LONGEST:
            ratio = next((ratio for run in range(len(runs)) if (ratio := next_ratio(shares(run), guess(cell), step)) is not None), None)
            if ratio is None:
                break
            outcomes = self.outcomes(cell, self.settings(cell, ratio))
            replicates = [replicate["runs"] for outcome in outcomes for replicate in outcome["replicates"]]
            walked[ratio] = [[of[run]["eroded_mass_fraction"] for of in replicates] for run in range(len(runs))]
            kept[ratio] = [of[0].get("k_over_k0") for of in replicates]
        row = {"replicates": min((len(of) for both in walked.values() for of in both), default=0)}
        for at, run in enumerate(runs):
            row |= {run + what: value for what, value in zip(FOUND, boundary(shares(at)))}
        below = [ratio for ratio, of in kept.items() if row["first_holds_to"] == round(ratio, 3) and None not in of]
        if below:
            row["k_over_k0"] = f"{statistics.mean(kept[below[0]]):.3g}"
        return row

    def largest(self, cell):
        """The largest particle that eroded, by D0F, over bases of rising size: mean, least and most of the replicates."""
        # Finer than what passed in any test: nothing there is stopped.
        found, d50 = [0.0] * REPLICATES, 0.12 if cell[1] == "1.2" else 0.19
        while d50 < 0.5:
            # D15F by D85B of linear curves from D0F = 1.
            ratio = float(cell[1]) ** 0.3 / (d50 * float(cell[3]) ** 0.7)
            replicates = self.outcome(self.settings(cell, ratio) | {"runs": 1})["replicates"]
            eroded = [replicate["runs"][0].get("largest_eroded_mm") or 0.0 for replicate in replicates]
            # What is as large as the base's own largest says nothing of the filter.
            largest = d50 * float(cell[3])
            found = [max(old, new) if new < 0.995 * largest else old for old, new in zip(found, eroded)]
            if max(eroded) == 0.0:
                break
            d50 *= 1.03
        return {"first": round(statistics.mean(found), 4), "first_least": round(min(found), 4), "first_most": round(max(found), 4),
                "replicates": len(replicates)}


def d50_by_number(cu):
    """D50 by number of a linear gradation from 1 mm: the thickness of a layer of the lattice."""
    return ((1.0 + cu**-6) / 2.0) ** (-1.0 / 3.0)


def guess(cell):
    """The ratio at which a cell's search begins."""
    exit, law = cell[5:7]
    if exit == BY_AREA:
        # The boundary of a narrow base by sieving; laws of dense flow hold some three times as coarse a filter.
        sieved = {("1.5", "dense"): 3.5, ("3", "dense"): 3.5, BROAD: 3.4, BROAD_DENSE: 4.1}.get(cell[1:3], 2.9)
        return sieved if law == NONE else 3.0 * sieved
    without = 3.2 if exit == "flux" else 4.6
    return without if law == NONE else 8.0


def next_ratio(walked, begin, step):
    """Where to walk next: outwards until every replicate holds below and erodes above, and between until the mean's crossing is close."""
    if not walked:
        return begin
    ratios = sorted(walked)
    holds = [ratio for ratio in ratios if max(walked[ratio]) < THRESHOLD]
    erodes = [ratio for ratio in ratios if min(walked[ratio]) >= THRESHOLD]
    if not holds and ratios[0] > 1.0:
        return ratios[0] / step
    if not erodes and ratios[-1] * step <= FARTHEST:
        return ratios[-1] * step
    mean = [ratio for ratio in ratios if statistics.mean(walked[ratio]) >= THRESHOLD]
    below = [ratio for ratio in ratios if mean and ratio < mean[0]]
    if not below:
        return None
    high = mean[0]
    return math.sqrt(below[-1] * high) if high / below[-1] > CLOSE else None


def boundary(walked):
    """Where the mean crosses, where the first and the last replicate do, and the ratios walked on both sides of the mean's crossing."""
    mean = {ratio: statistics.mean(of) for ratio, of in walked.items()}
    single = [crossing(dict(zip(walked, of))) for of in zip(*walked.values())]
    at, ratios = crossing(mean), sorted(mean)
    erodes = next((ratio for ratio in ratios if mean[ratio] >= THRESHOLD), None)
    holds = max((ratio for ratio in ratios if erodes is None or ratio < erodes), default=None)
    rounded = lambda value, digits=2: "" if value is None else round(value, digits)
    least = min((value for value in single if value), default=None)
    # A replicate that never erodes has no crossing; one that erodes at the least ratio walked begins somewhere below it.
    most = max(single) if None not in single else None
    return rounded(at if holds else None), rounded(least if least and least > ratios[0] else None), rounded(most), rounded(holds, 3), rounded(erodes, 3)


def main():
    parser = common.parser(__doc__, threads="1")
    parser.add_argument("--work", type=Path, required=True, help="folder for the packings")
    parser.add_argument("--out", help="of the cells")
    parser.add_argument("--increments", type=Path)
    parser.add_argument("--experiment", type=Path)
    parser.add_argument("--minutes", type=float, default=40.0, help="of processor time, after which no cell begins")
    options = parser.parse_args()
    if options.experiment:
        columns = [*EXPERIMENT_CELL, *ERODED, "k_over_k0"]
        each(options.experiment, EXPERIMENT_CELL, columns, dict.fromkeys(experiment_cells()), Models(options).experiment)
    if options.increments:
        each(options.increments, INCREMENTS_CELL, [*INCREMENTS_CELL, *ERODED, "k_over_k0"], increments_cells(), Models(options).increments)
    if options.out:
        each(Path(f"{options.out}.csv"), CELL, COLUMNS, plan(), Models(options).row)


if __name__ == "__main__":
    main()
