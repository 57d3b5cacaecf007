#!/usr/bin/env python3
"""Charts of how coarse a filter may be: both boundaries of `voidwalk design` against Cu of filter and base.

    scripts/charts.py [--out results/charts-DATE] [--binary target/release/voidwalk] [--threads N]
    scripts/charts.py --cu-f 1.5 --cu-b 1.5,3 --densities loose --thicknesses 60layers --networks 3     # a part of it
    scripts/charts.py --collect                                                                        # tables and charts alone

For every pair of Cu (filter 1.2, 1.5, 2, 3, 4, 6; base 1.5, 2, 3, 4.5, 6) the program is called once, with all densities (loose,
dense) and thicknesses (60 layers, 0.5 m), into OUT/cases/cuF-cuB. A pair that is done is not walked again, one that was stopped goes
on: the same command continues. Packings are kept in OUT/packings, one a Cu and density. A thickness in metres needs sizes: the base's
D85 is 0.2 mm (--d85-mm). --set KEY=VALUE is handed on to the program.

Writes OUT/charts.csv (a row for each pair, density, thickness and boundary: median, 5 and 95 % of networks in D15F/D85B, networks that
were not monotone, what was said) and, for each density and thickness, OUT/charts-DENSITY-THICKNESS.svg: D15F/D85B against Cu of the base,
a line for each Cu of the filter, no erosion on the left, continuing on the right. Python 3's standard library only.
"""

import argparse
import csv
import datetime
import json
import math
import pathlib
import subprocess
import sys
from xml.sax.saxutils import escape

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOUNDARIES = {"no_erosion": "no erosion up to", "continuing": "continuing erosion from"}
# Okabe and Ito.
COLOURS = ["#000000", "#0072B2", "#009E73", "#E69F00", "#D55E00", "#CC79A7"]


def numbers(text):
    values = [float(part) for part in text.split(",")]
    if not values or any(not 1 <= value <= 1000 for value in values):
        raise argparse.ArgumentTypeError(f"{text}: allowed: Cu from 1 to 1000, as 1.5,3")
    return values


def words(text):
    return [part for part in text.split(",") if part]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    date = datetime.date.today().isoformat()
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / f"charts-{date}")
    parser.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/voidwalk")
    parser.add_argument("--cu-f", type=numbers, default=[1.2, 1.5, 2, 3, 4, 6])
    parser.add_argument("--cu-b", type=numbers, default=[1.5, 2, 3, 4.5, 6])
    parser.add_argument("--densities", type=words, default=["loose", "dense"])
    parser.add_argument("--thicknesses", type=words, default=["60layers", "500mm"])
    parser.add_argument("--networks", type=int, default=10)
    parser.add_argument("--d85-mm", type=float, default=0.2)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--collect", action="store_true", help="walk nothing: tables and charts of the pairs that are done")
    return parser.parse_args()


def folder_of(args, cu_f, cu_b):
    return args.out / "cases" / f"cu{cu_f:g}-cu{cu_b:g}"


def walk(args, cu_f, cu_b):
    """One pair; what is done is not done again."""
    folder = folder_of(args, cu_f, cu_b)
    if (folder / "design.json").exists() and not (folder / ".voidwalk.unfinished").exists():
        return
    command = [args.binary, "design", "--filter", f"{cu_f:g}", "--out", folder, "--packings", args.out / "packings"]
    command += ["--density", ",".join(args.densities), "--thickness", ",".join(args.thicknesses)]
    settings = [f"base.cu={cu_b:g}", f"base.d85_mm={args.d85_mm:g}", f"replicates={args.networks}", *args.set]
    for setting in settings:
        command += ["--set", setting]
    if args.threads:
        command += ["--threads", str(args.threads)]
    folder.parent.mkdir(parents=True, exist_ok=True)
    print(f"Cu of the filter {cu_f:g}, of the base {cu_b:g}", file=sys.stderr)
    code = subprocess.call([str(part) for part in command], stdout=subprocess.DEVNULL)
    if code == 3:
        sys.exit("stopped; the same command goes on")
    if code != 0:
        sys.exit(f"{folder}: voidwalk ended with {code}")


