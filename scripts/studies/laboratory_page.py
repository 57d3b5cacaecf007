#!/usr/bin/env python3
"""The page of scripts/studies/laboratory.py: models beside tests, one figure and one table.

    scripts/studies/laboratory_page.py --out results/laboratory

Writes OUT.md and OUT.svg from OUT.csv and OUT-increments.csv, and from `arches.csv` and `openings.csv` beside it, whose cells have the same lattice and
stand where OUT.csv has none. TESTS holds every number of a test, with where it was read. What was not read in a source is in no count of agreement.
"""

import argparse
import csv
import textwrap
from html import escape
from pathlib import Path

from arches import CONCENTRATIONS

SANDS, BEADS_HOLD, CONTINUING = (6.8, 10.0), (8.0, 12.0), 9.0
SUSPENDED = 0.11
# k/k0 below which nothing flows, and how closely boundaries are bracketed.
SEALED, BRACKET = 0.005, 1.04
KENNEY_VOID_RATIOS = (0.39, 0.43)
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
    ("largest particle through filters of Cu 1.2, 3 and 6", "0.18, 0.25 and 0.26 D0F", "Kenney et al. (1985), as section 5 of the paper quotes it", "largest eroded"),
    ("glass beads", f"hold to D15F/D85B {BEADS_HOLD[0]:g}, fail from {BEADS_HOLD[1]:g} on, between by gradient",
     "**no source that was read**: this project's notes quote Tomlinson & Vaid (2000), searched again on 2026-11-25", "s_NE of beads, not counted"),
    ("the paper's loose filters", "below 5 no erosion", "the paper, a model: ours is the same model without arches, so that agreement is none", "not counted"),
]
# Laws, `marin-2018` once for each concentration that is stated with it.
SUSPENSIONS = [f"marin-2018 at {part:g}" for part in CONCENTRATIONS]
WITH_WATER = ["none", *SUSPENSIONS]
LAWS = [*WITH_WATER, "zuriguel-2005", "critical-3"]
BY_AREA = "area-along-flow"
WAYS = {"area": "area", "flux": "flow", BY_AREA: "area along flow"}
# Name, and where its cells stand.
MODELS = [
    (f"{network}, {WAYS[exit]}; {law}; {blocked}", network, exit, law, blocked)
    for network, exit, laws in [("lattice", "area", LAWS), ("lattice", "flux", WITH_WATER), ("graph", "flux", WITH_WATER), ("graph", BY_AREA, LAWS)]
    for law in laws for blocked in ("closed", "open")
    if blocked == "closed" or law in WITH_WATER and exit != BY_AREA
]
PAIRS = [("1.5", "loose", "1.5"), ("1.5", "dense", "1.5"), ("3", "loose", "1.5"), ("3", "dense", "1.5"), ("6", "loose", "1.5"), ("1.5", "loose", "3"),
         ("1.5", "dense", "3"), ("3", "loose", "3"), ("3", "dense", "3"), ("6", "loose", "3"), ("1.5", "loose", "4.5"), ("1.5", "dense", "4.5"),
         ("3", "loose", "4.5"), ("3", "dense", "4.5"), ("6", "loose", "4.5"), ("6", "dense", "1.5"), ("6", "dense", "3"),
         ("6", "dense", "4.5")]
ONE_SIZE, BEADS = ("1.2", "dense", "1"), ("1.2", "dense", "1.2")
LARGEST = [("1.2", "dense"), ("3", "loose"), ("6", "loose")]


# A uniform filter of three touching spheres has no finer constriction than this part of D0F; by D15F of Cu 1.2.
FINEST_OF_THREE = 1.2**0.3 / 0.1547
FIRST_WALKED = {"4.0", "3.2", "2.56"}


class Cells:
    """Boundaries of all models, by pair and model."""

    def __init__(self, out):
        rows = list(csv.DictReader(Path(f"{out}.csv").open()))
        self.largest = {(row["filter_cu"], law_of(row)): row for row in rows if row["measure"] == "largest"}
        self.found = {}
        # Boundaries of one pair by the concentration that was stated.
        self.by_concentration = {}
        beside = Path(out).parent
        for name in ("openings.csv", "arches.csv"):
            for row in csv.DictReader((beside / name).open()):
                usual = row.get("layers", "60") == "60" and row.get("across", "10") == "10"
                if name == "arches.csv" and row["concentration"] and usual and (row["filter_cu"], row["density"], row["base_cu"]) == PAIRS[0]:
                    self.by_concentration[row["concentration"]] = row["no_erosion"]
                # A replicate that erodes at the ratio with which a search begins, or below, may begin to anywhere below it.
                row |= {"least": "" if row["least"] in FIRST_WALKED else row["least"]}
                if usual and (row["least"] or row["most"] or not row["no_erosion"]):
                    row |= {"network": "lattice", "exit": "area", "first": row["no_erosion"]}
                    row |= {f"first_{end}": row[end] for end in ("least", "most", "holds_to", "erodes_from")}
                    self.found[self.cell(row)] = row
        self.found |= {self.cell(row): row for row in rows if row["measure"] == "boundary"}
        self.increments = list(csv.DictReader(Path(f"{out}-increments.csv").open()))
        self.experiment = list(csv.DictReader(Path(f"{out}-experiment.csv").open()))
        # Those of which a cell was computed.
        computed = {of[1:] for of, row in self.found.items() if is_computed(row)}
        self.models = [model for model in MODELS if model[1:] in computed]

    @staticmethod
    def cell(row):
        return (row["filter_cu"], row["density"], row["base_cu"]), row["network"], row["exit"], law_of(row), row.get("blocked") or "closed"

    def of(self, model, pair):
        return self.found.get((pair, *model[1:]))

    def sands(self, model, run="first"):
        """The cells of sands that were computed, as (pair, row)."""
        of_model = [(pair, self.of(model, pair)) for pair in PAIRS]
        return [(pair, row) for pair, row in of_model if row and (row.get(run) or row.get(f"{run}_holds_to"))]


