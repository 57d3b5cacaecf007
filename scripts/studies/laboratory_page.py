#!/usr/bin/env python3
"""The page of scripts/studies/laboratory.py: models beside tests, one figure and one table.

    scripts/studies/laboratory_page.py --out results/laboratory

Writes OUT.md and OUT.svg from OUT.csv, and from `arches.csv` and `openings.csv` beside it, whose cells have the same lattice. TESTS holds every
number of a test, with where it was read. What was not read in a source is in no count of agreement.
"""

import argparse
import csv
import textwrap
from html import escape
from pathlib import Path

SANDS, BEADS_HOLD, CONTINUING = (6.8, 10.0), (8.0, 12.0), 9.0
SUSPENDED = 0.11
KENNEY = {"1.2": 0.18, "3": 0.25, "6": 0.26}
# What was tested, its number, where it was read, and what the walk is asked for.
TESTS = [
    ("no erosion, bases with less than 15 % fines", f"D15F {SANDS[0]:g} to {SANDS[1]:g} D85B in tests",
     "Fell et al., Geotechnical Engineering of Dams, Table 9.2, after Foster & Fell (2001)", "s_NE of sands"),
    ("continuing erosion", f"D15F from {CONTINUING:g} D95B on", "the same, section 9.3.2, page 388", "s_CE of sands"),
    ("no erosion, bases with more fines", "6.4 to 13.5 D85B (> 85 %); 0.7 to 1.7 mm (35 to 85 %); 1.6 to 2.5 design limits (15 to 35 %)",
     "the same, Table 9.2", "not walked here: cohesion; without arches `real-soils.md`"),
    ("particles in suspension that uniform filters catch", f"about {SUSPENDED:g} D15F",
     "Sherard et al. (1984), abstract", f"s_NE of one size, {1 / SUSPENDED:.1f}"),
    ("uniform sands and gravels, uniform bases", "D15F/D85B of 5 is \"conservative, but not excessively\"", "the same", "s_NE above 5, by how much is not said"),
    ("largest particle through filters of Cu 1.2, 3 and 6", "0.18, 0.25 and 0.26 D0F", "Kenney et al. (1985), in section 4 of the paper", "largest eroded"),
    ("glass beads", "hold to D15F/D85B 8, fail from 12 on, between by gradient",
     "Tomlinson & Vaid (2000), **not read**: quoted in this project's notes; searched on 2026-11-25", "s_NE of beads, not counted"),
    ("the paper's loose filters", "below 5 no erosion", "the paper, a model: ours is the same model without arches, so that agreement is none", "not counted"),
]
# Name, and where its cells stand.
MODELS = [
    (f"{network}, {'flow' if exit == 'flux' else 'area'}; {law}; {blocked}", network, exit, law, blocked)
    for network, exit, laws in [
        ("lattice", "area", ["none", "marin-2018", "zuriguel-2005", "critical-3"]), ("lattice", "flux", ["none", "marin-2018"]),
        ("graph", "flux", ["none", "marin-2018"])]
    for law in laws for blocked in ("closed", "open")
    if blocked == "closed" or law in ("none", "marin-2018")
]
PAIRS = [("1.5", "loose", "1.5"), ("1.5", "dense", "1.5"), ("3", "loose", "1.5"), ("3", "dense", "1.5"), ("6", "loose", "1.5"), ("1.5", "loose", "3"),
         ("1.5", "dense", "3"), ("3", "loose", "3"), ("3", "dense", "3"), ("6", "loose", "3"), ("1.5", "loose", "4.5"), ("1.5", "dense", "4.5"),
         ("3", "loose", "4.5"), ("3", "dense", "4.5"), ("6", "loose", "4.5")]
ONE_SIZE, BEADS = ("1.2", "dense", "1"), ("1.2", "dense", "1.2")
LARGEST = [("1.2", "dense"), ("3", "loose"), ("6", "loose")]


