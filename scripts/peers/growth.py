#!/usr/bin/env python3
"""Prints how processor time and memory grow with size, over three decades where that takes minutes, as tables in Markdown.

    scripts/peers/growth.py [--binary target/release/voidwalk] [--bench BENCH] [--only NAME ...] [--turns 3]

Each row is a whole process, the least of so many turns: one thread, processor time, the most memory it held. The exponent is the slope of
time over size between neighbouring rows, on logarithmic scales; start-up and what does not grow make it small where runs are short.
BENCH is the program of `cargo bench --bench packing --no-run`: packings are compressed for so many steps, not to their end.
"""

import argparse
import math
import os
import subprocess
import tempfile
from pathlib import Path

SMALL = ["record.sensitivity=[]", "replicates=1", "runs=1"]


def run(settings):
    return lambda binary, out: [binary, "run", "--quiet", "--threads", "1", "--out", out] + [
        word for setting in [*SMALL, *settings] for word in ("--set", setting)]


def lattice(x, z):
    return [f"network.nx={x}", f"network.ny={x}", f"network.nz={z}"]


def particles(engine, n):
    return run([f"engine={engine}", f"base.n_base={n}"])


def cases(number):
    """A plan of so many small cases."""
    def command(binary, out):
        plan = Path(out).parent / f"plan-{number}.toml"
        plan.write_text(
            'title = "small cases"\n[set]\nreplicates = 1\nruns = 1\nrecord = { sensitivity = [] }\n'
            "network = { nx = 8, ny = 8, nz = 10 }\nbase.n_base = 2000\n"
            f'[[factor]]\nname = "seed"\nsetting = "seed"\nvalues = {list(range(1, number + 1))}\n')
        return [binary, "campaign", str(plan), "--quiet", "--threads", "1", "--out", out]
    return command


#: What grows: its name, and (size, command) in rising order.
SWEEPS = {
    "base particles, one by one (40 x 40 x 60 voids)": [(n, particles("particles", n)) for n in (10**5, 10**6, 10**7, 10**8)],
    "base particles, by counts": [(n, particles("counts", n)) for n in (10**6, 10**7, 10**8, 10**9)],
    "base particles, as their expectation": [(n, particles("expected", n)) for n in (10**6, 10**7, 10**8, 10**9)],
    "voids: cubes with 100 particles a void, expected": [
        (x**3, run([*lattice(x, x), f"base.n_base={100 * x**3}", "engine=expected"])) for x in (10, 22, 46, 100)],
    "layers of 20 x 20 voids, as much base, expected": [
        (z, run([*lattice(20, z), "base.n_base=2000000", "engine=expected"])) for z in (10, 60, 300, 1500)],
    "replicates of 10 x 10 x 20 voids, expected": [
        (n, run([*lattice(10, 20), "base.n_base=100000", "engine=expected", f"replicates={n}"])) for n in (2, 20, 200, 1000)],
    "cases of 8 x 8 x 10 voids": [(n, cases(n)) for n in (2, 20, 200, 1000)],
}


def measured(command, environment):
    """Processor time (s) and most memory (MB) of a command that succeeds."""
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment)
    said = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{command}: {said.decode()[-500:]}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def table(name, rows):
    print(f"\n**{name}**\n\n| size | processor s | exponent | MB | exponent |\n|---|---|---|---|---|")
    before = None
    for size, seconds, memory in rows:
        slopes = ["", ""]
        if before:
            over = math.log(size / before[0])
            slopes = [f"{math.log(now / then) / over:.2f}" for now, then in ((seconds, before[1]), (memory, before[2]))]
        print(f"| {size:,} | {seconds:.2f} | {slopes[0]} | {memory:.0f} | {slopes[1]} |", flush=True)
        before = (size, seconds, memory)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/voidwalk")
    parser.add_argument("--bench")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    sweeps = dict(SWEEPS)
    if options.bench:
        sweeps["grains of Cu 3, 600 steps of a compression"] = [
            (n, lambda _, __, n=n: [options.bench, "cu=3", f"grains={n}", "threads=1", "max_steps=600"]) for n in (300, 3000, 30_000, 300_000)]
    for name, sizes in sweeps.items():
        if options.only and not any(word in name for word in options.only):
            continue
        rows = []
        for size, command in sizes:
            with tempfile.TemporaryDirectory() as folder:
                turns = [measured(command(options.binary, f"{folder}/out-{turn}"), os.environ) for turn in range(options.turns)]
            rows.append((size, *map(min, zip(*turns))))
        table(name, rows)


if __name__ == "__main__":
    main()
