#!/usr/bin/env python3
"""The figure, the tables and the numbers of the page of scripts/studies/laboratory.py: models beside tests.

    scripts/studies/laboratory_page.py --out results/laboratory

Writes OUT.svg, and prints what OUT.md has to say, from OUT.csv, OUT-increments.csv and OUT-experiment.csv, and from `arches.csv` and `openings.csv` beside them, whose cells
have the same lattice and fill in what OUT.csv has not. What was not read in a source is in no count of agreement.
Exit code 1 where a table or a number does not stand on the page as it is printed.
"""

import argparse
import csv
import sys
from html import escape
from pathlib import Path

from arches import CONCENTRATIONS

SANDS, CONTINUING, SUSPENDED = (6.8, 10.0), 9.0, 0.11
# k/k0 below which nothing flows, and how closely boundaries are bracketed.
SEALED, BRACKET = 0.005, 1.04
KENNEY = {"1.2": 0.18, "3": 0.25, "6": 0.26}
# Three touching spheres of a uniform filter leave no finer constriction than this part of D0F; by D15F of Cu 1.2.
FINEST_OF_THREE = 1.2**0.3 / 0.1547
# Ratios with which searches of arches.csv and openings.csv begin: a replicate that erodes there may erode below as well.
FIRST_WALKED = {"4.0", "3.2", "2.56"}
SUSPENSIONS = [f"`marin-2018` {100 * part:g} %" for part in CONCENTRATIONS]
SIEVING, DENSE, CRITICAL = "sieving", "`zuriguel-2005`", "`critical-3`"
LAWS = [SIEVING, *SUSPENSIONS, DENSE, CRITICAL]
WAYS = {"area": "", "flux": ", water", "area-along-flow": ""}
# Network, exit, law and blocked constrictions.
MODELS = [(network, exit, law, blocked) for network, exit in (("lattice", "area"), ("lattice", "flux"), ("graph", "flux"), ("graph", "area-along-flow"))
          for law in LAWS for blocked in ("closed", "open")]
LATTICE, GRAPH = ({law: (*where, law, "closed") for law in LAWS} for where in (("lattice", "area"), ("graph", "area-along-flow")))
FLOWING, FLOWING_GRAPH, FLOWING_OPEN = ("lattice", "flux", SIEVING, "closed"), ("graph", "flux", SIEVING, "closed"), ("lattice", "flux", SIEVING, "open")
BASES = ["1.5", "3", "4.5"]
FILTERS = [(cu, density) for cu in ("1.5", "3", "6") for density in ("loose", "dense")]
PAIRS = [(*grains, base) for base in BASES for grains in FILTERS]
ONE_SIZE = ("1.2", "dense", "1")


def law_of(row):
    """The law of a row, with its concentration where it has one."""
    if row.get("concentration"):
        return f"`{row['law']}` {100 * float(row['concentration']):g} %"
    return SIEVING if row["law"] == "none" else f"`{row['law']}`"


def name_of(model):
    network, exit, law, blocked = model
    return f"{network}{WAYS[exit]}; {law}{'; open' if blocked == 'open' else ''}"


class Cells:
    """Boundaries of all models, by pair and model."""

    def __init__(self, out):
        rows = list(csv.DictReader(Path(f"{out}.csv").open()))
        self.largest = {(row["filter_cu"], law_of(row)): float(row["first"]) for row in rows if row["measure"] == "largest"}
        self.found = {}
        for name in ("openings.csv", "arches.csv"):
            for row in csv.DictReader((Path(out).parent / name).open()):
                if row.get("layers", "60") != "60" or row.get("across", "10") != "10":
                    continue
                least = "" if row["least"] in FIRST_WALKED else row["least"]
                if least or row["most"] or not row["no_erosion"]:
                    row |= {"network": "lattice", "exit": "area", "first": row["no_erosion"], "first_least": least, "first_most": row["most"]}
                    self.found[self.cell(row)] = row | {"first_holds_to": row["holds_to"]}
        self.found |= {self.cell(row): row for row in rows if row["measure"] == "boundary"}
        self.models = [model for model in MODELS if self.sands(model)]
        self.increments, self.experiment = (list(csv.DictReader(Path(f"{out}-{name}.csv").open())) for name in ("increments", "experiment"))

    @staticmethod
    def cell(row):
        return (row["filter_cu"], row["density"], row["base_cu"]), row["network"], row["exit"], law_of(row), row.get("blocked") or "closed"

    def row(self, model, pair):
        return self.found.get((pair, *model))

    def sands(self, model, run="first"):
        """The cells of sands that were computed, by pair."""
        return {pair: row for pair in PAIRS if is_computed(row := self.row(model, pair), run)}

    def spread(self, model):
        """Its boundaries of sands in words."""
        return parted(self.sands(model).values())


