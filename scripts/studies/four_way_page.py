"""The page of scripts/studies/four_way.py: every number comes from the csv, and a sentence that does not hold for it is left out."""

import csv
import math
import pathlib
import re

from four_way_beside import ARCHED, PRACTICE, SUSPENDED, beside_practice, expected, kenney
from four_way_cells import ARCH, BY_NAME, FILTERS, MODELS, SHOWN, THRESHOLD, USUAL_MASS_RATIO, cells_of, come_and_go
from four_way_cells import alike, cannot_be_told, pairs
from four_way_figure import figure
from four_way_words import bullet, counted, down, factors, listed, paragraph, span, value

# Grains of the paper's packings (Table 2), by Cu of the filter.
TABLE_2 = {1.2: 8262, 1.5: 9313, 3.0: 22600, 6.0: 59183}


def version_of_page(out):
    """The versions that walked and their machine, as the page names them; None where there is no page."""
    page = pathlib.Path(f"{out}.md")
    words = " ".join(page.read_text().split()) if page.exists() else ""
    named = re.search(r"`voidwalk [^;]*(?=; \d+ walks, )", words)
    return named and named.group()


def date_of_page(out):
    """The date of the walks, as the page names it; None where there is no page."""
    page = pathlib.Path(f"{out}.md")
    named = page.exists() and re.match(r"# .*\((\d{4}-\d\d-\d\d)\)", page.read_text())
    return named and named[1]


def write_page(out, plan, rows, refused, version, date):
    cells = cells_of(plan, rows)
    shown = [cell for cell in cells if cell.walks]
    usual = [cell for cell in shown if cell.whole and not cell.arches]
    name = pathlib.Path(out).name
    text = [f"# How coarse may the filter be: models against practice and tests ({date})", ""]
    text += [paragraph(words) for words in (practice_first(shown), sealed(rows), explained(shown, usual)) if words]
    text += [f"![Boundaries of models against practice and tests]({name}.svg)\n"]
    text += [*how_to_read(shown, name), *beside_practice(shown, usual), *expected(rows, usual), *time_taken(name, rows, version, shown)]
    text += not_run(cells, refused)
    write_cells(pathlib.Path(f"{out}-cells.csv"), shown)
    pathlib.Path(f"{out}.md").write_text("\n".join(text).rstrip("\n") + "\n")
    pathlib.Path(f"{out}.svg").write_text(figure(shown, PRACTICE, kenney))


def practice_first(shown):
    found = [cell for cell in shown if cell.s_ne < math.inf]
    above = sum(cell.s_ne > PRACTICE["design"] for cell in found)
    marked = [cell for cell in shown if cell.second_first]
    words = (f"**Practice goes first. These are boundaries of models, not design limits.** {above} of the {len(found)} boundaries of no erosion below "
             f"lie above {PRACTICE['design']:g}, the limit of design. The models have no cohesion, no particle shapes and no forces on particles.")
    if marked:
        passed = [walk for cell in shown for walks in cell.walks.values() for walk in walks if walk.lost[0] < THRESHOLD <= walk.lost[1]]
        worst = max(passed, key=lambda walk: walk.lost[1], default=None)
        words += (f" In {len(marked)} cells the second run (fresh base on the clogged filter) erodes at a smaller ratio than the first; that smaller "
                  "ratio counts.")
        if worst:
            words += (f" The program's verdict follows the first run and reads \"no erosion\" in the {counted(len(passed), 'walk')} between; at worst "
                      f"the first run lost {100 * worst.lost[0]:.1f} % and the second {100 * worst.lost[1]:.1f} %.")
    return words


def sealed(rows):
    """What holds with flow is mostly sealed."""
    flow = [row for row in rows if row["k_over_k0_1"]]
    lost = lambda row, run: float(row[f"eroded_{run}"])
    holds = [row for row in flow if lost(row, 1) < THRESHOLD]
    closed = [row for row in holds if float(row["k_over_k0_1"]) == 0.0]
    some = [row for row in flow if lost(row, 1) >= THRESHOLD > lost(row, 2)]
    closed_later = [row for row in some if float(row["k_over_k0_2"]) == 0.0]
    if not closed:
        return ""
    often = "mostly" if 2 * len(closed) > len(holds) else "often"
    words = (f"**With flow, \"holds\" {often} means \"sealed\", and a sealed filter does not drain.** k/k0 is the permeability at the end of a run "
             f"over that of the clean filter. Of {len(holds)} walks with flow whose first run loses less than 7.5 %, {len(closed)} end with k/k0 = "
             "0.0000: base that can no longer enter counts as held.")
    if closed_later:
        which = "All" if len(closed_later) == len(some) else f"{len(closed_later)} of"
        words += (f" {which} {counted(len(some), 'walk')} of \"some erosion\" end the second run with k/k0 = 0.0000, after the first lost up to "
                  f"{100 * max(lost(row, 1) for row in closed_later):.0f} %.")
    return words


