#!/usr/bin/env python3
"""Boundaries of `voidwalk boundary` beside fine scans: 40 seeded cases on small lattices, each scanned by a plain loop of `voidwalk run`.

    scripts/checks/check_boundary.py [--out target/check-boundary] [--binary target/release/voidwalk] [--cases 40] [--first 1] [--threads N] [--engine auto]

A case is a shipped constriction curve, a Cu of the base, a lattice of 8 to 11 voids across and 8 to 16 layers, and a seed, all drawn by
Python's random.Random(CASE). It is searched. Then every
ratio D15F/D85B from 0.75 times the least of the boundaries, in steps of 0.5 % that have nothing to do with those of the search, is walked by
`voidwalk run` on the same networks, with the engine of the search (or what --engine says), up to 1.15 times the largest. The boundary of a network by the scan is the smallest ratio from which
the first run (no erosion), or both (continuing), erode 7.5 % of the mass: halfway down to the ratio below.

A case agrees where the median of the scan lies within the band that the search gives (its 5 and 95 % over the networks). What is done is
kept in OUT/cases.jsonl, so that the same command continues. Prints a table in Markdown. Python 3's standard library only.
"""

import argparse
import json
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CURVES = ["shire2016-cu1.5-loose", "shire2016-cu1.5-dense", "shire2016-cu3-loose", "cu1.2-dense", "cu1.5-loose", "cu3-dense", "cu3-loose",
          "cu6-friction0.7"]
STEP = 0.005
THRESHOLD = 0.075
NETWORKS = 5
BOUNDARIES = ["no_erosion", "continuing"]


def drawn(args, number):
    draw = random.Random(number)
    across = draw.randint(8, 11)
    settings = {
        "filter.curve": draw.choice(CURVES), "base.cu": round(draw.uniform(1.2, 4), 2), "network.nx": across, "network.ny": across,
        "network.nz": draw.randint(8, 16), "seed": draw.randint(1, 10**6), "replicates": NETWORKS, "record.sensitivity": "[]", "record.thickness": "[]",
    }
    draw.random(), draw.random()
    # Where the scan begins, within a step.
    return settings, draw.random()


def call(args, *parts):
    command = [str(part) for part in (args.binary, *parts, "--quiet")]
    if args.threads:
        command += ["--threads", str(args.threads)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.returncode}: {done.stderr}")


def sets(settings):
    return [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]


def search(args, settings):
    folder = args.out / "boundary"
    shutil.rmtree(folder, ignore_errors=True)
    call(args, "boundary", *sets(settings), "--out", folder)
    return json.loads((folder / "boundary.json").read_text())["boundaries"][0]


def scan(args, settings, low, high, offset):
    """By network and boundary: the smallest ratio that erodes."""
    ratio = low * math.exp(STEP * (offset - 1))
    walked = []
    while ratio < high:
        folder = args.out / "run"
        shutil.rmtree(folder, ignore_errors=True)
        # One ratio says how coarse the base is: the built-in scene's d85_at_dc goes.
        call(args, "run", args.scene, *sets({**settings, "engine": args.engine, "base.d15f_over_d85b": f"{ratio:.6f}"}), "--out", folder)
        replicates = json.loads((folder / "outcome.json").read_text())["replicates"]
        walked.append((ratio, [[run["eroded_mass_fraction"] for run in of["runs"]] for of in replicates]))
        ratio *= math.exp(STEP)
    found = []
    for network in range(NETWORKS):
        of_network = {}
        for boundary, runs in zip(BOUNDARIES, (1, 2)):
            erodes = [all(mass >= THRESHOLD for mass in of[network][:runs]) for _, of in walked]
            first = erodes.index(True) if True in erodes else None
            of_network[boundary] = None if first in (None, 0) else walked[first][0] * math.exp(-STEP / 2)
        found.append(of_network)
    return found, len(walked)


def one(args, number):
    settings, offset = drawn(args, number)
    plain = search(args, settings)
    values = [of[name] for of in plain["networks"] for name in BOUNDARIES if of[name]]
    found, ratios = scan(args, settings, 0.75 * min(values), 1.15 * max(values), offset)
    return {"case": number, "settings": settings, "search": plain, "scan": found, "ratios": ratios}


def median(values):
    return statistics.median(values) if all(value is not None for value in values) else None


def table(done):
    print("| case | curve | Cu_B | voids | boundary | search: median (5 to 95 %) | scan: median | within the band | networks apart by (%) |")
    print("|---|---|---|---|---|---|---|---|---|")
    agree, all_off, of_networks = {name: 0 for name in BOUNDARIES}, [], []
    for case in done:
        settings, plain = case["settings"], case["search"]
        for name in BOUNDARIES:
            of_scan = [network[name] for network in case["scan"]]
            middle, found = median(of_scan), plain[name]
            within = None not in (middle, found) and None not in (found["low"], found["high"]) and found["low"] <= middle <= found["high"]
            agree[name] += bool(within)
            off = [100 * (scanned / network[name] - 1) for scanned, network in zip(of_scan, plain["networks"]) if scanned and network[name]]
            of_networks += [(name, value) for value in off]
            if middle and found:
                all_off.append((name, 100 * (middle / found["median"] - 1)))
            band = f"{found['median']:.3f} ({found['low']:.3f} to {found['high']:.3f})" if found and found["low"] else "none"
            size = f"{settings['network.nx']} x {settings['network.ny']} x {settings['network.nz']}"
            print(f"| {case['case']} | {settings['filter.curve']} | {settings['base.cu']} | {size} | {name.replace('_', ' ')} | {band} "
                  f"| {'none' if middle is None else f'{middle:.3f}'} | {'yes' if within else '**no**'} "
                  f"| {min(off, default=0):+.1f} to {max(off, default=0):+.1f} |")
    print()
    for name in BOUNDARIES:
        medians = [abs(value) for of, value in all_off if of == name]
        networks = [value for of, value in of_networks if of == name]
        print(f"- {name.replace('_', ' ')}: the scan's median within the band in {agree[name]} of {len(done)} cases; medians apart by "
              f"{statistics.median(medians):.2f} % in the middle case, {max(medians):.2f} % at most; networks by "
              f"{statistics.median([abs(value) for value in networks]):.2f} % in the middle, from {min(networks):+.1f} to {max(networks):+.1f} %.")
    print(f"- {sum(case['ratios'] for case in done)} ratios were scanned, each on {NETWORKS} networks.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target/check-boundary")
    parser.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/voidwalk")
    parser.add_argument("--cases", type=int, default=40, help="number of the last case")
    parser.add_argument("--first", type=int, default=1, help="number of the first case")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--engine", default="expected", help="of the scans: expected, as boundary walks, or auto, as run does")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    args.scene = args.out / "scene.toml"
    args.scene.unlink(missing_ok=True)
    subprocess.run([args.binary, "init", args.scene], check=True, stdout=subprocess.DEVNULL)
    kept = args.out / "cases.jsonl"
    done = {case["case"]: case for case in map(json.loads, kept.read_text().splitlines())} if kept.exists() else {}
    for number in range(args.first, args.cases + 1):
        if number not in done:
            done[number] = one(args, number)
            with kept.open("a") as file:
                file.write(json.dumps(done[number]) + "\n")
            print(f"case {number} of {args.cases}", file=sys.stderr)
    table([done[number] for number in range(args.first, args.cases + 1)])


if __name__ == "__main__":
    main()
