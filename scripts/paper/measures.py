"""Reads our value of each number that the paper states from the walks.

statements.toml names methods of Measures; the `says` of a statement tells what its measure gives. Rules that the paper states of "all"
combinations are counted over all that its list of filters and bases gives, which are 78. The paper says 66, and does not say which 12
it left out.
"""

from statistics import median

from study import MAIN, PUBLISHED, VARIANT, VARIANTS, NotWalked, Value, known, mean, need, size_at, total

#: Measures that differ only between constriction curves, and those that belong to a plan of their own.
OF_CURVES = {"void_ratio", "cu_csd", "dc0_over_d0f", "dense_finer", "csd_over_d15f", "mean_connectivity"}
ONCE = {"voids", "connections", "combinations", "spread_slows", "blocked_by_one_size", "kenney_largest", "kenney_drop", "kenney_eroded",
        "table3_largest_shift", "table3_not_less", "first_retained_over_dc0", "retained_finer"}
ALL_LAYERS, THREE_LAYERS = "blocked_fraction", "blocked_first_three_layers_fraction"
TABLE_3 = {"filter": "cu1.5-loose", "cu_b": "1.5", "d85b": "dc5"}


def takes(name, variant):
    """True if a measure is taken for a variant: of those with the same curves, for the first."""
    if name in OF_CURVES:
        return variant is next(other for other in VARIANTS if other.curves == variant.curves)
    return name not in ONCE or variant.name == MAIN


def exceptions(breaks, undecided=0):
    """Exceptions to a rule: a list with True for every case that breaks it."""
    certain, count = sum(need(breaks)), len(breaks)
    if not undecided:
        return Value(certain, words=f"of {count}")
    return Value(certain, certain, certain + undecided, f"of {count}, {undecided} undecided", open=certain == 0)


def positive(value):
    return need(value if value > 0 else None)


def last_max(items, key):
    """The last of the greatest."""
    return max(reversed(need(items)), key=key)


def fraction_within(spreads, limit):
    """Percent of all spreads (%) that keep within a limit."""
    count, kept = len(need(spreads)), sum(spread <= limit for spread in spreads)
    words = f"{kept} of {count}; the median spread is {median(spreads):.1f} %, the largest {max(spreads):.1f} %"
    return Value(100.0 * kept / count, words=words)


def rises(points):
    return [after[1] - before[1] for before, after in zip(points, points[1:])]


def height(points, x):
    """Height of a polygon of points that rise in x."""
    for (left, low), (right, high) in zip(points, points[1:]):
        if left <= x <= right and left < right:
            return low + (high - low) * (x - left) / (right - left)
    raise NotWalked


def best_boundary(cases):
    """Range of the ratio that leaves the fewest of (ratio, above) on the wrong side, and their number. Equal ratios are not parted."""
    cases = sorted(cases, key=lambda case: case[0])
    # Ratios of bases with unlike Cu are the same but for rounding.
    places = [at for at in range(1, len(cases)) if cases[at][0] > cases[at - 1][0] * (1 + 1e-9)]
    wrong = [sum(above != (index >= at) for index, (_, above) in enumerate(cases)) for at in places]
    first = last = wrong.index(min(need(wrong)))
    # Where several neighbouring boundaries are equally good, the range spans them.
    while last + 1 < len(places) and wrong[last + 1] == wrong[first]:
        last += 1
    return cases[places[first] - 1][0], cases[places[last]][0], wrong[first]


def ranks(values):
    """Ranks from 1; equal values share the mean of theirs."""
    return [sum(other < value for other in values) + 0.5 * (values.count(value) + 1) for value in values]


def rank_correlation(pairs):
    """Spearman's rank correlation."""
    x, y = (ranks([pair[side] for pair in pairs]) for side in (0, 1))
    middle = 0.5 * (len(pairs) + 1)
    xx, yy, xy = (total((a - middle) * (b - middle) for a, b in zip(*both)) for both in ((x, x), (y, y), (x, y)))
    return xy / (positive(xx) * positive(yy)) ** 0.5


def curve_ratios(a, b, unit):
    """Ratios of two constriction curves from Dc5 to Dc95, the sizes of each in units of one of its filter's sizes."""
    percents = (5, 10, 25, 50, 75, 90, 95)
    sizes = [[size_at(record["constrictions"], percent) / record[unit] for percent in percents] for record in (a, b)]
    return [size / other for size, other in zip(*sizes)]


