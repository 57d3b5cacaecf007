#!/usr/bin/env python3
"""Prints how long a user waits for `judge` and `boundary` of real pairs, from two sheets to the page, in Markdown.

    scripts/peers/waits.py [--binary target/release/voidwalk] [--before OTHER] [--turns 3] [--pairs 12] [--seed 5] [--samples 50]

The pairs are drawn by the seed from the real soils of tests/words/pairs.json, each with its filter; a pair that is refused, as its base is
coarser than its filter, is left out and counted. Whole processes, wall clock, medians of the turns, in which the programs follow one
another. VOIDWALK_ISA chooses the instructions. `judge` with three filters takes three of other pairs. --samples also times `judge --each`
of so many of these soils in one AGS4 file, drawn by a seed of its own (38), against three graded filters.
"""

import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
import common  # noqa: E402

# Percent finer of a graded filter at multiples of its D15, and three such D15 (mm).
GRADED = [(0.4, 0), (0.6, 3), (1, 15), (2, 50), (4, 80), (8, 100)]
D15F_MM = {"fine": 0.3, "usual": 0.6, "coarse": 2.0}
OTHERS = [f"other-{k}.csv" for k in range(3)]
COMMANDS = {
    "judge --quick": ["judge", "base.csv", "filter.csv", "--quick"],
    "judge": ["judge", "base.csv", "filter.csv"],
    "boundary": ["boundary", "base.csv", "--filter", "filter.csv"],
    "judge, three filters": ["judge", "base.csv", *OTHERS, "--quick"],
}


def timed(binary, words, folder):
    """Seconds by the clock of a whole process; nothing where the pair is refused."""
    began = time.monotonic()
    done = subprocess.run([binary, *words, "--quiet", "--out", "out"], cwd=folder, capture_output=True, text=True)
    seconds = time.monotonic() - began
    shutil.rmtree(folder / "out", ignore_errors=True)
    if done.returncode == 2 and "exchanged" in done.stderr:
        return None
    if done.returncode != 0:
        raise SystemExit(f"{words}: exit code {done.returncode}: {done.stderr[-500:]}")
    return seconds


def measured(pairs, others, binaries, turns):
    """By command, of each pair that is not refused: the median seconds of each program."""
    found = {command: [] for command in COMMANDS}
    for pair in pairs:
        with tempfile.TemporaryDirectory() as work:
            folder = Path(work)
            for name, points in zip(["base.csv", "filter.csv", *OTHERS], [pair["base"], pair["filter"], *others]):
                common.sheet(folder / name, points)
            for command, words in COMMANDS.items():
                rows = [[timed(binary, words, folder) for binary in binaries] for _ in range(turns)]
                if None not in rows[0]:
                    found[command].append([median(column) for column in zip(*rows)])
                    print(f"{command}, {pair['name']}: {found[command][-1]}", file=sys.stderr, flush=True)
    return found


def each_of_many(soils, binaries, turns):
    """By program the median seconds of a table of samples against three filters."""
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        lines = ['"GROUP","PROJ"', '"HEADING","PROJ_ID"', '"DATA","P1"', ""]
        lines += ['"GROUP","GRAT"', '"HEADING","LOCA_ID","SAMP_TOP","SPEC_DPTH","GRAT_SIZE","GRAT_PERP","GRAT_TYPE"']
        lines += ['"UNIT","","m","m","mm","%",""', '"TYPE","ID","2DP","2DP","3SF","1DP","PA"']
        for number, points in enumerate(soils, 1):
            lines += [f'"DATA","BH{number}","1.50","1.50","{mm:g}","{percent:.1f}","WS"' for mm, percent in reversed(points)]
        (folder / "site.ags").write_text("\r\n".join(lines) + "\r\n")
        for name, d15_mm in D15F_MM.items():
            common.sheet(folder / f"{name}.csv", [(factor * d15_mm, percent) for factor, percent in GRADED])
        words = ["judge", "site.ags", *(f"{name}.csv" for name in D15F_MM), "--each"]
        rows = [[timed(binary, words, folder) for binary in binaries] for _ in range(turns)]
    return [median(column) for column in zip(*rows)]


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--pairs", type=int, default=12)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--samples", type=int, default=0)
    options = parser.parse_args()
    binaries = [binary.resolve() for binary in (options.before, options.binary) if binary]
    listed = json.loads((common.ROOT / "tests/words/pairs.json").read_text())
    real = [pair for pair in listed if pair["name"].startswith("real soil")]
    others = list({pair["name"].split(" and ")[1]: pair["filter"] for pair in real}.values())[: len(OTHERS)]
    load = os.getloadavg()[0]
    found = measured(random.Random(options.seed).sample(real, options.pairs), others, binaries, options.turns)
    print(f"Instructions: {os.environ.get('VOIDWALK_ISA', 'the widest of the machine')}; load {load:.1f} before and "
          f"{os.getloadavg()[0]:.1f} after.\n")
    heads = ["before", "now"][-len(binaries):]
    print("| command | pairs | " + " | ".join(f"{head}: median s (least to most)" for head in heads) + " |")
    print("|---|---|" + "---|" * len(heads))
    for command, rows in found.items():
        cells = [f"{median(column):.2f} ({min(column):.2f} to {max(column):.2f})" for column in zip(*rows)]
        print(f"| {command} | {len(rows)} of {options.pairs} | " + " | ".join(cells) + " |")
    if options.samples:
        soils = [pair["base"] for pair in random.Random(38).sample(real, options.samples)]
        cells = [f"{seconds:.1f}" for seconds in each_of_many(soils, binaries, options.turns)]
        print(f"| {options.samples} samples, three filters | | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