def is_computed(row, run="first"):
    return bool(row and (row.get(run) or row.get(f"{run}_holds_to")))


def is_sealed(row):
    """Whether no water flows through the filter just below the boundary, so that it cannot be set beside a test."""
    return row["exit"] != "area" and bool(row.get("k_over_k0")) and float(row["k_over_k0"]) < SEALED


def value(row, run="first"):
    """The boundary as a number: where it lies beyond the walks, the greatest ratio that holds."""
    return float(row.get(run) or row[f"{run}_holds_to"])


def ends(row):
    """The least and the most of its replicates, where they are known."""
    return [float(row[f"first_{end}"]) if row.get(f"first_{end}") else None for end in ("least", "most")]


def shown(row):
    """A boundary; empty where it was not computed."""
    if not is_computed(row):
        return ""
    return f"{'' if row.get('first') else 'beyond '}{value(row):.1f}{' ‡' if is_sealed(row) else ''}"


def span(values, digits=1):
    low, high = (f"{end(values):.{digits}f}" for end in (min, max))
    return low if low == high else f"{low} to {high}"


def of_d95b(row):
    """Least ratio D15F/D85B that erodes on in tests: 9 D95B of a linear base."""
    return CONTINUING * float(row["base_cu"]) ** 0.2


def parted(rows, run="first", digits=1, by=lambda row: 1.0):
    """Boundaries that were found and those beyond the greatest ratio walked, each by a number of its row, with how many there are."""
    rows = [row for row in rows if is_computed(row, run)]
    found, beyond = ([value(row, run) / by(row) for row in rows if bool(row.get(run)) == is_found] for is_found in (True, False))
    parts = [f"{span(found, digits)} ({len(found)})"] if found else []
    return "; ".join(parts + ([f"beyond {span(beyond, digits)} ({len(beyond)})"] if beyond else []))


def table(head, rows):
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *rows]).replace("| --- ", "|---").replace("--- |", "---|")


def counted(cells):
    """A row a model: cells of sands and where they lie beside the range of tests; sealed cells are in no count. And the models that are always sealed."""
    rows, always = [], {}
    for model in cells.models:
        every = list(cells.sands(model).values())
        open_rows = [row for row in every if not is_sealed(row)]
        if not open_rows and len(every) == 1:
            always.setdefault(model[0], []).append(f"{value(every[0]):.1f} at {model[2].split(' ', 1)[1]}")
            continue
        within = [row for row in open_rows if SANDS[0] <= value(row) <= SANDS[1]]
        on_edge = sum(least is None or most is None or least < SANDS[0] or most > SANDS[1] for least, most in map(ends, within))
        places = [str(sum(value(row) < SANDS[0] for row in open_rows)), f"{len(within)}{f' ({on_edge})' if on_edge else ''}",
                  str(sum(value(row) > SANDS[1] for row in open_rows))]
        closed_words = parted([row for row in every if is_sealed(row)])
        words = parted(open_rows).removesuffix(f" ({len(every)})")
        rows.append([name_of(model), str(len(every)), words, ", ".join(places) if open_rows else "", closed_words])
    return {"counted": table(["model", "cells", "boundary", "below, within, above 6.8 to 10", "sealed, not counted"], rows),
            "always_sealed": "; ".join(f"{network} {', '.join(words)}" for network, words in always.items())}