def per_void(case, runs):
    """Particles retained per void in the first runs together: what the first retains is gone before the second."""
    replicates = [replicate["runs"][:runs] for replicate in case.outcome["replicates"]]
    return Value.of_values([total(run["retained_per_void"] for run in first) for first in replicates])


def twins(study):
    """Cases on the modified network, with their twins on the cubic one."""
    return known(lambda case: (case, study.named(MAIN, case.name)), [case for case in study.cases("table3") if case.line["levels"]])


def retained_after(study, increment):
    """Size curves of what the case of Fig. 18 retains after an increment of the first run, one a replicate."""
    curves = {}
    for replicate, run, at, size, percent in study.retained:
        if (run, at) == (1, increment):
            curves.setdefault(replicate, []).append((size, percent))
    return [curve for _, curve in sorted(curves.items()) if len(curve) > 1]


class Measures:
    """The measures of a plan. They take the keys of a statement, and raise NotWalked where the folder cannot tell."""

    def __init__(self, study, plan):
        self.study, self.plan, self.cases = study, plan, study.cases(plan)

    def case(self, **levels):
        return self.study.case(self.plan, **levels)

    def those(self, fits):
        return [case for case in self.cases if fits(case)]

    def loose(self, wide=None, low=0, high=100, **levels):
        """Cases on loose filters with D15F/D85B between two values."""
        return self.those(lambda case: case.loose and wide in (None, case.wide) and low <= case.d85_ratio < high and case.has(**levels))

    def twins(self, fits, filter=None, cu_b=None):
        """Cases with their twins of the same plan, with another filter or another Cu of the base."""

        def pair(case):
            return case, self.case(filter=filter or case.level("filter"), cu_b=cu_b or case.level("cu_b"), d85b=case.level("d85b"))

        return known(pair, self.those(fits))

    def by_density(self, fits):
        """Cases on dense filters, with their twins on the loose ones."""
        return [pair for dense, loose in (("cu1.5-dense", "cu1.5-loose"), ("cu3-dense", "cu3-loose"))
                for pair in self.twins(lambda case: case.has(filter=dense) and fits(case), filter=loose)]

    def uniform_pairs(self):
        return self.by_density(lambda case: case.has(filter="cu1.5-dense", cu_b="1.5") and case.d85_ratio < 6.4)

    def progress(self, filter, cu_b):
        """Eroded mass of the first run against D15F/D85B for a filter and a base, by rising ratio."""
        cases = self.those(lambda case: case.has(filter=filter, cu_b=cu_b))
        return sorted(((case.d85_ratio, case.mean(1)) for case in cases), key=lambda point: point[0])

    def parted(self, ratio, runs):
        """Loose combinations by a ratio, and by whether the means of these runs exceed 7.5 %: an interval cannot be on one side."""
        return best_boundary([(getattr(case, ratio), all(case.mean(run) >= 7.5 for run in runs)) for case in self.loose()])

    # The campaign.

    def voids(self):
        return Value(need(self.cases)[0].network["voids"])

    def combinations(self):
        return Value(len(need(self.cases)))

    def connections(self):
        network = need(self.cases)[0].network
        return Value(2.0 * network["constrictions"] / network["voids"])

    def n_base(self, **levels):
        return Value(need(self.case(**levels).line.get("n_base_eq2")))

    def most_particles(self):
        return Value(max(case.line["n_base"] * len(case.runs) for case in need(self.cases)))

    def second_blocks(self):
        def percent(case):
            first, both = (case.run(number)[ALL_LAYERS]["mean"] for number in (1, 2))
            return 100.0 * (both - first) / positive(first)

        values = sorted(need(known(percent, self.cases)))
        low, high = (values[int((len(values) - 1) * part)] for part in (0.25, 0.75))
        return Value(median(values), words=f"median; half of them {low:.1f} to {high:.1f}")

    def reruns(self, value, within):
        """Spreads over first runs: of the eroded mass in percent of the total, of a size in percent of its mean."""
        rows = [[replicate["runs"][0].get(value) for replicate in case.outcome["replicates"]] for case in self.cases]
        rows = [[one for one in row if one is not None] for row in rows]
        unit = (lambda row: 1.0) if value == "eroded_mass_fraction" else mean
        return fraction_within([100.0 * (max(row) - min(row)) / unit(row) for row in rows if len(row) > 1], within)

    def erosion_class(self, wanted, **levels):
        case = self.case(**levels)
        words = f"{case.verdict}: {case.mean(1):.1f} % then {case.mean(2):.1f} %"
        return Value(float(case.verdict == wanted), words=words, open=case.verdict == "undecided")

    def eroded(self, run, **levels):
        return self.case(**levels).eroded(run)

    def not_of_class(self, wanted, **limits):
        verdicts = [case.verdict for case in self.loose(**limits)]
        return exceptions([verdict not in (wanted, "undecided") for verdict in verdicts], verdicts.count("undecided"))

    def uniform_reduction(self):
        cases = [case for case in self.loose(wide=False, low=5) if case.mean(1) > 0]
        return Value(max(100.0 * (1.0 - case.mean(2) / case.mean(1)) for case in need(cases)))

    def wide_65_not_less(self):
        return exceptions([case.mean(2) >= case.mean(1) for case in self.loose(wide=True, d85b="dc0")])

    def second_over_first(self, **levels):
        first, second = (self.case(**levels).mean(run) for run in (1, 2))
        return Value(100.0 * second / positive(first), words=f"{first:.1f} % then {second:.1f} %")

    def rising(self):
        filters, bases = ({case.level(factor) for case in self.cases} for factor in ("filter", "cu_b"))
        steps = [rise for filter in filters for cu_b in bases for rise in rises(self.progress(filter, cu_b))]
        more = sum(rise > 0 for rise in need(steps))
        return Value(100.0 * more / len(steps), words=f"{more} of {len(steps)} steps")

    def uniform_rise(self):
        curves = [[point for point in self.progress(f"{filter}-loose", "1.5") if point[0] > 5] for filter in ("cu1.5", "cu3")]
        return Value(min(need([rise for points in curves for rise in rises(points)])))

    def filters_unlike(self):
        curves, differences = [self.progress(filter, "1.5") for filter in ("cu1.5-loose", "cu3-loose")], []
        for points, other in (curves, reversed(curves)):
            differences += known(lambda point: (point[0], abs(height(other, point[0]) - point[1])), points)
        ratio, most = last_max(differences, key=lambda pair: pair[1])
        return Value(most, words=f"at D15F/D85B {ratio:.2f}, between straight lines")

    def wider_filter_not_larger(self):
        pairs = self.twins(lambda case: case.has(filter="cu3-loose", cu_b="1.5"), filter="cu1.5-loose")
        return exceptions(known(lambda pair: pair[0].largest_over_d0f(1).value <= pair[1].largest_over_d0f(1).value, pairs))

    def dense_not_less(self):
        return exceptions([dense.mean(1) >= loose.mean(1) for dense, loose in self.by_density(lambda case: case.d85_ratio > 5)])

    def wide_not_less(self):
        pairs = self.twins(lambda case: case.level("cu_b") == "4.5" and case.d85_ratio > 5, cu_b="1.5")
        return exceptions([wide.mean(1) >= uniform.mean(1) for wide, uniform in pairs])

    def dividing(self, ratio, runs):
        low, high, wrong = self.parted(ratio, runs)
        return Value(0.5 * (low + high), low, high, f"{wrong} of {len(self.loose())} on the wrong side")

    def better(self, runs, sign):
        d85, d95 = (self.parted(ratio, runs)[2] for ratio in ("d85_ratio", "d95_ratio"))
        return Value(sign * (d95 - d85), words=f"{d85} wrong by D85B, {d95} by D95B, of {len(self.loose())}")

    def largest_over_d15f(self, **levels):
        cases = self.those(lambda case: case.has(**levels))
        values, count = need(known(lambda case: case.largest(1).value, cases)), sum(case.erodes_its_largest(1) for case in cases)
        words = f"{min(values):.3f} to {max(values):.3f} over {len(values)} bases, {count} of which erode their own largest"
        return Value(mean(values), words=words)

    def dense_largest_finer(self):
        values = known(lambda pair: 100.0 * (1.0 - pair[0].largest(1).value / pair[1].largest(1).value), self.uniform_pairs())
        return Value(mean(need(values)), words=f"mean of {len(values)} bases")

    def dense_largest_not_less(self):
        return exceptions(known(lambda pair: pair[0].largest(1).value >= pair[1].largest(1).value, self.uniform_pairs()))

    def most_eroded_below_5(self, filter):
        cases = self.those(lambda case: case.has(filter=filter, cu_b="1.5") and case.d85_ratio < 5)
        return last_max(known(lambda case: case.eroded(1), cases), key=lambda one: one.value)

    def density_effect(self):
        pairs = [pair for pair in self.uniform_pairs() if 5 <= pair[0].d85_ratio < 6]
        return Value(max(loose.mean(1) - dense.mean(1) for dense, loose in need(pairs)))

    def blocked_near_over_all(self, **levels):
        near, every = (self.case(**levels).blocked(part) for part in (THREE_LAYERS, ALL_LAYERS))
        return Value(near / positive(every), words=f"{near:.1f} % of the first three layers, {every:.1f} % of all")

    def rank(self, part):
        pairs = known(lambda case: (case.blocked(part), case.both_runs()), self.loose())
        return Value(rank_correlation(pairs), words=f"Spearman’s, over {len(pairs)} loose combinations")

    def few_blocked(self):
        cases = need([case for case in self.loose() if case.both_runs() < 7.5])
        few = sum(known(lambda case: case.blocked(ALL_LAYERS) < 7.5, cases))
        return Value(100.0 * few / len(cases), words=f"{few} of {len(cases)}")

    # Filters, percolation, one size, Kenney's bases.

    def filter(self, name):
        """A filter of the plan; those that only Kenney's tests need are in the plan of that name."""
        plans = [self.plan, "kenney"] if self.plan == MAIN else [self.plan]
        return need(known(lambda plan: self.study.filter(plan, name), plans))[0]

    def void_ratio(self, filter):
        # The published curves come with the void ratios of the paper.
        need(None if VARIANT[self.plan].curves == PUBLISHED else self.plan)
        return Value(need(self.filter(filter).get("void_ratio")))

    def cu_csd(self, filter):
        return Value(self.filter(filter)["cu_csd"])

    def dc0_over_d0f(self, filter):
        return Value(size_at(self.filter(filter)["constrictions"], 0) / self.filter(filter)["d0_mm"])

    def dense_finer(self, filter):
        dense, loose = (self.study.filter(self.plan, f"{filter}-{density}") for density in ("dense", "loose"))
        finer = [100.0 * (1.0 - ratio) for ratio in curve_ratios(dense, loose, "d0_mm")]
        return Value(mean(finer), words=f"{min(finer):.1f} to {max(finer):.1f} from Dc5 to Dc95")

    def csd_over_d15f(self):
        ratios = curve_ratios(*(self.study.filter(self.plan, name) for name in ("cu3-loose", "cu1.5-loose")), "d15_mm")
        return Value(mean(ratios), words=f"{min(ratios):.2f} to {max(ratios):.2f} from Dc5 to Dc95")

    def mean_connectivity(self):
        packing = need(self.study.packed.get(VARIANT[self.plan].curves))
        words = f"{packing['grains']} grains, voids merged at an overlap of {packing['merge_overlap']}"
        return Value(packing["mean_connectivity"], words=words)

    def spread_slows(self):
        percolation = need(self.study.percolation)
        deviations = {record["size"]: record["threshold"].get("sd") for record in percolation["sizes"]}
        ten, forty, eighty = (need(deviations.get(size)) for size in (10, 40, 80))
        slope = percolation.get("sd_exponent")
        words = "" if slope is None else f"it falls as L to the {slope:.2f} throughout, without a bend at 40"
        for box in percolation["boxes"]:
            shape, threshold = " × ".join(map(str, box["shape"])), 100.0 * box["threshold"]["mean"]
            words += f"; {shape} voids percolate with {threshold:.1f} % of their constrictions open"
        return Value(((forty - eighty) / 40) / ((ten - forty) / 30), words=words)

    def blocked_by_one_size(self, case):
        return Value.read(self.study.named("one-size", case).run(1)[ALL_LAYERS], 100.0)

    def kenney_largest(self, filter):
        """The largest of the means of all bases whose own largest does not erode.

        Where there is no such base, what erodes is only known to be at least as large.
        """
        cases = [case for case in self.study.cases("kenney") if case.level("filter") == filter]
        pairs = known(lambda case: (case.largest_over_d0f(1), case), cases)
        others = [pair for pair in pairs if not pair[1].erodes_its_largest(1)]
        largest, case = last_max(others or pairs, key=lambda pair: pair[0].value)
        words, left_out = f"at D50B/D0F {case.level('d50b_over_d0f')}", len(pairs) - len(others)
        if not others:
            words += ": at least so large, as every base that erodes erodes its own largest"
        elif left_out:
            words += f"; left out, as they erode their own largest: {left_out} finer bases"
        return largest._replace(words=words, open=not others)

    def kenney_drop(self, filter, at, to):
        fine, coarse = (self.study.case("kenney", filter=filter, d50b_over_d0f=size).mean(1) for size in (at, to))
        return Value(100.0 * coarse / positive(fine), words=f"{coarse:.1f} % against {fine:.1f} %")

    def kenney_eroded(self, filter, at):
        return self.study.case("kenney", filter=filter, d50b_over_d0f=at).eroded(1)

    # Table 3, and the network that it describes.

    def modified(self):
        """The case of Table 3 on the modified network, with as many grains per void as the plan has."""
        if self.plan == MAIN:
            return self.study.case("table3", **TABLE_3)
        return self.study.named("table3", need({"paper-2.5": "table3-2.5", "paper-inverse": "table3-inverse"}.get(self.plan)))

    def retained(self):
        """Voids, retained particles and their fraction by connectivity, first run of all replicates."""
        sums = {}
        for run in (run for replicate in self.modified().outcome["replicates"] for run in replicate["runs"] if run["run"] == 1):
            for row in run.get("by_connectivity", []):
                voids, particles = sums.get(row["connectivity"], (0, 0))
                more = row["retained_in_constrictions"] + row["retained_in_voids"]
                sums[row["connectivity"]] = voids + row["voids"], particles + more
        count = max(sum(particles for _, particles in sums.values()), 1)
        return {key: (*sums[key], sums[key][1] / count) for key in need(sorted(sums) if len(sums) > 1 else None)}

    def table3_share(self, connectivity):
        return Value(100.0 * need(self.retained().get(connectivity))[2])

    def table3_few(self):
        return Value(100.0 * total(row[2] for connectivity, row in self.retained().items() if connectivity < 6))

    def table3_per_void(self, connectivity):
        voids, particles, _ = need(self.retained().get(connectivity))
        return Value(particles / voids)

    def table3_all(self, runs):
        return per_void(self.modified(), runs)

    def cubic_per_void(self, runs):
        return per_void(self.case(**TABLE_3), runs)

    def table3_over_cubic(self, runs):
        return Value(self.table3_all(runs).value / self.cubic_per_void(runs).value)

    def table3_largest_shift(self):
        shifts = known(lambda pair: 100.0 * abs(pair[0].largest(1).value / pair[1].largest(1).value - 1.0), twins(self.study))
        return Value(max(need(shifts)))

    def table3_not_less(self):
        pairs = [(changed.mean(1), cubic.mean(1)) for changed, cubic in twins(self.study)]
        falls = [100.0 * (1.0 - changed / cubic) for changed, cubic in pairs if cubic >= 7.5]
        words = f"; where 7.5 % or more erode on the cubic one, {min(falls):.1f} to {max(falls):.1f} % less" if falls else ""
        result = exceptions([changed >= cubic for changed, cubic in pairs])
        return result._replace(words=result.words + words)

    # What the case of Fig. 18 retains.

    def first_retained_over_dc0(self):
        dc0 = size_at(self.study.named("progress", "fig18").filter["constrictions"], 0)
        # The first row above 0 % is the upper edge of the first size class that holds anything.
        finest = [[size / dc0 for size, percent in curve if percent > 0][:1] for curve in retained_after(self.study, 1)]
        return Value.of_values(need([size for sizes in finest for size in sizes]))

    def retained_finer(self):
        last = max(need([row[2] for row in self.study.retained if row[1] == 1]))
        first, end = (known(lambda curve: size_at(curve, 50), retained_after(self.study, step)) for step in (1, last))
        return Value(max(need(end)) / min(need(first)), words="largest median at the end over smallest after the first increment")
