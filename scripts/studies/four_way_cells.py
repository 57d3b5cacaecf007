"""The cells of scripts/studies/four_way.py and their boundaries, worked out from the walks in its csv alone."""

import collections
import math

USUAL_MASS_RATIO, ARCH = 0.05, 2.155
THRESHOLD, AROUND, WIDE = 0.075, 0.01, 0.3
# Two walks enclose a boundary closely enough where their ratios are no further apart: half a rung of the ladder.
CLOSE = 1.06**0.5 * 1.0001
# Cu, friction and number of grains of the six filters of the paper's Table 2.
FILTERS = {
    "Cu 1.5 loose": (1.5, 0.3, 3000),
    "Cu 1.5 dense": (1.5, 0.0, 3000),
    "Cu 3 loose": (3.0, 0.3, 6000),
    "Cu 3 dense": (3.0, 0.0, 6000),
    "Cu 1.2 dense": (1.2, 0.0, 3000),
    "Cu 6 loose": (6.0, 0.7, 8000),
}
BY_NAME = ["Cu 1.2 dense", "Cu 1.5 loose", "Cu 1.5 dense", "Cu 3 loose", "Cu 3 dense", "Cu 6 loose"]
MODELS = ["lattice, area", "lattice, flux", "graph, flux", "graph, area along flow"]
SHOWN = {"lattice, area": "lattice, area", "lattice, flux": "lattice, flow", "graph, flux": "graph, flow",
         "graph, area along flow": "graph, area"}

Walk = collections.namedtuple("Walk", "ratio lost k seconds thickness voids")
# Where a run begins to lose 7.5 %: between the walks below and above, of which either may be missing.
Boundary = collections.namedtuple("Boundary", "value below above run")


def d50_by_number(cu):
    """D50 by number of a linear gradation from 1 mm: the thickness of a layer of the lattice."""
    largest = cu * cu
    return ((1.0 + largest**-3) / 2.0) ** (-1.0 / 3.0)


def median(values):
    ranked = sorted(values)
    middle = len(ranked) // 2
    return ranked[middle] if len(ranked) % 2 else 0.5 * (ranked[middle - 1] + ranked[middle])


def between(below, above, loss, level):
    """Ratio at which the loss reaches the level, linear between two walks."""
    return below.ratio + (level - loss(below)) / (loss(above) - loss(below)) * (above.ratio - below.ratio)


def first_loss(walks, run):
    """The smallest ratio at which a run loses 7.5 %: infinite where none does, 0 where the smallest that was walked does."""
    loss = lambda walk: walk.lost[run]
    above = next((place for place, walk in enumerate(walks) if loss(walk) >= THRESHOLD), None)
    if above is None:
        return Boundary(math.inf, walks[-1], None, run)
    if above == 0:
        return Boundary(0.0, None, walks[0], run)
    return Boundary(between(walks[above - 1], walks[above], loss, THRESHOLD), walks[above - 1], walks[above], run)


