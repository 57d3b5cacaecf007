#!/usr/bin/env python3
"""Charts of how coarse a filter may be: both boundaries of `voidwalk boundary` against Cu of filter and base.

    scripts/studies/charts.py [--thicknesses 60layers] [--across 20] [--networks 10] [--d85-mm 0.2] [--threads N] [--out target/charts-DATE]

The program is called once a row: Cu of the filter and of the base, density, thickness, into OUT/cases; the coarsest useful grid (Cu 1.5, 3,
6) comes first. A row that is done is not walked again, one that was stopped goes on: the same command continues. A row that was walked with
other settings is refused: take another --out. A filter whose curve ships with the program (SHIPPED) is not packed; the others are, once,
into OUT/packings. --d85-mm is D85 of the base: it says how many layers a thickness in mm has, and nothing else.

Writes OUT/charts.csv (two lines a row, one a boundary: median, 5 and 95 % of networks in D15F/D85B, networks that were not monotone,
settings, what was said) and, for each density and thickness, OUT/charts-DENSITY-THICKNESS.svg: D15F/D85B against Cu of the base, a line
for each Cu of the filter, no erosion on the left, continuing on the right. Needs Matplotlib.
"""

import datetime
import itertools
import json
import pathlib
import subprocess
import sys

import common

CU_F, CU_B, DENSITIES = [1.2, 1.5, 2, 3, 4, 6], [1.5, 2, 3, 4.5, 6], ["loose", "dense"]
# Walked first.
COARSE = [1.5, 3, 6]
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
# D15F/D85B that Terzaghi's rule allows.
PRACTICE = 4
# Okabe and Ito, by Cu of the filter.
COLOURS = {1.2: "#CC79A7", 1.5: "#000000", 2: "#E69F00", 3: "#0072B2", 4: "#D55E00", 6: "#009E73"}


def arguments():
    parser = common.parser(__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=common.ROOT / "target" / f"charts-{datetime.date.today().isoformat()}")
    parser.add_argument("--thicknesses", nargs="+", default=["60layers", "500mm"])
    parser.add_argument("--networks", type=int, default=10)
    parser.add_argument("--across", type=int, default=20, help="voids across the filter, each way")
    parser.add_argument("--d85-mm", type=float, default=0.2)
    parser.add_argument("--threads", type=int)
    return parser.parse_args()


def walked(args, thickness, density, cu_f, cu_b):
    """The record of one row; what is done is not done again."""
    folder = args.out / "cases" / f"cu{cu_f:g}-cu{cu_b:g}-{density}-{thickness}"
    curve = SHIPPED.get((cu_f, density))
    settings = [f"base.cu={cu_b:g}", f"base.d85_mm={args.d85_mm:g}", f"replicates={args.networks}"]
    settings += [f"network.nx={args.across}", f"network.ny={args.across}"]
    if not (folder / "boundary.json").exists() or (folder / ".voidwalk.unfinished").exists():
        command = [args.binary, "boundary", "--filter", curve or f"{cu_f:g}", *([] if curve else ["--density", density])]
        command += ["--thickness", thickness, *common.sets(settings), "--out", folder, "--packings", args.out / "packings", "--quiet"]
        command += ["--threads", args.threads] if args.threads else []
        folder.parent.mkdir(parents=True, exist_ok=True)
        print(f"{datetime.datetime.now():%H:%M:%S} {folder.name}", file=sys.stderr)
        code = subprocess.run([str(part) for part in command], stdout=subprocess.DEVNULL).returncode
        if code:
            sys.exit("stopped; the same command goes on" if code == 3 else f"{folder}: voidwalk ended with {code}")
    record = json.loads((folder / "boundary.json").read_text())
    record["settings"] = [said.removeprefix("--set ") for said in record["settings"] if said.startswith("--set ")]
    if record["settings"] != settings:
        sys.exit(f"{folder}: was walked with {record['settings']}, not {settings}: give these, or another --out")
    return record


