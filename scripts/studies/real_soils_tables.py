#!/usr/bin/env python3
"""The tables and the figure of `real-soils.md`: the walk's boundaries of real soils beside the range of tests.

    scripts/studies/real_soils_tables.py [--results results] [--write]

Reads `real-soils.csv` and `real-soils-bases.csv`, prints most tables of `real-soils.md` (the page says which it does
not), and with --write draws `real-soils.svg`. Needs NumPy, SciPy and Matplotlib.
"""

import argparse
import csv
from pathlib import Path

import numpy as np
from scipy.stats import norm, rankdata, spearmanr

TOP = Path(__file__).resolve().parents[2]
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
# What it takes for a group's ratio to count as known, besides a median of at most 1 and 95 % of the soils below the
# upper end of the tests' range: soils, the factor from the median to 5 and 95 %, and the most without a boundary.
ENOUGH, WITHIN, WITHOUT = 30, 2.0, 0.05
# Groups of soils that are narrow for one filter or another.
NARROW = ("2 35-55 steep", "3 steep", "4 steep")
# The control of a boundary without a walk: so many times D60B.
TIMES_D60B = 6.5
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


def by(data, values, groups, names=None):
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


def is_narrow(ratio, spread):
    """Whether these soils' ratio counts as known."""
    found = ratio[(ratio > 0) & np.isfinite(ratio)]
    if len(ratio) < ENOUGH or (ratio == 0).sum() > WITHOUT * len(ratio):
        return False
    low, median, high = quantiles(found, [0.05, 0.5, 0.95])
    return median / low <= WITHIN and high / median <= WITHIN and median <= 1 and high <= spread


def left_out(data, name, group):
    """Whether a group is narrow with all its soils, and with each tenth of the study left out."""
    ratio, fold = data.ratio(name), tenths(data)
    of = (data.group == group) & ~np.isnan(ratio)
    spread = np.exp(np.nanmedian(data.half[data.group == group]))
    return is_narrow(ratio[of], spread), [is_narrow(ratio[of & (fold != k)], spread) for k in range(FOLDS)]


def is_checked(data, name, group):
    whole, without = left_out(data, name, group)
    return whole and all(without)


def flags(data):
    """Of which groups the ratio counts as known, and of how many tenths left out that stays so."""
    rows = []
    for name in FILTERS:
        for group in GROUPS:
            whole, without = left_out(data, name, group)
            if whole:
                rows.append([name, group, f"{sum(without)} of {FOLDS}", "yes" if all(without) else "no"])
    table(["filter", "group", "narrow with a tenth left out", "checked"], rows)


def ratios(data):
    """The ratio of each group of soils and shape of filter."""
    rows = []
    for name in FILTERS:
        ratio = data.ratio(name)
        for group in GROUPS:
            here = ratio[(data.group == group) & ~np.isnan(ratio)]
            found = here[(here > 0) & np.isfinite(here)]
            if len(found) < 5:
                continue
            fines, shape = group.rsplit(" ", 1)
            q, none = quantiles(found, [0.05, 0.5, 0.95]), int((here == 0).sum())
            checked = "yes" if is_checked(data, name, group) else "no"
            cells = [fines, *CLASSES[fines], shape, name, len(here), none, checked]
            rows.append([*cells, *(f"{x:.3f}" for x in q)])
    head = ["fines", "from", "to", "base", "filter", "soils", "no boundary", "checked", "5 %", "median", "95 %"]
    table(head, rows)


def of_rule(distance, half):
    """P(T >= D) by the tests' range alone; distance = ln(D / centre)."""
    return np.clip((half - distance) / (2 * half), 0, 1)


def of_walk(b, d, ratios, half):
    """P(T >= D) where T is the walk's boundary by one of these ratios, anywhere in the tests' range about that.

    The quantiles count alike; beyond the last of either end half of one each way."""
    q = quantiles(ratios, QUANTILES)
    each = of_rule(np.log(d[:, None] / b[:, None] * q[None, :]), half[:, None])
    return (each.sum(axis=1) + 0.5) / (len(q) + 1)


