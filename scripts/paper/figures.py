"""The figures of the paper with our results, drawn as SVG by hand. A figure for which nothing was walked is left out."""

import math
from html import escape
from typing import NamedTuple

from measures import ALL_LAYERS, THREE_LAYERS, twins
from study import MAIN, Case, Value, known, mean, need

#: Okabe and Ito: for lines, and darker for text on white.
BLACK, GREY = ("#000000", "#000000"), ("#767676", "#555555")
BLUE, GREEN, ORANGE = ("#0072B2", "#00598C"), ("#009E73", "#00684C"), ("#E69F00", "#855C00")
VERMILLION, PURPLE = ("#D55E00", "#A34700"), ("#CC79A7", "#8E3F6C")
RAMP = [("#8CC5E3", "#1F6F9C"), ("#5BA7D1", "#1F6F9C"), ("#2E86BC", "#1B6799"), ("#11679E", "#11679E"), ("#0A4B77", "#0A4B77"),
        ("#052D49", "#052D49")]
BY_BASE = {"1.5": BLUE, "3": GREEN, "4.5": VERMILLION}
SHAPES = {"circle": "m-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z", "diamond": "m0 -5.5l5.5 5.5l-5.5 5.5l-5.5 -5.5Z",
          "square": "m-4 -4h8v8h-8Z"}
WIDTH, LEFT, RIGHT, BOTTOM, HEIGHT = 720, 64, 20, 50, 330
D85, ERODED, PERCENT = "D15F / D85B (–)", "Base eroded, by mass (%)", (0.0, 100.0)


class Group(NamedTuple):
    """Points of one kind, or the line of a curve where there is no shape."""

    label: str
    colour: tuple
    #: x, and y as a number or with its interval.
    points: list
    shape: str = ""
    hollow: bool = False
    #: Width of the line through the points, where there is one.
    width: float = 0
    dash: str = ""


class Rule(NamedTuple):
    """A line across the figure at a value of x or y."""

    axis: str
    at: float
    label: str


class Figure(NamedTuple):
    name: str
    title: str
    caption: str
    x: str
    y: str
    x_range: tuple
    y_range: tuple
    groups: list
    rules: list = []
    log: bool = False


def spread(low, high):
    """A range that can be drawn, where all values are the same."""
    return (low, high) if high > low else (low, low + (abs(low) or 1.0))


def ticks(low, high, log):
    if log:
        powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        values = [factor * 10.0**power for power in powers for factor in (1, 2, 3, 5)]
    else:
        power = 10.0 ** math.floor(math.log10(high - low))
        step = next(power * part for part in (0.1, 0.2, 0.5, 1) if (high - low) / (power * part) <= 8)
        values = [step * index for index in range(math.ceil(low / step), math.floor(high / step) + 1)]
    return [value for value in values if low <= value <= high * (1 + 1e-9)]


def stroke(colour, width, dash=""):
    return f'fill="none" stroke="{colour}" stroke-width="{width}"' + (f' stroke-dasharray="{dash}"' if dash else "")


