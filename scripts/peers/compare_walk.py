#!/usr/bin/env python3
"""Builds and times the plain walks of benches/baseline beside the library's, in turns, and prints the ratios in Markdown.

    scripts/peers/compare_walk.py [N ...]     2000000 20000000 unless given; 200000000 takes half an hour

Whole runs of engine counts are always among them. NumPy and Numba are installed into target/venv-compare.
"""

import datetime
import os
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "studies"))
import common  # noqa: E402

CURVE = "src/core/data/filters/shire2016-cu1.5-loose.csv"
PYTHON = "target/venv-compare/bin/python"
SEED = 1
#: Repeats by scene; the slow languages are timed once in each.
REPEATS = 5


def values(command):
    """The numbers that a walk prints behind their names."""
    one_thread = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    words = subprocess.run(command, check=True, capture_output=True, text=True, env=one_thread).stdout.split()
    return {name: float(value) for name, value in zip(words[::2], words[1::2]) if name != "engine"}


def isas(*command):
    """Instruction sets with which a command ends well on this machine, the slowest first."""
    names = ["portable", "avx2", "avx512"]
    return [name for name in names if subprocess.run([*command, name], capture_output=True).returncode == 0]


def scene(build, binary, n, name, repeats):
    """Every walk of a scene in turns; the lists of what each printed."""
    # A run of 2e8 particles to its end takes plain code an hour: its first 110 increments stand for it.
    until = 0 if n < 100_000_000 else 110
    tail = [str(n), CURVE, name, str(SEED), str(until)]
    commands = {
        "plain C++": [f"{build}/walk_cpp", *tail],
        "plain Rust": [f"{build}/walk_rust", *tail],
    }
    slow = {
        "Numba": [PYTHON, "benches/baseline/walk_numba.py", *tail],
        "NumPy": [PYTHON, "benches/baseline/walk_numpy.py", *tail],
    }
    for isa in isas(binary, "1", "passive", "1", "1", "1"):
        for threads in (1, 2):
            label = f"voidwalk {isa}, {threads} thread{'s' * (threads > 1)}"
            commands[label] = [binary, str(n), name, str(SEED), str(until), str(threads), isa]
    seen = {label: [] for label in commands}
    for repeat in range(repeats):
        for label, command in commands.items():
            seen[label].append(values(command))
        if repeat == 0 and n <= 2_000_000:
            for label, command in slow.items():
                seen[label] = [values(command)]
    return seen


