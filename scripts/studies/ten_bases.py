#!/usr/bin/env python3
"""How coarse may the filter be, for ten bases: the boundaries of `voidwalk boundary`, and what they cost.

    scripts/studies/ten_bases.py [--out target/ten-bases] [--binary target/release/voidwalk]
    VOIDWALK_ISA=avx2 scripts/studies/ten_bases.py --out other    # as on a machine without AVX-512

Five bases that are linear on semi-log paper (D85 0.2 mm) and five sieve tables, on the filter cu1.5-loose. A base that is done is not
walked again: the same command continues. Settings are the program's defaults. Prints a table in Markdown: boundaries with their 5 to 95 %
over networks, ratios walked, processor time, wall time, and the machine's load when each began and ended.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import common

LINEAR = [1.2, 1.5, 2, 3, 4.5]
TABLES = {
    "uniform fine sand": [(0.1, 0), (0.125, 12), (0.18, 62), (0.25, 95), (0.355, 100)],
    "fine sand": [(0.063, 0), (0.125, 30), (0.25, 80), (0.5, 100)],
    "medium sand": [(0.15, 0), (0.3, 15), (0.6, 50), (1.18, 85), (2.36, 100)],
    "gap-graded sand": [(0.05, 0), (0.1, 25), (0.15, 28), (0.4, 34), (0.6, 75), (0.85, 100)],
    "silty sand": [(0.02, 0), (0.045, 8), (0.075, 18), (0.15, 45), (0.3, 78), (0.6, 96), (1.18, 100)],
}


def bases(folder):
    """Name, and words of the command line."""
    for cu in LINEAR:
        yield f"linear, Cu {cu:g}", common.sets([f"base.cu={cu:g}", "base.d85_mm=0.2"])
    for name, points in TABLES.items():
        path = folder / (name.replace(" ", "-") + ".csv")
        common.sheet(path, points)
        yield name, [path]


def walk(args, name, told):
    folder = args.out / "boundary"
    shutil.rmtree(folder, ignore_errors=True)
    command = [args.binary, "boundary", *told, "--filter", "cu1.5-loose", "--threads", "2", "--out", folder, "--quiet"]
    load, begun = os.getloadavg()[0], time.monotonic()
    done, seconds = common.spent(command)
    wall = time.monotonic() - begun
    if done.returncode:
        sys.exit(f"{name}: voidwalk ended with {done.returncode}")
    walks = (folder / "boundary.csv").read_text().splitlines()[1:]
    return {
        "base": name, "boundary": json.loads((folder / "boundary.json").read_text()),
        "walks": len(walks) + sum(not line.endswith(",") for line in walks),
        "processor_s": seconds, "wall_s": wall, "load": [load, os.getloadavg()[0]],
    }


def words(found, notes):
    if not found:
        return ", ".join(note["id"].replace("_", " ") for note in notes) or "none"
    band = "no band" if found["low"] is None or found["high"] is None else f"{found['low']:.3f} to {found['high']:.3f}"
    mm = found.get("d15f_mm")
    return f"{found['median']:.3f} ({band})" + (f"; D15F {mm['median']:.3f} mm" if mm else "")


def main():
    parser = common.parser(__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=common.ROOT / "target/ten-bases")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    kept = args.out / "done.jsonl"
    done = {one["base"]: one for one in common.lines_of(kept)}
    version = subprocess.run([args.binary, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    asked = {"version": version, "isa": os.environ.get("VOIDWALK_ISA")}
    print("| base | Cu | no erosion up to D15F/D85B (5 to 95 %) | continuing from | not monotone | walks | processor s | wall s | load |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, told in bases(args.out):
        if name not in done:
            done[name] = {**walk(args, name, told), "asked": asked}
            common.keep(kept, done[name])
        one = done[name]
        if one["asked"] != asked:
            sys.exit(f"{kept}: {name} was found with {one['asked']}, not {asked}: give these, or another --out")
        row, cu = one["boundary"]["boundaries"][0], one["boundary"]["base"]["cu"]
        print(f"| {name} | {'not known' if cu is None else f'{cu:.2f}'} | {words(row['no_erosion'], row.get('no_erosion_notes', []))} "
              f"| {words(row['continuing'], row.get('continuing_notes', []))} | {row['not_monotone']} of {len(row['networks'])} "
              f"| {one['walks']} | {one['processor_s']:.0f} | {one['wall_s']:.0f} | {one['load'][0]:.0f} to {one['load'][1]:.0f} |",
              flush=True)


if __name__ == "__main__":
    main()