def shifted(walk_by_usual, distance, half, weight):
    """P(T >= D) with the tests' range moved by a part of what the walk says beside its usual ratio."""
    return of_rule(distance - weight * np.log(walk_by_usual), half)


def brier(p, outcome):
    return float(np.mean((p - outcome) ** 2))


def validated(data, groups, likeness=0.0, seed=SEED, ratio=None):
    """Probabilities and drawn outcomes, by folds of neighbouring soils; of the uniform filter, or of another ratio.

    `likeness`: rank correlation, within a group, between where a soil stands in the walk and where its test stands in
    the tests' range. 0 is what the rule alone says."""
    draw = np.random.default_rng(seed)
    ratio = data.ratio() if ratio is None else ratio
    known = ~np.isnan(ratio) & (ratio > 0) & np.isfinite(ratio)
    fold = tenths(data)
    names = ["design limit, yes or no", "Foster and Fell, yes or no", "walk, yes or no"]
    names += ["rule", "walk", "mean", "least"] + [f"shift {weight}" for weight in (0.25, 0.5, 1)]
    out = {name: [] for name in [*names, "outcome", "group", "distance"]}
    for group in groups:
        of = known & (data.group == group)
        if of.sum() < 12:
            continue
        z = np.full(len(ratio), np.nan)
        z[of] = norm.ppf((rankdata(ratio[of]) - 0.5) / of.sum())
        for k in range(FOLDS):
            test, others = of & (fold == k), of & (fold != k)
            if not test.any() or others.sum() < 10:
                continue
            i = np.repeat(np.flatnonzero(test), DRAWS)
            noise = draw.standard_normal(len(i))
            place = norm.cdf(likeness * z[i] + np.sqrt(1 - likeness**2) * noise)
            tests = np.log(data.low[i]) + 2 * data.half[i] * place
            # Filters about the centre, where the question is open.
            distance = draw.uniform(-np.log(4), np.log(4), len(i))
            d = data.centre[i] * np.exp(distance)
            p = of_rule(distance, data.half[i])
            w = of_walk(ratio[i] * data.centre[i], d, ratio[others], data.half[i])
            usual = ratio[i] / np.median(ratio[others])
            b = ratio[i] * data.centre[i]
            out["design limit, yes or no"].append((d <= data.design_mm[i]).astype(float))
            out["Foster and Fell, yes or no"].append((d <= data.foster_fell[i]).astype(float))
            out["walk, yes or no"].append((d <= b).astype(float))
            out["rule"].append(p)
            out["walk"].append(w)
            out["mean"].append((p + w) / 2)
            out["least"].append(np.minimum(p, w))
            for weight in (0.25, 0.5, 1):
                out[f"shift {weight}"].append(shifted(usual, distance, data.half[i], weight))
            out["outcome"].append((tests >= np.log(d)).astype(float))
            out["group"].append(np.full(len(i), GROUPS.index(group)))
            out["distance"].append(distance)
    return {name: np.concatenate(of) for name, of in out.items()}, names


def reliability(p, outcome, bins=10):
    rows = []
    for k in range(bins):
        here = (p >= k / bins) & ((p < (k + 1) / bins) | ((k == bins - 1) & (p >= 1)))
        if here.any():
            rows.append((k, int(here.sum()), float(p[here].mean()), float(outcome[here].mean())))
    return rows


def scatter(data):
    """What goes with the ratio within a class of fines and a group: rank correlations.

    The ratio's denominator holds D85B but for 35 to 85 % fines, so that its correlation with D85B / D50B is partly by
    construction there."""
    ratio = data.ratio()
    names = {
        "D85B / D50B": data.steepness, "fines": data.fines, "clay": data.clay, "ln Cu": np.log(data.cu),
        "gravel": data.gravel,
        "D85B": data.d85_mm, "D95B": data.d95_mm, "D95B / D85B": data.d95_mm / data.d85_mm,
    } | {f"D{p}B": getattr(data, f"d{p}_mm") for p in (20, 30, 40, 50, 60, 70)}
    rows = []
    masks = [(name, data.fines_class == name) for name in CLASSES] + [(g, data.group == g) for g in GROUPS]
    for group, mask in masks:
        of = mask & (ratio > 0)
        if of.sum() < 20:
            continue
        cells = []
        for values in names.values():
            here = of & np.isfinite(values)
            rho = spearmanr(ratio[here], values[here])[0] if here.sum() >= 20 else np.nan
            cells.append("-" if np.isnan(rho) else f"{rho:+.2f}")
        rows.append([group, int(of.sum()), *cells])
    table(["group", "soils", *names], rows)


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