class Cells:
    """Boundaries of all models, by pair and model."""

    def __init__(self, out):
        rows = list(csv.DictReader(Path(f"{out}.csv").open()))
        self.largest = {(row["filter_cu"], row["law"]): row for row in rows if row["measure"] == "largest"}
        self.found = {}
        beside = Path(out).parent
        for name in ("arches.csv", "openings.csv"):
            for row in csv.DictReader((beside / name).open()):
                usual = not row.get("concentration") and row.get("layers", "60") == "60" and row.get("across", "10") == "10"
                if usual and (row["least"] or row["most"] or not row["no_erosion"]):
                    self.add(row | {"network": "lattice", "exit": "area", "first": row["no_erosion"]}
                             | {f"first_{name}": row[name] for name in ("least", "most", "holds_to", "erodes_from")})
        for row in rows:
            if row["measure"] == "boundary":
                self.add(row)

    def add(self, row):
        pair = row["filter_cu"], row["density"], row["base_cu"]
        self.found[pair, row["network"], row["exit"], row["law"], row.get("blocked") or "closed"] = row

    def of(self, model, pair):
        return self.found.get((pair, *model[1:]))

    def sands(self, model, run="first"):
        """The cells of sands that were computed, as (pair, row)."""
        of_model = [(pair, self.of(model, pair)) for pair in PAIRS]
        return [(pair, row) for pair, row in of_model if row and (row.get(run) or row.get(f"{run}_holds_to"))]


def shown(row, run="first"):
    """A boundary with the least and the most of five replicates; empty where it was not computed."""
    if not row or not (row.get(run) or row.get(f"{run}_holds_to")):
        return ""
    least, most = row.get(f"{run}_least"), row.get(f"{run}_most")
    if not row.get(run):
        return f"beyond {float(row[f'{run}_holds_to']):.1f}"
    span = f"{least} to {most}" if least and most else f"from {least}" if least else f"to {most}"
    return f"{row[run]} ({span})"


def value(row, run="first"):
    """The boundary as a number: where it lies beyond the walks, the greatest ratio that holds."""
    return float(row.get(run) or row[f"{run}_holds_to"])


def table(cells):
    """Models as rows; a column for sands by Cu of the base, one size, beads and largest particles."""
    head = ["model (way; arches; blocked constrictions)", "filter Cu 1.5 loose, base Cu 1.5", "Cu 1.5 loose, 3", "Cu 3 loose, 3", "other sands",
            "one size", "beads", "largest by D0F, filter Cu 1.2", "Cu 3", "Cu 6"]
    tests = ["**tests**", *["6.8 to 10"] * 4, f"{1 / SUSPENDED:.1f}", "8 to 12 \\*", *map(str, KENNEY.values())]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|", "| " + " | ".join(tests) + " |"]
    first = [PAIRS[0], PAIRS[5], PAIRS[7]]
    for model in MODELS:
        of = lambda pair: shown(cells.of(model, pair))
        others = [row for pair, row in cells.sands(model) if pair not in first]
        beyond = "beyond " if any(not row.get("first") for row in others) else ""
        numbers = [value(row) for row in others]
        spread = f"{min(numbers):.2f} to {beyond}{max(numbers):.2f} ({len(numbers)})" if numbers else ""
        largest = [largest_shown(cells, of_filter, model) for of_filter in LARGEST]
        row = [model[0], *map(of, first), spread, of(ONE_SIZE), of(BEADS), *largest]
        lines.append("| " + " | ".join(row) + " |")
    return lines


def largest_shown(cells, of_filter, model):
    row = cells.largest.get((of_filter[0], model[3])) if model[1:3] == ("lattice", "area") and model[4] == "closed" else None
    return f"{float(row['first']):.3f} ({float(row['first_least']):.3f} to {float(row['first_most']):.3f})" if row else ""


LEFT, RIGHT, TOP, ROW = 300, 860, 96, 26
LEAST, MOST = 2.0, 16.0
COLOURS = {"1.5": "#2b5fa8", "3": "#b06a1a", "4.5": "#4a8f4a"}


def x(ratio):
    return LEFT + (min(max(ratio, LEAST), MOST) - LEAST) / (MOST - LEAST) * (RIGHT - LEFT)