def both_networks(cells):
    """A row a filter, columns for bases: sieving on lattice and graph."""
    both = lambda pair: ", ".join(shown(cells.row(models[SIEVING], pair)) or "not walked" for models in (LATTICE, GRAPH))
    rows = [[f"{cu} {density}", *(both((cu, density, base)) for base in BASES)] for cu, density in FILTERS]
    return table(["filter Cu", *(f"base Cu {base}" for base in BASES)], rows)


def by_increments(cells):
    rows = {}
    for row in cells.increments:
        mark = " ‡" if float(row["k_over_k0"]) < SEALED else ""
        key = row["base_cu"], law_of(row), row["d15f_over_d85b"]
        rows.setdefault(key, []).append(f"{float(row['eroded_percent']):.1f}{mark}")
    shares = dict.fromkeys(f"{100 * float(row['inject_share']):g} %" for row in cells.increments)
    return table(["base Cu", "law", "D15F/D85B", *shares], [[*key, *eroded] for key, eroded in rows.items()])


def predicted(cells):
    """What the laws predict for the experiment: the table at increments of 1 %, and what is said of its scatter and of finer increments."""
    key = lambda row: (law_of(row), row["blocked"], float(row["d15f_over_d85b"]))
    coarse, fine = ({key(row): row for row in cells.experiment if row["inject_share"] == share} for share in ("0.01", "0.001"))
    columns = list(dict.fromkeys((blocked, ratio) for _, blocked, ratio in coarse))
    mass = lambda row: f"{float(row['eroded_percent']):.0f}"
    cell = lambda row: f"{mass(row)} ‡" if float(row["k_over_k0"]) < SEALED else f"{mass(row)}, {float(row['k_over_k0']):.2f}"
    rows = [[law, *(cell(coarse[law, *column]) for column in columns)] for law in dict.fromkeys(law for law, *_ in coarse)]
    moved = lambda at, name: abs(float(fine[at][name]) - float(coarse[at][name]))
    widest = {at: float(row["most"]) - float(row["least"]) for at, row in coarse.items()}
    worst = max(widest, key=widest.get)
    most = max(fine, key=lambda at: moved(at, "eroded_percent"))
    others = max(moved(at, "eroded_percent") for at in fine if at != most)
    return {
        "predicted": table(["law", *(f"{blocked}, {ratio:g}" for blocked, ratio in columns)], rows),
        "scatter": f"{max(widest[at] for at in widest if at != worst):.1f} points, but {widest[worst]:.1f} for {worst[0]} {worst[1]} at {worst[2]:g}",
        "finer": f"the mass moves by up to {others:.1f} points and k/k0 by up to {max(moved(at, 'k_over_k0') for at in fine):.3f}, but {most[0]} {most[1]} at "
                 f"{most[2]:g} passes {mass(fine[most])} % ({float(fine[most]['least']):.0f} to {float(fine[most]['most']):.0f}) in place of {mass(coarse[most])} %",
    }


def change(cells, model, other):
    """What a change of the model does to the boundary of sands: a factor, in those pairs of both where it is shown."""
    both = [(old, cells.row(other, pair)) for pair, old in cells.sands(model).items()]
    both = [(old, new) for old, new in both if new and new.get("first") and old.get("first")]
    times = []
    for old, new in both:
        ratio = value(new) / value(old)
        (low, high), (other_low, other_high) = ([end or value(row) for end in ends(row)] for row in (old, new))
        if not is_sealed(old) and not is_sealed(new) and (low > other_high or other_low > high) and max(ratio, 1 / ratio) >= BRACKET:
            times.append(ratio)
    return f"{span(times, 2)} ({len(times)} of {len(both)})" if times else f"not shown (0 of {len(both)})"