def collect(args):
    """Rows of the table, of every pair that is done."""
    rows = []
    for cu_f in args.cu_f:
        for cu_b in args.cu_b:
            path = folder_of(args, cu_f, cu_b) / "design.json"
            if not path.exists():
                continue
            design = json.loads(path.read_text())
            for found in design["boundaries"]:
                for name in BOUNDARIES:
                    boundary = found[name] or {"median": None, "low": None, "high": None}
                    rows.append(
                        {
                            "cu_f": cu_f,
                            "cu_b": cu_b,
                            "density": found["density"],
                            "thickness": found["thickness"],
                            "layers": found["layers"],
                            "boundary": name,
                            "median": boundary["median"],
                            "low": boundary["low"],
                            "high": boundary["high"],
                            "not_monotone": found["not_monotone"],
                            "networks": len(found["networks"]),
                            "confidence": design["confidence"],
                            "note": found.get(f"{name}_note") or "",
                        }
                    )
    return rows


def chart(rows, title):
    """Two panels, one a boundary, as SVG."""
    width, height, left, top, panel = 860, 420, 60, 50, 320
    bottom = height - 50
    values = [row[of] for row in rows for of in ("median", "low", "high") if row[of] is not None]
    if not values:
        return None
    low, high = math.floor(min(values) - 0.2), math.ceil(max(values) + 0.2)
    cu_b = sorted({row["cu_b"] for row in rows})
    span = math.log(cu_b[-1] / cu_b[0]) or 1.0

    def y(value):
        return bottom - (value - low) / (high - low) * (bottom - top)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        'font-family="Helvetica, Arial, sans-serif" font-size="12">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        f'<text x="{left}" y="20" font-size="14">{escape(title)}</text>',
    ]
    for index, (name, heading) in enumerate(BOUNDARIES.items()):
        start = left + index * (panel + 60)

        def x(cu, start=start):
            return start + 15 + (panel - 30) * (math.log(cu / cu_b[0]) / span if len(cu_b) > 1 else 0.5)

        parts.append(f'<text x="{start}" y="{top - 10}">{escape(heading)}, D15F/D85B</text>')
        parts.append(
            f'<rect x="{start}" y="{top}" width="{panel}" height="{bottom - top}" fill="none" stroke="#767676"/>'
        )
        for tick in range(low, high + 1, max(1, (high - low) // 8)):
            parts.append(f'<line x1="{start}" x2="{start + panel}" y1="{y(tick):.1f}" y2="{y(tick):.1f}" stroke="#dddddd"/>')
            parts.append(f'<text x="{start - 6}" y="{y(tick) + 4:.1f}" text-anchor="end">{tick}</text>')
        for cu in cu_b:
            parts.append(f'<text x="{x(cu):.1f}" y="{bottom + 16}" text-anchor="middle">{cu:g}</text>')
        parts.append(f'<text x="{start + panel / 2}" y="{bottom + 36}" text-anchor="middle">Cu of the base</text>')
        for line, cu_f in enumerate(sorted({row["cu_f"] for row in rows})):
            colour = COLOURS[line % len(COLOURS)]
            of = [row for row in rows if row["boundary"] == name and row["cu_f"] == cu_f and row["median"] is not None]
            points = " ".join(f'{x(row["cu_b"]):.1f},{y(row["median"]):.1f}' for row in of)
            if not of:
                continue
            parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
            for row in of:
                at = x(row["cu_b"])
                if row["low"] is not None and row["high"] is not None:
                    parts.append(
                        f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{y(row["low"]):.1f}" y2="{y(row["high"]):.1f}" '
                        f'stroke="{colour}"/>'
                    )
                parts.append(f'<circle cx="{at:.1f}" cy="{y(row["median"]):.1f}" r="3" fill="{colour}"/>')
            if index == 1:
                parts.append(
                    f'<text x="{start + panel + 8}" y="{y(of[-1]["median"]) + 4:.1f}" fill="{colour}">Cu {cu_f:g}</text>'
                )
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


def write(path, text):
    """Whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def main():
    args = arguments()
    if not args.collect:
        for cu_f in args.cu_f:
            for cu_b in args.cu_b:
                walk(args, cu_f, cu_b)
    rows = collect(args)
    if not rows:
        sys.exit(f"{args.out}: no pair is done")
    table = args.out / "charts.csv"
    part = table.with_name("charts.csv.part")
    with part.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    part.replace(table)
    print(table)
    for density, thickness in dict.fromkeys((row["density"], row["thickness"]) for row in rows):
        of = [row for row in rows if (row["density"], row["thickness"]) == (density, thickness)]
        text = chart(of, f"How coarse may the filter be? {density}, {thickness}")
        if text:
            path = args.out / f"charts-{density}-{thickness}.svg".replace(" ", "")
            write(path, text)
            print(path)


if __name__ == "__main__":
    main()