def lines_of(record, thickness, density, cu_f, cu_b):
    """The lines of a row's table, one a boundary."""
    # Of a curve that is known within a range, the end that holds least.
    known = [row for row in record["boundaries"] if row["no_erosion"] and row["no_erosion"]["low"] is not None]
    found = min(known, key=lambda row: row["no_erosion"]["low"], default=record["boundaries"][0])
    for name in BOUNDARIES:
        boundary = found[name] or {"median": None, "low": None, "high": None}
        yield {
            "cu_f": cu_f, "cu_b": cu_b, "density": density, "thickness": thickness, "layers": found["layers"], "boundary": name,
            **{of: boundary[of] and round(boundary[of], 4) for of in ("median", "low", "high")},
            "not_monotone": found["not_monotone"], "networks": len(found["networks"]),
            "constrictions": SHIPPED.get((cu_f, density), "packed"), "settings": " ".join(record["settings"]),
            "note": "; ".join(note["id"] for note in found.get(f"{name}_notes", [])),
        }


def chart(path, rows, title, below):
    """Two panels, one a boundary, as SVG."""
    pyplot = common.pyplot()
    drawn, panels = pyplot.subplots(1, 2, figsize=(9, 4.9), sharey=True)
    for ax, (name, heading) in zip(panels, BOUNDARIES.items()):
        for cu_f in CU_F:
            of = [row for row in rows if row["boundary"] == name and row["cu_f"] == cu_f and row["low"] is not None]
            if of:
                x, low = [row["cu_b"] for row in of], [row["low"] for row in of]
                up = [(row["high"] or row["low"]) - row["low"] for row in of]
                ax.errorbar(x, low, [[0] * len(of), up], fmt="o-", ms=4, color=COLOURS[cu_f], label=f"filter Cu {cu_f:g}")
        if name == "no_erosion":
            ax.axhline(PRACTICE, color="#555555", ls="--", label="practice: 4 (Terzaghi)")
        ax.set(xscale="log", xlabel="Cu of the base", title=f"{heading}: D15F/D85B")
        ax.set_xticks(CU_B, [f"{cu:g}" for cu in CU_B])
        ax.minorticks_off()
        ax.grid(color="0.9")
    handles, labels = panels[0].get_legend_handles_labels()
    drawn.legend(handles, labels, frameon=False, loc="center left", bbox_to_anchor=(1, 0.6))
    drawn.suptitle(title, fontweight="bold")
    drawn.text(0.01, 0.0, "\n".join(below), va="top", color="#444444")
    drawn.tight_layout()
    drawn.savefig(path, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(drawn)


def told(args, rows, density, thickness):
    """What stands below a chart."""
    layers = sorted({row["layers"] for row in rows})
    layers = f"{layers[0]} layers of voids" if len(layers) == 1 else f"{layers[0]} to {layers[-1]} layers of voids at the boundary"
    lines = [f"Lines: the lower end of the band (5 %) of {args.networks} networks of {args.across} x {args.across} voids across, {layers}; "
             "bars: up to 95 %."]
    of_base = f"D85 of the base is {args.d85_mm:g} mm. " if thickness.endswith("mm") else ""
    lines.append(f"{of_base}By the model alone: no flow, no cohesion. Practice goes first.")
    if density == "loose":
        lines.append("The Cu 6 filter is the loosest that was packed: friction 0.7 between its grains.")
    return lines


def main():
    args = arguments()
    rows = list(itertools.product(args.thicknesses, DENSITIES, CU_F, CU_B))
    found = {row: walked(args, *row) for row in sorted(rows, key=lambda row: not (row[2] in COARSE and row[3] in COARSE))}
    lines = [line for row in rows for line in lines_of(found[row], *row)]
    common.table(args.out / "charts.csv", lines)
    for thickness, density in itertools.product(args.thicknesses, DENSITIES):
        of = [line for line in lines if (line["thickness"], line["density"]) == (thickness, density)]
        thick = {"60layers": "60 layers"}.get(thickness, thickness.replace("mm", " mm"))
        title = f"How coarse may a {density} filter be, {thick} thick?"
        chart(args.out / f"charts-{density}-{thickness}.svg", of, title, told(args, of, density, thickness))
    print(args.out)


if __name__ == "__main__":
    main()