LEFT, RIGHT, TOP, ROW = 300, 860, 96, 26
LEAST, MOST = 2.0, 16.0
# Length of a line whose end is not known.
DASHED = 14
COLOURS = {"1.5": "#2b5fa8", "3": "#b06a1a", "4.5": "#4a8f4a"}


def x(ratio):
    return LEFT + (min(max(ratio, LEAST), MOST) - LEAST) / (MOST - LEAST) * (RIGHT - LEFT)


def figure(cells):
    """A row a model; a mark a pair of sand with the least and the most of its replicates; the range of tests behind."""
    bottom = TOP + ROW * len(cells.models)
    text = lambda at, y, words, anchor="start", size=12: f'<text x="{at:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">{escape(words)}</text>'
    line = lambda x1, y1, x2, y2, more: f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {more}/>'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 {bottom + 44}" font-family="sans-serif">',
             f'<rect width="900" height="{bottom + 44}" fill="white"/>', text(20, 24, "Where the base begins to erode: models beside tests on sands", size=16),
             f'<rect x="{x(SANDS[0]):.1f}" y="{TOP - 6}" width="{x(SANDS[1]) - x(SANDS[0]):.1f}" height="{bottom - TOP + 6}" fill="#ece4f4"/>',
             text((x(SANDS[0]) + x(SANDS[1])) / 2, TOP - 10, f"tests {SANDS[0]:g} to {SANDS[1]:g}", "middle")]
    for place, (base, colour) in enumerate(COLOURS.items()):
        parts += [f'<circle cx="{25 + 100 * place}" cy="44" r="4" fill="{colour}"/>', text(34 + 100 * place, 48, f"base Cu {base}")]
    parts.append(text(20, 68, "line: least and most of the replicates, dashed: end not known; arrow: holds at the greatest walked; hollow: sealed"))
    for place, model in enumerate(cells.models):
        middle, rows = TOP + ROW * place + ROW / 2, cells.sands(model)
        parts += [line(LEFT, middle + ROW / 2, RIGHT, middle + ROW / 2, 'stroke="#ddd"'), text(LEFT - 8, middle + 4, name_of(model).replace("`", ""), "end")]
        for k, (pair, row) in enumerate(rows.items()):
            y = middle + (k - (len(rows) - 1) / 2) * min(3.0, (ROW - 8) / len(rows))
            colour, here = COLOURS[pair[2]], x(value(row))
            inside = "white" if is_sealed(row) else colour
            if not row.get("first"):
                parts.append(f'<path d="M{here:.1f} {y - 3:.1f}l7 3l-7 3z" fill="{inside}" stroke="{colour}"/>')
                continue
            for end, outwards in zip(ends(row), (-DASHED, DASHED)):
                parts.append(line(here, y, x(end) if end else here + outwards, y, f'stroke="{colour}"' + ("" if end else ' stroke-dasharray="2 2"')))
            parts.append(f'<circle cx="{here:.1f}" cy="{y:.1f}" r="2.6" fill="{inside}" stroke="{colour}"/>')
    for tick in range(int(LEAST), int(MOST) + 1, 2):
        parts += [line(x(tick), bottom, x(tick), bottom + 4, 'stroke="#222"'), text(x(tick), bottom + 17, str(tick), "middle")]
    parts += [line(LEFT, bottom, RIGHT, bottom, 'stroke="#222"'), text((LEFT + RIGHT) / 2, bottom + 34, "D15F/D85B", "middle")]
    return "\n".join([*parts, "</svg>\n"])


