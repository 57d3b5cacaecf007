#!/usr/bin/env python3
"""How void ratio, constriction curve and run time of a packing depend on the settings of its compression.

    scripts/studies/study_packing.py [--set narrow|wide|table2] [--grains 5000] [--seeds 1,2,3] [--work target/study-packing]

`narrow` is Cu 1.5, dense and loose; `wide` is Cu 3, dense and loose, and Cu 6: every row is the protocol with its default settings, but for
a tenth of the stiffness (half the time) and what it names. `table2` is the six filters of the paper with the numbers of grains that go with
them (then --grains is ignored). The table in Markdown gives the mean over the seeds and, after the sign, the standard deviation of one
packing. One thread, so that CPU seconds mean something on a busy machine. Every run is kept as a JSON line in WORK/runs.jsonl, and is not
done again if it is there (delete the file after a change of the program).

Dc5, Dc50 and Cu_CSD are those of `voidwalk constrictions`; diameters are relative to the smallest grain of the gradation.
"""

import json
import os
import pathlib
import statistics
import subprocess

import common

BASE = {"stiffness_ratio": 0.1, "hold_steps": 4000, "max_steps": 400_000}

# The hold is a number of steps, and the step goes with stiffness to the power of -1/3: rows of other stiffness hold for the same time.
VARIANTS = {
    "none": {},
    "stiffness 0.01": {"stiffness_ratio": 0.01, "hold_steps": 1860},
    "stiffness 0.3": {"stiffness_ratio": 0.3, "hold_steps": 5770},
    "stiffness 1": {"stiffness_ratio": 1, "hold_steps": 8620},
    "half the compression and servo rate": {"squeeze_rate": 5e-3, "servo_rate": 1e-3},
    "mass exponent 0 (true masses)": {"mass_exponent": 0},
    "mass exponent 2": {"mass_exponent": 2},
    "1500 grains": {"grains": 1500},
    "15000 grains": {"grains": 15000},
    "restitution 0.2": {"restitution": 0.2},
    "restitution 0.8": {"restitution": 0.8},
    "drag 0.01": {"drag": 0.01},
    "drag 0.1": {"drag": 0.1},
    "settling drag 0.03": {"settling_drag": 0.03},
    "settling drag 0.3": {"settling_drag": 0.3},
    "start fraction 0.2": {"start_fraction": 0.2},
    "start fraction 0.45": {"start_fraction": 0.45},
    "compression to a fraction of 0.8": {"compression_target_fraction": 0.8},
    "servo gain 0.003": {"servo_gain": 3e-3},
    "servo gain 0.03": {"servo_gain": 3e-2},
    "half the time step": {"step_fraction": 0.35, "hold_steps": 8000},
    "twice the hold": {"hold_steps": 8000},
}

FILTERS = {"narrow": [(1.5, 0.0), (1.5, 0.3)], "wide": [(3.0, 0.0), (3.0, 0.3), (6.0, 0.7)]}
HEAD = ["void ratio", "with friction 0.3", "coordination without rattlers", "rattler fraction", "Dc5", "Dc50", "Cu_CSD", "steps", "CPU s"]
DIGITS = {"void_ratio_before": 4, "void_ratio": 4, "coordination_held": 2, "rattlers": 3, "dc5": 4, "dc50": 4, "cu_csd": 3}

# Cu, friction, grains, void ratio of the paper's Table 2.
TABLE2 = [
    (1.2, 0.0, 8262, 0.558), (1.5, 0.0, 9313, 0.531), (1.5, 0.3, 9313, 0.658),
    (3.0, 0.0, 22600, 0.382), (3.0, 0.3, 22600, 0.455), (6.0, 0.7, 60000, 0.340),
]


def one(pack, voidwalk, settings, work):
    """One packing and its curve."""
    table = work / "packing.csv"
    command = [pack, "threads=1", f"out={table}", *(f"{k}={v}" for k, v in settings.items())]
    done, seconds = common.spent(command, check=True, capture_output=True, text=True)
    line = json.loads(done.stdout.strip().splitlines()[-1]) | {"cpu_s": seconds}
    curve = subprocess.run([voidwalk, "constrictions", str(table), "--overwrite", "--json", "--out", str(work / "curve")],
                           check=True, capture_output=True, text=True)
    curve = json.loads(curve.stdout)
    line["dc5"], line["dc50"] = curve["dc_mm"]["5"] / curve["d0_mm"], curve["dc_mm"]["50"] / curve["d0_mm"]
    line["cu_csd"] = curve["cu_csd"]
    return line


def spread(lines, field, digits):
    values = [line[field] for line in lines]
    mean = f"{statistics.fmean(values):.{digits}f}"
    return mean if len(values) < 2 else f"{mean} ± {statistics.stdev(values):.{digits}f}"


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--set", choices=["narrow", "wide", "table2"], default="narrow")
    parser.add_argument("--grains", type=int, default=5000)
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--work", type=pathlib.Path, default=common.ROOT / "target/study-packing")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    kept = options.work / "runs.jsonl"
    known = {json.dumps(entry["settings"], sort_keys=True): entry["result"] for entry in common.lines_of(kept)}
    pack = common.bench("packing")

    def result(settings):
        key = json.dumps(settings, sort_keys=True)
        if key not in known:
            known[key] = one(pack, options.binary, settings, options.work)
            common.keep(kept, {"settings": settings, "result": known[key], "load": os.getloadavg()[0]})
        return known[key]

    seeds = [int(s) for s in options.seeds.split(",")]

    def row(name, lines):
        cells = [spread(lines, field, digits) for field, digits in DIGITS.items()]
        cells += [f"{statistics.fmean(line[field] for line in lines):.{digits}f}" for field, digits in (("steps", 0), ("cpu_s", 1))]
        settled = sum(line["settled"] for line in lines)
        note = "" if settled == len(lines) else f" ({settled} of {len(lines)} at rest)"
        print(f"| {name}{note} | " + " | ".join(cells) + " |", flush=True)

    def header(first):
        print(f"| {first} | " + " | ".join(HEAD) + " |\n|" + "---|" * (len(HEAD) + 1), flush=True)

    if options.set == "table2":
        header("Cu, friction, grains (void ratio of the paper)")
        for cu, friction, grains, paper in TABLE2:
            row(f"{cu:g}, {friction:g}, {grains} ({paper})",
                [result({"cu": cu, "friction": friction, "grains": grains, "seed": s}) for s in seeds])
        return
    for cu, friction in FILTERS[options.set]:
        print(f"\nCu {cu:g}, friction {friction:g}, {options.grains} grains, seeds {options.seeds}\n")
        header("changed")
        for name in VARIANTS:
            base = {"cu": cu, "friction": friction, "grains": options.grains, **BASE}
            row(name, [result({**base, **VARIANTS[name], "seed": s}) for s in seeds])


if __name__ == "__main__":
    main()