def explained(shown, usual):
    """The one paragraph: what spheres, sieving and flow explain, and what not; each sentence where its cells were walked."""
    design, uniform, tested = PRACTICE["design"], PRACTICE["uniform"], PRACTICE["tested"]
    several = sum(len(cell.walks) > 1 for cell in usual)
    says = ["**What spheres, sieving and flow explain.** (Cells have one replicate" + (f", except {several}.)" if several else ".)")]
    area = [cell.s_ne for cell in usual if cell.model == "lattice, area"]
    if area:
        below, above = sum(value < design for value in area), sum(value > uniform for value in area)
        says.append(f"Sieving of spheres alone (lattice, area; {len(area)} cells): erosion begins at D15F/D85B {span(area)}, {below} below "
                    f"{design:g}, {len(area) - below - above} from {design:g} to {uniform:g} (the limits of Terzaghi and of Sherard et al.), {above} "
                    "above.")
    dense = pairs(usual, lambda c: "dense" in c.name, name=lambda c: c.name.replace("dense", "loose"))
    if dense:
        found = [cell.s_ne / twin.s_ne for cell, twin in dense]
        unsure = sum(cannot_be_told(cell, twin) for cell, twin in dense)
        says.append(f"Dense filters hold coarser ratios than loose ones in {sum(value > 1 for value in found)} of {len(dense)} pairs (s_NE x "
                    f"{factors(found)}"
                    + (f"; {unsure} within a flat range of the loss)." if unsure else ")."))
    thick = pairs(usual, lambda c: c.layers == 600, layers=60)
    if thick:
        says.append(f"600 layers instead of 60, with ten times the base, change s_NE x {factors([c.s_ne / t.s_ne for c, t in thick])} ({len(thick)} pairs).")
    flow = pairs(usual, lambda c: c.model == "lattice, flux", model="lattice, area")
    if flow:
        begins = {base: factors([c.s_ne / t.s_ne for c, t in flow if c.base == base]) for base in sorted({c.base for c, _ in flow})}
        by_base = listed(f"{found} for base Cu {base:g}" for base, found in begins.items())
        continues = [c.s_ce / t.s_ce for c, t in flow]
        says.append(f"Water, on the same lattice ({len(flow)} pairs of flow and area), changes s_NE x {by_base}, and s_CE x {factors(continues)}"
                    + (" in every pair." if max(continues) < 1 else "."))
    network = pairs(usual, lambda c: c.model == "graph, flux", model="lattice, flux")
    if network:
        says.append("The packing's own voids instead of the lattice, with flow, change s_NE x "
                    f"{factors([c.s_ne / t.s_ne for c, t in network])} ({len(network)} pairs).")
    if usual and max(cell.s_ne for cell in usual) < tested[0]:
        says.append(f"None of the {len(usual)} bracketed cells without arches reaches the {tested[0]:g} to {tested[1]:g} of tests.")
    says.append("Particle shapes, arches, deposition, forces, cohesion and mass transport are in none of them. They could make a filter hold more or "
                "less, and this study cannot separate them.")
    narrow = [0.154701 / cu**0.3 for cu, _, _ in FILTERS.values() if cu < 2]
    if min(narrow) > SUSPENDED:
        says.append(f"Uniform sand filters stopped suspended particles of about {SUSPENDED:g} D15F (Sherard et al. 1984). Three touching grains of the "
                    f"uniform filters here leave at least {span(narrow, '{:.3f}'.format)} D15F, so sieving by spheres cannot do that.")
    arches = [(cell, twin) for cell in shown if cell.arches and cell.whole and (twin := alike(usual, cell))]
    if arches:
        bands = "; ".join(f"{SHOWN[cell.model]}: s_NE {down(twin.s_ne)} to {down(cell.s_ne)}" for cell, twin in arches)
        says.append(f"Arches enter as a bound: particles retained as if up to {ARCH} times as large (an arch of three) give a band ({bands}).")
        beyond = [SHOWN[cell.model] for cell, _ in arches if cell.s_ne > PRACTICE["continuing_d95"] * cell.base**0.2]
        if beyond:
            says.append(f"Its upper end for {listed(beyond)} lies beyond 9 D95B, where Foster & Fell place continuing erosion.")
    return " ".join(says)


