"""Reads the folder that paper.sh fills: the folder of a campaign for each plan, and a percolation study."""

import csv
import json
import math
from typing import NamedTuple


class NotWalked(Exception):
    """The folder does not hold what a number needs."""


class Malformed(Exception):
    """A file of the folder cannot be used."""


class Variant(NamedTuple):
    """A way to run the campaign of the paper; a `base` is the plan whose cases it shares, where it walks only those that it changes."""

    name: str
    title: str
    curves: str
    base: str = ""


OWN, PUBLISHED = "own packings, voids merged at the overlap that was fitted to Table 2 of the paper", "curves that the authors published"
AS_STATED = "own packing, voids merged at the overlap that the paper states"
#: The page is about the first; each of the others changes what its title says.
VARIANTS = [
    Variant("paper", "own curves, grains per void as packed", OWN),
    Variant("paper-hull", "published curves (convex hulls at 50 %), grains per void of that rule", PUBLISHED),
    Variant("paper-inverse", "voids per grain in place of grains per void, cap 2e8", OWN),
    Variant("paper-2.5", "2.5 grains per void", OWN),
    Variant("paper-capped", "cap 2e8", OWN, "paper"),
    Variant("paper-2.5-capped", "2.5 grains, cap 2e8", OWN, "paper-2.5"),
    Variant("paper-published", "published curves, grains per void of our own rule", PUBLISHED),
    Variant("paper-published-2.5", "published curves, 2.5 grains", PUBLISHED),
    Variant("overlap-0.5", "voids merged at an overlap of 50 %, all facets", AS_STATED),
]
MAIN, VARIANT = VARIANTS[0].name, {variant.name: variant for variant in VARIANTS}
OTHER_PLANS, SERIES = ["kenney", "table3", "one-size", "progress"], ["fig13-continuing", "fig13-some", "fig13-none"]
#: From this fraction of the largest size of the base on, an eroded particle counts as that size.
ITS_LARGEST = 0.99


def total(values):
    """Sum from left to right: `sum` rounds otherwise from Python 3.12 on."""
    result = 0.0
    for value in values:
        result += value
    return result


def mean(values):
    return total(values) / len(values)


def need(value):
    """The value, where there is one."""
    if value is None or value == []:
        raise NotWalked
    return value


def known(function, items):
    """The results of a function, without those that were not walked."""
    results = []
    for item in items:
        try:
            results.append(function(item))
        except NotWalked:
            pass
    return results


def student(degrees):
    """t of a two-sided 95 % interval: sums of Abramowitz and Stegun 26.7.3 and 26.7.4, solved for atan(t / sqrt(degrees))."""

    def within(angle):
        sine, cosine, odd = math.sin(angle), math.cos(angle), degrees % 2
        term = cosine if odd else 1.0
        terms = 0.0 if degrees == 1 else term
        for k in range(1 + odd, degrees - 1, 2):
            term *= k / (k + 1) * cosine * cosine
            terms += term
        return 2 / math.pi * (angle + sine * terms) if odd else sine * terms

    low, high = 0.0, math.pi / 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if within(middle) < 0.95 else (low, middle)
    return math.sqrt(degrees) * math.tan(low)


class Value(NamedTuple):
    """A number, with the 95 % interval of a mean over several replicates; `open` where the replicates leave it undecided."""

    value: float
    low: float = None
    high: float = None
    words: str = ""
    open: bool = False

    @classmethod
    def read(cls, record, factor=1.0):
        return cls(*(None if record.get(key) is None else record[key] * factor for key in ("mean", "low", "high")))

    @classmethod
    def of_values(cls, values):
        middle, n = mean(values), len(values)
        if n == 1:
            return cls(middle)
        half = student(n - 1) * math.sqrt(total((value - middle) ** 2 for value in values) / (n - 1)) / math.sqrt(n)
        return cls(middle, middle - half, middle + half)

    @property
    def interval(self):
        return None if self.low is None or self.high is None else (self.low, self.high)


def size_at(rows, percent):
    """Size below which a percentage of a curve of (size, percent) rows lies, by straight lines."""
    if rows and rows[0][1] >= percent:
        return rows[0][0]
    for (size, share), (next_size, next_share) in zip(rows, rows[1:]):
        if share <= percent <= next_share and next_share > share:
            return size + (percent - share) / (next_share - share) * (next_size - size)
    raise NotWalked


