"""The figure of scripts/studies/four_way.py: every cell as a bar, a panel for each base, rules and tests behind."""

import math
from html import escape

from four_way_cells import ARCH, FILTERS, SHOWN
from four_way_words import down, value

LEFT, RIGHT, WIDTH, HIGH = 290, 880, 1080, 13.0
ROW, BAR, GAP, HEAD = 17, 9, 13, 58
GREEN, AMBER, DARK, BLUE, PURPLE, RED = "#5aa469", "#e0b040", "#222", "#2b5fa8", "#7a4fa3", "#b03030"
COLUMNS = {910: "begins", 974: "continues", 1040: "k/k0"}


def x(ratio):
    return LEFT + min(max(ratio, 0.0), HIGH) / HIGH * (RIGHT - LEFT)


def words(where, y, what, anchor="start", **more):
    style = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in more.items())
    return f'<text x="{where:.1f}" y="{y:.1f}" text-anchor="{anchor}"{style}>{escape(what)}</text>'


def line(x1, y1, x2, y2, colour, **more):
    style = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in more.items())
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"{style}/>'


def box(a, b, y, height, fill):
    return f'<rect x="{x(a):.1f}" y="{y:.1f}" width="{max(x(b) - x(a), 0):.1f}" height="{height:.1f}" fill="{fill}"/>'


def figure(shown, practice, kenney):
    """Practice: design, uniform, no_erosion, tested, continuing_d95, as D15F/D85B but the last, which is by D95B."""
    bases = sorted({cell.base for cell in shown})
    parts, y = [], 128
    for base in bases:
        panel, bottom = draw_panel([cell for cell in shown if cell.base == base], base, y, practice, kenney)
        parts += panel
        y = bottom + 30
    head = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y:.0f}" font-family="sans-serif" font-size="12">',
            f'<rect width="{WIDTH}" height="{y:.0f}" fill="white"/>',
            '<pattern id="arches" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
            f'<rect width="6" height="6" fill="#e3f0e6"/><rect width="2" height="6" fill="{GREEN}"/></pattern>',
            words(20, 26, "How coarse may the filter be? Models against practice and tests", font_size=17),
            words(20, 46, "Boundaries of models, not limits to design by. k/k0: permeability left at the largest walked ratio that holds; "
                  "0: sealed, it does not drain.")]
    return "\n".join(head + legend() + parts + ["</svg>\n"])


def legend():
    first, second = 70, 92
    return [f'<rect x="20" y="{first - 9}" width="26" height="{BAR}" fill="{GREEN}"/>', words(52, first, "no erosion"),
            f'<rect x="130" y="{first - 9}" width="26" height="{BAR}" fill="{AMBER}"/>',
            words(162, first, "some erosion; right of the bar it continues"),
            f'<rect x="424" y="{first - 9}" width="26" height="{BAR}" fill="url(#arches)"/>',
            words(456, first, f"erosion begins in this band with arches: retained as if 1 to {ARCH} times as large"),
            line(20, second - 4, 46, second - 4, DARK, stroke_width=2),
            words(52, second, "ratios at which the loss is 7.5 % give or take one point, where wide; or replicates"),
            words(516, second, "†  fresh base on the clogged filter is lost first"),
            f'<path d="M798 {second - 4}h26m-26 -4v8m26 -8v8" stroke="{PURPLE}" fill="none" stroke-width="1.5"/>',
            words(830, second, "largest particle that passed, Kenney: page")]


def draw_panel(cells, base, top, practice, kenney):
    names = list(dict.fromkeys(cell.name for cell in cells))
    rows_of = {name: rows([cell for cell in cells if cell.name == name]) for name in names}
    start = top + HEAD
    bottom = start + sum(GAP + ROW * len(rows_of[name]) for name in names) + 6
    parts = [words(20, top + 16, f"Base Cu {base:g}", font_size=15, font_weight="bold")]
    parts += references(base, top, start - 2, bottom, practice)
    parts += [words(where, start - 4, what, "middle", font_size=11) for where, what in COLUMNS.items()]
    parts.append(words((910 + 974) / 2, start - 18, "erosion, D15F/D85B", "middle", font_size=11))
    y = start
    for name in names:
        if ends := kenney(FILTERS[name][0], base):
            a, b = map(x, ends)
            parts.append(f'<path d="M{a:.1f} {y + 7}H{b:.1f}M{a:.1f} {y + 3}v8M{b:.1f} {y + 3}v8" stroke="{PURPLE}" fill="none" stroke-width="1.5"/>')
        y += GAP
        parts.append(words(20, y + 11, name, font_weight="bold"))
        for cell, twin in rows_of[name]:
            parts += draw_row(cell, twin, y)
            y += ROW
    for tick in range(math.floor(HIGH) + 1):
        parts += [line(x(tick), bottom, x(tick), bottom + 4, DARK), words(x(tick), bottom + 16, str(tick), "middle", font_size=11)]
    parts += [line(LEFT, bottom, RIGHT, bottom, DARK), words(LEFT - 8, bottom + 16, "D15F/D85B", "end", font_size=11)]
    return parts, bottom