def controls(data):
    """Brier scores of boundaries that are no walk of the soil: D60B, and the walks of other soils of the group."""
    known = data.ratio()
    draw, rows = np.random.default_rng(SEED), []

    def scores(ratio):
        found, _ = validated(data, GROUPS, ratio=ratio)
        each = [(found["walk"][m], found["outcome"][m]) for m in
                [np.full(len(found["group"]), True)] + [found["group"] == GROUPS.index(g) for g in NARROW]]
        return [brier(p, outcome) for p, outcome in each]

    rows.append(["walk", *(f"{score:.3f}" for score in scores(known))])
    by_size = np.where(np.isnan(known) | (known == 0), np.nan, TIMES_D60B * data.d60_mm / data.centre)
    rows.append([f"{TIMES_D60B} D60B", *(f"{score:.3f}" for score in scores(by_size))])
    shuffled = []
    for _ in range(SHUFFLES):
        ratio = known.copy()
        for group in GROUPS:
            of = np.flatnonzero((data.group == group) & (known > 0))
            ratio[of] = draw.permutation(known[of])
        shuffled.append(scores(ratio))
    low, middle, high = np.min(shuffled, axis=0), np.median(shuffled, axis=0), np.max(shuffled, axis=0)
    rows.append(["walks of other soils of the group", *(f"{m:.3f} ({a:.3f} to {b:.3f})" for a, m, b in zip(low, middle, high))])
    table(["control", "all", *NARROW], rows)


def other_filters(data):
    """Cross-validation of filters of other shapes, group by group: what was said with 0.9 or more, and the score."""
    rows = []
    for name in FILTERS:
        found, _ = validated(data, GROUPS, ratio=data.ratio(name))
        for group in NARROW:
            of = found["group"] == GROUPS.index(group)
            p, outcome = found["walk"][of], found["outcome"][of]
            sure = p >= 0.9
            if sure.any():
                cells = f"{sure.sum()}", f"{p[sure].mean():.3f}", f"{outcome[sure].mean():.3f}"
                rows.append([name, group, *cells, f"{brier(p, outcome):.3f}"])
    table(["filter", "group", "outcomes said 0.9 or more", "said", "came", "Brier score of all"], rows)


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


def by_hand(data):
    """Splits of the ratio by hydrometer, gravel, and Cu, within the classes of fines."""
    ratio, rows = data.ratio(), []
    splits = {
        "hydrometer": data.finest_mm < 0.01, "no hydrometer": data.finest_mm >= 0.01,
        "gravel below 5 %": data.gravel < 5, "gravel 5 to 30 %": (data.gravel >= 5) & (data.gravel < 30),
        "gravel above 30 %": data.gravel >= 30,
        "regraded": ~np.isnan(data.regraded_mm), "not regraded": np.isnan(data.regraded_mm),
        "Cu below 6": data.cu < 6, "Cu 6 to 30": (data.cu >= 6) & (data.cu < 30), "Cu above 30": data.cu >= 30,
        "Cu not known": np.isnan(data.cu),
    }
    for name, mask in splits.items():
        cells = []
        for fines in CLASSES:
            here = ratio[mask & (data.fines_class == fines) & (ratio > 0)]
            cells.append(f"{spread_of(here)}, {len(here)}" if len(here) >= 5 else "-")
        rows.append([name, *cells])
    table(["soils", *CLASSES], rows)


