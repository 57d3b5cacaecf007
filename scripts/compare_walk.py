"""Times the plain walks and the library's in turns and writes results/walk-speed-DATE.md.

Called by compare_walk.sh: BUILD BINARY N...
"""

import datetime
import os
import platform
import statistics
import subprocess
import sys

CURVE = "src/data/filters/shire2016-cu1.5-loose.csv"
PYTHON = "target/venv-compare/bin/python"
SEED = 1
#: Repeats by scene; the slow languages are timed once in each.
REPEATS = 3


def values(command):
    """The name-value pairs that a walk prints."""
    one_thread = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    words = subprocess.run(command, check=True, capture_output=True, text=True, env=one_thread).stdout.split()
    return {name: float(value) for name, value in zip(words[::2], words[1::2])}


def isas(binary):
    names = ["portable", "avx2", "avx512"]
    tries = [subprocess.run([binary, "1", "passive", "1", "1", "1", n], capture_output=True) for n in names]
    return [name for name, tried in zip(names, tries) if tried.returncode == 0]


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
    for isa in isas(binary):
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


def first_line(*command):
    return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]


def processor():
    lines = open("/proc/cpuinfo").read().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def main():
    build, binary, *sizes = sys.argv[1:]
    date = datetime.date.today().isoformat()
    lines = [
        "# The walk against plain walks",
        "",
        f"{date}, commit {first_line('git', 'rev-parse', '--short', 'HEAD')}, {processor()}, "
        f"{os.cpu_count()} cores, {first_line('rustc', '--version')}, {first_line('g++', '--version')}. Seed {SEED}.",
        f"Load average when it began {os.getloadavg()[0]:.1f}.",
        "",
        "Scene: 40 x 40 x 60 lattice, curve shire2016-cu1.5-loose; `graded` is a base of Cu 4.5 with D85 = Dc5,",
        "`passive` the same shape, finer than every constriction. A step is an attempted move. One thread: processor",
        "time; two threads: wall time. Walks are timed in turns; ratios are against the faster of plain C++ and",
        "plain Rust (one core). Made by `scripts/compare_walk.sh`.",
    ]
    for n in map(int, sizes):
        for name in ("graded", "passive"):
            repeats = REPEATS if n < 10_000_000 else 1
            lines += ["", f"## {name}, N = {n:.0e}, {repeats} repeats", ""]
            lines += table(scene(build, binary, n, name, repeats))
            with open(f"results/walk-speed-{date}.md", "w") as out:
                out.write("\n".join(lines + [f"\nLoad average at the end {os.getloadavg()[0]:.1f}."]) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