class Cell:
    """One filter, model, base and thickness: walks by replicate in the order of their ratios, by the size that particles are retained at."""

    def __init__(self, planned, walks):
        self.planned = planned
        self.name, self.model, self.base, self.layers, self.mass_ratio, self.asked = planned
        self.walks = walks
        self.arches, self.flow = self.mass_ratio != USUAL_MASS_RATIO, self.model != "lattice, area"
        if not walks:
            return
        runs = [[first_loss(replicate, run) for run in (0, 1)] for replicate in walks.values()]
        self.run1 = median([pair[0].value for pair in runs])
        # Erosion begins where either run loses 7.5 %, and continues where fresh base on the clogged filter, the second, does.
        self.begins = [min(pair, key=lambda boundary: boundary.value) for pair in runs]
        self.continues = [pair[1] for pair in runs]
        self.s_ne, self.s_ce = (median([boundary.value for boundary in found]) for found in (self.begins, self.continues))
        self.second_first = any(boundary.run == 1 and boundary.value < math.inf for boundary in self.begins)

    @property
    def mm(self):
        stated = next((walk.thickness for walks in self.walks.values() for walk in walks if walk.thickness), None)
        return stated or (self.layers * d50_by_number(FILTERS[self.name][0]) if self.model.startswith("lattice") else None)

    @property
    def voids(self):
        return next(walk.voids for walks in self.walks.values() for walk in walks)

    @property
    def whole(self):
        found = [*self.begins, *self.continues] if self.walks else []
        close = all(found_one.below and found_one.above and found_one.above.ratio <= CLOSE * found_one.below.ratio for found_one in found)
        return len(self.walks) == self.asked and close

    def allowed(self, runs):
        """Ratios from the first at which the runs lose 6.5 % to the last at which they do not lose 8.5 %; 0 or infinite: beyond the walks."""
        loss, lows, highs = (lambda walk: max(walk.lost[run] for run in runs)), [], []
        for walks in self.walks.values():
            low, high = THRESHOLD - AROUND, THRESHOLD + AROUND
            first = next((place for place, walk in enumerate(walks) if loss(walk) >= low), None)
            last = max((place for place, walk in enumerate(walks) if loss(walk) < high), default=None)
            lows.append(math.inf if first is None else 0.0 if first == 0 else between(walks[first - 1], walks[first], loss, low))
            highs.append(0.0 if last is None else math.inf if last == len(walks) - 1 else between(walks[last], walks[last + 1], loss, high))
        return min(lows), max(highs)

    def smallest(self):
        return min(walks[0].ratio for walks in self.walks.values())

    def flat(self, runs):
        """The ratios that 7.5 % give or take a point allows, where they are far apart, else None."""
        low, high = self.allowed(runs)
        return (low, high) if high - max(low, self.smallest()) > WIDE and high < math.inf else None

    def where(self):
        return f"{self.name}, base Cu {self.base:g}, {SHOWN[self.model]}, {self.layers:,} layers{', arches' if self.arches else ''}"


def cells_of(plan, rows):
    """Every cell of the plan, in the order of a reader, with what was walked of it."""
    walked = collections.defaultdict(dict)
    for row in rows:
        mass_ratio = float(row["mass_ratio"])
        factor = 1.0 if abs(mass_ratio - USUAL_MASS_RATIO) < 1e-6 else ARCH
        number = lambda name: float(row[name]) if row.get(name) else None
        k = (number("k_over_k0_1"), number("k_over_k0_2"))
        walk = Walk(factor * float(row["ratio"]), (float(row["eroded_1"]), float(row["eroded_2"])), k, number("cpu_seconds"),
                    number("thickness_mm"), int(row["voids"]))
        key = (row["filter"], row["model"], float(row["base_cu"]), int(row["layers"]), round(mass_ratio, 6))
        walked[key].setdefault(int(row["replicate"]), []).append(walk)
    cells = []
    for planned in plan:
        found = walked.get((*planned[:4], round(planned[4], 6)), {})
        cells.append(Cell(planned, {replicate: sorted(found[replicate]) for replicate in sorted(found)}))
    return sorted(cells, key=lambda c: (c.base, BY_NAME.index(c.name), c.arches, MODELS.index(c.model), c.layers))


def come_and_go(cells):
    """Replicates that hold at a larger ratio than one at which they do not, in either run; and of how many."""
    goes = lambda walks, run: any(a.lost[run] >= THRESHOLD > b.lost[run] for a, b in zip(walks, walks[1:]))
    replicates = [walks for cell in cells for walks in cell.walks.values()]
    return sum(any(goes(walks, run) for run in (0, 1)) for walks in replicates), len(replicates)


def alike(cells, cell, **other):
    """The cell without arches that differs from this one in nothing but what is named."""
    parts = ("name", "model", "base", "layers")
    target = [other.get(part, getattr(cell, part)) for part in parts]
    return next((one for one in cells if not one.arches and [getattr(one, part) for part in parts] == target), None)


def pairs(cells, chosen, **other):
    """Each chosen cell with the one that differs in nothing but what is named: a value, or what a function makes of the cell."""
    named = lambda cell: {part: change(cell) if callable(change) else change for part, change in other.items()}
    return [(cell, twin) for cell in cells if chosen(cell) and (twin := alike(cells, cell, **named(cell)))]


def cannot_be_told(cell, twin):
    """Whether the one's boundary lies in the range that 7.5 % give or take a point allows the other, where that range is wide."""
    inside = lambda value, bounds: bounds is not None and bounds[0] <= value <= bounds[1]
    return inside(cell.s_ne, twin.flat((0, 1))) or inside(twin.s_ne, cell.flat((0, 1)))
