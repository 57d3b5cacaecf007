#!/usr/bin/env python3
"""Times the engines `particles`, `counts` and `auto` beside each other, for the rule by which `auto` picks.

    scripts/studies/auto_rule.py --binary target/release/voidwalk > target/auto-DATE.md

One thread, one replicate of the built-in lattice with both runs; processor seconds of whole processes,
`--turns` turns in alternation. Columns: least seconds of each engine; what `auto` loses, which is the larger of the medians
of `auto / particles` and `auto / counts` of a turn.
"""

import argparse
import os
import resource
import statistics
import subprocess
import tempfile

# Curve of the filter, coefficient of uniformity of the base, percentile of the filter's constrictions at its D85B;
# the built-in scene's particles or as many.
ROWS = [
    ("cu1.5-loose", 1.5, 5, None),
    ("cu1.5-loose", 1.5, 10, None),
    ("cu1.5-loose", 1.5, 15, None),
    ("cu1.5-loose", 1.5, 25, None),
    ("cu3-loose", 1.5, 5, None),
    ("cu3-loose", 1.5, 10, None),
    ("cu3-loose", 1.5, 15, None),
    ("cu1.5-dense", 1.5, 25, None),
    ("cu1.5-loose", 3, 75, None),
    ("cu1.5-loose", 3, 10, 800_000),
    ("cu1.5-loose", 3, 10, 1_100_000),
    ("cu1.5-loose", 3, 10, 1_400_000),
    # Just below and above the number from which `auto` counts.
    ("cu1.5-loose", 3, 10, 1_020_000),
    ("cu1.5-loose", 3, 10, 1_060_000),
    ("cu1.5-loose", 1.5, 15, 1_520_000),
    ("cu1.5-loose", 1.5, 15, 1_570_000),
]
ENGINES = ["particles", "counts", "auto"]


def processor_seconds(binary, instructions, engine, row):
    curve, uniformity, constriction, particles = row
    settings = {
        "replicates": 1,
        "record.sensitivity": "[]",
        "engine": engine,
        "filter.curve": f"shire2016-{curve}",
        "base.dc_curve": f"shire2016-{curve}",
        "base.cu": uniformity,
        "base.d85_at_dc": constriction,
    }
    if particles is not None:
        settings["base.n_base"] = particles
    sets = [f"--set={name}={value}" for name, value in settings.items()]
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [binary, "run", "--threads", "1", "--quiet", "--out", f"{folder}/out", *sets],
            check=True,
            capture_output=True,
            env={**os.environ, "VOIDWALK_ISA": instructions},
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--isa", nargs="+", default=["portable", "avx2", "avx512"])
    args = parser.parse_args()
    print("| instructions | filter, base Cu, D85B at | particles | counts | auto | lost by auto |")
    print("|---|---|---|---|---|---|")
    for instructions in args.isa:
        for row in ROWS:
            turns = [[processor_seconds(args.binary, instructions, engine, row) for engine in ENGINES]
                     for _ in range(args.turns)]
            particles, counts, auto = (min(seconds) for seconds in zip(*turns))
            lost = max(statistics.median(turn[2] / turn[other] for turn in turns) for other in (0, 1))
            curve, uniformity, constriction, fewer = row
            name = f"{curve}, {uniformity}, Dc{constriction}" + (f", `base.n_base` {fewer / 1e6:g}e6" if fewer else "")
            print(f"| {instructions} | {name} | {particles:.2f} | {counts:.2f} | {auto:.2f} "
                  f"| {lost:.2f} |", flush=True)


if __name__ == "__main__":
    main()