def svg(figure):
    """The figure as an element of a page and as a file: names stand above the frame."""
    parts, x, y = [], 14.0, 20.0
    keys = [(rule.label, BLACK if rule.axis == "y" else GREY, None) for rule in figure.rules]
    for label, colour, group in keys + [(group.label, group.colour, group) for group in figure.groups if group.label and group.points]:
        length = 46 + 6.7 * len(label)
        if x + length > WIDTH and x > 14:
            x, y = 14.0, y + 19
        if group is None or group.width and not group.shape:
            line = stroke(colour[0], group.width if group else 1.5, group.dash if group else "7 4")
            parts.append(f'<path d="M{x:.1f} {y}h26" {line}/>')
        else:
            parts.append(mark(x + 13, y, group))
        parts.append(f'<text x="{x + 32:.1f}" y="{y + 4.5}" fill="{colour[1]}">{escape(label)}</text>')
        x += length
    top = y + 21
    bottom, right = top + HEIGHT, WIDTH - RIGHT
    scale = math.log if figure.log else float
    x_range, (floor, ceiling) = spread(*figure.x_range), spread(*figure.y_range)
    low, high = map(scale, x_range)

    def across(value):
        return LEFT + (scale(value) - low) / (high - low) * (right - LEFT)

    def up(value):
        return bottom - (value - floor) / (ceiling - floor) * HEIGHT

    for value in ticks(*x_range, figure.log):
        parts.append(f'<path d="M{across(value):.2f} {top}V{bottom}" {stroke("#cccccc", 0.8)}/>')
        parts.append(f'<text x="{across(value):.2f}" y="{bottom + 17}" text-anchor="middle">{value:g}</text>')
    for value in ticks(floor, ceiling, False):
        parts.append(f'<path d="M{LEFT} {up(value):.2f}H{right}" {stroke("#cccccc", 0.8)}/>')
        parts.append(f'<text x="{LEFT - 7}" y="{up(value) + 4.5:.2f}" text-anchor="end">{value:g}</text>')
    inside = f'clip-path="url(#{figure.name}-frame)"'
    parts.append(f'<clipPath id="{figure.name}-frame"><path d="M{LEFT} {top}H{right}V{bottom}H{LEFT}Z"/></clipPath>')
    for rule in figure.rules:
        line = f"M{across(rule.at):.2f} {top}V{bottom}" if rule.axis == "x" else f"M{LEFT} {up(rule.at):.2f}H{right}"
        parts.append(f'<path d="{line}" {inside} {stroke((BLACK if rule.axis == "y" else GREY)[0], 1.5, "7 4")}/>')
    for group in figure.groups:
        points = [(value, at if isinstance(at, Value) else Value(at)) for value, at in group.points]
        if group.width and points:
            line = "L".join(f"{across(value):.2f} {up(at.value):.2f}" for value, at in points)
            parts.append(f'<path d="M{line}" {inside} {stroke(group.colour[0], group.width, group.dash)}/>')
        for value, at in points if group.shape else []:
            words = f"{group.label or figure.y}: {value:.4g}, {at.value:.4g}"
            if at.interval:
                words += " ({:.4g} to {:.4g})".format(*at.interval)
                bar = "M{0:.2f} {1:.2f}V{2:.2f}".format(across(value), *map(up, at.interval))
                parts.append(f'<path d="{bar}" {inside} {stroke(group.colour[0], 1.2)}/>')
            parts.append(mark(across(value), up(at.value), group, words))
    middle = (top + bottom) / 2
    parts.append(f'<path d="M{LEFT} {top}V{bottom}H{right}" {stroke("#1a1a1a", 1)}/>')
    parts.append(f'<text x="{(LEFT + right) / 2}" y="{bottom + 40}" text-anchor="middle">{escape(figure.x)}</text>')
    parts.append(f'<text transform="translate(18 {middle}) rotate(-90)" text-anchor="middle">{escape(figure.y)}</text>')
    height = bottom + BOTTOM
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" width="{WIDTH}" height="{height:g}" role="img" '
            'font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#1a1a1a">')
    title = f'<title>{escape(figure.title)}</title>\n<desc>{escape(figure.caption)}</desc>'
    return "\n".join([head, title, f'<rect width="{WIDTH}" height="{height:g}" fill="#ffffff"/>', *parts, "</svg>\n"])


def mark(x, y, group, words=""):
    fill = "#ffffff" if group.hollow else group.colour[0]
    title = f"<title>{escape(words)}</title>" if words else ""
    return f'<path d="M{x:.2f} {y:.2f}{SHAPES[group.shape]}" fill="{fill}" stroke="{group.colour[0]}" stroke-width="1.8">{title}</path>'


def scatter(name, title, caption, groups, rules=(), x=D85, y=ERODED, percent=True, reach=(2.5, 7.2)):
    """A figure of points in groups."""
    every = need([point for group in groups for point in group.points])
    x_range = min(reach[0], *(point[0] for point in every)), max(reach[1], *(point[0] for point in every))
    y_range = PERCENT if percent else (0.0, 1.08 * max(at.value if at.high is None else at.high for _, at in every))
    groups = [group._replace(points=sorted(group.points, key=lambda point: point[0])) for group in groups]
    return Figure(name, title, caption, x, y, x_range, y_range, groups, list(rules))


