"""The page and the figure of scripts/four_way.py, from its cells and their boundaries."""

import math
import pathlib
import platform
import re
import time

USUAL_MASS_RATIO, ARCH = 0.05, 2.155
# Foster & Fell: frontier of no erosion of a base with less than 15 % fines (tests); Sherard et al.: design.
TESTED, DESIGN, CONTINUING_D95 = (6.8, 10.0), (4.0, 5.0), 9.0
# Largest particle that passes, by D15F: Kenney et al. (1985) by Cu of the filter; Sherard et al. (1984), suspensions.
LARGEST_PASSING = [("Kenney et al. 1985, filter Cu 1.2", 0.167), ("Kenney et al. 1985, filter Cu 3", 0.182),
                   ("Kenney et al. 1985, filter Cu 6", 0.146), ("Sherard et al. 1984, suspensions", 0.11)]
# Eroded in the first run by a prototype (shared/frontier.md): filter Cu 1.5 loose, base Cu 1.5, 60 layers.
EXPECTED = {("lattice, area", 5.5): 60, ("lattice, area", 4.4): 8, ("lattice, flux", 5.5): 93,
            ("lattice, flux", 4.4): 50, ("graph, flux", 5.5): 78, ("graph, flux", 4.4): 28}
# Cu, friction and number of grains of the six filters of the paper's Table 2, fewer grains than there (59,183 at Cu 6).
FILTERS = {
    "Cu 1.5 loose": (1.5, 0.3, 3000),
    "Cu 1.5 dense": (1.5, 0.0, 3000),
    "Cu 3 loose": (3.0, 0.3, 6000),
    "Cu 3 dense": (3.0, 0.0, 6000),
    "Cu 1.2 dense": (1.2, 0.0, 3000),
    "Cu 6 loose": (6.0, 0.7, 8000),
}


def version_of_page(out):
    """The version that walked, as the page names it; None where there is none."""
    page = pathlib.Path(f"{out}.md")
    named = re.search(r"`(voidwalk [^`]*)`", page.read_text()) if page.exists() else None
    return named and named.group(1)


def write_page(out, plan, found, refused, rows, version, come_and_go):
    done = [cell for cell in plan if len(found.get(cell, [])) == cell[5]]
    part = [cell for cell in plan if 0 < len(found.get(cell, [])) < cell[5]]
    shown = sorted((cell for cell in plan if found.get(cell)), key=order)
    cpu = sum(float(row["cpu_seconds"]) for row in rows)
    text = [f"# How coarse may the filter be: models beside tests ({time.strftime('%Y-%m-%d')})\n", *practice_first(found, shown), "",
            "D15F/D85B up to which a model's filter holds its base: **no erosion** while less than 7.5 % of the base's mass is lost in the first run, **some**",
            "erosion while the second loses less than 7.5 %, continuing beyond. A replicate is a packing of its own with a seed of its own. Where a cell has more",
            "than one, its number is the median, with the smallest and the largest in brackets; one replicate has no interval, and says nothing of scatter.",
            f"`{version}`, {platform.machine()}; {len(rows)} walks, {cpu / 60:.1f} minutes of processor time (one or two threads, on a machine shared with",
            f"other work); made by `scripts/four_way.py`, every walk in `{pathlib.Path(out).name}.csv`. Figure: `{pathlib.Path(out).name}.svg`.\n",
            f"**{len(done)} of the {len(plan)} cells of the plan were run**, those named below were not. Models with a boundary here: "
            f"{'; '.join(sorted({cell[1] for cell in shown}))}.\n",
            "| filter | Cu of the base | model | layers | no erosion up to | some erosion up to | replicates |", "|---|---|---|---|---|---|---|"]
    for cell in shown:
        name, model, base, layers, mass_ratio, _ = cell
        first, second = (interval(values) for values in boundaries(cell, found))
        text.append(f"| {name} | {base:g} | {model}{note(mass_ratio)} | {layers} | {first} | {second} | {len(found[cell])} |")
    walked = sorted({cell[0] for cell in shown})
    text += ["", "`> x`: the largest ratio walked holds; `< x`: the smallest loses more. Layers are as thick as D50F by number; the voids of a packing reach as",
             "far in mm, rounded up to whole copies of the cell. Lattices are 20 x 20 voids wide with the packing's measured constrictions and its own grains",
             f"per void; grains of the packings: {', '.join(f'{name} {FILTERS[name][2]:,}' for name in walked)}.", "",
             "| tests and practice, base with less than 15 % fines | D15F/D85B |", "|---|---|",
             f"| Foster & Fell (2001), frontier of no erosion in tests | {TESTED[0]} to {TESTED[1]:g} |",
             f"| Sherard et al. (1984), design: conservative, not excessively | {DESIGN[0]:g} to {DESIGN[1]:g} |"]
    text += [f"| Foster & Fell, continuing erosion from D15F = 9 D95B, linear base of Cu {cu:g} | {CONTINUING_D95 * cu**0.2:.1f} |"
             for cu in sorted({cell[2] for cell in shown})]
    text += [f"| largest particle that passes: {name}, {share:g} D15F | {1 / share:.1f} (of that particle) |" for name, share in LARGEST_PASSING]
    text += ["", *explained(found, shown), ""] + expected(rows) + moved(found, shown)
    text += ["", f"**Erosion that comes and goes**: {come_and_go} of {sum(len(found[c]) for c in shown)} replicates walked a larger ratio that holds above one that does",
             "not, in either run; the smallest that does not is the boundary then. That is no proof that there is none: each replicate was walked at a few",
             "rungs of 6 %, close together only at its boundary, and such a ladder would hardly see erosion that comes and goes between two of them.", "", "## Not run", ""]
    text += [f"{len(done)} of {len(plan)} cells of the plan are whole, {len(part)} in part. Not run, or not to the end:", ""]
    text += [f"- {name}, base Cu {base:g}, {model}, {layers} layers{note(mass)}" + (f": {refused[cell]}" if (cell := (name, model, base, layers, mass, n)) in refused else "")
             for name, model, base, layers, mass, n in plan if (name, model, base, layers, mass, n) not in done]
    pathlib.Path(f"{out}.md").write_text("\n".join(text) + "\n")
    pathlib.Path(f"{out}.svg").write_text(figure([cell for cell in shown if cell[2] == 1.5], found))