def table(seen):
    """Rows of Markdown; ratios against the faster plain walk."""

    def times(label, field):
        # Several threads by the wall; one by the processor's time, which other programs do not lengthen.
        field = field.replace("ns_", "wall_") if "threads" in label else field
        return [run[field] for run in seen[label]]

    base = {}
    for field in ("ns_step_all", "ns_step_after"):
        fastest = min(("plain C++", "plain Rust"), key=lambda label: statistics.median(times(label, field)))
        base[field] = (min(times(fastest, field)), statistics.median(times(fastest, field)))
    rows = [
        "| walk | ns a step, insertion included: min, median | ratio of medians (of minima) | "
        "ns a step, after the last insertion: min, median | ratio of medians (of minima) | processor ns a step | "
        "eroded | blocked |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for label, runs in seen.items():
        cells = [label]
        for field in ("ns_step_all", "ns_step_after"):
            low, middle = min(times(label, field)), statistics.median(times(label, field))
            cells.append(f"{low:.2f}, {middle:.2f}")
            cells.append(f"{base[field][1] / middle:.1f} ({base[field][0] / low:.1f})")
        cells.append(f"{min(run['ns_step_all'] for run in runs):.2f}")
        cells += [f"{runs[0]['eroded']:.0f}", f"{runs[0]['blocked']:.0f}"]
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def counts(build, scale):
    """Whole first runs of engine counts beside the time that the plain walks would take for the same moves."""
    plain = {}
    for label, program in (("plain C++", "walk_cpp"), ("plain Rust", "walk_rust")):
        plain[label] = values([f"{build}/{program}", "200000000", CURVE, "graded", str(SEED), "110"])["ns_step_all"]
    best = min(plain.values())
    cost = " and ".join(f"{ns:.1f} ns a step ({label})" for label, ns in plain.items())
    lines = [
        "\n## Engine `counts`: whole first runs\n\n"
        f"The plain walks' first 110 increments with 2e8 particles cost {cost}. The ratio is the faster of these times the completed\n"
        "moves, over the run's processor time, its coarse particles included. Least of three runs; 1e12 is of a wider base (Cu 24), of\n"
        "which as many particles are coarse as of 2e8 at Cu 4.5.\n\n"
        "| walk | N | processor s | wall s | increments | walked one by one | moves | ratio to plain | peak MB |\n"
        "|---|---|---|---|---|---|---|---|---|"
    ]
    known = isas(scale, "counts", "1", "2", "2", "2", "1")
    cases = [(isa, 1, "200000000", "4.5") for isa in reversed(known)]
    cases += [(known[-1], 2, "200000000", "4.5"), (known[-1], 1, "1000000000", "4.5"), (known[-1], 1, "1000000000000", "24")]
    for isa, threads, n, cu in cases:
        runs = [values([scale, "counts", n, "40", "40", "60", str(threads), isa, cu]) for _ in range(3)]
        run, wall = min(runs, key=lambda run: run["cpu"]), min(run["wall"] for run in runs)
        ratio = best * 1e-9 * run["moves"] / run["cpu"]
        lines.append(
            f"| voidwalk {isa}, {threads} thread{'s' * (threads > 1)} | {float(n):.0e} | {run['cpu']:.2f} | {wall:.2f} | "
            f"{run['increments']:.0f} | {run['one_by_one']:.0f} | {run['moves']:.3g} | {ratio:.3g} | {run['peak_mb']:g} |"
        )
    return lines


def build_plain(build):
    os.makedirs(build, exist_ok=True)
    subprocess.run(["g++", "-O3", "-march=native", "-o", f"{build}/walk_cpp", "benches/baseline/walk.cpp"], check=True)
    rustc = ["rustc", "--edition", "2024", "-C", "opt-level=3", "-C", "target-cpu=native"]
    subprocess.run([*rustc, "-o", f"{build}/walk_rust", "benches/baseline/walk.rs"], check=True)
    if not os.path.exists(PYTHON):
        subprocess.run(["python3", "-m", "venv", "target/venv-compare"], check=True)
        subprocess.run([PYTHON, "-m", "pip", "install", "--quiet", "numpy", "numba"], check=True)


def main():
    os.chdir(common.ROOT)
    build, binary, scale = "target/compare", common.bench("compare_walk"), common.bench("scale_walk")
    sizes = sys.argv[1:] or ["2000000", "20000000"]
    build_plain(build)
    version = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    print(f"{datetime.date.today()}, commit {version}, {os.cpu_count()} processors, seed {SEED}, load {os.getloadavg()[0]:.1f} at the start.\n\n"
          "Scene: 40 x 40 x 60 lattice, curve shire2016-cu1.5-loose; `graded` is a base of Cu 4.5 with D85 = Dc5, `passive` the same shape,\n"
          "finer than every constriction. A step is an attempted move. One thread: processor time; two threads: wall time. Walks are timed\n"
          "in turns; ratios are against the faster of plain C++ and plain Rust (one core).")
    print("\n".join(counts(build, scale)))
    for n in map(int, sizes):
        for name in ("graded", "passive"):
            repeats = REPEATS if n < 10_000_000 else 1
            print(f"\n## {name}, N = {n:.0e}, {repeats} repeats\n")
            print("\n".join(table(scene(build, binary, n, name, repeats))), flush=True)
    print(f"\nLoad {os.getloadavg()[0]:.1f} at the end.")


if __name__ == "__main__":
    main()