def law_of(row):
    """The law of a row, with its concentration where it has one."""
    return f"{row['law']} at {float(row['concentration']):g}" if row.get("concentration") else row["law"]


def is_computed(row, run="first"):
    return bool(row and (row.get(run) or row.get(f"{run}_holds_to")))


def shown(row, run="first"):
    """A boundary with the least and the most of five replicates; empty where it was not computed."""
    if not is_computed(row, run):
        return ""
    least, most = row.get(f"{run}_least"), row.get(f"{run}_most")
    sealed = " ‡" if is_sealed(row) else ""
    if not row.get(run):
        return f"beyond {float(row[f'{run}_holds_to']):.1f}{sealed}"
    span = f"{least} to {most}" if least and most else f"from {least}" if least else f"to {most}"
    return f"{row[run]} ({span}){sealed}"


def value(row, run="first"):
    """The boundary as a number: where it lies beyond the walks, the greatest ratio that holds."""
    return float(row.get(run) or row[f"{run}_holds_to"])


def found_and_beyond(rows, run="first", by=lambda row: 1.0):
    """The boundaries that were found, and the greatest ratios walked of those that hold there, each by a number of its row."""
    rows = [row for row in rows if is_computed(row, run)]
    return tuple([value(row, run) / by(row) for row in rows if bool(row.get(run)) == is_found] for is_found in (True, False))


def parted(found, beyond, digits=1):
    """Both in words, with how many there are of each."""
    parts = [f"{span(found, digits)} ({len(found)})"] if found else []
    return "; ".join(parts + ([f"beyond {span(beyond, digits)} ({len(beyond)})"] if beyond else []))


def is_sealed(row):
    """Whether no water flows through the filter just below the boundary, so that it cannot be set beside a test."""
    return row["exit"] != "area" and bool(row.get("k_over_k0")) and float(row["k_over_k0"]) < SEALED


def table(cells):
    """Models as rows; a column for sands by Cu of the base, one size, beads and largest particles."""
    head = ["model (way; arches; blocked constrictions)", "filter Cu 1.5 loose, base Cu 1.5", "Cu 1.5 loose, 3", "Cu 3 loose, 3", "other sands",
            "one size", "beads", "largest by D0F, filter Cu 1.2", "Cu 3", "Cu 6"]
    tests = ["**tests**", *[f"{SANDS[0]:g} to {SANDS[1]:g}"] * 4, f"{1 / SUSPENDED:.1f}", f"{BEADS_HOLD[0]:g} to {BEADS_HOLD[1]:g} \\*", *map(str, KENNEY.values())]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|", "| " + " | ".join(tests) + " |"]
    first = [PAIRS[0], PAIRS[5], PAIRS[7]]
    for model in cells.models:
        of = lambda pair: shown(cells.of(model, pair))
        others = [row for pair, row in cells.sands(model) if pair not in first]
        spread = parted(*found_and_beyond(others), digits=2)
        largest = [largest_shown(cells, of_filter, model) for of_filter in LARGEST]
        row = [model[0], *map(of, first), spread, of(ONE_SIZE), of(BEADS), *largest]
        lines.append("| " + " | ".join(row) + " |")
    return lines


def lattice_beside_graph(cells):
    """A row a pair of sands: its boundaries by area on both networks, law by law."""
    both = [models for models in BOTH if models[1] in cells.models]
    head = ["filter", "base Cu", *(f"{where}, `{lattice[3]}`" for lattice, _ in both for where in ("lattice", "graph"))]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for pair in sorted(PAIRS, key=lambda pair: (float(pair[2]), float(pair[0]), pair[1] == "dense")):
        row = [f"Cu {pair[0]}, {pair[1]}", pair[2], *(shown(cells.of(model, pair)) for models in both for model in models)]
        lines.append("| " + " | ".join(row) + " |")
    return lines


def largest_shown(cells, of_filter, model):
    row = cells.largest.get((of_filter[0], model[3])) if model[1:3] == ("lattice", "area") and model[4] == "closed" else None
    return f"{float(row['first']):.3f} ({float(row['first_least']):.3f} to {float(row['first_most']):.3f})" if row else ""


