#!/usr/bin/env python3
"""Error against run time: what a second of processor time buys, by engine, sampling, replicates and number of particles.

    scripts/studies/precision.py [--binary target/release/voidwalk] [--out results/precision/whole-runs]
    scripts/studies/precision.py --across 14 --replicates 16 --networks 16 --most 1e5 --out target/precision      # a quick look
    scripts/studies/precision.py --tiers sampling bias --set base.cu=4.5 --set base.d15f_over_d85b=6.5            # a part, of another scene

Runs the program as whole processes and reads their folders. --set changes the built-in scene.
The seed and the options alone say what is walked, so the same call gives the same numbers; only columns with `seconds` or `merit` in
their name differ. A time is the processor time of a whole process on one thread, with its network, its files and its page, over the
number of its replicates. An eroded mass is a fraction of the first run.

Three tiers, each with its CSV files and figures in --out:

exact     Probabilities of leaving that this script works out by itself, on random 6 x 6 x 4 lattices that the program draws. "First
          particle": a single particle of size Dc35 on a clean lattice. It is walked alone, in runs of one particle; and many at once, on
          the lattice whose finer constrictions lead into a void without exits, where each of them is a first one. "Clogged lattice":
          particles that fit everywhere, with 58 % of the constrictions closed. Particles do not meet there, so the error must be that of
          independent draws; the engine `expected` draws nothing and errs by rounding.
sampling  The scatter of the eroded mass over replicates, on new networks and on one, and how the error of a mean falls with replicates.
bias      One setting changed at a time: share of the base, caps, width, length, injection. Paired by replicate where the networks stay.

Needs SciPy and Matplotlib.
"""

import csv
import datetime
import json
import math
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from scipy import stats

import common

TIERS = ["exact", "sampling", "bias"]
ENGINES = ["particles", "counts", "expected"]
PLAIN = ["runs=1", "record.sensitivity=[]", "record.size_curves=[]", "record.series_every=0"]
SHAPE, CLOGGED, FIRST_AT_DC, ALONE = (6, 6, 4), 0.58, 35, "one at a time"
VARIANTS = {
    "counts": ["engine=counts"],
    "particles": ["engine=particles"],
    "expected": ["engine=expected"],
    "counts, stratified base": ["engine=counts", "sampling=stratified"],
    "expected, stratified base": ["engine=expected", "sampling=stratified"],
}
SHARES = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75]
CAPS = [100_000, 1_000_000, 10_000_000, 50_000_000, 200_000_000]
WIDTHS, LENGTHS, INJECTED = [10, 20, 40], [15, 30, 60, 120], [0.002, 0.01, 0.05, 0.1, 1.0]
# Okabe and Ito.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000", "#56B4E9"]


class Program:
    """The program, called with one thread and its settings."""

    def __init__(self, args):
        self.binary, self.folder = args.binary, Path(args.folder)

    def check(self, settings):
        said = subprocess.run([self.binary, "check", "--json", *common.sets(settings)], check=True, capture_output=True, text=True)
        return json.loads(said.stdout)

    def run(self, settings, keep=None):
        """Its outcome and processor time; `keep` reads the folder before it goes."""
        words = common.sets([*PLAIN, *settings])
        with tempfile.TemporaryDirectory(dir=self.folder) as out:
            command = [self.binary, "run", "-q", "--overwrite", "--threads", "1", "--out", out]
            done, seconds = common.spent([*command, *words], capture_output=True, text=True)
            if done.returncode:
                raise SystemExit(f"{' '.join(map(str, command + words))}\n{done.stdout}{done.stderr}")
            outcome = json.loads((Path(out) / "outcome.json").read_text())
            return outcome, seconds, keep and keep(Path(out))

    def replicates(self, settings, count, seed):
        """Eroded mass fraction of each replicate's first run, processor time of one, base particles of one."""
        outcome, seconds, _ = self.run([*settings, f"replicates={count}", f"seed={seed}"])
        values = [replicate["runs"][0]["eroded_mass_fraction"] for replicate in outcome["replicates"]]
        return {"values": values, "seconds": seconds / count, "n_base": outcome["n_base"]}