def boundaries(cell, found):
    """First and second boundaries of the replicates, by the size that particles are retained at."""
    factor = 1.0 if cell[4] == USUAL_MASS_RATIO else ARCH
    return [[factor * pair[run] for pair in found[cell]] for run in (0, 1)]


def counted(number, what="replicate"):
    return f"{number} {what}{'' if number == 1 else 's'}"


def practice_first(found, shown):
    above = sum(median(boundaries(cell, found)[0]) > DESIGN[0] for cell in shown)
    return ["**Practice goes first. These are boundaries of models, not limits to design by.** A ratio that a model holds is not allowed by it: rules of retention for",
            f"filters decide, and {above} of the {len(shown)} boundaries of no erosion below lie above {DESIGN[0]:g}, the careful end of design by Sherard et al. (1984). The models have no",
            "cohesion, no shapes and no forces on particles."]


def said(cell, found):
    """The boundary of no erosion of a cell, and from how many replicates."""
    return f"{interval(boundaries(cell, found)[0])} ({counted(len(found[cell]))})"


def explained(found, shown):
    """What the cells that were walked say of sieving, density, water and arches, each only where it was walked."""
    where = lambda cell: f"{cell[0]}, base Cu {cell[2]:g}, {cell[3]} layers"
    usual = [cell for cell in shown if cell[4] == USUAL_MASS_RATIO]
    beside = lambda cell, **other: next((c for c in usual if c[:5] == (other.get("name", cell[0]), other.get("model", cell[1]), *cell[2:5])), None)
    lines = ["**What these cells say, and what not.**", ""]
    area = [cell for cell in usual if cell[1] == "lattice, area"]
    if area:
        medians = [median(boundaries(cell, found)[0]) for cell in area]
        within = sum(DESIGN[0] <= value <= DESIGN[1] for value in medians)
        lines += [f"- Sieving alone, on the paper's lattice by area ({counted(len(area), 'cell')}, {counted(sum(len(found[c]) for c in area))}): no erosion up to {interval([min(medians)])} to {interval([max(medians)])};"
                  f" {within} lie within Sherard's {DESIGN[0]:g} to {DESIGN[1]:g}. That is no proof of the model: water, arches and shapes are left out of it."]
    for cell in usual:
        if "dense" in cell[0] and (loose := beside(cell, name=cell[0].replace("dense", "loose"))):
            lines += [f"- Density, {where(cell)}, {cell[1]}: {said(cell, found)}; loose {said(loose, found)}."
                      + (" One dense packing: whether a dense filter holds coarser ratios in general is not shown." if len(found[cell]) == 1 else "")]
    for cell in usual:
        if cell[1] == "graph, flux" and (lattice := beside(cell, model="lattice, area")):
            lines += [f"- Water in the packing's own voids, {where(cell)}: {said(cell, found)}, where the lattice by area has {said(lattice, found)}."
                      f" {counted(len(found[cell]), 'packing')} of {FILTERS[cell[0]][2]:,} grains; and the network is another, too, so that it is not the water's effect alone."
                      " Why was not measured here."]
    for cell in usual:
        first, second = map(median, boundaries(cell, found))
        if second < first:
            lines += [f"- {where(cell)}, {cell[1]}: the second run fails earlier ({interval([second])}) than the first ({interval([first])};"
                      f" {counted(len(found[cell]))}): between the two the first loses less than 7.5 % and the second more. Both are interpolated between walks some 3 % apart."]
    arches = [cell for cell in shown if cell[4] != USUAL_MASS_RATIO]
    if arches:
        lines += [f"- An arch of three is a bound on arches only: a particle is retained as if at most {ARCH} times as large ({counted(len(arches), 'cell')})."]
    firsts = [value for cell in usual for value in boundaries(cell, found)[0]]
    if firsts and max(firsts) < TESTED[0]:
        lines += [f"- Filters in tests hold at {TESTED[0]} to {TESTED[1]:g}, above every boundary here but those of an arch. Grains that are no spheres, arches of several particles, deposition, and a base that"
                  " is carried as a mass and not one particle after another could hold more; they are in none of these walks, cannot be told from each other by this study, and none is put in to meet a table."]
    return lines


