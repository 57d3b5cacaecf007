#!/usr/bin/env python3
"""The tables and the figure of `real-soils.md`: the walk's boundaries of real soils beside the range of tests.

    scripts/studies/real_soils_tables.py [--results results] [--write]

Reads `real-soils.csv` and `real-soils-bases.csv`, of walks by `scripts/studies/real_soils.py` of 516d681f, prints the tables that
`real-soils.md` takes its numbers from, and with --write draws `real-soils.svg`. Needs NumPy, SciPy and Matplotlib.
"""

import argparse
import csv
from pathlib import Path

import numpy as np
from scipy.stats import norm

import common

SEED = 3604
FOLDS = 10
QUANTILES = np.arange(0.05, 0.951, 0.05)
DRAWS = 20
CLASSES = {"1": (85, 100), "2 55-85": (55, 85), "2 35-55": (35, 55), "3": (15, 35), "4": (0, 15)}
# D85B / D50B after regrading up to which a base is steep: its coarse half then holds the rest back.
STEEP = 4.0
GROUPS = [f"{name} {kind}" for name in CLASSES for kind in ("steep", "broad")]
# Filters of the study.
FILTERS = ("cu1.5", "cu3", "c33", "cu12")
USUAL = ("cu1.5", "loose", "no_erosion_mm")
# Groups of soils that are narrow for one filter or another.
NARROW = ("2 35-55 steep", "3 steep", "4 steep")
# The control of a boundary without a walk: so many times D60B.
TIMES_D60B = 6.5
# What else was walked as the base.
OTHER_BASES = ("no clay", "crumbs", "4 x base")
SHUFFLES = 30


def number(text):
    try:
        return float(text)
    except ValueError:
        return np.nan


class Data:
    """Columns by soil: of practice, and of each boundary. A boundary below all that was tried is 0."""

    def __init__(self, folder):
        bases = list(csv.DictReader((folder / "real-soils-bases.csv").open()))
        self.id = np.array([int(row["soil"]) for row in bases])
        self.fines_class = np.array([row["group"] for row in bases])
        for name in bases[0]:
            if name not in ("soil", "group"):
                setattr(self, name, np.array([number(row[name]) for row in bases]))
        self.steepness = self.d85_mm / self.d50_mm
        # Where D50B is finer than all that was measured the curve is as broad as can be.
        kind = np.where(self.steepness <= STEEP, "steep", "broad")
        self.group = np.array([f"{name} {word}" for name, word in zip(self.fines_class, kind)])
        self.low, self.high = self.tests_low_mm, self.tests_high_mm
        self.centre = np.sqrt(self.low * self.high)
        # Foster and Fell's criterion: 9 and 7 D85B, 0.7 mm, 1.6 times the design limit.
        factor = {"1": 9 / 6.4, "4": 7 / 6.8}
        self.foster_fell = self.low * np.array([factor.get(name, 1.0) for name in self.fines_class])
        self.half = np.log(self.high / self.low) / 2
        self.place = {soil: i for i, soil in enumerate(self.id)}
        self.boundaries, self.tail = {}, {}
        for row in csv.DictReader((folder / "real-soils.csv").open()):
            i = self.place[int(row["soil"])]
            for which in ("no_erosion_mm", "continuing_mm"):
                key = (row["filter"], row["density"], which, row["base"], row["network"])
                text = row[which]
                if text:
                    value = 0.0 if text in ("below", "unwalked") else np.inf if text == "above" else number(text)
                    self.boundaries.setdefault(key, np.full(len(self.id), np.nan))[i] = value
            self.tail.setdefault((row["filter"], row["density"], row["base"]), {})[i] = row["tail"]

    def of(self, name="cu1.5", density="loose", which="no_erosion_mm", base="", network="1"):
        return self.boundaries.get((name, density, which, base, network), np.full(len(self.id), np.nan))

    def is_open(self, name="cu1.5", density="loose"):
        """Soils whose boundary hangs on how the tail below the finest sieve is read."""
        tail = self.tail.get((name, density, ""), {})
        return np.array([tail.get(i, "") != "" for i in range(len(self.id))])

    def ratio(self, name="cu1.5"):
        """One value a soil, by the tests' centre: of the uniform filter the geometric mean of loose and dense, of
        others loose; nothing of soils whose boundary hangs on an open tail."""
        loose, is_open = self.of(name), self.is_open(name)
        if name != "cu1.5":
            return np.where(is_open, np.nan, loose / self.centre)
        is_open |= self.is_open(density="dense")
        return np.where(is_open, np.nan, np.sqrt(loose * self.of(density="dense")) / self.centre)