LEFT, RIGHT, TOP, ROW = 300, 860, 96, 26
LEAST, MOST = 2.0, 16.0
# How long a line is whose end is not known.
DASHED = 14
COLOURS = {"1.5": "#2b5fa8", "3": "#b06a1a", "4.5": "#4a8f4a"}


def x(ratio):
    return LEFT + (min(max(ratio, LEAST), MOST) - LEAST) / (MOST - LEAST) * (RIGHT - LEFT)


def figure(cells):
    """A row a model; a mark a pair of sand with the least and the most of its replicates; the range of tests behind."""
    bottom = TOP + ROW * len(cells.models)
    text = lambda at, y, words, anchor="start", **more: (
        f'<text x="{at:.1f}" y="{y:.1f}" text-anchor="{anchor}"{"".join(f" {n}={chr(34)}{v}{chr(34)}" for n, v in more.items())}>{escape(words)}</text>')
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 {bottom + 44}" font-family="sans-serif" font-size="12">',
             f'<rect width="900" height="{bottom + 44}" fill="white"/>',
             text(20, 24, "Where the base begins to erode: models beside tests on sands", **{"font-size": "16"}),
             f'<rect x="{x(SANDS[0]):.1f}" y="{TOP - 6}" width="{x(SANDS[1]) - x(SANDS[0]):.1f}" height="{bottom - TOP + 6}" fill="#ece4f4"/>',
             text((x(SANDS[0]) + x(SANDS[1])) / 2, TOP - 12, f"tests {SANDS[0]:g} to {SANDS[1]:g}", "middle")]
    at = 20
    for base, colour in COLOURS.items():
        parts += [f'<circle cx="{at + 5}" cy="44" r="4" fill="{colour}"/>', text(at + 14, 48, f"base Cu {base}")]
        at += 100
    parts.append(text(at, 48, "line: least and most of the replicates, dashed: end not known; arrow: holds at the greatest walked; hollow: sealed"))
    for place, model in enumerate(cells.models):
        middle = TOP + ROW * place + ROW / 2
        parts.append(f'<line x1="{LEFT}" y1="{middle + ROW / 2}" x2="{RIGHT}" y2="{middle + ROW / 2}" stroke="#ddd"/>')
        parts.append(text(LEFT - 8, middle + 4, model[0], "end"))
        of_model = cells.sands(model)
        for k, (pair, row) in enumerate(of_model):
            y = middle + (k - (len(of_model) - 1) / 2) * min(3.0, (ROW - 8) / max(len(of_model), 1))
            colour, here = COLOURS[pair[2]], x(value(row))
            for end, outwards in (("least", -DASHED), ("most", DASHED)):
                if not row.get(f"first_{end}") and not row.get("first"):
                    continue
                known = bool(row.get(f"first_{end}"))
                to = x(float(row[f"first_{end}"])) if known else here + outwards
                dashes = "" if known else ' stroke-dasharray="2 2"'
                parts.append(f'<line x1="{here:.1f}" y1="{y:.1f}" x2="{to:.1f}" y2="{y:.1f}" stroke="{colour}" stroke-width="1.5"{dashes}/>')
            if row.get("first"):
                inside = "white" if is_sealed(row) else colour
                parts.append(f'<circle cx="{here:.1f}" cy="{y:.1f}" r="2.6" fill="{inside}" stroke="{colour}"/>')
            else:
                parts.append(f'<path d="M{here:.1f} {y - 3:.1f}l7 3l-7 3z" fill="{colour}"/>')
    for tick in range(int(LEAST), int(MOST) + 1, 2):
        parts += [f'<line x1="{x(tick):.1f}" y1="{bottom}" x2="{x(tick):.1f}" y2="{bottom + 4}" stroke="#222"/>',
                  text(x(tick), bottom + 17, str(tick), "middle")]
    parts += [f'<line x1="{LEFT}" y1="{bottom}" x2="{RIGHT}" y2="{bottom}" stroke="#222"/>', text((LEFT + RIGHT) / 2, bottom + 34, "D15F/D85B", "middle")]
    return "\n".join([*parts, "</svg>\n"])


def paragraph(words, first="", rest=""):
    return textwrap.fill(words, 150, initial_indent=first, subsequent_indent=rest, break_long_words=False, break_on_hyphens=False)


def bullet(words):
    return paragraph(words, "- ", "  ")


def span(values, digits=1):
    low, high = (f"{end(values):.{digits}f}" for end in (min, max))
    return low if low == high else f"{low} to {high}"


def model_of(*parts):
    return next(model for model in MODELS if model[1:] == parts)