def sd_interval(values, known_mean=None):
    """A standard deviation with its 95 % interval, of chi squared by Wilson and Hilferty."""
    mean = statistics.fmean(values) if known_mean is None else known_mean
    degrees = len(values) - (known_mean is None)
    sd = math.sqrt(sum((value - mean) ** 2 for value in values) / degrees)

    def bound(z):
        a = 2 / (9 * degrees)
        return sd / math.sqrt(max((1 - a + z * math.sqrt(a)) ** 3, 1e-3))
    return sd, bound(1.959964), bound(-1.959964)


def merit(error, seconds):
    return 1 / (error * error * seconds) if error > 0 and seconds > 0 else None


def difference(found, reference, paired):
    """Mean difference and its 95 % interval: replicate by replicate, or of independent values (Welch)."""
    if paired:
        each = [a - b for a, b in zip(found, reference)]
        mean, variance, degrees = statistics.fmean(each), statistics.variance(each) / len(each), len(each) - 1
    else:
        parts = [statistics.variance(values) / len(values) for values in (found, reference)]
        mean, variance = statistics.fmean(found) - statistics.fmean(reference), sum(parts)
        below = sum(part * part / (len(values) - 1) for part, values in zip(parts, (found, reference)))
        degrees = max(int(variance * variance / below), 1) if below else 1
    half = stats.t.ppf(0.975, degrees) * math.sqrt(variance)
    return mean, mean - half, mean + half


