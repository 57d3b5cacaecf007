"""The page and the figure of scripts/four_way.py, from its cells and their boundaries."""

import math
import pathlib
import platform
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
EXPLAINED = """**What spheres, sieving and water explain, and what not.** A filter of spheres that only sieves, on the paper's lattice by area, has
its boundary where design rules have theirs, and a thicker or a denser filter holds coarser ratios. Let water choose the way, and the boundary moves far to
the fine side: water leads particles to the wide constrictions, those are the ones that nothing of the base blocks, and what is blocked is bypassed.
Filters in tests hold at ratios of 6.8 to 10, so what is missing in the model with water is what holds particles *although* they fit: grains that are no
spheres, arches of several particles, deposition, and a base that is carried there as a mass and not one particle after another. An arch of three
is a bound on the second only: a particle is retained as if at most 2.155 times as large. None of these can be told from the others by this
study, and none is put in to meet a table. That the lattice by area lies near the design rules is no proof of it: it leaves out water, which would lower its
boundary, and arches and shapes, which would raise it."""


def write_page(out, plan, found, refused, rows, version, come_and_go):
    done = [cell for cell in plan if len(found.get(cell, [])) == cell[5]]
    part = [cell for cell in plan if 0 < len(found.get(cell, [])) < cell[5]]
    shown = [cell for cell in plan if found.get(cell)]
    cpu = sum(float(row["cpu_seconds"]) for row in rows)
    text = [f"# How coarse may the filter be: four models beside tests ({time.strftime('%Y-%m-%d')})\n",
            "D15F/D85B up to which a filter holds its base: **no erosion** while less than 7.5 % of the base's mass is lost in the first run, **some**",
            "erosion while the second loses less than 7.5 %, continuing beyond. Each number is the median over replicates, with the smallest and the largest",
            "in brackets; a replicate is a packing of its own with a seed of its own, so that the interval holds the scatter between packings as well as",
            f"that of the walk. `{version}`, {platform.machine()}; {len(rows)} walks, {cpu / 60:.1f} minutes of processor time (one thread, on a machine shared with",
            f"other work); made by `scripts/four_way.py`, every walk in `{pathlib.Path(out).name}.csv`. Figure: `{pathlib.Path(out).name}.svg`.\n",
            f"**{len(done)} of the {len(plan)} cells of the plan were run**, those named below were not; a cell with one replicate has no interval.\n",
            "| filter | Cu of the base | model | layers | no erosion up to | some erosion up to | replicates |", "|---|---|---|---|---|---|---|"]
    for cell in sorted(shown, key=order):
        name, model, base, layers, mass_ratio, _ = cell
        factor = 1.0 if mass_ratio == USUAL_MASS_RATIO else ARCH
        first, second = (interval([factor * pair[run] for pair in found[cell]]) for run in (0, 1))
        text.append(f"| {name} | {base:g} | {model}{note(mass_ratio)} | {layers} | {first} | {second} | {len(found[cell])} |")
    text += ["", "`> x`: the largest ratio walked holds; `< x`: the smallest loses more. Layers are as thick as D50F by number; the voids of a packing reach as",
             "far in mm, rounded up to whole copies of the cell. Lattices are 20 x 20 voids wide with the packing's measured constrictions and its own grains",
             "per void; packings have 3,000 (Cu 1.2, 1.5), 6,000 (Cu 3) and 8,000 grains (Cu 6: the paper's 59,183 were not affordable here).", "",
             "| tests and practice, base with less than 15 % fines | D15F/D85B |", "|---|---|",
             f"| Foster & Fell (2001), frontier of no erosion in tests | {TESTED[0]} to {TESTED[1]:g} |",
             f"| Sherard et al. (1984), design: conservative, not excessively | {DESIGN[0]:g} to {DESIGN[1]:g} |"]
    text += [f"| Foster & Fell, continuing erosion from D15F = 9 D95B, linear base of Cu {cu:g} | {CONTINUING_D95 * cu**0.2:.1f} |" for cu in (1.5, 3.0, 4.5)]
    text += [f"| largest particle that passes: {name}, {share:g} D15F | {1 / share:.1f} (of that particle) |" for name, share in LARGEST_PASSING]
    text += ["", EXPLAINED, ""] + expected(rows) + moved(found, shown)
    text += ["", f"**Erosion that comes and goes**: {come_and_go} of {sum(len(found[c]) for c in shown)} replicates walked a larger ratio that holds above one that does",
             "not, in either run; the smallest that does not is the boundary then. Where the second boundary is below the first, the second run loses more than the first.", "", "## Not run", ""]
    text += [f"{len(done)} of {len(plan)} cells of the plan are whole, {len(part)} in part. Not run, or not to the end:", ""]
    text += [f"- {name}, base Cu {base:g}, {model}, {layers} layers{note(mass)}" + (f": {refused[cell]}" if (cell := (name, model, base, layers, mass, n)) in refused else "")
             for name, model, base, layers, mass, n in plan if (name, model, base, layers, mass, n) not in done]
    pathlib.Path(f"{out}.md").write_text("\n".join(text) + "\n")
    pathlib.Path(f"{out}.svg").write_text(figure([cell for cell in sorted(shown, key=order) if cell[2] == 1.5], found))


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
    """How thickness and water move the boundary of no erosion, in words."""
    lines = []
    for name in sorted({cell[0] for cell in shown}):
        for model in sorted({cell[1] for cell in shown if cell[0] == name}):
            by_layers = {cell[3]: median([pair[0] for pair in found[cell]]) for cell in shown
                         if cell[:3] == (name, model, 1.5) and cell[4] == USUAL_MASS_RATIO}
            if len(by_layers) > 1 and all(0 < v < math.inf for v in by_layers.values()):
                steps = ", ".join(f"{v:.2f} at {layers} layers" for layers, v in sorted(by_layers.items()))
                lines.append(f"- {name}, {model}: no erosion up to {steps}.")
    return (["**Thickness**, base Cu 1.5:", ""] + lines) if lines else []