def quantiles(values, shares):
    return np.quantile(values, shares) if len(values) else np.full(len(shares), np.nan)


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def by(values, groups):
    """Rows of number, none, 5, 25, 50, 75, 95 %, within a factor of two of the median."""
    rows = []
    for group, mask in groups:
        here = values[mask & ~np.isnan(values)]
        found = here[(here > 0) & np.isfinite(here)]
        if len(here) == 0:
            continue
        q = quantiles(found, [0.05, 0.25, 0.5, 0.75, 0.95])
        near = np.mean(np.abs(np.log(np.maximum(here, 1e-9) / q[2])) <= np.log(2)) if len(found) else np.nan
        rows.append([group, len(here), int((here == 0).sum()), *(f"{x:.2f}" for x in q), f"{100 * near:.0f} %"])
    return rows


HEAD = ["soils", "number", "no boundary", "5 %", "25 %", "median", "75 %", "95 %", "within a factor of 2 of the median"]


def tenths(data):
    """The tenth of the study that a soil is in, by contiguous ids: soils of one investigation are neighbours."""
    return (np.argsort(np.argsort(data.id)) * FOLDS) // len(data.id)


def of_rule(distance, half):
    """P(T >= D) by the tests' range alone; distance = ln(D / centre)."""
    return np.clip((half - distance) / (2 * half), 0, 1)


def of_walk(b, d, ratios, half):
    """P(T >= D) where T is the walk's boundary by one of these ratios, anywhere in the tests' range about that.

    The quantiles count alike; beyond the last of either end half of one each way."""
    q = quantiles(ratios, QUANTILES)
    each = of_rule(np.log(d[:, None] / b[:, None] * q[None, :]), half[:, None])
    return (each.sum(axis=1) + 0.5) / (len(q) + 1)


def brier(p, outcome):
    return float(np.mean((p - outcome) ** 2))


def validated(data, ratio):
    """Probabilities of no erosion by the tests' range alone and by the walk, and drawn outcomes, by folds of neighbouring soils."""
    draw = np.random.default_rng(SEED)
    known = ~np.isnan(ratio) & (ratio > 0) & np.isfinite(ratio)
    fold, out = tenths(data), {name: [] for name in ("rule", "walk", "outcome", "group")}
    for group in GROUPS:
        of = known & (data.group == group)
        if of.sum() < 12:
            continue
        for k in range(FOLDS):
            test, others = of & (fold == k), of & (fold != k)
            if not test.any() or others.sum() < 10:
                continue
            i = np.repeat(np.flatnonzero(test), DRAWS)
            tests = np.log(data.low[i]) + 2 * data.half[i] * norm.cdf(draw.standard_normal(len(i)))
            # Filters about the centre, where the question is open.
            distance = draw.uniform(-np.log(4), np.log(4), len(i))
            d = data.centre[i] * np.exp(distance)
            out["rule"].append(of_rule(distance, data.half[i]))
            out["walk"].append(of_walk(ratio[i] * data.centre[i], d, ratio[others], data.half[i]))
            out["outcome"].append((tests >= np.log(d)).astype(float))
            out["group"].append(np.full(len(i), GROUPS.index(group)))
    return {name: np.concatenate(of) for name, of in out.items()}


def reliability(p, outcome, bins=10):
    rows = []
    for k in range(bins):
        here = (p >= k / bins) & ((p < (k + 1) / bins) | ((k == bins - 1) & (p >= 1)))
        if here.any():
            rows.append((k, int(here.sum()), float(p[here].mean()), float(outcome[here].mean())))
    return rows