# What the page lacks.
CENTRE = (SANDS[0] * SANDS[1]) ** 0.5
SIEVING = model_of("lattice", "area", "none", "closed")
DENSE = model_of("lattice", "area", "zuriguel-2005", "closed")
CRITICAL = model_of("lattice", "area", "critical-3", "closed")
FLOWING = model_of("lattice", "flux", "none", "closed")
# Concentrations ten times apart.
# By concentration, on the lattice by area.
SUSPENDED_MODELS = [(part, model_of("lattice", "area", name, "closed")) for part, name in zip(CONCENTRATIONS, SUSPENSIONS)]
HIGH, LOW = "0.05", "0.005"
# Both networks, law by law, by area.
BOTH = [(model_of("lattice", "area", law, "closed"), model_of("graph", BY_AREA, law, "closed")) for law in LAWS]


def in_range(rows):
    """How many boundaries lie below the range of tests, within and above it, of how many within the interval crosses an edge, and of how many an end is not known."""
    within = [row for row in rows if SANDS[0] <= value(row) <= SANDS[1]]
    ends = [[float(row.get(f"first_{end}") or value(row)) for end in ("least", "most")] for row in within]
    crossing = sum(low < SANDS[0] or high > SANDS[1] for low, high in ends)
    unknown = sum(not all(row.get(f"first_{end}") for end in ("least", "most")) for row in within)
    words = ", ".join([f"the interval of {crossing} crosses an edge"] * bool(crossing) + [f"of {unknown} one end is not known"] * bool(unknown))
    return sum(value(row) < SANDS[0] for row in rows), len(within), sum(value(row) > SANDS[1] for row in rows), words


def comparable(cells, model):
    """The cells of sands that can be set beside a test: all whose filter is not sealed."""
    return [(pair, row) for pair, row in cells.sands(model) if not is_sealed(row)]


def of_d95b(row):
    """Least ratio D15F/D85B that erodes on in tests: 9 D95B of a linear base."""
    return CONTINUING * float(row["base_cu"]) ** 0.2


def second_runs(cells, model):
    """Boundaries of continuing erosion by that of tests: found, and holding at the greatest ratio walked."""
    return found_and_beyond([row for _, row in comparable(cells, model)], "second", of_d95b)


def increments(cells):
    """What erodes by the share of the base in an increment."""
    pairs = {}
    for row in cells.increments:
        pairs.setdefault((row["base_cu"], f"`{law_of(row)}`", row["d15f_over_d85b"]), {})[row["inject_share"]] = row
    shares = list(dict.fromkeys(row["inject_share"] for row in cells.increments))
    yield paragraph(
        "**Boundaries of graphs depend on the increments, and those that are sealed (‡) are no boundaries of filters.** The filter of Cu 1.5, loose, just below four of its boundaries, by the share of the "
        "base that an increment inserts; percent that erodes, mean, least and most of five (`laboratory-increments.csv`; \"sealed\": k/k0 is 0 at the end):")
    yield ""
    yield "| " + " | ".join(["base Cu", "law", "D15F/D85B", *shares]) + " |"
    yield "|---" * (3 + len(shares)) + "|"
    of = lambda row: f"{row['eroded_percent']} ({row['least']} to {row['most']}){'' if float(row['k_over_k0']) >= SEALED else ', sealed'}"
    for pair, rows in pairs.items():
        yield "| " + " | ".join([*pair, *(of(rows[share]) for share in shares)]) + " |"
    yield ""
    yield paragraph(f"All other cells have {shares[0]}. With it much of the base is in the filter before the first particle can be through, and a filter that seals keeps all of it (`src/docs/graph.md`).")
    yield ""


