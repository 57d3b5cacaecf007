#!/usr/bin/env python3
"""Charts of how coarse a filter may be: both boundaries of `voidwalk boundary` against Cu of filter and base.

    scripts/studies/charts.py [--out target/charts-DATE] [--binary target/release/voidwalk] [--threads N] [--until 13:05]
    scripts/studies/charts.py --cu-f 1.5 --cu-b 1.5,3 --densities loose --thicknesses 60layers --networks 3     # a part of it
    scripts/studies/charts.py --collect                                                                        # tables and charts alone

The program is called once a row: Cu of the filter (1.2, 1.5, 2, 3, 4, 6) and of the base (1.5, 2, 3, 4.5, 6), density (loose, dense),
thickness (60 layers, 500 mm), into OUT/cases/cuF-cuB-DENSITY-THICKNESS; the coarsest useful grid (Cu 1.5, 3, 6) comes first. A row that
is done is not walked again, one that was stopped goes on: the same command continues. With --until no row is begun after that time of
day. A filter whose curve ships with the program (SHIPPED) is not packed; the others are, once, into OUT/packings.

Smaller than the program's defaults, so that a row costs seconds and not minutes: --across 20 voids (40), --networks 10. What that
changes stands in the page beside the charts. --d85-mm is D85 of the base: it says how many layers a thickness in mm has, and nothing
else. --set KEY=VALUE is handed on to the program. A row that was walked with other settings is refused: take another --out.

Writes OUT/charts.csv (two lines a row, one a boundary: median, 5 and 95 % of networks in D15F/D85B, networks that were not monotone,
settings, processor time, what was said) and, for each density and thickness, OUT/charts-DENSITY-THICKNESS.svg: D15F/D85B against Cu of
the base, a line for each Cu of the filter, no erosion on the left, continuing on the right. Python 3's standard library only.
"""

import argparse
import csv
import datetime
import itertools
import json
import math
import pathlib
import re
import resource
import subprocess
import sys
from xml.sax.saxutils import escape

ROOT = pathlib.Path(__file__).resolve().parents[2]
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


