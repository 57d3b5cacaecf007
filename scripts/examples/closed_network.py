"""The voids of a filter with what closed: open constrictions grey, those of the first run orange, of the second blue.

    python scripts/examples/closed_network.py RUN [PICTURE.svg]

RUN is the folder of a run with `record.voids` on the voids of a packing. The picture shows of the first replicate the slice that is a
fifth of the filter deep; water flows from left to right. Needs nothing but Python.
"""

from __future__ import annotations

import csv
import pathlib
import sys
from typing import Dict, List

WIDTH, EDGE, BELOW = 720, 12, 30
CLASSES = [(0, "open", "#b8b8b8", 0.7), (1, "closed in the first run", "#d55e00", 1.3), (2, "closed in the second run", "#0072b2", 1.3)]


def table(path: pathlib.Path) -> List[Dict[str, str]]:
    with open(path) as file:
        return list(csv.DictReader(file))


folder = pathlib.Path(sys.argv[1])
picture = sys.argv[2] if len(sys.argv) > 2 else "closed_network.svg"
places = {row["void"]: [float(row[f"{axis}_mm"]) for axis in "xyz"] for row in table(folder / "voids.csv")}
closed_in = {row["constriction"]: int(row["run"]) for row in table(folder / "blocked.csv")}
low, high = ([pick(place[axis] for place in places.values()) for axis in range(3)] for pick in (min, max))
middle, half = (low[1] + high[1]) / 2, (high[1] - low[1]) / 10

scale = (WIDTH - 2 * EDGE) / (high[2] - low[2])
lines: Dict[int, List[str]] = {run: [] for run, *_ in CLASSES}
for row in table(folder / "constrictions_of_network.csv"):
    step = [float(row[f"d{axis}_mm"]) for axis in "xyz"]
    if row["from"] in places:
        begin = places[row["from"]]
        end = [a + b for a, b in zip(begin, step)]
    else:
        # From the reservoir before the filter.
        end = places[row["to"]]
        begin = [a - b for a, b in zip(end, step)]
    if all(abs(point[1] - middle) <= half and low[0] <= point[0] <= high[0] for point in (begin, end)):
        ends = [(EDGE + scale * (point[2] - low[2]), EDGE + scale * (point[0] - low[0])) for point in (begin, end)]
        lines[closed_in.get(row["constriction"], 0)].append("M{:.1f} {:.1f}L{:.1f} {:.1f}".format(*ends[0], *ends[1]))

height = 2 * EDGE + scale * (high[0] - low[0])
with open(picture, "w") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height + BELOW:.0f}" width="{WIDTH}" height="{height + BELOW:.0f}" '
               'role="img" font-family="Helvetica, Arial, sans-serif" font-size="13">\n<title>Constrictions that closed</title>\n'
               '<rect width="100%" height="100%" fill="#ffffff"/>\n')
    for at, (run, name, colour, thick) in enumerate(CLASSES):
        file.write(f'<path d="{"".join(lines[run])}" fill="none" stroke="{colour}" stroke-width="{thick}"/>\n'
                   f'<text x="{EDGE + 190 * at}" y="{height + BELOW / 2:.0f}" fill="{colour if run else "#707070"}">{name}: {len(lines[run])}</text>\n')
    file.write("</svg>\n")
print(picture, *(f"{name}: {len(lines[run])}" for run, name, *_ in CLASSES), sep="\n")
