#!/usr/bin/env python3
"""What openings beside particles change: boundaries of no erosion, and the permeability of filters that hold.

    scripts/studies/openings.py --out results/openings.csv --flow results/openings-flow.csv [--binary target/release/voidwalk]

Filters from the library of packings, bases linear on semi-log paper, five replicates. `--out`: D15F/D85B at which 7.5 % of the base
erodes in the first run, 10 x 10 x 60 voids, bracketed to 4 %; `no_erosion` is where the mean crosses, `least` and `most` where the first
and the last replicate do, by interpolation; a `least` that is the least ratio walked (4, or 4 / 1.25 and so on) is at most that.
`--flow`: 10 x 10 x 30 voids with water (exit = flux), two runs; k/k0 at the end of each, mean, least and most. Blocked constrictions are
closed or open; what is closed is walked by engine `expected` without water, all else one by one. Rows that are there already are not
walked again.
"""

from pathlib import Path

import common
from arches import CONCENTRATIONS, Walks, each

BLOCKED = ["closed", "open"]
FILTERS = [(1.5, "loose"), (3, "loose")]
BASES = [1.5, 3, 4.5]
RATIOS = [3, 4, 5]
CELL = ["filter_cu", "density", "base_cu", "law", "concentration", "blocked"]
COLUMNS = CELL + ["holds_to", "erodes_from", "no_erosion", "least", "most"]
FLOW_CELL = CELL + ["d15f_over_d85b"]
FLOW_COLUMNS = FLOW_CELL + [f"{name}_{run}" for run in ("first", "second") for name in ("eroded_percent", "k_over_k0", "least", "most")]


def of_cell(cell, ratio):
    """What differs from the built-in scene."""
    filter_cu, density, base_cu, law, concentration, blocked = cell
    suspension = {} if concentration == "" else {"walk.concentration": concentration}
    return suspension | {
        "filter.library": density, "filter.cu": filter_cu, "filter.d0_mm": 1, "base.cu": base_cu, "base.d15f_over_d85b": round(ratio, 6),
        "network.nx": 10, "network.ny": 10, "replicates": 5, "record.sensitivity": "[]", "record.thickness": "[]", "walk.blocked": blocked,
        "walk.arching": law,
    }


class Openings(Walks):
    """Boundaries without water."""

    names, close = CELL, 1.04

    def settings(self, cell, ratio):
        engine = "expected" if cell[5] == "closed" else "particles"
        return of_cell(cell, ratio) | {"network.nz": 60, "runs": 1, "engine": engine}

    def with_water(self, cell):
        """Erosion and permeability at the end of both runs."""
        settings = of_cell(cell[:6], cell[6]) | {"network.nz": 30, "runs": 2, "engine": "particles", "walk.exit": "flux"}
        outcome = self.outcome(settings)
        row = dict(zip(FLOW_CELL, cell))
        for at, run in enumerate(("first", "second")):
            runs = [replicate["runs"][at] for replicate in outcome["replicates"]]
            kept = [run["k_over_k0"] for run in runs]
            eroded = sum(run["eroded_mass_fraction"] for run in runs) / len(runs)
            row |= {f"eroded_percent_{run}": round(100 * eroded, 2), f"k_over_k0_{run}": f"{sum(kept) / len(kept):.3g}"}
            row |= {f"least_{run}": f"{min(kept):.3g}", f"most_{run}": f"{max(kept):.3g}"}
        return row


def main():
    parser = common.parser(__doc__, threads="2")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--flow", type=Path)
    options = parser.parse_args()
    walks = Openings(options)
    pairs = [(*of, base, "none", "", blocked) for base in BASES for of in FILTERS for blocked in BLOCKED]
    pairs += [(*FILTERS[0], BASES[0], "marin-2018", concentration, blocked) for concentration in CONCENTRATIONS for blocked in BLOCKED]
    if options.flow:
        with_water = [(*FILTERS[0], base, "none", "", blocked, ratio) for base in BASES[:2] for ratio in RATIOS for blocked in BLOCKED]
        each(options.flow, FLOW_CELL, FLOW_COLUMNS, with_water, walks.with_water)
    if options.out:
        each(options.out, CELL, COLUMNS, pairs, walks.boundary)


if __name__ == "__main__":
    main()