def time_of_day(text):
    try:
        return datetime.datetime.combine(datetime.date.today(), datetime.time.fromisoformat(text))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: allowed: a time of day, as 13:05") from None


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    date = datetime.date.today().isoformat()
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / f"charts-{date}")
    parser.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/voidwalk")
    parser.add_argument("--cu-f", type=numbers, default=[1.2, 1.5, 2, 3, 4, 6])
    parser.add_argument("--cu-b", type=numbers, default=[1.5, 2, 3, 4.5, 6])
    parser.add_argument("--densities", type=words, default=["loose", "dense"])
    parser.add_argument("--thicknesses", type=words, default=["60layers", "500mm"])
    parser.add_argument("--networks", type=int, default=10)
    parser.add_argument("--across", type=int, default=20, help="voids across the filter, each way")
    parser.add_argument("--d85-mm", type=float, default=0.2)
    parser.add_argument("--until", type=time_of_day, metavar="HH:MM", help="begin no row after this time of today")
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
    for setting in settings:
        parts += ["--set", setting]
    return parts, settings


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
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.call([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with (args.out / "cases" / "processor.txt").open("a") as file:
        file.write(f"{folder.name} {after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.1f}\n")
    if code == 3:
        sys.exit("stopped; the same command goes on")
    if code != 0:
        sys.exit(f"{folder}: voidwalk ended with {code}: {' '.join(str(part) for part in command)}")


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


def apart(places, least):
    """Places (rising) moved as little downwards as keeps them this far apart."""
    moved = []
    for place in places:
        moved.append(max(place, moved[-1] + least) if moved else place)
    return moved


def chart(rows, title, below):
    """Two panels, one a boundary, as SVG."""
    width, height, left, top, panel, between = 900, 486, 50, 66, 330, 90
    bottom = height - 92
    values = [row[of] for row in rows for of in ("median", "low", "high") if row[of] is not None]
    if not values:
        return None
    low, high = min(3, math.floor(min(values) - 0.1)), math.ceil(max(values) + 0.1)
    cu_b = sorted({row["cu_b"] for row in rows})
    span = math.log(cu_b[-1] / cu_b[0]) or 1.0
    step = 0.5 if high - low <= 8 else 1

    def y(value):
        return bottom - (value - low) / (high - low) * (bottom - top)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        'font-family="Helvetica, Arial, sans-serif" font-size="12">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        f'<text x="{left}" y="22" font-size="15" font-weight="bold">{escape(title)}</text>',
        *(f'<text x="{left}" y="{bottom + 52 + 15 * at}" fill="#444444">{escape(line)}</text>' for at, line in enumerate(below)),
    ]
    for index, (name, heading) in enumerate(BOUNDARIES.items()):
        start = left + index * (panel + between)

        def x(cu, start=start):
            return start + 15 + (panel - 30) * (math.log(cu / cu_b[0]) / span if len(cu_b) > 1 else 0.5)

        parts.append(f'<text x="{start}" y="{top - 12}">{escape(heading)}: D15F/D85B</text>')
        parts.append(f'<text x="{start + panel + 8}" y="{top - 12}">filter</text>')
        parts.append(
            f'<rect x="{start}" y="{top}" width="{panel}" height="{bottom - top}" fill="none" stroke="#767676"/>'
        )
        for at in range(round((high - low) / step) + 1):
            tick = low + at * step
            is_whole = tick == int(tick)
            parts.append(f'<line x1="{start}" x2="{start + panel}" y1="{y(tick):.1f}" y2="{y(tick):.1f}" '
                         f'stroke="{"#c8c8c8" if is_whole else "#ececec"}"/>')
            if is_whole:
                parts.append(f'<text x="{start - 6}" y="{y(tick) + 4:.1f}" text-anchor="end">{tick:g}</text>')
        for cu in cu_b:
            parts.append(f'<line x1="{x(cu):.1f}" x2="{x(cu):.1f}" y1="{top}" y2="{bottom}" stroke="#ececec"/>')
            parts.append(f'<text x="{x(cu):.1f}" y="{bottom + 16}" text-anchor="middle">{cu:g}</text>')
        parts.append(f'<text x="{start + panel / 2}" y="{bottom + 33}" text-anchor="middle">Cu of the base</text>')
        if index == 0 and low <= PRACTICE <= high:
            parts.append(f'<line x1="{start}" x2="{start + panel}" y1="{y(PRACTICE):.1f}" y2="{y(PRACTICE):.1f}" stroke="#555555" '
                         'stroke-dasharray="6 4"/>')
            parts.append(f'<text x="{start + 20}" y="{y(PRACTICE) + 14:.1f}" fill="#555555">practice: 4 (Terzaghi)</text>')
        ends = []
        for cu_f in sorted({row["cu_f"] for row in rows}):
            colour = COLOURS.get(cu_f, "#555555")
            of = [row for row in rows if row["boundary"] == name and row["cu_f"] == cu_f and row["low"] is not None]
            if not of:
                continue
            points = " ".join(f'{x(row["cu_b"]):.1f},{y(row["low"]):.1f}' for row in of)
            parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
            for row in of:
                at = x(row["cu_b"])
                if row["high"] is not None:
                    parts.append(
                        f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{y(row["low"]):.1f}" y2="{y(row["high"]):.1f}" '
                        f'stroke="{colour}"/>'
                    )
                parts.append(f'<circle cx="{at:.1f}" cy="{y(row["low"]):.1f}" r="3" fill="{colour}"/>')
            if of[-1]["cu_b"] < cu_b[-1]:
                # The line ends within the panel.
                parts.append(f'<text x="{x(of[-1]["cu_b"]) + 8:.1f}" y="{y(of[-1]["low"]) + 4:.1f}" fill="{colour}">Cu {cu_f:g}</text>')
                continue
            ends.append((y(of[-1]["low"]), cu_f, colour))
        ends.sort()
        for (_, cu_f, colour), place in zip(ends, apart([end[0] for end in ends], 14)):
            parts.append(f'<text x="{start + panel + 8}" y="{place + 4:.1f}" fill="{colour}">Cu {cu_f:g}</text>')
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


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


def write(path, text):
    """Whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def main():
    args = arguments()
    if not args.collect:
        for row in rows_of(args):
            if args.until and datetime.datetime.now() >= args.until:
                print("the time is over; the same command goes on", file=sys.stderr)
                break
            walk(args, row)
    rows = collect(args)
    if not rows:
        sys.exit(f"{args.out}: no row is done")
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
        thick = {"60layers": "60 layers"}.get(thickness, thickness.replace("mm", " mm"))
        text = chart(of, f"How coarse may a {density} filter be, {thick} thick?", told(of))
        if text:
            path = args.out / f"charts-{density}-{thickness}.svg".replace(" ", "")
            write(path, text)
            print(path)


if __name__ == "__main__":
    main()