def percolation(study):
    rows = [row for row in need(study.percolation)["sizes"] if row["threshold"].get("sd") is not None]
    points = []
    for row in need(rows):
        sd, half = row["threshold"]["sd"], 1.96 * (row.get("sd_error") or 0.0)
        points.append((row["size"], Value(sd, sd - half, sd + half)))
    caption = "Over the realisations, as in Fig. 6 of the paper. Bars: 95 % intervals, for normal thresholds."
    y_range = min(0.0, *(at.low for _, at in points)), max(0.001, *(at.high for _, at in points))
    x, y, group = "Size of the lattice, L (voids along each side)", "Standard deviation (–)", Group("", BLUE, points, "circle", width=1.5)
    title = "Fig. 6: standard deviation of the percolation threshold"
    return Figure("fig6", title, caption, x, y, (0.0, points[-1][0]), y_range, [group])


def curves(study, name, title, x, x_range, kind, unit):
    """Curves of the filters of Table 2, and the published curves of constrictions."""
    groups = []
    for filter, label, colour, dash in FILTERS:
        records = known(lambda plan: study.filter(plan, filter), [MAIN, "kenney"])[:1]
        published = known(lambda plan: study.filter(plan, filter), ["paper-published"] if kind == "constrictions" else [])
        looks = [(one, label, colour, 2, dash) for one in records] + [(one, "published", BLACK, 1.2, "2 3") for one in published]
        for record, words, shade, width, pattern in looks:
            words = "" if words in [group.label for group in groups] else words
            points = [(size / record[unit], percent) for size, percent in record[kind]]
            groups.append(Group(words, shade, points, width=width, dash=pattern))
    caption = "Own packings; dotted: published curves (Shire and O’Sullivan 2016)." if kind == "constrictions" else ""
    return Figure(name, title, caption, x, "Percent finer (%)", x_range, PERCENT, need(groups), log=True)


def mean_progress(rows, run):
    """Percent eroded by each increment, mean over the replicates; a walk that has ended keeps its last value."""
    walks = {}
    for replicate, number, increment, eroded in rows:
        if number == run:
            walks.setdefault(replicate, {})[increment] = eroded
    last = max((increment for walk in walks.values() for increment in walk), default=0)
    points, current = [], dict.fromkeys(walks, 0.0)
    for increment in range(last + 1):
        current = {replicate: walks[replicate].get(increment, value) for replicate, value in current.items()}
        points.append((increment, 100.0 * mean(list(current.values()) or [0.0])))
    return points


def progress(study):
    groups = [Group(f"{label}, {words} run", colour, mean_progress(study.series[name], run), width=2, dash=dash)
              for name, label, colour in PROGRESS if name in study.series for run, words, dash in ((1, "first", ""), (2, "second", "6 4"))]
    last = max(len(group.points) for group in need(groups)) - 1
    return Figure("fig13", "Fig. 13: progress of erosion", "Means over the replicates, of the mass that the run inserts in all.",
                  "Increment of the run (–)", ERODED, (0, last), PERCENT, groups)


