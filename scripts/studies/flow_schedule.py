#!/usr/bin/env python3
"""Error of the schedule by which the flow is solved, beside solving it whenever anything has closed.

    scripts/studies/flow_schedule.py --work FOLDER [--binary target/release/voidwalk] [--threads 2] [--replicates 60]

Walks a base of 20,000 particles, Cu 1.5, on the voids of 400 grains (filter Cu 1.5, loose, two copies), two runs, with a `walk.flow_tolerance` of 0,
0.03, 0.1 and 1, on the same random numbers. Prints a table in Markdown: percentage points eroded beyond those of tolerance 0, with the standard
error, and the scatter of the mean of ten replicates.
"""

import statistics
import subprocess
from pathlib import Path

import common
from arches import Walks

SIZES_MM = [0.26, 0.33, 0.36, 0.38, 0.40]
TOLERANCES = [0.03, 0.1, 1]
PARTICLES, COPIES = 20_000, 2
FILTER = "[filter]\ncu = 1.5\nd0_mm = 1\nfriction = 0.3\n[packing]\ngrains = 400\n"


def outcome(options, size, tolerance):
    grains = (options.work / "packing/grains.csv").resolve()
    return Walks(options).outcome({
        "filter.cu": 1.5, "filter.d0_mm": 1, "network.kind": '"graph"', "network.packing": f'"{grains}"', "network.copies": COPIES,
        "base.cu": 1.5, "base.d85_mm": size, "base.n_base": PARTICLES, "replicates": options.replicates, "runs": 2, "seed": 5,
        "walk.flow_tolerance": tolerance, "record.sensitivity": "[]", "record.thickness": "[]",
    })


def eroded(found, run):
    return [100 * replicate["runs"][run]["eroded_mass_fraction"] for replicate in found["replicates"]]


def main():
    parser = common.parser(__doc__, threads="2")
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--replicates", type=int, default=60)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    (options.work / "filter.toml").write_text(FILTER)
    if not (options.work / "packing/packing.json").exists():
        command = [options.binary, "pack", options.work / "filter.toml", "--seed", "1", "--out", options.work / "packing", "--quiet"]
        subprocess.run([str(part) for part in command], check=True)
    print("| D85B, k/k0 at the end | run | eroded, % |", " | ".join(map(str, TOLERANCES)), "| scatter of ten |")
    print("|---|---|---|" + "---|" * (len(TOLERANCES) + 1))
    for size in SIZES_MM:
        exact = outcome(options, size, 0)
        others = [outcome(options, size, tolerance) for tolerance in TOLERANCES]
        for run in (0, 1):
            kept = statistics.mean(replicate["runs"][run]["k_over_k0"] for replicate in exact["replicates"])
            shares = eroded(exact, run)
            cells = []
            for other in others:
                more = [a - b for a, b in zip(eroded(other, run), shares)]
                cells.append(f"{statistics.mean(more):.2f} ± {statistics.stdev(more) / len(more) ** 0.5:.2f}")
            scatter = statistics.stdev(shares) / 10**0.5
            print(f"| {size}, {kept:.2g} | {run + 1} | {statistics.mean(shares):.2f} |", " | ".join(cells), f"| {scatter:.2f} |", flush=True)


if __name__ == "__main__":
    main()