def slope(points):
    """Of ln(error) against ln(particles)."""
    logs = [(math.log(x), math.log(y)) for x, y in points if y > 0]
    if len(logs) < 2:
        return None
    mx, my = (statistics.fmean(values) for values in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


def network_of(program, settings, seed):
    """The network that the program draws for its first replicate: rows (from, to, diameter in mm), where None leads out; and D85 of the
    base, where it is stated by constrictions: those of a file are a sample of the curve."""
    def read(folder):
        with open(folder / "constrictions_of_network.csv", newline="") as file:
            each = [(int(row["from"]), int(row["to"]), float(row["diameter_mm"])) for row in csv.DictReader(file)]
        return [(start, None if end < 0 else end, size) for start, end, size in each], "d85_at_dc" in (folder / "scene.toml").read_text()
    outcome, _, (rows, is_by_dc) = program.run([*settings, "replicates=1", "base.n_base=1", "record.voids=[]", f"seed={seed}"], keep=read)
    return rows, [f"base.d85_mm={outcome['inputs']['base']['d85_mm']!r}"] if is_by_dc else []


def network_file(path, rows, starts, shape):
    lines = [f"# shape = {', '.join(map(str, shape))}"] if shape else []
    lines += ["from,to,diameter_mm", *(f"start,{void}," for void in range(starts))]
    lines += [f"{start},{'end' if end is None else end},{diameter!r}" for start, end, diameter in rows]
    path.write_text("\n".join(lines) + "\n")


def probability(rows, starts, diameter):
    """That a lone particle leaves, which begins in each start node alike: the linear solve, by Gauss-Seidel sweeps.

    It takes an exit by its share of the open area, and is stopped where that is finer than it, or where no exit is open."""
    exits = {}
    for start, end, size in rows:
        exits.setdefault(start, []).append((end, size))
    shares = []
    for void, of_void in sorted(exits.items(), reverse=True):
        total = sum(size * size for _, size in of_void)
        if total > 0:
            shares.append((void, [(end, size * size / total) for end, size in of_void if size > 0 and size >= diameter]))
    leaves, change = {}, 1.0
    while change > 1e-15:
        change = 0.0
        for void, of_void in shares:
            new = sum(share * (1.0 if end is None else leaves.get(end, 0.0)) for end, share in of_void)
            change = max(change, abs(new - leaves.get(void, 0.0)) / new if new > 0 else 0.0)
            leaves[void] = new
    return statistics.fmean(leaves.get(void, 0.0) for void in range(starts))


def known_networks(args, program):
    """Networks of each kind with an answer that is neither sure nor hopeless: file, exact answer and diameter, by quantity and way."""
    lattice = [f"network.{axis}={count}" for axis, count in zip(("nx", "ny", "nz"), SHAPE)]
    voids, starts = math.prod(SHAPE), SHAPE[0] * SHAPE[1]
    probe, _, _ = program.run([*lattice, "replicates=1", "base.n_base=1", *of_first(args)])
    first = probe["inputs"]["base"]["d85_mm"]
    known = {("clogged lattice", "together"): [], ("first particle", ALONE): [], ("first particle", "together"): []}
    for number in range(1, 32 * args.networks):
        if all(len(each) == args.networks for each in known.values()):
            break
        seed = args.seed + number - 1
        rows, _ = network_of(program, [*args.set, *lattice], seed)
        draws = random.Random(f"clogged {seed}")
        clogged = [(start, end, 0.0 if draws.random() < CLOGGED else size) for start, end, size in rows]
        stopping = [(start, voids if size < first else end, size) for start, end, size in rows]
        passing = min(size for _, _, size in rows) / 2
        of_one = probability(rows, starts, first)
        kinds = [("clogged lattice", "together", clogged, SHAPE, passing, probability(clogged, starts, 0.0)),
                 ("first particle", ALONE, rows, SHAPE, first, of_one), ("first particle", "together", stopping, None, passing, of_one)]
        for name, way, of_kind, shape, diameter, exact in kinds:
            if 0.02 < exact < 0.98 and len(known[name, way]) < args.networks:
                path = Path(args.folder) / f"{name}-{way}-{seed}.csv".replace(" ", "-")
                network_file(path, of_kind, starts, shape)
                known[name, way].append({"file": path, "exact": exact, "diameter": diameter, "seed": seed})
    return known


def of_first(args):
    """The scene with a base whose D85 is the size of the first particle."""
    of_base = [setting for setting in args.set if not setting.startswith("base.")]
    return [*of_base, "base.cu=1.5", f"base.d85_at_dc={FIRST_AT_DC}"]


def exact(args, program):
    filters = [setting for setting in args.set if setting.startswith("filter.")]
    rows, networks, slopes = [], [], []
    known = known_networks(args, program)
    for (name, way), engine in [(key, engine) for key in known for engine in ([key[1]] if key[1] == ALONE else ENGINES)]:
        most = max(args.most / 100, 100) if engine == ALONE else args.most if engine == "particles" else 1e4 * args.most
        counts = [10**power for power in range(2, 13) if 10**power <= most]
        for place, particles in enumerate(counts):

            def walk(of):
                together = [f"engine={engine}", f"base.n_base={particles}", "replicates=1"]
                settings = ["base.n_base=1", f"replicates={particles}"] if engine == ALONE else together
                settings += [f"network.file={of['file']}", f"base.single_mm={of['diameter']!r}", "inject_share=1"]
                outcome, seconds, _ = program.run([*filters, *settings, f"seed={of['seed'] + 1_000_003 * (place + 1)}"])
                return sum(replicate["runs"][0]["eroded"] for replicate in outcome["replicates"]) / particles, seconds

            walked = list(map(walk, known[name, way]))
            variances = [of["exact"] * (1 - of["exact"]) / particles for of in known[name, way]]
            off = [found - of["exact"] for (found, _), of in zip(walked, known[name, way])]
            z = [o / math.sqrt(v) if engine != "expected" and v * particles**2 >= 50 else None for o, v in zip(off, variances)]
            error, low, high = sd_interval(off, 0.0)
            seconds = statistics.fmean(seconds for _, seconds in walked)
            rows.append({"quantity": name, "engine": engine, "particles": particles, "networks": len(off), "error": error, "error_low": low,
                         "error_high": high, "expected_error": math.sqrt(statistics.fmean(variances)), "bias": statistics.fmean(off),
                         "largest_z": max((abs(each) for each in z if each is not None), default=None), "core_seconds": seconds,
                         "merit": merit(error, seconds)})
            if particles == counts[-1]:
                networks += [{"quantity": name, "engine": engine, "particles": particles, "network": at, "seed": of["seed"],
                              "exact": of["exact"], "found": found, "z": each}
                             for at, ((found, _), of, each) in enumerate(zip(walked, known[name, way], z), 1)]
        of_line = rows[-len(counts):]
        slopes.append({"quantity": name, "engine": engine, "slope": slope([(row["particles"], row["error"]) for row in of_line]),
                       "largest_z": max((row["largest_z"] for row in of_line if row["largest_z"] is not None), default=None)})
        print(f"exact: {name}, {engine}: {counts[-1]:.0e} particles, error {rows[-1]['error']:.1e}", file=sys.stderr)
    series = [(f"{row['quantity']}, {row['engine']}", row) for row in rows]
    for figure, x, label in [("exact-particles", "particles", "Particles of a network"),
                             ("exact-time", "core_seconds", "Processor time of a network (s)")]:
        args.figure(figure, "Error against exact answers", (label, "Root mean square error of the probability of leaving (–)"),
                    [(key, row[x], row["error"], row["error_low"], row["error_high"]) for key, row in series])
    return {"exact": rows, "exact_networks": networks, "exact_slopes": slopes}


def sampling(args, program):
    lattice, of_size = network_of(program, args.narrow, args.seed)
    shape = [args.shape[axis] for axis in ("nx", "ny", "nz")]
    path = Path(args.folder) / "one-network.csv"
    network_file(path, lattice, shape[0] * shape[1], shape)
    n_base = program.check(args.narrow)["n_base"]
    of_one = [*(setting for setting in args.set if not setting.startswith("network.")), *of_size, f"base.n_base={n_base}"]
    lines, rows = [], []
    for kind, settings in [("new networks", args.narrow), ("one network", [*of_one, f"network.file={path}"])]:
        walked = map(lambda more: program.replicates([*settings, *more], args.replicates, args.seed), VARIANTS.values())
        first = None
        for variant, found in zip(VARIANTS, walked):
            values, seconds = found["values"], found["seconds"]
            first = first or values
            sd, low, high = sd_interval(values)
            mean, off = statistics.fmean(values), [a - b for a, b in zip(values, first)]
            error = None if values is first else statistics.stdev(off) / math.sqrt(len(off))
            line = {"variant": variant, "networks": kind, "replicates": len(values), "mean": mean, "difference": statistics.fmean(off)}
            line |= {"difference_error": error, "sd": sd, "sd_low": low, "sd_high": high}
            binomial = math.sqrt(mean * (1 - mean) / n_base)
            lines.append({**line, "binomial": binomial, "core_seconds": seconds, "merit": merit(sd, seconds)})
            for group in (2**power for power in range(20) if len(values) // 2**power >= 4):
                means = [statistics.fmean(values[at:at + group]) for at in range(0, len(values) - group + 1, group)]
                error, low, high = sd_interval(means)
                rows.append({"variant": variant, "networks": kind, "group": group, "groups": len(means), "error": error,
                             "error_low": low, "error_high": high, "core_seconds": group * seconds})
            print(f"sampling: {kind}, {variant}: {100 * mean:.2f} %, sd {100 * sd:.3f} points", file=sys.stderr)
        args.figure("sampling-" + kind.replace(" ", "-"), f"Error of the eroded mass against time, {kind}",
                    ("Processor time of the replicates averaged (s)", "Standard error of the eroded mass (percentage points)"),
                    [(row["variant"], row["core_seconds"], *(100 * row[of] for of in ("error", "error_low", "error_high")))
                     for row in rows if row["networks"] == kind])
    return {"sampling": rows, "sampling_merit": lines}


def bias(args, program):
    here, whole = program.check(args.narrow), program.check(args.set)
    n_base, part = here["n_base"], here["n_base"] / whole["n_base"]
    injected = 1 / here["increments"]

    def base(share):
        return [f"base.n_base={max(1, round(n_base * share))}"]
    changes = [("reference", "as the scene has it, " + " x ".join(map(str, args.shape.values())) + " voids", 1.0, [], True)]
    changes += [("base particles", f"{share:g} of Eq. (2)", share, base(share), True) for share in SHARES]
    # A cap is one of the whole scene: a narrower lattice has the same share.
    changes += [("cap", f"{cap:.0e} particles", cap, base(cap * part / n_base), True) for cap in CAPS if cap < whole["n_base"]]
    changes += [("cross-section", f"{n} x {n} voids", n, [f"network.nx={n}", f"network.ny={n}"], False)
                for n in WIDTHS if [n, n] != [args.shape["nx"], args.shape["ny"]]]
    changes += [("length", f"{n} layers", n, [f"network.nz={n}"], False) for n in LENGTHS if n != args.shape["nz"]]
    changes += [("injection", f"{100 * share:g} % an increment", share, [f"inject_share={share}"], True)
                for share in INJECTED if abs(share / injected - 1) > 1e-6]
    walked = list(map(lambda of: program.replicates([*args.narrow, *of[3]], args.replicates, args.seed), changes))
    rows = []
    for (factor, level, at, _, paired), found in zip(changes, walked):
        is_reference = found is walked[0]
        off = (0.0, None, None) if is_reference else difference(found["values"], walked[0]["values"], paired)
        rows.append({"factor": factor, "level": level, "at": at, "reference": is_reference, "n_base": found["n_base"],
                     "replicates": len(found["values"]), "value": statistics.fmean(found["values"]), "bias": off[0], "bias_low": off[1],
                     "bias_high": off[2], "paired": paired and not is_reference, "core_seconds": found["seconds"]})
        print(f"bias: {factor}, {level}: {100 * off[0]:+.2f} points", file=sys.stderr)
    sizes = [(row, sorted(abs(100 * row[of]) for of in ("bias_low", "bias_high"))) for row in rows[1:]]
    args.figure("bias", "Size of the bias of a setting against time",
                ("Processor time of a replicate (s)", "Size of the difference from the reference (percentage points)"),
                [(row["factor"], row["core_seconds"], abs(100 * row["bias"]), low if row["bias_low"] * row["bias_high"] > 0 else 0.0, high)
                 for row, (low, high) in sizes], joined=False)
    return {"bias": rows}


def figure(path, title, labels, points, joined=True):
    """Points (series, x, y, low, high) along two logarithmic axes, as SVG, with a guide of slope -1/2 through the first."""
    points = [point for point in points if point[1] > 0 and point[2] > 0]
    pyplot = common.pyplot()
    drawn, ax = pyplot.subplots(figsize=(8.4, 5))
    for number, name in enumerate(dict.fromkeys(point[0] for point in points)):
        x, y, low, high = zip(*(point[1:] for point in points if point[0] == name))
        reach = [[max(b - a, 0) for a, b in zip(low, y)], [max(b - a, 0) for a, b in zip(y, high)]]
        ax.errorbar(x, y, reach, fmt="o-" if joined else "o", ms=4, lw=1.2, color=COLOURS[number % len(COLOURS)], label=name)
    if joined:
        _, x0, y0, _, _ = points[0]
        ends = [get(point[1] for point in points) for get in (min, max)]
        ax.plot(ends, [y0 * math.sqrt(x0 / x) for x in ends], "--", color="0.5", label="slope −1/2")
    ax.set(xscale="log", yscale="log", xlabel=labels[0], ylabel=labels[1], title=title)
    ax.grid(color="0.85")
    ax.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
    drawn.savefig(path, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(drawn)


def arguments():
    parser = common.parser(__doc__)
    parser.add_argument("--out", type=Path, default=common.ROOT / "results/precision/whole-runs")
    parser.add_argument("--tiers", nargs="+", choices=TIERS, default=TIERS)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a setting of the scene")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--replicates", type=int, default=32, help="of a line of sampling and of bias")
    parser.add_argument("--across", type=int, default=20, help="voids across the lattice, each way, for sampling and bias")
    parser.add_argument("--networks", type=int, default=32, help="of the tier exact")
    parser.add_argument("--most", type=float, default=1e6, help="particles of the tier exact, walked one by one")
    return parser.parse_args()


def main():
    args = arguments()
    (args.out / "figures").mkdir(parents=True, exist_ok=True)
    args.figure = lambda name, *what, **how: figure(args.out / "figures" / f"{name}.svg", *what, **how)
    with tempfile.TemporaryDirectory() as args.folder:
        program = Program(args)
        args.narrow = [*args.set, f"network.nx={args.across}", f"network.ny={args.across}"]
        network = program.check(args.narrow)["inputs"]["network"]
        args.shape = {axis: network[axis] for axis in ("nx", "ny", "nz")}
        for tier in args.tiers:
            for name, rows in {"exact": exact, "sampling": sampling, "bias": bias}[tier](args, program).items():
                common.table(args.out / f"{name}.csv", rows)
    version = subprocess.run([args.binary, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    print(f"{datetime.date.today()}, {version}: {args.out}")


if __name__ == "__main__":
    main()
