#!/usr/bin/env python3
"""Charts of how coarse a filter may be: both boundaries of `voidwalk boundary` against Cu of filter and base.

    scripts/studies/charts.py [--out target/charts-DATE] [--binary target/release/voidwalk] [--threads N]
    scripts/studies/charts.py --cu-f 1.5 --cu-b 1.5,3 --densities loose --thicknesses 60layers --networks 3     # a part of it
    scripts/studies/charts.py --collect                                                                        # tables and charts alone

The program is called once a row: Cu of the filter (1.2, 1.5, 2, 3, 4, 6) and of the base (1.5, 2, 3, 4.5, 6), density (loose, dense),
thickness (60 layers, 500 mm), into OUT/cases/cuF-cuB-DENSITY-THICKNESS; the coarsest useful grid (Cu 1.5, 3, 6) comes first. A row that
is done is not walked again, one that was stopped goes on: the same command continues. A filter
whose curve ships with the program (SHIPPED) is not packed; the others are, once, into OUT/packings.

Smaller than the program's defaults, so that a row costs seconds and not minutes: --across 20 voids (40), --networks 10. What that
changes stands in the page beside the charts. --d85-mm is D85 of the base: it says how many layers a thickness in mm has, and nothing
else. --set KEY=VALUE is handed on to the program. A row that was walked with other settings is refused: take another --out.

Writes OUT/charts.csv (two lines a row, one a boundary: median, 5 and 95 % of networks in D15F/D85B, networks that were not monotone,
settings, processor time, what was said) and, for each density and thickness, OUT/charts-DENSITY-THICKNESS.svg: D15F/D85B against Cu of
the base, a line for each Cu of the filter, no erosion on the left, continuing on the right. Needs Matplotlib.
"""

import argparse
import datetime
import itertools
import json
import pathlib
import re
import subprocess
import sys

import matplotlib
from matplotlib import pyplot

import common

matplotlib.use("svg")
matplotlib.rcParams |= {"svg.hashsalt": "voidwalk", "svg.fonttype": "none", "font.size": 9}

BOUNDARIES = {"no_erosion": "no erosion up to", "continuing": "continuing erosion from"}
# Curves that ship with the program, each of a packing of this Cu and density (results/packing.md). The loosest Cu 6 that was
# packed had friction 0.7 between its grains.
SHIPPED = {
    (1.2, "dense"): "cu1.2-dense",
    (1.5, "loose"): "cu1.5-loose",
    (1.5, "dense"): "cu1.5-dense",
    (3, "loose"): "cu3-loose",
    (3, "dense"): "cu3-dense",
    (6, "loose"): "cu6-friction0.7",
}
# Walked first.
COARSE = [1.5, 3, 6]
# D15F/D85B that Terzaghi's rule allows.
PRACTICE = 4
# Okabe and Ito, by Cu of the filter.
COLOURS = {1.2: "#CC79A7", 1.5: "#000000", 2: "#E69F00", 3: "#0072B2", 4: "#D55E00", 6: "#009E73"}


def numbers(text):
    values = [float(part) for part in text.split(",")]
    if not values or any(not 1 <= value <= 1000 for value in values):
        raise argparse.ArgumentTypeError(f"{text}: allowed: Cu from 1 to 1000, as 1.5,3")
    return values


def words(text):
    return [part for part in text.split(",") if part]


def arguments():
    parser = common.parser(__doc__)
    date = datetime.date.today().isoformat()
    parser.add_argument("--out", type=pathlib.Path, default=common.ROOT / "target" / f"charts-{date}")
    parser.add_argument("--cu-f", type=numbers, default=[1.2, 1.5, 2, 3, 4, 6])
    parser.add_argument("--cu-b", type=numbers, default=[1.5, 2, 3, 4.5, 6])
    parser.add_argument("--densities", type=words, default=["loose", "dense"])
    parser.add_argument("--thicknesses", type=words, default=["60layers", "500mm"])
    parser.add_argument("--networks", type=int, default=10)
    parser.add_argument("--across", type=int, default=20, help="voids across the filter, each way")
    parser.add_argument("--d85-mm", type=float, default=0.2)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--collect", action="store_true", help="walk nothing: tables and charts of the pairs that are done")
    return parser.parse_args()