def spread_of(values):
    q = quantiles(values, [0.05, 0.5, 0.95])
    return f"{q[1]:.2f} ({q[0]:.2f} to {q[2]:.2f})"


def beside(data):
    """Of how many soils the walk's boundary lies beyond those of practice."""
    rows = []
    for group in GROUPS:
        b = data.ratio() * data.centre
        of = (data.group == group) & ~np.isnan(b)
        if of.sum() < 5:
            continue
        share = lambda limit: f"{100 * np.mean(b[of] > limit[of]):.0f} %"
        limits = (data.design_mm, data.foster_fell, data.centre, data.high)
        rows.append([group, int(of.sum()), *(share(limit) for limit in limits)])
    head = ["group", "soils", "beyond the design limit", "Foster and Fell", "the tests' centre", "the tests' end"]
    table(head, rows)


def beyond_ends(data):
    """By filter: of how many soils the walk's boundary lies beyond the lower and the upper end of the tests' range."""
    rows = []
    for group in GROUPS:
        cells = []
        for name in FILTERS:
            b = data.ratio(name) * data.centre
            of = (data.group == group) & ~np.isnan(b)
            shares = [100 * np.mean(b[of] > end[of] * (1 + 1e-9)) for end in (data.low, data.high)] if of.any() else []
            cells.append(" / ".join(f"{share:.0f}" for share in shares) + f" %, {of.sum()}" if of.sum() >= 5 else "-")
        rows.append([group, *cells])
    print("Beyond the lower / the upper end of the tests' range:")
    table(["group", *FILTERS], rows)


def more_base(data):
    """Where the uniform loose filter's boundary lies with four times the base: ratio, and shares beyond both ends."""
    b, rows = data.of(*USUAL, "4 x base"), []
    masks = [("all", np.full(len(data.id), True))] + [(g, data.group == g) for g in GROUPS]
    for group, mask in masks:
        of = mask & ~np.isnan(b) & ~data.is_open()
        if of.sum() < 5:
            continue
        shares = [f"{(b[of] > end[of] * (1 + 1e-9)).sum()} of {of.sum()}" for end in (data.low, data.high)]
        rows.append([group, f"{np.median(b[of] / data.centre[of]):.2f}", *shares])
    print("With four times the base, uniform, loose:")
    table(["group", "median ratio", "beyond the lower end", "beyond the upper end"], rows)


def controls(data, usual):
    """Brier scores of boundaries that are no walk of the soil: D60B, and the walks of other soils of the group."""
    known = data.ratio()
    draw, rows = np.random.default_rng(SEED), []

    def scores(found, by):
        each = [np.full(len(found["group"]), True)] + [found["group"] == GROUPS.index(group) for group in NARROW]
        return [brier(found[by][of], found["outcome"][of]) for of in each]

    rows += [[name, *(f"{score:.3f}" for score in scores(usual, by))] for name, by in (("the tests' range alone", "rule"), ("walk", "walk"))]
    by_size = np.where(np.isnan(known) | (known == 0), np.nan, TIMES_D60B * data.d60_mm / data.centre)
    rows.append([f"{TIMES_D60B} D60B", *(f"{score:.3f}" for score in scores(validated(data, by_size), "walk"))])
    shuffled = []
    for _ in range(SHUFFLES):
        ratio = known.copy()
        for group in GROUPS:
            of = np.flatnonzero((data.group == group) & (known > 0))
            ratio[of] = draw.permutation(known[of])
        shuffled.append(scores(validated(data, ratio), "walk"))
    low, middle, high = np.min(shuffled, axis=0), np.median(shuffled, axis=0), np.max(shuffled, axis=0)
    rows.append(["walks of other soils of the group", *(f"{m:.3f} ({a:.3f} to {b:.3f})" for a, m, b in zip(low, middle, high))])
    table(["control", "all", *NARROW], rows)


def against(data, keys, of=None):
    """Medians (5 to 95 %) of other boundaries by that of the uniform loose filter, or by `of`."""
    rows = []
    for group in GROUPS:
        cells = []
        for key in keys:
            other, usual = data.of(*key), data.of() if of is None else of
            here = (data.group == group) & (usual > 0) & (other > 0) & np.isfinite(other) & np.isfinite(usual)
            here &= ~data.is_open()
            cells.append(f"{spread_of(other[here] / usual[here])}, {here.sum()}" if here.sum() >= 5 else "-")
        rows.append([group, *cells])
    table(["group", *(", ".join(part for part in key if part) for key in keys)], rows)


