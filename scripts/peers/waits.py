#!/usr/bin/env python3
"""Prints how long a user waits for `judge` and `boundary` of real pairs, from two sheets to the page, in Markdown.

    scripts/peers/waits.py SOILS.json [--binary target/release/voidwalk] [--before OTHER] [--turns 3] [--pairs 12] [--seed 5] [--samples 50]

The pairs are drawn by the seed from soils of six points and more and six filters; a pair that is
refused, as its base is coarser than its filter, is left out and counted. Whole processes, wall clock, medians of the turns, in which the
programs follow one another. VOIDWALK_ISA chooses the instructions. `judge` with three filters takes the soil and the first three of the
six filters. --samples also times `judge --each` of so many samples of one AGS4 file, drawn by a seed of its own (38),
against three graded filters.
"""

import json
import os
import random
import shutil
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from common import parser as command_line, sheet, spent  # noqa: E402

# The middle of each band; sizes in mm.
FILTERS = {
    "C33 sand": [(0.15, 6), (0.3, 20), (0.6, 42.5), (1.18, 67.5), (2.36, 90), (4.75, 97.5), (9.5, 100)],
    "No. 8 stone": [(1.18, 2.5), (2.36, 5), (4.75, 20), (9.5, 92.5), (12.5, 100)],
    "No. 57 stone": [(2.36, 2.5), (4.75, 5), (12.5, 42.5), (25, 97.5), (37.5, 100)],
    "fine sand": [(0.075, 2), (0.15, 20), (0.3, 70), (0.6, 100)],
    "2-4 mm gravel": [(2, 0), (4, 100)],
    "4.75-37.5 mm gravel": [(4.75, 0), (37.5, 100)],
}
# Percent finer of a graded filter at multiples of its D15, and three such D15 (mm).
GRADED = [(8, 100), (4, 80), (2, 50), (1, 15), (0.6, 3), (0.4, 0)]
D15F_MM = {"fine": 0.3, "usual": 0.6, "coarse": 2.0}


def commands(folder):
    base, of_filter = folder / "base.csv", folder / "filter.csv"
    others = [folder / f"other-{k}.csv" for k in range(3)]
    return {
        "judge --quick": ["judge", base, of_filter, "--quick"],
        "judge": ["judge", base, of_filter],
        "boundary": ["boundary", base, "--filter", of_filter],
        "judge, three filters": ["judge", base, *others, "--quick"],
    }


def timed(binary, words, out):
    """Seconds by the clock and of the processors of a whole process; nothing where the pair is refused."""
    began = time.monotonic()
    done, of_processors = spent([binary, *words, "--quiet", "--out", out], capture_output=True, text=True)
    seconds = time.monotonic() - began
    if done.returncode == 2 and "exchanged" in done.stderr:
        return None
    if done.returncode != 0:
        raise SystemExit(f"{words}: exit code {done.returncode}: {done.stderr[-500:]}")
    return seconds, of_processors


def drawn(soils, pairs, seed):
    """So many pairs of a soil and the name of a filter."""
    soils = [soil for soil in soils if len(soil["points_mm_percent"]) >= 6]
    draw = random.Random(seed)
    return [(draw.choice(soils), list(FILTERS)[k % len(FILTERS)]) for k in range(pairs)]


def measured(pairs, binaries, turns):
    """By command: soil, filter, and of each program the median seconds by the clock and of the processors."""
    found = {}
    with tempfile.TemporaryDirectory() as work:
        for number, (soil, name) in enumerate(pairs):
            folder = Path(work, f"{number}")
            folder.mkdir()
            sheet(folder / "base.csv", soil["points_mm_percent"])
            sheet(folder / "filter.csv", FILTERS[name])
            for k, other in enumerate(list(FILTERS)[:3]):
                sheet(folder / f"other-{k}.csv", FILTERS[other])
            for command, words in commands(folder).items():
                rows = []
                for turn in range(turns):
                    out = [folder / f"{command}-{turn}-{at}" for at in range(len(binaries))]
                    rows.append([timed(binary, words, of) for binary, of in zip(binaries, out)])
                    for of in out:
                        shutil.rmtree(of, ignore_errors=True)
                    if None in rows[0]:
                        break
                if None not in rows[0]:
                    seconds = [[median(row[at][k] for row in rows) for k in range(2)] for at in range(len(binaries))]
                    found.setdefault(command, []).append((soil["id"], name, seconds))
                    print(f"{command}, soil {soil['id']}, {name}: {seconds}", file=sys.stderr, flush=True)
    return found