def experiment(cells):
    """The test that would tell the laws apart, how to do it, and what each law predicts for it."""
    yield from map(bullet, [
        "**Filter**: glass beads of 1.00 to 1.44 mm, straight on a sieve diagram (D15F 1.06 mm), 69 mm thick in a tube of 50 mm or more, on a screen that the base passes. Pour it under water in layers of "
        "10 mm and tap until its height no longer falls. Report the void ratio; do not vibrate later.",
        "**Base**: beads of one size, 0.162, 0.132 or 0.106 mm (D15F/D85B 6.5, 8, 10; within 5 %), of the liquid's density (polystyrene in brine): glass of 0.13 mm settles about half as fast as the water flows at "
        "gradient 1, so that its concentration in the filter is not that of the feed. In all 5 % of the solid volume of the filter.",
        "**Feed**: from a stirred tank, downwards, at 0.5, 2, 5 and 15 % of solids by volume (18, 4.4, 1.8 and 0.6 pore volumes of suspension). Then clear liquid at the same head, until less than 0.1 % "
        "of the base leaves in a pore volume, at least five pore volumes. Without this nothing can leave at 15 % under any law.",
        "**Gradient**: constant head across the filter alone, 1 or 10. Log the flow.",
        "**Weigh** what passed, what lies in slices of the filter, and what lies above it, each as a part of what was offered. Measure the permeability between piezometers inside the filter: a cake on top "
        "conducts, too, so that k/k0 of the whole tells nothing.",
        "**Repeats**: five, each on a new filter. First D15F/D85B 8 at 0.5 and 15 %, both gradients: 20 tests. A control at 0.02 % shows what settles or sticks.",
        "**Decide beforehand**: 50 % and more has passed, 7.5 % and less was held, anything between is undecided; a difference counts beyond twice the standard deviation of the repeats.",
    ])
    yield ""
    yield paragraph(
        "What the laws predict: the mass that passes in percent, least and most of five in brackets, and k/k0 (lattice with water, 10 x 10 x 60 voids; `laboratory-experiment.csv`), by the share of the base that "
        "an increment inserts. ‡ Sealed: with increments of 1 % at least 60 % of the base is inside before anything can leave, so that what a sealed filter holds is no prediction but at the smaller share. No law knows the gradient: each number is for 1 and for 10.")
    yield ""
    for blocked, share in dict.fromkeys((row["blocked"], row["inject_share"]) for row in cells.experiment):
        rows = [row for row in cells.experiment if (row["blocked"], row["inject_share"]) == (blocked, share)]
        ratios = sorted(dict.fromkeys(row["d15f_over_d85b"] for row in rows), key=float)
        by_law = {}
        for row in rows:
            sealed_mark = " ‡" if float(row["k_over_k0"]) < SEALED else ""
            by_law.setdefault(law_of(row), {})[row["d15f_over_d85b"]] = (
                f"{float(row['eroded_percent']):.0f} ({float(row['least']):.0f} to {float(row['most']):.0f}), {float(row['k_over_k0']):.2f}{sealed_mark}")
        yield "| " + " | ".join([f"blocked constrictions {blocked}, increments of {100 * float(share):g} %", *(f"D15F/D85B {float(ratio):g}" for ratio in ratios)]) + " |"
        yield "|---" * (1 + len(ratios)) + "|"
        for law, cell in by_law.items():
            yield "| " + " | ".join(["sieving alone" if law == "none" else f"`{law}`", *(cell.get(ratio, "") for ratio in ratios)]) + " |"
        yield ""
    yield paragraph(
        "**What tells them apart.** Sieving passes everything at every concentration; the laws of dense flow pass next to nothing at any. Only `marin-2018` changes with the concentration: at D15F/D85B 8 from 98 to "
        "100 % at 0.5 % to nothing at 15 %. So two tests at 8 can refute sieving alone (nothing passes at 15 %) or the dense laws (the base passes at 0.5 %). They cannot confirm `marin-2018`: whatever retains more "
        "at a higher concentration has the same sign. Its numbers at 2 and 5 % would be the test, and these depend on how a particle chooses its exit. No law knows the gradient: a difference between 1 and "
        "10, at the same concentration at the face of the filter, shows that a law without flow is not enough, and not which law is wrong in R or φ. 6.5 lies within the tolerance of a sieve from "
        f"{FINEST_OF_THREE:.1f}, where spheres begin to be caught by geometry alone.")
    yield ""


def networks(cells):
    """The boundaries by area on both networks: what was walked, a table, and what the graph changes, law by law."""
    yield paragraph(
        "Six filters, three bases, constrictions closed, no openings; the boundary of the first run. The lattice has 10 x 10 x 60 voids and five replicates. "
        "The graph has the voids of five packings of 3,000 grains (Cu 1.5), 6,000 (Cu 3) and 10,000 (Cu 6), seeds 1 to 5, one run each. "
        "Its thickness is 60 layers rounded up to whole copies of the packing: 61 to 63 layers, of Cu 3 73 to 74. Of Cu 6 the packing is the finer 78 % of the mass, with the base of the "
        "whole; its constrictions are finer by up to 2 %. A constriction of a packing has no direction, so that area alone leads nowhere: a particle chooses by area among the exits that water leaves by. "
        "The lattice needs no water, so a graph may be sealed (‡) where the lattice cannot be. An empty cell was not walked.")
    yield ""
    yield from lattice_beside_graph(cells)
    yield ""
    yield from increments(cells)
    for law, (lattice, graph) in zip(LAWS, BOTH):
        both = [(cells.of(lattice, pair), row) for pair, row in cells.sands(graph)]
        if not both:
            continue
        rows = [row for _, row in both]
        found, beyond = found_and_beyond(rows)
        times = {sealed: [value(row) / value(old) for old, row in both if old and row.get("first") and old.get("first") and is_sealed(row) == sealed] for sealed in (False, True)}
        least = [value(row) / value(old) for old, row in both if old and row.get("first") and not old.get("first")]
        words = [f"the graph has its boundary at {parted(found, beyond)}"]
        words += [f"{span(of, 2)} times that of the lattice where the graph is {'sealed' if sealed else 'not sealed'} ({plural(len(of), 'pair')})" for sealed, of in times.items() if of]
        if least:
            words.append(f"at most {span(least, 2)} times it where the lattice holds at the greatest ratio walked ({len(least)})")
        sealed_rows = sum(map(is_sealed, rows))
        yield bullet(f"**`{law}`**: {'; '.join(words)}. Sealed just below the boundary: {sealed_rows} of {len(rows)}.")


def plural(count, word):
    return f"{count} {word}{'' if count == 1 else 's'}"