def rescued(data, what):
    """Soils without a boundary, or far below the tests' range, and how many of them another base brings into it."""
    other, usual = data.of(base=what), data.of()
    rows = []
    for group in GROUPS:
        low = (data.group == group) & (usual < data.low / 2) & ~np.isnan(other)
        if low.sum() >= 3:
            mended = other[low] >= data.low[low] / 2
            rows.append([group, int(low.sum()), int(mended.sum())])
    table(["group", "less than half of the tests' lower end", f"no longer so: {what}"], rows)


def figure(data, found, path):
    """The ratio over the steepness of the base, and the reliability diagram."""
    from matplotlib import ticker

    plt = common.pyplot()
    drawn, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), width_ratios=[1.5, 1])
    ratio = data.ratio()
    colours = ["#7b3294", "#c2410c", "#e08214", "#2c7fb8", "#1b7837"]
    words = ["more than 85 % fines", "55 to 85 %", "35 to 55 %", "15 to 35 %", "less than 15 %"]
    for fines, colour, word in zip(CLASSES, colours, words):
        of = (data.fines_class == fines) & (ratio > 0) & np.isfinite(data.steepness)
        left.plot(np.minimum(data.steepness[of], 60), ratio[of], ".", ms=4, color=colour, label=word, rasterized=True)
    left.axhspan(1 / 1.558, 1.558, color="0.9", zorder=0, label="range of tests, 35 to 85 % fines")
    left.axvline(STEEP, color="0.4", lw=0.8, ls="--")
    left.set(xscale="log", yscale="log", xlabel="D85B / D50B after regrading (60: 60 and more)")
    left.set(ylabel="D15F of no erosion: walk / centre of the tests", ylim=(0.015, 2.2))
    ticks_of = ((left.xaxis, (1.5, 2, 3, 4, 6, 10, 20, 40, 60)), (left.yaxis, (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2)))
    for axis, ticks in ticks_of:
        axis.set_major_locator(ticker.FixedLocator(ticks))
        axis.set_minor_locator(ticker.NullLocator())
        axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    left.legend(frameon=True, framealpha=1, edgecolor="none", fontsize=7.5, loc="lower left")
    right.plot([0, 1], [0, 1], color="0.6", lw=0.8)
    for name, colour, word in (("walk", "#2c7fb8", "by the walk"), ("rule", "#1b7837", "by the tests' range alone")):
        bins = reliability(found[name], found["outcome"])
        right.plot([p for _, _, p, _ in bins], [o for *_, o in bins], "o-", ms=4, color=colour, label=word)
        if name == "walk":
            for _, n, p, o in bins:
                right.annotate(str(n), (p, o), (4, -9), textcoords="offset points", fontsize=6.5, color=colour)
    right.set(xlabel="probability of no erosion that was said", ylabel="share of drawn outcomes without erosion")
    right.legend(frameon=False, fontsize=7.5)
    drawn.tight_layout()
    drawn.savefig(path, dpi=130, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=common.ROOT / "results")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    data = Data(options.results)
    table(["group", *HEAD[1:]], by(data.ratio(), [(group, data.group == group) for group in GROUPS]))
    beside(data)
    beyond_ends(data)
    more_base(data)
    print("By the uniform loose filter's boundary:")
    against(data, [("cu1.5", "dense"), ("cu3",), ("c33",), ("cu12",)])
    against(data, [(*USUAL, what) for what in OTHER_BASES])
    for what in OTHER_BASES:
        rescued(data, what)
    print("Continuing erosion by 9 D95B:")
    against(data, [("cu1.5", "loose", "continuing_mm")], data.continuing_9_d95_mm)
    usual = validated(data, data.ratio())
    controls(data, usual)
    if options.write:
        figure(data, usual, options.results / "real-soils.svg")


if __name__ == "__main__":
    main()