def figure(cells, found):
    """Each cell as a bar: green up to the first boundary, amber to the second, red beyond; tests as bands behind."""
    left, right, row, top = 330, 1010, 22, 74
    low, high = 0.0, 15.0
    x = lambda ratio: left + (min(max(ratio, low), high) - low) / (high - low) * (right - left)
    groups = list(dict.fromkeys(cell[0] for cell in cells))
    height = top + row * len(cells) + 30 * len(groups) + 70
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1040 {height}" font-family="sans-serif" font-size="12">',
             f'<rect width="1040" height="{height}" fill="white"/>',
             '<text x="20" y="26" font-size="16">How coarse may the filter be? Base with Cu 1.5</text>']
    bottom = height - 58
    for name, (a, b), colour, y in [("design rules (Sherard)", DESIGN, "#dfe6f2", 46), ("tests of sands hold up to here (Foster &amp; Fell)", TESTED, "#e7e0ef", 62)]:
        parts.append(f'<rect x="{x(a):.1f}" y="{top - 6}" width="{x(b) - x(a):.1f}" height="{bottom - top + 6}" fill="{colour}"/>')
        parts.append(f'<text x="{(x(a) + x(b)) / 2:.1f}" y="{y}" text-anchor="middle">{name}</text>')
    y = top
    for group in groups:
        parts.append(f'<text x="20" y="{y + 18}" font-weight="bold">Filter {group}</text>')
        y += 28
        for cell in (cell for cell in cells if cell[0] == group):
            factor, arches = (1.0, "") if cell[4] == USUAL_MASS_RATIO else (ARCH, ", arches of three")
            runs = [[factor * min(pair[run], high) for pair in found[cell]] for run in (0, 1)]
            first, second = median(runs[0]), max(median(runs[0]), median(runs[1]))
            parts.append(f'<text x="{left - 8}" y="{y + 12}" text-anchor="end">{cell[1]}, {cell[3]} layers{arches}</text>')
            for a, b, colour in [(low, first, "#5aa469"), (first, second, "#e0b040"), (second, high, "#c9665f")]:
                parts.append(f'<rect x="{x(a):.1f}" y="{y + 2}" width="{max(0, x(b) - x(a)):.1f}" height="12" fill="{colour}"/>')
            a, b = x(min(runs[0])), x(max(runs[0]))
            parts.append(f'<path d="M{a:.1f} {y + 8}H{b:.1f}M{a:.1f} {y + 4}v8M{b:.1f} {y + 4}v8" stroke="black" fill="none"/>')
            y += row
    for tick in range(math.ceil(low), math.floor(high) + 1):
        parts.append(f'<line x1="{x(tick):.1f}" y1="{top - 6}" x2="{x(tick):.1f}" y2="{bottom}" stroke="#0002"/>')
        parts.append(f'<text x="{x(tick):.1f}" y="{bottom + 16}" text-anchor="middle">{tick}</text>')
    parts.append(f'<text x="{(left + right) / 2}" y="{bottom + 34}" text-anchor="middle">D15F / D85B: green no erosion, amber some, red continuing;'
                 ' the black mark is the range over replicates</text>')
    return "\n".join(parts + ["</svg>\n"])
