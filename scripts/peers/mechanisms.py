#!/usr/bin/env python3
"""Prints what arches and openings beside particles cost: processor time by that of the same scene without them, in Markdown.

    scripts/peers/mechanisms.py [--binary target/release/voidwalk] [--particles 2000000 200000000] [--turns 5]
        [--instructions portable avx2 avx512] [--only marin] [--engines particles]

Scenes follow one another in each turn; whole processes, one thread, medians. Another mechanism lets other particles pass, so that the
number of moves differs: time by move is given beside the time of the scene. `--instructions` walks all of it with each set of instructions
(VOIDWALK_ISA), else with the widest of the machine. `--only` takes the mechanisms whose name holds one of these words, and what they are set against;
`--engines` those of these engines.
"""

import argparse
import itertools
import json
import os
import tempfile
from pathlib import Path
from statistics import median

from growth import measured, run

SUSPENSION = ["walk.arching=marin-2018", "walk.concentration=0.05"]

#: Engine, and what a base particle meets.
SCENES = [
    ("particles", "closed, no arches", []),
    ("particles", "openings", ["walk.blocked=open"]),
    ("particles", "arches, zuriguel-2005", ["walk.arching=zuriguel-2005"]),
    ("particles", "arches, marin-2018 at 0.05", SUSPENSION),
    ("particles", "arches, critical-3", ["walk.arching=critical-3"]),
    ("particles", "arches, marin-2018 at 0.005", ["walk.arching=marin-2018", "walk.concentration=0.005"]),
    ("counts", "closed, no arches", []),
    ("counts", "arches, marin-2018 at 0.05", SUSPENSION),
    ("expected", "closed, no arches", []),
    ("expected", "arches, marin-2018 at 0.05", SUSPENSION),
]


def walked(binary, engine, settings, particles, environment):
    with tempfile.TemporaryDirectory() as folder:
        command = run([f"engine={engine}", f"base.n_base={particles}", *settings])
        seconds, _ = measured(command(binary, f"{folder}/out"), environment)
        outcome = json.loads(Path(folder, "out/outcome.json").read_text())
    of_run = outcome["replicates"][0]["runs"][0]
    return seconds, of_run["particle_moves"], of_run["eroded_mass_fraction"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--particles", nargs="*", type=int, default=[2_000_000, 200_000_000])
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--instructions", nargs="*", default=[os.environ.get("VOIDWALK_ISA", "")], choices=["portable", "avx2", "avx512"])
    parser.add_argument("--only", nargs="*", default=[""])
    parser.add_argument("--engines", nargs="*", default=["particles", "counts", "expected"])
    options = parser.parse_args()
    of_only = [scene for scene in SCENES if scene[0] in options.engines and scene[2] and any(word in scene[1] for word in options.only)]
    scenes = [scene for scene in SCENES if scene in of_only or (not scene[2] and any(scene[0] == other[0] for other in of_only))]
    print("| particles | instructions | engine | mechanism | processor s | by that without | thousand million moves | ns a move | eroded |")
    print("|---|---|---|---|---|---|---|---|---|")
    for particles, isa in itertools.product(options.particles, options.instructions):
        environment = os.environ | ({"VOIDWALK_ISA": isa} if isa else {})
        turns = [[walked(options.binary, engine, settings, particles, environment) for engine, _, settings in scenes] for _ in range(options.turns)]
        without = {}
        for (engine, mechanism, _), rows in zip(scenes, zip(*turns)):
            seconds, (_, moves, eroded) = median(row[0] for row in rows), rows[0]
            without.setdefault(engine, seconds)
            ns = 1e9 * seconds / moves if moves else float("nan")
            print(
                f"| {particles:,} | {isa or 'widest'} | {engine} | {mechanism} | {seconds:.2f} | {seconds / without[engine]:.2f} "
                f"| {moves / 1e9:.2f} | {ns:.1f} | {100 * eroded:.1f} % |", flush=True)


if __name__ == "__main__":
    main()