class Case:
    """A case of a campaign: its line of the ledger and its outcome."""

    def __init__(self, line, outcome):
        self.line, self.outcome = line, outcome
        self.name, self.runs, self.verdict = line["case"], line["runs"], line["verdict"]
        self.filter, self.base, self.network = (outcome["inputs"][part] for part in ("filter", "base", "network"))
        self.d85_ratio, self.d95_ratio = line["ratios"]["d15f_over_d85b"], line["ratios"]["d15f_over_d95b"]
        self.loose, self.wide = self.level("filter").endswith("loose"), self.level("cu_b") != "1.5"

    def level(self, factor):
        return self.line["levels"].get(factor, "")

    def has(self, **levels):
        return all(self.level(factor) == level for factor, level in levels.items())

    def run(self, number):
        return need(self.runs[number - 1] if number <= len(self.runs) else None)

    def eroded(self, number):
        """Percent of the base mass eroded in a run."""
        return Value.read(self.run(number)["eroded_mass_fraction"], 100.0)

    def mean(self, number):
        """Mean of the same; 0 where there is no such run."""
        return self.eroded(number).value if number <= len(self.runs) else 0.0

    def both_runs(self):
        return 0.5 * (self.mean(1) + self.mean(2))

    def blocked(self, part):
        """Percent of constrictions blocked after the second run: of all, or of the first three layers."""
        return 100.0 * self.run(2)[part]["mean"]

    def largest(self, number, factor=1.0):
        """Largest eroded particle of a run over D15F."""
        return Value.read(need(self.run(number).get("largest_eroded_over_d15f")), factor)

    def largest_over_d0f(self, number):
        return self.largest(number, self.filter["d15_mm"] / self.filter["d0_mm"])

    def erodes_its_largest(self, number):
        """True if the largest particle of the base erodes: a larger one might have eroded too."""
        sizes = known(lambda number: self.largest(number).value * self.filter["d15_mm"], [number])
        return any(size >= ITS_LARGEST * self.base["d100_mm"] for size in sizes)

    def d50b_over_d0f(self):
        return need(self.base.get("d50_mm")) / self.filter["d0_mm"]


def read(path, parse):
    try:
        with open(path, encoding="utf-8", newline="") as file:
            return parse(file)
    except (OSError, ValueError, LookupError) as error:
        raise Malformed(f"{path}: {error!r}") from error


def ledger(folder):
    """The cases of a campaign."""
    cases = []
    for line in read(folder / "ledger.jsonl", lambda file: [json.loads(text) for text in file]):
        path = folder / line["folder"] / "outcome.json"
        outcome = read(path, json.load)
        pairs = [(a[part]["mean"], b[part]["mean"]) for a, b in zip(outcome["summary"], line["runs"])
                 for part in ("eroded_mass_fraction", "blocked_fraction")]
        # A number that goes through JSON twice may lose its last bit.
        same = len(outcome["summary"]) == len(line["runs"]) and all(abs(a - b) < 1e-12 for a, b in pairs)
        if outcome["seed"] != line["seed"] or not same:
            raise Malformed(f"{path}: seed and summary are not what ledger.jsonl says")
        cases.append(Case(line, outcome))
    return cases


def table(path, *columns):
    """Rows of replicate, run, increment and these columns of a CSV table."""
    first = ("replicate", "run", "increment")
    return read(path, lambda file: [(*(int(row[name]) for name in first), *(float(row[name]) for name in columns))
                                    for row in csv.DictReader(file)])


class Study:
    """Everything that the folder holds. What was not walked is missing, and the page says so."""

    def __init__(self, folder):
        plans = [variant.name for variant in VARIANTS] + OTHER_PLANS
        self.campaigns = {name: ledger(folder / name) for name in plans if (folder / name / "ledger.jsonl").is_file()}
        path = folder / "percolation" / "percolation.json"
        self.percolation = read(path, json.load) if path.is_file() else None
        # The packing of overlap-0.5, measured at both overlaps.
        packings = [(AS_STATED, path) for path in sorted((folder / "packings").glob("*/constrictions.json"), reverse=True)]
        packings.append((OWN, folder / "constrictions" / "constrictions.json"))
        self.packed = {curves: read(path, json.load) for curves, path in packings if path.is_file()}
        places = {case.name: folder / "progress" / case.line["folder"] for case in self.campaigns.get("progress", [])}
        self.series = {name: table(places[name] / "series.csv", "eroded_mass_fraction") for name in SERIES if name in places}
        #: What the case of Fig. 18 retains.
        columns = ["diameter_mm", "percent_finer_by_mass"]
        self.retained = table(places["fig18"] / "retained.csv", *columns) if "fig18" in places else []

    def variants(self):
        """The variants that were walked."""
        return [variant for variant in VARIANTS if variant.name in self.campaigns]

    def cases(self, plan):
        """The cases of a plan; for a variant that walks only what it changes, the others from its base."""
        base = VARIANT[plan].base if plan in VARIANT and plan in self.campaigns else ""
        return list({case.name: case for name in (base, plan) for case in self.campaigns.get(name, [])}.values())

    def case(self, plan, **levels):
        return need(next((case for case in self.cases(plan) if case.has(**levels)), None))

    def named(self, plan, name):
        return need(next((case for case in self.cases(plan) if case.name == name), None))

    def filter(self, plan, name):
        return self.case(plan, filter=name).filter