def by_model(cells):
    """A line a model: where its boundaries lie beside the range of tests, and what is left of the permeability."""
    for model in cells.models:
        every = cells.sands(model)
        words = []
        rows = [row for _, row in comparable(cells, model)]
        if rows:
            found, beyond = found_and_beyond(rows)
            part = f"found at {span(found)} in {plural(len(found), 'cell')} of sands, {span([v / CENTRE for v in found], 2)} times the centre of the range" if found else "none found"
            if beyond:
                part += f"; {plural(len(beyond), 'cell')} hold{'s' if len(beyond) == 1 else ''} at the greatest ratio walked, {span(beyond)}"
            below, within, above, edges = in_range(rows)
            words.append(f"{part}. {below} below the range, {within} within"
                         f"{f' ({edges})' if edges else ''}, {above} above.")
            if any(second_runs(cells, model)):
                words.append(f"Continuing erosion, times 9 D95B: {parted(*second_runs(cells, model), digits=2)}.")
        closed = [row for _, row in every if is_sealed(row)]
        if closed:
            words.append(f"Sealed below the boundary, so in no count: {', '.join(f'{value(row):.1f}' for row in closed)}.")
        kept = [float(row["k_over_k0"]) for row in rows if row.get("k_over_k0")]
        if kept:
            words.append(f"k/k0 just below the boundary: {span(kept, 2)}.")
        yield f"**{model[0]}**: {' '.join(words)}"


def why_not_shown(old, new):
    """Why a shift between two cells is not shown; empty where it is."""
    if is_sealed(old) or is_sealed(new):
        return "a sealed filter"
    (low, high), (other_low, other_high) = ([float(row.get(f"first_{end}") or value(row)) for end in ("least", "most")] for row in (old, new))
    if low <= other_high and other_low <= high:
        return "replicates overlap"
    times = value(new) / value(old)
    return "less than the bracket" if max(times, 1 / times) < BRACKET else ""


def change(cells, model, other, what):
    """What a change of the model does to the boundary, in the pairs that both have."""
    both = [(row, cells.of(other, pair)) for pair, row in cells.sands(model)]
    both = [(row, new) for row, new in both if row.get("first") and new and new.get("first")]
    times = [value(new) / value(row) for row, new in both if not why_not_shown(row, new)]
    parts = [f"times {span(times, 2)} ({plural(len(times), 'pair')})"] if times else []
    parts += [f"not shown in {plural(reasons, 'pair')} ({why})" for why in ("a sealed filter", "replicates overlap", "less than the bracket")
              if (reasons := sum(why_not_shown(*pair) == why for pair in both))]
    if parts:
        yield f"{what} {', '.join(parts)}"


def largest_ratios(cells, law):
    """Largest particles by those of Kenney's tests, filter by filter."""
    return [float(cells.largest[cu, law]["first"]) / number for cu, number in KENNEY.items() if (cu, law) in cells.largest]


def largest_words(cells):
    """Largest particles beside Kenney's, law by law."""
    for law in LAWS:
        if ratios := largest_ratios(cells, law):
            yield f"{'without arches' if law == 'none' else f'by `{law}`'} {', '.join(f'{times:.2f}' for times in ratios)}"


def sealed(cells):
    """The cells with water and closed constrictions whose filter lets nothing through."""
    of = [(model, row) for model in MODELS if model[2] != "area" and model[4] == "closed" for _, row in cells.sands(model) if row.get("k_over_k0")]
    rows, arched = [row for _, row in of if is_sealed(row)], [is_sealed(row) for model, row in of if model[3] != "none"]
    if rows:
        every = f", of which {len(arched)} are all that have arches" if arched and all(arched) else ""
        yield (f"**With water and closed constrictions a filter that holds may let no water through**: k/k0 is below {SEALED:g} just below the boundary in {len(rows)} of {len(of)} cells{every}. "
               "What cannot enter any more counts as held. Such a boundary cannot be set beside a test through whose filter water flows.")