def rows_of(args):
    """Every row, those of the coarsest useful grid first."""
    every = itertools.product(args.thicknesses, args.cu_f, args.cu_b, args.densities)
    return sorted(every, key=lambda row: not (row[1] in COARSE and row[2] in COARSE))


def folder_of(args, thickness, cu_f, cu_b, density):
    return args.out / "cases" / f"cu{cu_f:g}-cu{cu_b:g}-{density}-{thickness}"


def is_done(folder):
    return (folder / "boundary.json").exists() and not (folder / ".voidwalk.unfinished").exists()


def asked(args, thickness, cu_f, cu_b, density):
    """What the program is asked for, and the settings that boundary.json names."""
    curve = SHIPPED.get((cu_f, density))
    parts = ["--filter", curve or f"{cu_f:g}"] + ([] if curve else ["--density", density]) + ["--thickness", thickness]
    settings = [f"base.cu={cu_b:g}", f"base.d85_mm={args.d85_mm:g}", f"replicates={args.networks}"]
    settings += [f"network.nx={args.across}", f"network.ny={args.across}", *args.set]
    return parts + common.sets(settings), settings


def walk(args, row):
    """One row; what is done is not done again."""
    folder = folder_of(args, *row)
    parts, settings = asked(args, *row)
    if is_done(folder):
        of_done = [said.removeprefix("--set ") for said in json.loads((folder / "boundary.json").read_text())["settings"] if said.startswith("--set ")]
        if of_done != settings:
            sys.exit(f"{folder}: was walked with {of_done}, not {settings}: give these, or another --out")
        return
    command = [args.binary, "boundary", *parts, "--out", folder, "--packings", args.out / "packings"]
    if args.threads:
        command += ["--threads", str(args.threads)]
    folder.parent.mkdir(parents=True, exist_ok=True)
    print(f"{datetime.datetime.now():%H:%M:%S} {folder.name}", file=sys.stderr)
    done, seconds = common.spent(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with (args.out / "cases" / "processor.txt").open("a") as file:
        file.write(f"{folder.name} {seconds:.1f}\n")
    if done.returncode == 3:
        sys.exit("stopped; the same command goes on")
    if done.returncode != 0:
        sys.exit(f"{folder}: voidwalk ended with {done.returncode}: {' '.join(str(part) for part in command)}")


def processor_seconds(args):
    """Of each row, also of the calls that were stopped; with its packing where it made one."""
    seconds = {}
    path = args.out / "cases" / "processor.txt"
    for line in path.read_text().splitlines() if path.exists() else []:
        name, spent = line.split()
        seconds[name] = seconds.get(name, 0.0) + float(spent)
    return seconds


def number(text):
    return float(text) if "." in text else int(text)


def collect(args):
    """Lines of the table, of every row of the folder that is done, asked for or not."""
    lines, seconds, found = [], processor_seconds(args), []
    for folder in (args.out / "cases").glob("cu*"):
        name = re.fullmatch(r"cu([0-9.]+)-cu([0-9.]+)-([a-z]+)-(.+)", folder.name)
        if name and is_done(folder):
            cu_f, cu_b, density, thickness = name.groups()
            found.append((thickness.endswith("mm"), thickness, density != "loose", density, number(cu_f), number(cu_b), folder))
    for _, thickness, _, density, cu_f, cu_b, folder in sorted(found):
        record = json.loads((folder / "boundary.json").read_text())
        # Of a curve that is known within a range, the end that holds least.
        known = [row for row in record["boundaries"] if row["no_erosion"] and row["no_erosion"]["low"] is not None]
        found = min(known, key=lambda row: row["no_erosion"]["low"], default=record["boundaries"][0])
        for name in BOUNDARIES:
            boundary = found[name] or {"median": None, "low": None, "high": None}
            lines.append(
                {
                    "cu_f": cu_f,
                    "cu_b": cu_b,
                    "density": density,
                    "thickness": thickness,
                    "layers": found["layers"],
                    "boundary": name,
                    **{of: boundary[of] and round(boundary[of], 4) for of in ("median", "low", "high")},
                    "not_monotone": found["not_monotone"],
                    "networks": len(found["networks"]),
                    "constrictions": SHIPPED.get((cu_f, density), "packed"),
                    "settings": " ".join(said.removeprefix("--set ") for said in record["settings"] if said.startswith("--set ")),
                    "processor_s": round(seconds.get(folder.name, 0.0), 1),
                    "note": "; ".join(note["id"] for note in found.get(f"{name}_notes", [])),
                }
            )
    return lines


def chart(path, rows, title, below):
    """Two panels, one a boundary, as SVG."""
    drawn, panels = pyplot.subplots(1, 2, figsize=(9, 4.9), sharey=True)
    for ax, (name, heading) in zip(panels, BOUNDARIES.items()):
        for cu_f in sorted({row["cu_f"] for row in rows}):
            of = [row for row in rows if row["boundary"] == name and row["cu_f"] == cu_f and row["low"] is not None]
            if of:
                x, low = [row["cu_b"] for row in of], [row["low"] for row in of]
                up = [(row["high"] or row["low"]) - row["low"] for row in of]
                ax.errorbar(x, low, [[0] * len(of), up], fmt="o-", ms=4, color=COLOURS.get(cu_f, "#555555"), label=f"filter Cu {cu_f:g}")
        if name == "no_erosion":
            ax.axhline(PRACTICE, color="#555555", ls="--", label="practice: 4 (Terzaghi)")
        ax.set(xscale="log", xlabel="Cu of the base", title=f"{heading}: D15F/D85B")
        ticks = sorted({row["cu_b"] for row in rows})
        ax.set_xticks(ticks, [f"{cu:g}" for cu in ticks])
        ax.minorticks_off()
        ax.grid(color="0.9")
    handles, labels = panels[0].get_legend_handles_labels()
    drawn.legend(handles, labels, frameon=False, loc="center left", bbox_to_anchor=(1, 0.6))
    drawn.suptitle(title, fontweight="bold")
    drawn.text(0.01, 0.0, "\n".join(below), va="top", color="#444444")
    drawn.tight_layout()
    drawn.savefig(path, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(drawn)


def told(rows):
    """What stands below a chart."""
    layers = sorted({row["layers"] for row in rows})
    layers = f"{layers[0]} layers of voids" if len(layers) == 1 else f"{layers[0]} to {layers[-1]} layers of voids at the boundary"
    first = dict(setting.split("=") for setting in rows[0]["settings"].split())
    lines = [f"Lines: the lower end of the band (5 %) of {rows[0]['networks']} networks of {first['network.nx']} x {first['network.ny']} voids across, {layers}; "
             "bars: up to 95 %."]
    of_base = f"D85 of the base is {float(first['base.d85_mm']):g} mm. " if rows[0]["thickness"].endswith("mm") else ""
    lines.append(f"{of_base}By the model alone: no flow, no cohesion. Practice goes first.")
    if any(SHIPPED.get((row["cu_f"], row["density"]), "").startswith("cu6-friction") for row in rows):
        lines.append("The Cu 6 filter is the loosest that was packed: friction 0.7 between its grains.")
    return lines


def main():
    args = arguments()
    if not args.collect:
        for row in rows_of(args):
            walk(args, row)
    rows = collect(args)
    if not rows:
        sys.exit(f"{args.out}: no row is done")
    table = args.out / "charts.csv"
    common.table(table, rows)
    print(table)
    for density, thickness in dict.fromkeys((row["density"], row["thickness"]) for row in rows):
        of = [row for row in rows if (row["density"], row["thickness"]) == (density, thickness)]
        thick = {"60layers": "60 layers"}.get(thickness, thickness.replace("mm", " mm"))
        path = args.out / f"charts-{density}-{thickness}.svg".replace(" ", "")
        chart(path, of, f"How coarse may a {density} filter be, {thick} thick?", told(of))
        print(path)


if __name__ == "__main__":
    main()