def retained(study):
    steps = {}
    for replicate, run, increment, size, percent in need(study.retained):
        if (replicate, run) == (1, 1):
            steps.setdefault(increment, []).append((size, percent))
    sizes = [size for curve in steps.values() for size, _ in curve]
    groups = [Group("base", GREY, study.named("progress", "fig18").base["gradation"], width=2, dash="2 3")]
    for index, increment in enumerate(sorted(steps)):
        shade = RAMP[index * 5 // (len(steps) - 1) if len(steps) > 1 else 3]
        groups.append(Group(f"increment {increment}", shade, steps[increment], width=2))
    return Figure("fig18", "Fig. 18: gradation of the retained particles",
                  "Loose filter with Cu 1.5, base with Cu 3 at Dc5, first run, first replicate.", "Size / D0F (–)",
                  "Percent finer by mass (%)", (min(sizes), max(sizes)), PERCENT, groups, log=True)


def points(cases, x, y):
    return known(lambda case: (x(case), y(case)), cases)


def kenney(study, filter, largest):
    """Largest eroded particle, or proportion eroded, against the size of a uniform base."""
    cases = [case for case in study.cases("kenney") if case.level("filter") == filter]
    if not largest:
        return [Group("voidwalk", BLUE, points(cases, Case.d50b_over_d0f, lambda case: case.eroded(1)), "circle", width=1)]
    parts = [[case for case in cases if case.erodes_its_largest(1) == whole] for whole in (False, True)]
    drawn = [points(part, Case.d50b_over_d0f, lambda case: case.largest_over_d0f(1)) for part in parts]
    return [Group("voidwalk", BLUE, drawn[0], "circle", width=1),
            Group("voidwalk, the base’s own largest", BLUE, drawn[1], "circle", True, 1)]


def both_runs(study, density, ratio):
    """Both runs of all bases on loose or on dense filters."""
    return [Group(f"base Cu {cu_b}, filter Cu {cu_f}, {words} run", colour,
                  points([case for case in study.cases(MAIN) if case.has(filter=f"cu{cu_f}-{density}", cu_b=cu_b)],
                         lambda case: getattr(case, ratio), lambda case: case.eroded(run)), shape, run == 2)
            for cu_b, colour in BY_BASE.items() for cu_f, shape in (("1.5", "circle"), ("3", "diamond"))
            for run, words in ((1, "first"), (2, "second"))]


def by_filter(study, other, value):
    """A value of the first run against D15F/D85B, base with Cu 1.5, for two filters."""
    return [Group(filter, colour, points([case for case in study.cases(MAIN) if case.has(filter=filter, cu_b="1.5")],
                                         lambda case: case.d85_ratio, lambda case: getattr(case, value)(1)), shape, width=1)
            for filter, colour, shape in (("cu1.5-loose", BLUE, "circle"), (other, VERMILLION, "diamond"))]


def blocked(study, part):
    """Eroded mass against what is blocked, loose filters."""
    return [Group(f"base Cu {cu_b}", colour, points([case for case in study.cases(MAIN) if case.loose and case.has(cu_b=cu_b)],
                                                    lambda case: case.blocked(part), lambda case: Value(case.both_runs())), "circle")
            for cu_b, colour in BY_BASE.items()]


def networks(study):
    """The cases on the network of Table 3 and their twins on the cubic one."""
    return [Group(f"base Cu {cu_b}, {network}", colour,
                  points([pair[side] for pair in twins(study) if pair[0].has(cu_b=cu_b)],
                         lambda case: case.d85_ratio, lambda case: case.eroded(1)), shape, not side, 1)
            for cu_b, shape in (("1.5", "circle"), ("3", "diamond"), ("4.5", "square"))
            for side, network, colour in ((1, "cubic", BLUE), (0, "as in Table 3", PURPLE))]


FILTERS = [("cu1.2-dense", "Cu 1.2", GREEN, ""),
           ("cu1.5-loose", "Cu 1.5, loose", BLUE, ""), ("cu1.5-dense", "Cu 1.5, dense", BLUE, "6 4"),
           ("cu3-loose", "Cu 3, loose", VERMILLION, ""), ("cu3-dense", "Cu 3, dense", VERMILLION, "6 4"),
           ("cu6-friction0.7", "Cu 6", PURPLE, "")]
PROGRESS = [("fig13-continuing", "continuing: dense Cu 3, base Cu 1.5, Dc5", VERMILLION),
            ("fig13-some", "some: dense Cu 1.5, base Cu 3, Dc5", ORANGE), ("fig13-none", "none: loose Cu 1.5, base Cu 1.5, Dc50", GREEN)]
LIMIT = Rule("y", 7.5, "7.5 %")
#: The rules that the paper states; it does not state the limits of Sherard and Dunnigan.
D85_RULES = [LIMIT, Rule("x", 4.0, "4: Terzaghi"), Rule("x", 5.0, "5: the paper"), Rule("x", 7.0, "7: Foster and Fell, no erosion")]
D95_RULES = [LIMIT, Rule("x", 4.7, "4.7: the paper"), Rule("x", 9.0, "9: Foster and Fell, some erosion")]
SHERARD = "Sherard and Dunnigan vary the limit with the base; the paper states none of their numbers, so none is drawn."
WIDER, DENSER = "Base with Cu 1.5, loose filters, first run.", "Filter and base with Cu 1.5, first run."
UNIFORM = "Base with Cu 1.2; it ends at 1.2 D50B. Where that size erodes, the filter says no more."
BLOCKED = "Loose filters, blocked after the second run."
D95_LOOK = {"rules": D95_RULES, "x": "D15F / D95B (–)", "reach": (2.0, 9.2)}
KENNEY_LOOK = {"x": "D50B / D0F (–)", "reach": (0.1, 0.4)}
BLOCKED_LOOK = {"y": "Base eroded, mean of both runs (%)", "reach": (0.0, 10.0)}
OVER_D0F = {"y": "Largest eroded / D0F (–)", "percent": False}
OVER_D15F = {"y": "Largest eroded / D15F (–)", "percent": False, "rules": [Rule("y", 0.2, "0.2: Kenney et al., Dc* ≤ D15F/5")]}
#: Figures of points: name, title, caption, groups with their arguments, and how they look.
SCATTERS = [
    ("fig14a", "Fig. 14(a): loose filters", SHERARD, both_runs, ["loose", "d85_ratio"], {"rules": D85_RULES}),
    ("fig14b", "Fig. 14(b): dense filters", SHERARD, both_runs, ["dense", "d85_ratio"], {"rules": D85_RULES}),
    ("fig15a", "Fig. 15(a): loose filters", "", both_runs, ["loose", "d95_ratio"], D95_LOOK),
    ("fig15b", "Fig. 15(b): dense filters", "", both_runs, ["dense", "d95_ratio"], D95_LOOK),
    ("fig16a", "Fig. 16(a): largest eroded particle over D0F", WIDER, by_filter, ["cu3-loose", "largest_over_d0f"], OVER_D0F),
    ("fig16b", "Fig. 16(b): proportion eroded", WIDER, by_filter, ["cu3-loose", "eroded"], {"rules": D85_RULES}),
    ("fig16c", "Fig. 16(c): largest eroded particle over D15F", WIDER, by_filter, ["cu3-loose", "largest"], OVER_D15F),
    ("fig17a", "Fig. 17(a): largest eroded particle by density", DENSER, by_filter, ["cu1.5-dense", "largest_over_d0f"], OVER_D0F),
    ("fig17b", "Fig. 17(b): proportion eroded by density", DENSER, by_filter, ["cu1.5-dense", "eroded"], {"rules": D85_RULES}),
    ("fig19a", "Fig. 19(a): blocked throughout", BLOCKED, blocked, [ALL_LAYERS],
     {**BLOCKED_LOOK, "x": "Constrictions blocked, of all (%)", "rules": [Rule("x", 7.5, "7.5 %")]}),
    ("fig19b", "Fig. 19(b): blocked in the first three layers", BLOCKED, blocked, [THREE_LAYERS],
     {**BLOCKED_LOOK, "x": "Constrictions blocked, of the first three layers (%)"}),
    ("fig20", "Fig. 20: change of connectivity", "Loose filter with Cu 1.5, first run.", networks, [], {"rules": D85_RULES}),
]
for number, base, model, test in ((8, "cu1.2-dense", 0.18, 0.18), (9, "cu3-loose", 0.3, 0.25), (10, "cu6-friction0.7", 0.34, 0.26)):
    limits = [Rule("y", test, f"{test}: tests of Kenney et al.")] + [Rule("y", model, f"{model}: the paper’s model")] * (model != test)
    for letter, look in (("a", {**KENNEY_LOOK, **OVER_D0F, "rules": limits}), ("b", KENNEY_LOOK)):
        heading = f"Fig. {number}({letter}): filter with Cu {base[2:].split('-')[0]}"
        SCATTERS.append((f"fig{number}{letter}", heading, UNIFORM, kenney, [base, letter == "a"], look))
CURVES = [
    ("fig7a", "Fig. 7(a): gradations of the filters, by mass", "Size / D0F (–)", (1.0, 36.0), "gradation", "d0_mm"),
    ("fig7b", "Fig. 7(b): constrictions over D0F, by number", "Constriction / D0F (–)", (0.15, 1.5), "constrictions", "d0_mm"),
    ("fig7c", "Fig. 7(c): constrictions over D15F, by number", "Constriction / D15F (–)", (0.05, 1.0), "constrictions", "d15_mm"),
]


def figures(study):
    """All figures for which something was walked."""
    draws = [lambda row=row: curves(study, *row) for row in CURVES]
    draws += [lambda draw=draw: draw(study) for draw in (percolation, progress, retained)]
    draws += [lambda row=row: scatter(*row[:3], row[3](study, *row[4]), **row[5]) for row in SCATTERS]
    return sorted(known(lambda draw: draw(), draws), key=lambda figure: figure.name)