def page(cells, name, head):
    of = cells.of
    one, beads = of(SIEVING, ONE_SIZE), of(SIEVING, BEADS)
    suspensions = ", ".join(f"at {100 * part:g} % {parted(*found_and_beyond([row for _, row in cells.sands(model)]))}" for part, model in SUSPENDED_MODELS)
    dense, critical = (parted(*found_and_beyond([row for _, row in cells.sands(model)])) for model in (DENSE, CRITICAL))
    on_graph = {lattice[3]: [row for _, row in cells.sands(graph)] for lattice, graph in BOTH}
    dense_graph, critical_graph = (parted(*found_and_beyond(on_graph[model[3]])) for model in (DENSE, CRITICAL))
    laws_rows = on_graph[DENSE[3]] + on_graph[CRITICAL[3]]
    sealed_laws = sum(map(is_sealed, laws_rows))
    graph_rows = sum(on_graph.values(), [])
    caught = 1 / SUSPENDED
    sieving = [value(row) for _, row in cells.sands(SIEVING)]
    off = [abs(times - 1) for times in largest_ratios(cells, "none")]
    assert [of < 0.1 for of in off] == [True, False, False], "the page says that the walk without arches returns the uniform filter alone"
    lines = ["# Which model explains which test", "",
             paragraph(f"**None explains all; the concentration of the tests is not known. Sieving puts the boundary of no erosion of sands at D15F/D85B {span(sieving)} in {len(sieving)} cells, below the {SANDS[0]:g} to {SANDS[1]:g} "
                       f"of tests in {sum(at < SANDS[0] for at in sieving)}. It lets one size through from {value(one):.1f} on, where tests caught it at {caught:.1f}. The laws of dense flow hold too much on the lattice: "
                       f"`zuriguel-2005` {dense}, `critical-3` {critical}. On the voids of packings, by area, sieving puts it at {parted(*found_and_beyond(on_graph['none']))}; but of {len(graph_rows)} "
                       f"such cells with and without arches {sum(map(is_sealed, graph_rows))} are sealed just below the boundary, and boundaries there depend on the increments. `marin-2018` moves with the concentration of the suspension: on the lattice, by area, {suspensions}.**"), head, "",
             f"![Boundaries of models against the range of tests]({name}.svg)", "",
             "## Tests", ""]
    lines += [bullet(f"**{what}**: {number}. Read in: {source}. Compared: {how}.") for what, number, source, how in TESTS]
    lines += ["", "## Table", "",
              paragraph("D15F/D85B at which 7.5 % of the base erodes in the first run; in brackets the least and the most of five replicates. \"Beyond\": holds at "
                        "the greatest ratio walked. \"From\": the last replicate holds there. \"To\": the first erodes at the least ratio walked. Other sands: the filters Cu 1.5, 3 and 6, loose and dense, with bases of Cu 1.5, 3 and "
                        f"4.5, as far as they were computed; in brackets how many were found, and how many hold at the greatest ratio walked. **An empty cell was not computed.** Every cell stands in `{name}.csv`, `arches.csv` or `openings.csv`."), ""]
    lines += table(cells)
    lines += ["", paragraph(f"\\* not read in a source, in no count. ‡ sealed: k/k0 below {SEALED:g} just below the boundary."),
              "", "## Lattice beside graph", "", *networks(cells), "", "## By model", "",
              paragraph(f"The centre of the range is {CENTRE:.1f} D85B. \"No erosion\" is here 7.5 % of the base, which is not the criterion of the tests. Fell et al. (9.3.2) call it no erosion when the \"filter seals with practically no erosion of the base material\". A stricter limit lowers every boundary. "
                        "A bound has no factor. Table 9.2 describes filters by D15F alone, so every filter here stands beside the same range. Bases here are straight on a sieve diagram; the curves of the tested ones were not read."), ""]
    lines += map(bullet, by_model(cells))
    lines += ["", "## What follows", ""]
    flow = "; ".join(part for args in [
        (SIEVING, FLOWING, "water on the lattice, without arches,"),
        (FLOWING, model_of("graph", "flux", "none", "closed"), "the packing's own voids instead of the lattice, with water,"),
        (SIEVING, BOTH[0][1], "the packing's own voids instead of the lattice, by area, without arches,"),
        (FLOWING, model_of("lattice", "flux", "none", "open"), "openings, with water,"),
    ] for part in change(cells, *args))
    follows = [
        f"**What changes the boundary**: {flow}.",
        f"**One size in suspension** (Sherard et al.: about 0.11 D15F, so 9.1): sieving lets it through from {shown(one)} on, {value(one) * SUSPENDED:.1f} times that. Three touching spheres of a uniform "
        "filter leave more than 0.11 D15F, so that no sieving by spheres can catch it there. The concentration of these tests was not read.",
        f"**Kenney's tests**: the largest particle that passes filters of Cu 1.2, 3 and 6 is, by that of tests, {'; '.join(largest_words(cells))}. The paper has 0.30 and 0.34 D0F for Cu 3 and 6 (1.20 and 1.31). "
        f"The filter of Cu 6 (e 0.34) is denser than that of the tests ({span(KENNEY_VOID_RATIOS, 2)}; the paper, section 5). So the walk without arches "
        "returns one of three within a tenth, the uniform filter, and lets particles through the broader ones that tests held. "
        "The walk was expected to reproduce these tests by sieving alone, since vibration breaks arches. It does not. That these tests were vibrated was not read in a source. "
        "If they were, something other than arches holds the broader ones, or the lattice leads too many particles to its widest constrictions; this was not tested.",
        f"**Glass beads** (not counted): sieving {shown(beads)}, `zuriguel-2005` {shown(of(DENSE, BEADS))}, `critical-3` "
        f"{shown(of(CRITICAL, BEADS))}. None knows the gradient that decided between {BEADS_HOLD[0]:g} and {BEADS_HOLD[1]:g}.",
        *sealed(cells),
        "**Not fitted**: no law and no setting was fitted to a test. **Not counted**: the paper's own cases (the same model) and beads (not read).",
    ]
    lines += map(bullet, follows)
    lines += ["", "## The experiment that would decide", "", *experiment(cells)]
    lines += ["## What would refute each", ""]
    lines += map(bullet, [
        f"**Sieving** lies below the tests in {sum(at < SANDS[0] for at in sieving)} cells of {len(sieving)} already. The shape of grains, which it lacks, could be why. Smooth spheres of one size and of the liquid's density that do not stick, arrive one by one and are caught in number "
        f"beyond D15F/D85B {FINEST_OF_THREE:.1f} would refute it as the only cause: no constriction of three touching spheres is finer. From {value(one):.1f} to there a thicker filter could catch them.",
        "**`marin-2018`**: a boundary that moves much less than predicted when the base arrives ten times more diluted. The lattice, by area, moves it from "
        f"{float(cells.by_concentration[HIGH]):.1f} at {HIGH} to {float(cells.by_concentration[LOW]):.1f} at {LOW} (filter Cu 1.5, loose; base Cu 1.5).",
        "**`zuriguel-2005`** (the dense limit) and **`critical-3`** (every particle below R = 3): a base that erodes where the law holds it. On the lattice both hold what eroded in tests, "
        f"whose boundary lies at {SANDS[0]:g} to {SANDS[1]:g}: the first {dense}, the second {critical}. So on the lattice both, with arches that never break and that single particles make, hold more than these tests. Which of these assumptions is at fault is not known. On the voids of "
        f"packings, by area, the first lies at {dense_graph} and the second at {critical_graph}, as far as they were walked. {sealed_laws} of these {len(laws_rows)} cells are sealed just below, so that they neither refute nor support. "
        "Neither bounds the other or `marin-2018`.",
        "**Closed constrictions or openings, with water**: k/k0 inside a filter after it stopped eroding (see the experiment). A test with that number was not looked for.",
        "**Lattice or graph**: the same packing in a test, with the mass that erodes at three ratios.",
    ])
    lines += ["", "## Not computed", "",
              bullet("Empty cells of the tables; one size with water; the second run of graphs by area."),
              *(bullet(f"{model[0]}, filter Cu {pair[0]}, {pair[1]}, base Cu {pair[2]}: it erodes at {row['first_erodes_from']}, the least ratio for which there was time; empty in the table.")
                for model in MODELS for pair in PAIRS if (row := of(model, pair)) and not is_computed(row) and row.get("first_erodes_from")),
              bullet("Again with the schedule of the flow of 2026-11-29: 44 graphs by area (Cu 3 and 6; Cu 1.5, dense, with laws and bases of Cu 3 and 4.5; Cu 1.5, loose, with laws and, but for `critical-3`, bases "
                     "of Cu 3 and 4.5). Their numbers are of the schedule before, which solved once 1 % of the constrictions had closed. In 19 cells that were walked again the first boundary moved by up to 3.5 %, in one "
                     "by 5.9 %, and the second by up to 6.1 %; just below it k/k0 fell, in five of ten graphs by area to 0 where water flowed before."),
              bullet("The experiment at increments of 0.1 % where its tables are empty or have no column."),
              bullet("Bases with more than 15 % fines: tests have cohesion and the walk has none. Without arches they are in `real-soils.md`."),
              bullet("Skill on single tests: no table of single tests (base, filter, held or not) could be read. Searched again on 2026-11-25: Honjo (1985), Raut (2006) and "
                     "Indraratna et al. (2007) speak of such data, and only their first pages could be read."),
              bullet(f"Sherard et al. on uniform sands (5 is conservative): no boundary to compare with. {sum(of < 5 for of in sieving)} of the {len(sieving)} cells of sieving lie below 5.")]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True)
    parser.add_argument("--of", default="2026-11-25, AMD EPYC, program of commit ddfd4ba with the script of b1fdde1, later cells of db5594f; `marin-2018` and the experiment of 2026-11-29, Intel Xeon, 6cc5f87c; other walks with water of that day, d08a321 and (increments) b2bd062, but for those named under *Not computed*. Arches and filters of Cu 6 are of 2026-11-26: `arches.csv` by commits eda8e41 and, dense and broad filters with bases of Cu 3 and 4.5 and Cu 6 with laws, 8d84574; `laboratory.csv` and `openings.csv` by 9225e12; graphs by area and `laboratory-increments.csv` by c8430d8.", help="date, machine and commit of the walks")
    options = parser.parse_args()
    cells = Cells(options.out)
    Path(f"{options.out}.svg").write_text(figure(cells))
    name = Path(options.out).name
    head = paragraph(f"{options.of} Boundaries of 10 x 10 x 60 voids, two runs (`arches.csv` and `openings.csv`: one), seed 1; graphs: five packings, seeds 1 to 5; by area one run.")
    command = f"    scripts/studies/laboratory.py --work FOLDER --out results/{name}    # goes on where it was stopped\n    scripts/studies/laboratory_page.py --out results/{name}"
    Path(f"{options.out}.md").write_text(page(cells, name, f"{head}\n\n{command}"))


if __name__ == "__main__":
    main()