def each_of_many(soils, samples, binaries, turns):
    """By program the median seconds of a table of samples against three filters."""
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        lines = ['"GROUP","PROJ"', '"HEADING","PROJ_ID"', '"DATA","P1"', ""]
        lines += ['"GROUP","GRAT"', '"HEADING","LOCA_ID","SAMP_TOP","SPEC_DPTH","GRAT_SIZE","GRAT_PERP","GRAT_TYPE"']
        lines += ['"UNIT","","m","m","mm","%",""', '"TYPE","ID","2DP","2DP","3SF","1DP","PA"']
        for number, soil in enumerate(random.Random(38).sample(soils, samples), 1):
            rows = sorted(soil["points_mm_percent"], reverse=True)
            lines += [f'"DATA","BH{number}","1.50","1.50","{mm:g}","{percent:.1f}","WS"' for mm, percent in rows]
        (folder / "site.ags").write_text("\r\n".join(lines) + "\r\n")
        for name, d15_mm in D15F_MM.items():
            sheet(folder / f"{name}.csv", [(factor * d15_mm, percent) for factor, percent in sorted(GRADED)])
        words = ["judge", folder / "site.ags", *(folder / f"{name}.csv" for name in D15F_MM), "--each"]
        took = [[timed(binary, words, folder / f"{turn}-{at}")[0] for at, binary in enumerate(binaries)] for turn in range(turns)]
    return [median(column) for column in zip(*took)]


def spread(values):
    return f"{median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def main():
    parser = command_line(__doc__)
    parser.add_argument("soils", type=Path)
    parser.add_argument("--before")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--pairs", type=int, default=12)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--samples", type=int, default=0)
    options = parser.parse_args()
    binaries = [binary for binary in (options.before, options.binary) if binary]
    soils = json.loads(options.soils.read_text())
    pairs = drawn(soils, options.pairs, options.seed)
    load = os.getloadavg()[0]
    found = measured(pairs, binaries, options.turns)
    print(f"Instructions: {os.environ.get('VOIDWALK_ISA', 'the widest of the machine')}; load {load:.1f} before and "
          f"{os.getloadavg()[0]:.1f} after.\n")
    heads = ["before", "now"][-len(binaries):]
    print("| command | pairs | " + " | ".join(f"{head}: median s (least to most)" for head in heads) + " |")
    print("|---|---|" + "---|" * len(heads))
    for command, rows in found.items():
        cells = [spread([row[2][at][0] for row in rows]) for at in range(len(binaries))]
        print(f"| {command} | {len(rows)} of {options.pairs} | " + " | ".join(cells) + " |")
    if options.samples:
        seconds = each_of_many(soils, options.samples, binaries, options.turns)
        print(f"| {options.samples} samples, three filters | | " + " | ".join(f"{one:.1f}" for one in seconds) + " |")
    print("\n| soil, filter | " + " | ".join(found) + " |\n|---|" + "---|" * len(found))
    by_pair = {}
    for command, rows in found.items():
        for soil, name, seconds in rows:
            by_pair.setdefault((soil, name), {})[command] = ", ".join(f"{s:.2f}" for s, _ in seconds)
    for (soil, name), cells in by_pair.items():
        print(f"| {soil}, {name} | " + " | ".join(cells.get(command, "refused") for command in found) + " |")


if __name__ == "__main__":
    main()