def how_to_read(shown, name):
    several, layers = [cell for cell in shown if len(cell.walks) > 1], sorted({cell.layers for cell in shown})
    flat = [cell for cell in shown if cell.flat((0, 1)) or cell.flat((1,))]
    lines = ["## How to read it", "",
             bullet("**s_NE**: the smallest D15F/D85B at which either run loses 7.5 % of the base's mass. **s_CE**: the smallest at which the second "
                    "run does. \"Some erosion\" lies between."),
             bullet("Lattice: 20 x 20 voids wide, with the constrictions of the packing. Graph: the packing's own voids and constrictions. Area: a "
                    "particle takes an exit in proportion to its area (on the graph, among those down the pressure). Flow: in proportion to the "
                    "water, solved as the filter clogs."),
             bullet(f"{len(shown) - len(several)} of the {len(shown)} cells have one replicate: **no interval, and their scatter is unknown**. They "
                    f"have one decimal, rounded down. `{name}-cells.csv` has the two walked ratios around each boundary."
                    + (f" {counted(len(several), 'cell')} has more: the median." if several else ""))]
    if flat:
        lines.append(bullet("Flat: the loss stays within one percentage point of 7.5 % over a range of ratios wider than 0.3 "
                            f"({counted(len(flat), 'cell')}). The boundary is then known only to that range."))
    thickest = max(layers, default=60)
    lines.append(bullet(f"**The base has {100 * USUAL_MASS_RATIO:g} % of the filter's mass, so it grows with the thickness**: at {thickest:,} layers "
                        f"7.5 % of it is {thickest / 60:g} times the mass at 60. How much of the rise of s_NE with thickness this causes was not "
                        "measured. **Practice gives thickness no credit.**"))
    lines += unlike(shown)
    grains = {FILTERS[name][0]: FILTERS[name][2] for name in BY_NAME}
    if any(grains[cu] < TABLE_2[cu] for cu in grains):
        lines.append(bullet("The packings are smaller than those of the paper's Table 2: "
                            + listed(f"{grains[cu]:,} grains for {TABLE_2[cu]:,} (Cu {cu:g})" for cu in sorted(grains)) + "."))
    if any(cell.arches for cell in shown):
        lines.append(bullet(f"Arches: {ARCHED}, at the same number of particles."))
    goes, replicates = come_and_go(shown)
    lines.append(bullet(f"In {goes} of {replicates} replicates a larger walked ratio holds above one that does not. Ratios are some 6 % apart except "
                        "at boundaries."))
    return lines + [""]


def unlike(shown):
    """Thickness in layers is not like for like, and thick graphs repeat one packing."""
    graphs = [cell for cell in shown if cell.model == "graph, flux" and not cell.arches]
    lines, apart = [], {}
    for cell in graphs:
        twin = alike(shown, cell, model="lattice, flux") or alike(shown, cell, model="lattice, area")
        if twin and cell.mm / twin.mm > 1.15:
            apart[cell.name, cell.layers] = f"{cell.mm / twin.mm:.2f} times for {cell.name}"
    if apart:
        lines.append(bullet("A packing is repeated whole, so a graph may be thicker than its lattice of as many layers: "
                            f"{listed(apart.values())}."))
    thick = [(cell, twin) for cell in graphs if cell.layers > 60 and (twin := alike(shown, cell, layers=60))]
    if thick:
        times = span([cell.voids / twin.voids for cell, twin in thick], "{:.3g}".format)
        lines.append(bullet(f"Graphs of {listed(f'{n:,}' for n in sorted({c.layers for c, _ in thick}))} layers repeat the voids of 60 layers {times} "
                            "times: they are no larger sample."))
    return lines


