#!/usr/bin/env python3
"""Times walks with water as whole processes, on one thread and on several, and prints a table in Markdown.

    scripts/peers/flow.py --binary target/release/voidwalk --work DIR [--before OTHER] [--threads 1 2] [--turns 5] [--scenes ...]

In each turn every scene is walked by every binary on every number of threads, one after another; ratios are medians over pairs of
one turn. DIR keeps the packings, made where they are missing. Exits with 1 where a binary gives other numbers on other numbers of
threads. Python 3's standard library only.

    lattice   the built-in scene with walk.exit = "flux", one replicate: 40 x 40 x 60 voids, two runs
    graph     three copies of the voids of 9,000 grains, 43,000 voids, base Cu 1.5 at D15F/D85B 5.5, one run
    thick     600 layers of the voids of 3,000 grains, 190,000 voids, base Cu 1.5 at 3.5, one run, engine expected
    thickest  2,400 layers of the same, 757,000 voids, at 3.8: a minute or two a walk
"""

import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
from statistics import median

FILTER = '[filter]\ncu = 1.5\nd0_mm = 1\n'
RECORD = "[record]\nsensitivity = []\nseries_every = 0\n"
# Mean grain by number of a filter of Cu 1.5 from 1 mm on (mm).
GRAIN = 1.2250715253233675


def graph(grains, ratio, network, more=""):
    """A scene on the voids of so many grains."""
    head = f"replicates = 1\nruns = 1\nseed = 1\n{more}"
    base = f"[base]\ncu = 1.5\nd15f_over_d85b = {ratio}\nmass_ratio = 0.05\n"
    network = f'[network]\nkind = "graph"\npacking = "GRAINS/grains-{grains}/grains.csv"\n{network}\n'
    return f'{head}{FILTER}{base}{network}[walk]\nexit = "flux"\n{RECORD}'


EXPECTED = 'engine = "expected"\n'
SCENES = {
    "lattice": None,
    "graph": graph(9000, 5.5, "copies = 3"),
    "thick": graph(3000, 3.5, f"thickness_mm = {600 * GRAIN}", EXPECTED),
    "thickest": graph(3000, 3.8, f"thickness_mm = {2400 * GRAIN}", EXPECTED),
}
LATTICE = ["walk.exit=flux", "replicates=1", "record.sensitivity=[]", "record.series_every=0"]


def packed(binary, work, grains):
    """Packs so many grains where nobody has."""
    folder = work / f"grains-{grains}"
    if not (folder / "grains.csv").exists():
        work.mkdir(parents=True, exist_ok=True)
        scene = work / "filter.toml"
        scene.write_text(f"[filter]\ncu = 1.5\nfriction = 0.3\n[packing]\ngrains = {grains}\n")
        subprocess.run([binary, "pack", scene, "--seed", "1", "--out", folder, "--quiet"], check=True)


def walked(binary, name, work, threads):
    """Wall and processor seconds of a walk, and what flow.csv says."""
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "run"
        command = [binary, "run", "--out", out, "--threads", str(threads), "--quiet"]
        if SCENES[name] is None:
            command += [part for setting in LATTICE for part in ("--set", setting)]
        else:
            path = pathlib.Path(scratch) / "scene.toml"
            path.write_text(SCENES[name].replace("GRAINS", str(work)))
            command.insert(2, path)
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wall, after = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return wall, processor, (out / "flow.csv").read_bytes() + (out / "eroded.csv").read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True)
    parser.add_argument("--before", help="an earlier program")
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=["lattice", "graph", "thick"])
    options = parser.parse_args()
    work = options.work.resolve()
    for grains in (3000, 9000):
        packed(options.binary, work, grains)
    binaries = [("after", options.binary)] + [("before", options.before)] * bool(options.before)
    ways = [(which, binary, threads) for which, binary in binaries for threads in options.threads]
    is_same = True
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the beginning; {options.turns} turns, medians\n")
    print("| scene | program | threads | wall s (least to most) | processor s | wall over that of the first row | the same numbers |")
    print("|---|---|---|---|---|---|---|")
    for name in options.scenes:
        turns = [[walked(binary, name, work, threads) for _, binary, threads in ways] for _ in range(options.turns)]
        first = {}
        for at, (which, _, threads) in enumerate(ways):
            wall, processor, numbers = zip(*(turn[at] for turn in turns))
            known = first.setdefault(which, numbers[0])
            same = all(one == known for one in numbers)
            is_same = is_same and same
            ratio = median(turn[at][0] / turn[0][0] for turn in turns)
            print(f"| {name} | {which} | {threads} | {median(wall):.2f} ({min(wall):.2f} to {max(wall):.2f}) | {median(processor):.2f}"
                  f" | {ratio:.2f} | {'yes' if same else 'NO'} |", flush=True)
    print(f"\nload {os.getloadavg()[0]:.1f} at the end")
    sys.exit(0 if is_same else 1)


if __name__ == "__main__":
    main()