def rows(cells):
    """Cells without arches, each followed by the same with arches where that was walked."""
    alike = lambda cell, other: (cell.model, cell.layers) == (other.model, other.layers)
    found = []
    for cell in (cell for cell in cells if not cell.arches):
        found.append((cell, None))
        found += [(other, cell) for other in cells if cell.whole and other.arches and other.whole and alike(cell, other)]
    return found


def references(base, top, above, below, practice):
    """Rules and tests as lines and a band, with their names over the panel."""
    tested, end = practice["tested"], practice["continuing_d95"] * base**0.2
    first, second, third = top + 16, top + 31, top + 46
    small = dict(font_size=11)
    parts = [box(*tested, above, below - above, "#ece4f4")]
    drawn = [(practice["design"], BLUE, ""), (practice["uniform"], BLUE, "5 3"), (practice["no_erosion"], PURPLE, ""), (end, RED, "6 3")]
    for ratio, colour, dash in drawn:
        parts.append(line(x(ratio), above, x(ratio), below, colour, stroke_width=1.4, **(dict(stroke_dasharray=dash) if dash else {})))
    parts += [words(x(practice["design"]) - 4, third, f"{practice['design']:g} Terzaghi; Sherard & Dunnigan", "end", fill=BLUE, **small),
              words(x(practice["uniform"]) - 4, second, f"{practice['uniform']:g} Sherard et al. 1984", "end", fill=BLUE, **small),
              words(x(practice["no_erosion"]) - 4, first, f"{practice['no_erosion']:g} no erosion, Foster & Fell", "end", fill=PURPLE, **small),
              words(x(tested[0]) + 6, second, f"boundary in tests {tested[0]:g} to {tested[1]:g}", fill=PURPLE, **small),
              words(x(end) - 4, third, f"{practice['continuing_d95']:g} D95B = {end:.1f} continuing, Foster & Fell", "end", fill=RED, **small)]
    return parts


def draw_row(cell, twin, y):
    label = f"{SHOWN[cell.model]}, {cell.layers:,} layers" + (", with arches" if twin else "")
    parts, middle, wide = [words(LEFT - 8, y + 11, label, "end")], y + 7, []
    if not cell.whole:
        reached = min(boundary.below.ratio if boundary.below else 0.0 for boundary in cell.begins)
        halo = dict(stroke="white", stroke_width=4, paint_order="stroke")
        parts += [box(0, reached, y + 2, BAR, GREEN), words(x(reached) + 3, y + 11, "→ not bracketed", font_size=11, **halo)]
        return parts + numbers(cell, y, value(cell.begins, cell.s_ne), value(cell.continues, cell.s_ce))
    if twin:
        parts += [box(0, twin.s_ne, y + 2, BAR, GREEN), box(twin.s_ne, cell.s_ne, y + 2, BAR, "url(#arches)")]
        both = lambda which: f"{down(getattr(twin, which))} to {down(getattr(cell, which))}"
        return parts + numbers(cell, y, both("s_ne"), both("s_ce"))
    parts += [box(0, cell.s_ne, y + 2, BAR, GREEN), box(cell.s_ne, cell.s_ce, y + 2, BAR, AMBER)]
    for found, runs in [(cell.begins, (0, 1)), (cell.continues, (1,))]:
        if flat := cell.flat(runs):
            wide.append((max(flat[0], cell.smallest()), flat[1]))
        elif len(found) > 1:
            wide.append((min(b.value for b in found), max(b.value for b in found)))
    parts += [line(x(a), middle, x(b), middle, DARK, stroke_width=2) for a, b in wide]
    return parts + numbers(cell, y, down(cell.s_ne), down(cell.s_ce))


def numbers(cell, y, begins, continues):
    below = [boundary.below.k[boundary.run] for boundary in cell.begins if boundary.below]
    k = "" if not below or below[0] is None else "0" if max(below) == 0 else f"{max(below):.2f}"
    mark = " †" if cell.second_first else ""
    return [words(where, y + 11, what, "middle", font_size=11) for where, what in zip(COLUMNS, (begins + mark, continues, k))]