def write_cells(path, shown):
    """Every cell: its boundaries, the walked ratios around them, and k/k0 at these, at the end of the run that fails there."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["filter", "base_cu", "model", "layers", "thickness_mm", "s_ne", "s_ne_walked", "s_ne_k_over_k0", "s_ce", "s_ce_walked",
                         "s_ce_k_over_k0", "notes"])
        for cell in shown:
            model = SHOWN[cell.model] + (", arches" if cell.arches else "")
            boundaries = [part for found, middle in [(cell.begins, cell.s_ne), (cell.continues, cell.s_ce)]
                          for part in (value(found, middle), walked(found), permeability(found))]
            writer.writerow([cell.name, f"{cell.base:g}", model, cell.layers, f"{cell.mm:.1f}", *boundaries, notes(cell)])


def walked(found):
    below = min((b.below.ratio for b in found if b.below), default=None)
    above = max((b.above.ratio for b in found if b.above), default=None)
    return ", ".join("none" if ratio is None else f"{ratio:.2f}" for ratio in (below, above))


def permeability(found):
    values = [walk.k[b.run] for b in found for walk in (b.below, b.above) if walk and walk.k[b.run] is not None]
    return ", ".join(dict.fromkeys("0" if k == 0 else f"{k:.3f}" for k in values))


def notes(cell):
    words = []
    if not cell.whole:
        largest = max((walks[-1] for walks in cell.walks.values()), key=lambda walk: walk.ratio)
        words.append(f"not bracketed: at {largest.ratio:.2f} the runs lose {100 * largest.lost[0]:.1f} and {100 * largest.lost[1]:.1f} %")
    if cell.second_first:
        later = f"the first at {down(cell.run1)}" if down(cell.run1) != down(cell.s_ne) else "by less than 0.1"
        words.append(f"second run first, {later}")
    if len(cell.walks) > 1 and cell.whole:
        each = lambda found: " to ".join(f"{end(boundary.value for boundary in found):.2f}" for end in (min, max))
        words.append(f"{len(cell.walks)} replicates: s_NE {each(cell.begins)}, s_CE {each(cell.continues)}")
    for what, runs in [("s_NE", (0, 1)), ("s_CE", (1,))]:
        if flat := cell.flat(runs):
            low = f"{cell.smallest():.1f} or less" if flat[0] == 0 else f"{flat[0]:.1f}"
            words.append(f"flat: {what} {low} to {flat[1]:.1f}")
    return "; ".join(words)


def time_taken(name, rows, version, shown):
    walks = lambda cells: [walk for cell in cells for replicate in cell.walks.values() for walk in replicate]
    minutes = lambda cells: sum(walk.seconds for walk in walks(cells)) / 60
    groups = {}
    for cell in shown:
        groups.setdefault((cell.model, cell.layers), []).append(cell)
    costly = sorted(groups.items(), key=lambda group: -minutes(group[1]))[:4]
    each = "; ".join(f"{SHOWN[model]}, {layers:,} layers: {minutes(cells):.1f} in {counted(len(walks(cells)), 'walk')}"
                     for (model, layers), cells in costly)
    return ["## Time", "", paragraph(f"{version}; {len(rows)} walks, every one in `{name}.csv`; made by `scripts/studies/four_way.py`. They took "
                                     f"{minutes(shown):.1f} minutes of processor time, of which {each}. Packings, and walks that were given up, are "
                                     "not included.")]


def not_run(cells, refused):
    """What of the plan has no boundary, and what the plan leaves out of the full product."""
    lines = ["## Not run", ""]
    for cell in (cell for cell in cells if not cell.whole):
        walks = [walk for replicate in cell.walks.values() for walk in replicate]
        reason = f"; {refused[cell.planned]}" if cell.planned in refused else ""
        if walks:
            each = listed(f"{w.ratio:.2f} ({100 * w.lost[0]:.1f} and {100 * w.lost[1]:.1f} % lost)" for w in walks)
            minutes = [walk.seconds / 60 for walk in walks]
            lines.append(bullet(f"{cell.where()}: s_NE {value(cell.begins, cell.s_ne)} and s_CE {value(cell.continues, cell.s_ce)}, **not "
                                f"bracketed**. Walked at {each}; a walk takes {span(minutes, '{:.0f}'.format)} minutes of processor time, "
                                f"{sum(minutes):.1f} in all{reason}."))
        else:
            lines.append(bullet(f"{cell.where()}: not walked{reason}."))
    lines += [""] if len(lines) > 2 else []
    return lines + left_out([cell for cell in cells if not cell.arches], [cell for cell in cells if cell.arches])


def left_out(planned, arches):
    """What the plan leaves out of filters x models x thicknesses x bases."""
    names, models = ([known for known in order if any(known in (cell.name, cell.model) for cell in planned)] for order in (BY_NAME, MODELS))
    bases, layers = sorted({cell.base for cell in planned}), sorted({cell.layers for cell in planned})
    ran, arched = [cell for cell in planned if cell.whole], [cell for cell in arches if cell.whole]
    product = len(names) * len(models) * len(layers) * len(bases)
    lines = [paragraph(f"{len(names)} filters x {len(models)} models x {len(layers)} thicknesses x {len(bases)} bases are {product} cells. "
                       f"{len(planned)} were planned and {len(ran)} have both boundaries: **{product - len(ran)} have not**. Of those with arches "
                       f"{len(arches)} were planned and {len(arched)} have both. Cells with both boundaries, of {len(names) * len(bases)} (filters "
                       "x bases) in each place:"),
             f"| model | {' | '.join(f'{n:,} layers' for n in layers)} |", "|---|" + "---|" * len(layers)]
    of = lambda model, n: str(sum((cell.model, cell.layers) == (model, n) for cell in ran))
    lines += [f"| {SHOWN[model]} | {' | '.join(of(model, n) for n in layers)} |" for model in models] + [""]
    if arches:
        lines.append(paragraph(f"Arches: only {'; '.join(cell.where() for cell in arches)}."))
    return lines