def note(mass_ratio):
    """What is said of cells with a base that stands for one retained as if larger."""
    return "" if mass_ratio == USUAL_MASS_RATIO else f", retained as if {ARCH} times as large"


def order(cell):
    name, model, base, layers, mass_ratio, _ = cell
    return base, name, mass_ratio, layers, model


def interval(values):
    show = lambda v: "> 15.5" if v == math.inf else "< 1" if v == 0 else f"{v:.2f}"
    ranked = sorted(values)
    if len(ranked) == 1:
        return show(ranked[0])
    return f"{show(median(ranked))} ({show(ranked[0])} to {show(ranked[-1])})"


def median(values):
    ranked = sorted(values)
    middle = len(ranked) // 2
    return ranked[middle] if len(ranked) % 2 else 0.5 * (ranked[middle - 1] + ranked[middle])


def expected(rows):
    """The erosion that a prototype had beside that of these walks."""
    lines = ["**Beside \"What to expect\"** (a prototype; filter Cu 1.5 loose, base Cu 1.5, 60 layers, mass eroded in the first run):", "",
             "| model | D15F/D85B | expected | here |", "|---|---|---|---|"]
    for (model, ratio), percent in EXPECTED.items():
        here = [100 * float(row["eroded_1"]) for row in rows if row["filter"] == "Cu 1.5 loose" and row["model"] == model and row["base_cu"] == "1.5"
                and row["layers"] == "60" and float(row["mass_ratio"]) == USUAL_MASS_RATIO and abs(float(row["ratio"]) - ratio) < 1e-6]
        lines.append(f"| {model} | {ratio:g} | {percent} % | {', '.join(f'{v:.1f} %' for v in here) or 'not run'} |")
    return lines + [""]


def moved(found, shown):
    """How thickness moves the boundary of no erosion, in words."""
    lines = []
    for name in sorted({cell[0] for cell in shown}):
        for model in sorted({cell[1] for cell in shown if cell[0] == name}):
            by_layers = {cell[3]: cell for cell in shown if cell[:3] == (name, model, 1.5) and cell[4] == USUAL_MASS_RATIO}
            if len(by_layers) > 1:
                steps = ", ".join(f"{layers} layers up to {said(cell, found)}" for layers, cell in sorted(by_layers.items()))
                lines.append(f"- {name}, {model}: no erosion at {steps}.")
    return (["**Thickness**, base Cu 1.5:", ""] + lines) if lines else []


