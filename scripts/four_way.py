#!/usr/bin/env python3
"""How coarse may the filter be, by four models: lattice or the packing's own voids, by area or by water.

    scripts/four_way.py --binary target/release/voidwalk --packings FOLDER... --out results/four-way-2026-11-22

Each FOLDER is one that `voidwalk pack` has written. For each packing, model, base and thickness D15F/D85B is raised in steps; every
replicate has two boundaries of its own, where its first run (no erosion turns to some) and its second (some turns to continuing)
passes 7.5 % of the mass, interpolated between steps. Replicates have the same random numbers at every step. A walk on the packing's own
voids has one network, so that its scatter is that of the walk alone.

Writes OUT.csv, OUT.svg and OUT.md; what is in OUT.csv already is not walked again.
"""

import argparse
import csv
import json
import math
import pathlib
import platform
import subprocess
import tempfile
import time

THRESHOLD = 0.075
MODELS = {
    "lattice, area": [],
    "lattice, flux": ["walk.exit=flux"],
    "graph, flux": ["network.kind=graph", "walk.exit=flux"],
    "graph, area along flow": ["network.kind=graph", "walk.exit=area-along-flow"],
}
# What tests and practice say, as D15F/D85B: frontier of no erosion for a base of less than 15 % fines.
LABORATORY = [
    ("Foster & Fell 2001, no erosion, tests", 6.8, 10.0),
    ("Sherard et al. 1984, design", 4.0, 5.0),
]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--packings", nargs="+", required=True, type=pathlib.Path)
    parser.add_argument("--bases", nargs="+", type=float, default=[1.5], help="Cu of the base")
    parser.add_argument("--layers", nargs="+", type=int, default=[60], help="thickness in layers of the lattice")
    parser.add_argument("--models", nargs="+", default=list(MODELS), choices=list(MODELS))
    parser.add_argument("--steps", nargs="+", type=float, default=[3.5 + 0.5 * k for k in range(14)])
    parser.add_argument("--replicates", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    return parser.parse_args()


def scene(packing, base_cu, layer_mm, layers, model):
    """A scene of this packing; lengths are those of the packing."""
    record = json.loads((packing / "packing.json").read_text())
    measured = json.loads((packing / "constrictions.json").read_text())
    cu, d0 = record["cu"], record["gradation"][0][0]
    lines = [f"replicates = {{replicates}}", "[filter]", f"cu = {cu}", f"d0_mm = {d0}"]
    if "graph" not in model:
        lines += [f'curve = "{(packing / "constrictions.csv").resolve()}"', f"grains_per_void = {measured['grains_per_void']}"]
    lines += ["[base]", f"cu = {base_cu}", "d15f_over_d85b = 5", "[network]"]
    if "graph" in model:
        lines += [f'packing = "{(packing / "grains.csv").resolve()}"', 'kind = "graph"', f"thickness_mm = {layers * layer_mm}"]
    else:
        lines += ["nx = 40", "ny = 40", f"nz = {layers}"]
    return "\n".join(lines + ["[record]", "sensitivity = []", "series_every = 0", ""])


def walk(options, text, sets, folder):
    path = folder / "scene.toml"
    path.write_text(text)
    out = folder / "run"
    command = [options.binary, "run", str(path), "--out", str(out), "--overwrite", "--quiet"]
    for item in sets:
        command += ["--set", item]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads((out / "outcome.json").read_text())


def crossing(points):
    """Smallest ratio at which the eroded part passes the threshold, linear between steps; None where no step does, and minus infinity
    where the first does."""
    before = None
    for ratio, eroded in points:
        if eroded >= THRESHOLD:
            if before is None:
                return -math.inf
            return before[0] + (THRESHOLD - before[1]) / (eroded - before[1]) * (ratio - before[0])
        before = (ratio, eroded)
    return None


def spread(values, first, last):
    known = sorted(v if v is not None else math.inf for v in values)
    if not known:
        return None
    at = lambda share: known[min(len(known) - 1, int(share * len(known)))]
    middle = known[len(known) // 2] if len(known) % 2 else 0.5 * (known[len(known) // 2 - 1] + known[len(known) // 2])
    show = lambda v: f"{v:.2f}" if math.isfinite(v) else f"> {last:g}" if v > 0 else f"< {first:g}"
    return show(middle), show(at(0.0)), show(at(0.999))


def study(options):
    table = pathlib.Path(f"{options.out}.csv")
    fields = ["packing", "model", "base_cu", "layers", "ratio", "replicate", "run", "eroded", "k_over_k0", "seconds"]
    rows = list(csv.DictReader(table.open())) if table.exists() else []
    known = {(r["packing"], r["model"], float(r["base_cu"]), int(r["layers"]), float(r["ratio"])) for r in rows}
    with table.open("a", newline="") as file, tempfile.TemporaryDirectory() as scratch:
        writer = csv.DictWriter(file, fields)
        if not rows:
            writer.writeheader()
        for packing in options.packings:
            layer_mm = layer(packing)
            for model in options.models:
                for base in options.bases:
                    for layers in options.layers:
                        text = scene(packing, base, layer_mm, layers, model).replace("{replicates}", str(options.replicates))
                        over = 0
                        for ratio in options.steps:
                            if (packing.name, model, base, layers, ratio) in known:
                                continue
                            sets = [s for s in MODELS[model] if not s.startswith("network.kind")]
                            sets += [f"base.d15f_over_d85b={ratio}", f"seed={options.seed}"]
                            begun = time.time()
                            outcome = walk(options, text, sets, pathlib.Path(scratch))
                            seconds = round(time.time() - begun, 2)
                            for number, replicate in enumerate(outcome["replicates"], 1):
                                for run in replicate["runs"]:
                                    row = dict(packing=packing.name, model=model, base_cu=base, layers=layers, ratio=ratio)
                                    row |= dict(replicate=number, run=run["run"], eroded=run["eroded_mass_fraction"])
                                    row |= dict(k_over_k0=run.get("k_over_k0", ""), seconds=seconds)
                                    writer.writerow(row)
                                    rows.append({k: str(v) for k, v in row.items()})
                            file.flush()
                            print(packing.name, model, base, layers, ratio, seconds, flush=True)
                            # Twice past both boundaries in every replicate: coarser filters erode more.
                            passed = all(run["eroded_mass_fraction"] >= THRESHOLD for r in outcome["replicates"] for run in r["runs"])
                            over = over + 1 if passed else 0
                            if over == 2:
                                break
    return rows


def layer(packing):
    """D50F by number (mm): the thickness of a layer of the lattice."""
    sizes = []
    with (packing / "grains.csv").open() as file:
        for line in file:
            if line[0] in "-0123456789.":
                sizes.append(float(line.rsplit(",", 1)[1]))
    return sorted(sizes)[len(sizes) // 2]


def report(options, rows):
    cases = {}
    for row in rows:
        key = (row["packing"], row["model"], float(row["base_cu"]), int(row["layers"]))
        cases.setdefault(key, {}).setdefault((int(row["replicate"]), int(row["run"])), []).append((float(row["ratio"]), float(row["eroded"])))
    lines, bars = [], []
    for key in sorted(cases):
        of = cases[key]
        steps = [ratio for points in of.values() for ratio, _ in points]
        found = []
        for run in (1, 2):
            found.append(spread([crossing(sorted(points)) for (_, r), points in sorted(of.items()) if r == run], min(steps), max(steps)))
        (ne, ne_low, ne_high), (ce, ce_low, ce_high) = found
        replicates = len({r for r, _ in of})
        lines.append(f"| {key[0]} | {key[1]} | {key[2]:g} | {key[3]} | {ne} ({ne_low} to {ne_high}) | {ce} ({ce_low} to {ce_high}) | {replicates} |")
        bars.append((f"{key[0]}, {key[1]}, Cu of base {key[2]:g}, {key[3]} layers", ne, ce))
    version = subprocess.run([options.binary, "--version"], capture_output=True, text=True).stdout.strip()
    text = f"""# How coarse may the filter be: four models and the laboratory ({time.strftime('%Y-%m-%d')})

D15F/D85B at which the eroded mass passes 7.5 %: in the first run (no erosion turns to some) and in the second (some turns to continuing).
Median over replicates, and in brackets the smallest and the largest of them. `{version}`, {platform.machine()}, seed {options.seed};
made by `scripts/four_way.py`, every walk in `{options.out.name}.csv`. `> x` says that the last step walked, x, does not
reach it, `< x` that the first one is beyond it.

| packing | model | Cu of the base | layers | no erosion up to | some erosion up to | replicates |
|---|---|---|---|---|---|---|
{chr(10).join(lines)}

| tests and practice, base with less than 15 % fines | D15F/D85B |
|---|---|
""" + "\n".join(f"| {name} | {low:g} to {high:g} |" for name, low, high in LABORATORY) + "\n"
    pathlib.Path(f"{options.out}.md").write_text(text)
    pathlib.Path(f"{options.out}.svg").write_text(figure(bars, options))


def figure(bars, options):
    """Each case as a bar: green up to the first boundary, amber to the second, red beyond; the laboratory above."""
    left, right, row = 420, 980, 26
    low, high = 2.0, max(12.0, max(options.steps))
    x = lambda ratio: left + (min(ratio, high) - low) / (high - low) * (right - left)
    number = lambda text: float(text.lstrip("<> "))
    height = 90 + row * (len(bars) + len(LABORATORY))
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 {height}" font-family="sans-serif" font-size="13">',
             f'<rect width="1000" height="{height}" fill="white"/>']
    y = 30
    for name, a, b in LABORATORY:
        parts.append(f'<text x="{left - 10}" y="{y + 13}" text-anchor="end">{name.replace("&", "&amp;")}</text>')
        parts.append(f'<rect x="{x(a):.1f}" y="{y}" width="{x(b) - x(a):.1f}" height="16" fill="#888"/>')
        y += row
    for name, ne, ce in bars:
        parts.append(f'<text x="{left - 10}" y="{y + 13}" text-anchor="end">{name}</text>')
        for a, b, colour in [(low, number(ne), "#5aa469"), (number(ne), number(ce), "#e0b040"), (number(ce), high, "#c0504d")]:
            parts.append(f'<rect x="{x(a):.1f}" y="{y}" width="{max(0, x(b) - x(a)):.1f}" height="16" fill="{colour}"/>')
        y += row
    for tick in range(math.ceil(low), math.floor(high) + 1):
        parts.append(f'<line x1="{x(tick):.1f}" y1="24" x2="{x(tick):.1f}" y2="{y}" stroke="#0002"/>')
        parts.append(f'<text x="{x(tick):.1f}" y="{y + 18}" text-anchor="middle">{tick}</text>')
    parts.append(f'<text x="{(left + right) / 2}" y="{y + 40}" text-anchor="middle">D15F / D85B: green no erosion, amber some, red continuing; grey tests and practice</text>')
    return "\n".join(parts + ["</svg>\n"])


def main():
    options = arguments()
    report(options, study(options))


if __name__ == "__main__":
    main()
