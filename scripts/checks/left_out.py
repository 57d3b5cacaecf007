#!/usr/bin/env python3
"""What a scene does not need: which parts the program leaves out, what that saves, and that the answer is the same.

    scripts/checks/left_out.py [--binary target/release/voidwalk]

Runs scenes as they are and by their full path (every particle one by one, everything recorded, two runs), on the same networks,
and prints the table of results/stability.md in Markdown. Networks are 12 x 12 x 20, so that the full path can be walked.
Exit code 1 where an answer differs.
"""
import argparse
import itertools
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
VOIDWALK = ROOT / "target" / "release" / "voidwalk"
SMALL = ["network.nx=12", "network.ny=12", "network.nz=20", "record.sensitivity=[]", "replicates=12"]
FULL = ["engine=particles"]

LOOSE, DENSE = "cu1.5-loose", "cu1.5-dense"
SCENES = {
    "built-in scene": [],
    "paper: loose Cu 1.5, base Cu 3 at Dc5": [f"filter.curve={LOOSE}", "base.cu=3"],
    "paper: loose Cu 1.5, base Cu 4.5 at Dc5": [f"filter.curve={LOOSE}", "base.cu=4.5"],
    "paper: dense Cu 1.5, base Cu 4.5 at Dc15": [f"filter.curve={DENSE}", "base.cu=4.5", "base.d85_at_dc=15"],
    "paper: loose Cu 1.5, base Cu 1.5 at Dc50": [f"filter.curve={LOOSE}", "base.cu=1.5", "base.d85_at_dc=50"],
    "paper: connectivity of Table 3, base Cu 3 at Dc5": [f"filter.curve={LOOSE}", "base.cu=3", "network.connectivity=table3"],
    "one size at Dc5 (scripts/campaigns/one-size.toml)": [f"filter.curve={LOOSE}", "base.single_mm=0.155", "base.n_base=300000"],
    "a base that passes everywhere": [f"filter.curve={LOOSE}", "base.single_mm=0.02", "base.n_base=3000000"],
}


def run(folder, name, sets):
    """Outcome, and processor seconds of the process."""
    out = folder / name
    words = [str(VOIDWALK), "run", "--out", str(out), "--quiet", "--threads", "1"]
    words += itertools.chain.from_iterable(("--set", s) for s in sets)
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{name}: {said}")
    return json.loads((out / "outcome.json").read_text()), usage.ru_utime + usage.ru_stime


def eroded(outcome, run_index):
    return [r["runs"][run_index]["eroded_mass_fraction"] for r in outcome["replicates"]]


def compare(a, b):
    """Mean difference in percentage points, its standard error, and t; paired by network."""
    differences = [x - y for x, y in zip(a, b)]
    n, mean = len(differences), sum(differences) / len(differences)
    error = math.sqrt(sum((d - mean) ** 2 for d in differences) / (n - 1) / n)
    return 100 * mean, 100 * error, 0.0 if error == 0 else mean / error


def figures(outcome):
    """The first run of every replicate without what a clock says."""
    return [{k: v for k, v in r["runs"][0].items() if k != "seconds"} for r in outcome["replicates"]]


def main():
    global VOIDWALK
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--binary", type=pathlib.Path, default=VOIDWALK)
    VOIDWALK, load = parser.parse_args().binary.resolve(), os.getloadavg()[0]
    rows, wrong = [], []
    with tempfile.TemporaryDirectory() as scratch:
        for number, (name, sets) in enumerate(SCENES.items()):
            at = pathlib.Path(scratch)
            sets = SMALL + sets
            print(name, file=sys.stderr, flush=True)
            outcome, seconds = run(at, f"{number}-auto", sets)
            full, full_seconds = run(at, f"{number}-full", sets + FULL)
            cells, same = [], outcome["engine"] == "particles"
            for index in range(2):
                difference, error, t = compare(eroded(outcome, index), eroded(full, index))
                rounding = abs(difference) < 1e-9 and error < 1e-9
                if same and difference == 0:
                    cells.append("the same bits")
                elif rounding:
                    cells.append("none beyond rounding")
                else:
                    cells.append(f"{difference:+.3f} ± {error:.3f}")
                # Twelve pairs, sixteen looks: |t| above 5 on 11 degrees of freedom comes once in some 150 reports.
                if (abs(t) > 5 and not rounding) or (same and difference != 0):
                    wrong.append(name)
            # Less recorded, one run: what is left must be the very same.
            less, _ = run(at, f"{number}-less", sets + ["runs=1", "record.series_every=0", "record.size_curves=[]"])
            alike = figures(less) == figures(outcome)
            if not alike:
                wrong.append(name + ", less recorded")
            rows.append(f"| {name} | {outcome['engine']} | {seconds:.2f}, {full_seconds:.2f} | {cells[0]} | {cells[1]} | "
                        f"{'the same bits' if alike else 'DIFFERS'} |")
    print(f"Load {load:.1f} at the start; processor seconds of whole processes; differences of the eroded mass are paired by network\n\n"
          "| scene | engine as it is | s, full path s | run 1, points | run 2, points | first run alone, nothing recorded |\n"
          "|---|---|---|---|---|---|", *rows, sep="\n")
    if wrong:
        sys.exit(f"answers differ: {wrong}")


main()