def figure(cells):
    """A row a model; a mark a pair of sand with the least and the most of its replicates; the range of tests behind."""
    bottom = TOP + ROW * len(MODELS)
    text = lambda at, y, words, anchor="start", **more: (
        f'<text x="{at:.1f}" y="{y:.1f}" text-anchor="{anchor}"{"".join(f" {n}={chr(34)}{v}{chr(34)}" for n, v in more.items())}>{escape(words)}</text>')
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 {bottom + 44}" font-family="sans-serif" font-size="12">',
             f'<rect width="900" height="{bottom + 44}" fill="white"/>',
             text(20, 24, "Where the base begins to erode: models beside tests on sands", **{"font-size": "16"}),
             f'<rect x="{x(SANDS[0]):.1f}" y="{TOP - 6}" width="{x(SANDS[1]) - x(SANDS[0]):.1f}" height="{bottom - TOP + 6}" fill="#ece4f4"/>',
             text((x(SANDS[0]) + x(SANDS[1])) / 2, TOP - 12, "tests 6.8 to 10", "middle")]
    at = 20
    for base, colour in COLOURS.items():
        parts += [f'<circle cx="{at + 5}" cy="44" r="4" fill="{colour}"/>', text(at + 14, 48, f"base Cu {base}")]
        at += 100
    parts.append(text(at, 48, "line: least and most of five replicates; arrow: holds at the greatest ratio walked"))
    for place, model in enumerate(MODELS):
        middle = TOP + ROW * place + ROW / 2
        parts.append(f'<line x1="{LEFT}" y1="{middle + ROW / 2}" x2="{RIGHT}" y2="{middle + ROW / 2}" stroke="#ddd"/>')
        parts.append(text(LEFT - 8, middle + 4, model[0], "end"))
        of_model = cells.sands(model)
        if not of_model:
            parts.append(text(LEFT + 8, middle + 4, "not computed", fill="#888"))
        for k, (pair, row) in enumerate(of_model):
            y = middle + (k - (len(of_model) - 1) / 2) * min(3.0, (ROW - 8) / max(len(of_model), 1))
            colour, here = COLOURS[pair[2]], x(value(row))
            low, high = (float(row.get(f"first_{end}") or value(row)) for end in ("least", "most"))
            parts.append(f'<line x1="{x(low):.1f}" y1="{y:.1f}" x2="{x(high):.1f}" y2="{y:.1f}" stroke="{colour}" stroke-width="1.5"/>')
            if row.get("first"):
                parts.append(f'<circle cx="{here:.1f}" cy="{y:.1f}" r="2.6" fill="{colour}"/>')
            else:
                parts.append(f'<path d="M{here:.1f} {y - 3:.1f}l7 3l-7 3z" fill="{colour}"/>')
    for tick in range(int(LEAST), int(MOST) + 1, 2):
        parts += [f'<line x1="{x(tick):.1f}" y1="{bottom}" x2="{x(tick):.1f}" y2="{bottom + 4}" stroke="#222"/>',
                  text(x(tick), bottom + 17, str(tick), "middle")]
    parts += [f'<line x1="{LEFT}" y1="{bottom}" x2="{RIGHT}" y2="{bottom}" stroke="#222"/>', text((LEFT + RIGHT) / 2, bottom + 34, "D15F/D85B", "middle")]
    return "\n".join([*parts, "</svg>\n"])


def sums(cells):
    """For each model: how many cells of sands, from where to where, and how many lie in the range of tests."""
    for model in MODELS:
        for run, limit in (("first", None), ("second", CONTINUING)):
            of_model = cells.sands(model, run)
            if of_model:
                values = [value(row, run) for _, row in of_model]
                inside = sum(SANDS[0] <= v <= SANDS[1] for v in values)
                yield model, run, len(values), min(values), max(values), inside


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    options = parser.parse_args()
    cells = Cells(options.out)
    Path(f"{options.out}.svg").write_text(figure(cells))
    print("\n".join(table(cells)))
    for line in sums(cells):
        print(line[0][0], *line[1:])


if __name__ == "__main__":
    main()