def folds(data):
    """How well the quantiles of nine tenths of the soils, in the order of their ids, hold for the tenth."""
    ratio, rows, fold = data.ratio(), [], tenths(data)
    for group in GROUPS:
        of = (data.group == group) & (ratio > 0)
        if of.sum() < 12:
            continue
        inside, medians = [], []
        for k in range(FOLDS):
            here, others = ratio[of & (fold == k)], ratio[of & (fold != k)]
            low, high = quantiles(others, [0.05, 0.95])
            inside += list((here >= low) & (here <= high))
            medians += [np.median(here)] if len(here) >= 3 else []
        rows.append([group, int(of.sum()), f"{100 * np.mean(inside):.0f} %", len(medians),
                     f"{min(medians):.2f} to {max(medians):.2f}"])
    table(["group", "soils", "within the others' 5 to 95 %", "folds of 3 soils or more", "their medians"], rows)


def single_sizes(data):
    """Which size of the base the boundary follows best: scatter (factor) of boundary / size."""
    b, rows = data.ratio() * data.centre, []
    for fines in CLASSES:
        cells = []
        for percent in (30, 40, 50, 60, 70, 80, 85, 95):
            size = getattr(data, f"d{percent}_mm")
            here = (data.fines_class == fines) & (b > 0) & np.isfinite(size)
            log = np.log(b[here] / size[here])
            cells.append(f"{np.exp(np.median(log)):.1f} (x{np.exp(np.std(log)):.2f})" if here.sum() >= 10 else "-")
        rows.append([fines, *cells])
    table(["fines", "D30B", "D40B", "D50B", "D60B", "D70B", "D80B", "D85B", "D95B"], rows)


def figure(data, found, path):
    """The ratio over the steepness of the base, and the reliability diagram."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    import matplotlib.ticker

    plt.rcParams |= {"svg.hashsalt": "voidwalk", "svg.fonttype": "none", "font.size": 9, "font.family": "sans-serif"}
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
        axis.set_major_locator(matplotlib.ticker.FixedLocator(ticks))
        axis.set_minor_locator(matplotlib.ticker.NullLocator())
        axis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
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
    parser.add_argument("--results", type=Path, default=TOP / "results")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    data = Data(options.results)
    ratio, groups = data.ratio(), [(group, data.group == group) for group in GROUPS]
    table(["group", *HEAD[1:]], by(data, ratio, groups))
    ratios(data)
    flags(data)
    beside(data)
    beyond_ends(data)
    more_base(data)
    by_hand(data)
    folds(data)
    scatter(data)
    single_sizes(data)
    print("By the uniform loose filter's boundary:")
    against(data, [("cu1.5", "dense"), ("cu3",), ("c33",), ("cu12",)])
    against(data, [(*USUAL, "no clay"), (*USUAL, "flocs"), (*USUAL, "crumbs"), (*USUAL, "4 x base")])
    against(data, [(*USUAL, "to 2 mm"), (*USUAL, "as sampled")])
    against(data, [(*USUAL, "to 4.75 mm"), (*USUAL, "", "2"), ("cu1.5", "loose", "continuing_mm")])
    for what in ("no clay", "flocs", "crumbs", "4 x base", "to 2 mm"):
        rescued(data, what)
    print("Continuing erosion by 9 D95B:")
    against(data, [("cu1.5", "loose", "continuing_mm")], data.continuing_9_d95_mm)
    for likeness in (0.0, 0.5, 0.8):
        found, names = validated(data, GROUPS, likeness)
        outcome, group = found["outcome"], found["group"]
        rows = []
        for name in names:
            cells = [brier(found[name][group == g], outcome[group == g]) if (group == g).any() else np.nan
                     for g in range(len(GROUPS))]
            cells = [brier(found[name], outcome), *cells]
            rows.append([name, *("-" if np.isnan(x) else f"{x:.3f}" for x in cells)])
        print(f"rank correlation of walk and test within a group {likeness}: {len(outcome)} outcomes")
        table(["probability", "Brier score", *GROUPS], rows)
        if likeness == 0:
            if options.write:
                figure(data, found, options.results / "real-soils.svg")
            for name in ("rule", "walk", "mean"):
                rows = [[f"{k / 10:.1f} to {(k + 1) / 10:.1f}", n, f"{p:.2f}", f"{o:.2f}"]
                        for k, n, p, o in reliability(found[name], outcome)]
                table([name, "outcomes", "said", "came"], rows)
    other_filters(data)
    controls(data)


if __name__ == "__main__":
    main()