def figure(cells, found):
    """Each cell as a bar: green up to the first boundary, amber to the second, red beyond, with its replicates; tests as bands behind."""
    left, right, row, top = 330, 1010, 22, 74
    low, high = 0.0, 15.0
    x = lambda ratio: left + (min(max(ratio, low), high) - low) / (high - low) * (right - left)
    groups = list(dict.fromkeys(cell[0] for cell in cells))
    height = top + row * len(cells) + 30 * len(groups) + 70
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1040 {height}" font-family="sans-serif" font-size="12">',
             f'<rect width="1040" height="{height}" fill="white"/>',
             '<text x="20" y="26" font-size="16">How coarse may the filter be? Boundaries of models, not limits to design by; base Cu 1.5</text>',
             '<pattern id="earlier" width="2" height="2" patternUnits="userSpaceOnUse"><rect width="2" height="2" fill="#c9665f"/><rect width="1" height="2" fill="black"/></pattern>']
    bottom = height - 58
    for name, (a, b), colour, y in [("design rules (Sherard)", DESIGN, "#dfe6f2", 46), ("tests of sands hold up to here (Foster &amp; Fell)", TESTED, "#e7e0ef", 62)]:
        parts.append(f'<rect x="{x(a):.1f}" y="{top - 6}" width="{x(b) - x(a):.1f}" height="{bottom - top + 6}" fill="{colour}"/>')
        parts.append(f'<text x="{(x(a) + x(b)) / 2:.1f}" y="{y}" text-anchor="middle">{name}</text>')
    y = top
    for group in groups:
        parts.append(f'<text x="20" y="{y + 18}" font-weight="bold">Filter {group}</text>')
        y += 28
        for cell in (cell for cell in cells if cell[0] == group):
            arches = "" if cell[4] == USUAL_MASS_RATIO else ", arches of three"
            runs = [[min(value, high) for value in values] for values in boundaries(cell, found)]
            first, second = map(median, runs)
            parts.append(f'<text x="{left - 8}" y="{y + 12}" text-anchor="end">{cell[1]}, {cell[3]} layers{arches}</text>')
            # Where the second run fails earlier than the first, the part between the two is striped.
            between = "#e0b040" if first <= second else "url(#earlier)"
            for a, b, colour in [(low, min(first, second), "#5aa469"), (min(first, second), max(first, second), between), (max(first, second), high, "#c9665f")]:
                parts.append(f'<rect x="{x(a):.1f}" y="{y + 2}" width="{x(b) - x(a):.1f}" height="12" fill="{colour}"/>')
            words = counted(len(found[cell]))
            if second < first:
                words = f"second run fails earlier ({second:.2f}) than the first ({first:.2f}); {words}"
            parts.append(f'<text x="{right - 6}" y="{y + 12}" text-anchor="end" font-size="11">{words}</text>')
            if len(found[cell]) > 1:
                a, b = x(min(runs[0])), x(max(runs[0]))
                parts.append(f'<path d="M{a:.1f} {y + 8}H{b:.1f}M{a:.1f} {y + 4}v8M{b:.1f} {y + 4}v8" stroke="black" fill="none"/>')
            y += row
    for tick in range(math.ceil(low), math.floor(high) + 1):
        parts.append(f'<line x1="{x(tick):.1f}" y1="{top - 6}" x2="{x(tick):.1f}" y2="{bottom}" stroke="#0002"/>')
        parts.append(f'<text x="{x(tick):.1f}" y="{bottom + 16}" text-anchor="middle">{tick}</text>')
    parts.append(f'<text x="{(left + right) / 2}" y="{bottom + 34}" text-anchor="middle">D15F / D85B: green no erosion, amber some, red continuing</text>')
    stripes = "; black stripes: the second run fails before the first" if any("url(#earlier)" in part for part in parts) else ""
    parts.append(f'<text x="520" y="{bottom + 50}" text-anchor="middle">black mark: range over replicates; one replicate has no interval{stripes}</text>')
    return "\n".join(parts + ["</svg>\n"])