def facts(cells):
    """The tables and numbers of the page in its words, by name."""
    sieving = [value(row) for row in cells.sands(LATTICE[SIEVING]).values()]
    at_pair = lambda law, pair=PAIRS[0]: value(cells.row(LATTICE[law], pair))
    least = lambda law: min(map(value, cells.sands(LATTICE[law]).values()))
    on_graph = {law: list(cells.sands(GRAPH[law]).values()) for law in LAWS}
    graph_rows, laws_rows = sum(on_graph.values(), []), on_graph[DENSE] + on_graph[CRITICAL]
    watered = [row for model in cells.models if model[1] != "area" and model[3] == "closed" for row in cells.sands(model).values() if row.get("k_over_k0")]
    ratios = {law: [cells.largest[cu, law] / tested for cu, tested in KENNEY.items()] for law in LAWS if ("1.2", law) in cells.largest}
    assert [abs(times - 1) < 0.1 for times in ratios[SIEVING]] == [True, False, False], "the page says that sieving returns the uniform filter alone"
    brackets = [float(row["first_erodes_from"]) / float(row["first_holds_to"]) for model in cells.models if model[0] == "graph"
                for row in cells.sands(model).values() if row.get("first")]
    wide = [100 * (ratio - 1) for ratio in brackets if ratio > BRACKET + 0.001]
    late = {(pair, tuple(model)): row["first_erodes_from"] for (pair, *model), row in cells.found.items() if not is_computed(row)}
    assert all(pair == PAIRS[0] and model[:2] == ("graph", "flux") for pair, model in late), "the page speaks of this pair on the graph with water"
    return predicted(cells) | counted(cells) | {
        "sieving": f"{span(sieving)} ({len(sieving)} cells)", "below": f"{sum(at < SANDS[0] for at in sieving)} cells below",
        "one": f"from {at_pair(SIEVING, ONE_SIZE):.1f} on", "caught": f"at {1 / SUSPENDED:.1f}", "finest": f"beyond D15F/D85B {FINEST_OF_THREE:.1f}",
        "dense_flow": f"to {least(CRITICAL):.1f} or beyond {least(DENSE):.1f}",
        "sieving_graph": cells.spread(GRAPH[SIEVING]), "graph_cells": f"of {len(graph_rows)} such cells",
        "suspensions": ", ".join(f"{cells.spread(LATTICE[law]).removesuffix(f' ({len(sieving)})')} at {100 * part:g} %" for part, law in zip(CONCENTRATIONS, SUSPENSIONS)),
        "graph_sealed": f"arches {sum(map(is_sealed, graph_rows))} are sealed",
        "laws_on_graphs": f"{len(laws_rows)} of 36 cells", "sealed_laws": f"{sum(map(is_sealed, laws_rows))} of them are sealed",
        **{f"continuing_{name}": ", ".join(parted(cells.sands(LATTICE[law]).values(), "second", 2, of_d95b) for law in laws)
           for name, laws in (("sieving", [SIEVING]), ("suspensions", SUSPENSIONS))},
        "both_networks": both_networks(cells), "by_increments": by_increments(cells),
        "water": change(cells, LATTICE[SIEVING], FLOWING), "graph_flow": change(cells, FLOWING, FLOWING_GRAPH),
        "graph_area": change(cells, LATTICE[SIEVING], GRAPH[SIEVING]), "open_flow": change(cells, FLOWING, FLOWING_OPEN),
        "largest": "; ".join(f"{law} {', '.join(f'{times:.2f}' for times in each)}" for law, each in ratios.items() if any(each)),
        "sealed": f"{sum(map(is_sealed, watered))} of {len(watered)} cells with water", "no_time": " and ".join(f"{ratio} ({model[2]})" for (_, model), ratio in late.items()),
        "wide": f"({len(wide)} cells on graphs to {max(wide):.0f} % at most)",
        "would_refute": f"from {at_pair(SUSPENSIONS[2]):.1f} at 5 % to {at_pair(SUSPENSIONS[0]):.1f} at 0.5 %",
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    options = parser.parse_args()
    cells = Cells(options.out)
    Path(f"{options.out}.svg").write_text(figure(cells))
    page, missing = " ".join(Path(f"{options.out}.md").read_text().split()), 0
    for name, fact in facts(cells).items():
        is_there = " ".join(fact.split()) in page
        missing += not is_there
        print(f"{name}{'' if is_there else ', NOT ON THE PAGE'}: {fact}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
