"""Measures what the Python package costs: arrays in and out, calls, a walk beside the command line's.

    target/python/bin/python scripts/python/measure.py

Times are the least of several; `tracemalloc` counts NumPy's memory alone, so copies are told by shared memory.
"""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable

import numpy as np

import voidwalk as vw


def least(times: int, call: Callable[[], object]) -> float:
    """The least wall time (s) of some calls."""
    taken = []
    for _ in range(times):
        begun = time.perf_counter()
        call()
        taken.append(time.perf_counter() - begun)
    return min(taken)


def peak_mb() -> float:
    """Most memory that the process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    print(f"voidwalk {vw.__version__}, Python {platform.python_version()}, NumPy {np.__version__}, load {os.getloadavg()[0]:.1f}")
    draw = np.random.default_rng(1)

    # Ten million diameters: into a packing, whose arrays are views, and on into the library.
    million = 10_000_000
    diameter, coords = draw.uniform(0.5, 1.0, million), draw.uniform(0, 500, (million, 3))
    seconds = least(3, lambda: vw.Packing(coords, diameter, 500.0))
    packing = vw.Packing(coords, diameter, 500.0)
    shared = np.shares_memory(packing.diameter, diameter) and np.shares_memory(packing.coords, coords)
    print(f"Packing of 1e7 grains: {1e3 * seconds:.0f} ms to look through, memory shared: {shared}")
    del packing, coords, diameter

    # A million constrictions in, and back out.
    count = 340_000
    conns = np.stack([draw.integers(0, count - 1, 1_000_000), np.zeros(1_000_000, dtype=int)], axis=1)
    conns[:, 1] = np.minimum(conns[:, 0] + draw.integers(1, 50, 1_000_000), count - 1)
    conns = conns[conns[:, 0] != conns[:, 1]]
    size = draw.uniform(0.1, 0.4, len(conns))
    sides = np.arange(200), np.arange(count - 200, count)
    before = peak_mb()
    made = lambda: vw.Network(conns, size, *sides, count=count)
    seconds = least(3, made)
    network = made()
    shared = np.shares_memory(network.conns, conns)
    print(f"Network of {len(conns)} constrictions from arrays: {seconds:.2f} s, {peak_mb() - before:.0f} MB more at most, shared: {shared}")
    seconds = least(3, lambda: vw.Network(conns, size, *sides, count=count, exit="area"))
    print(f"  with a direction: {seconds:.2f} s")
    seconds = least(3, lambda: (network._native.conns(), network._native.diameter()))
    print(f"  back out of the library: {seconds:.3f} s")
    directed = vw.Network(conns, size, *sides, count=count, exit="area")
    result = vw.walk(directed, 0.15, n_base=1000, runs=1, replicates=2, series_every=0)
    print(f"  blocked by constriction of {result.blocked.shape} comes with its walk")

    # Ten million diameters out: the rows of series are few, the constrictions of a lattice are many.
    lattice = None

    def cubic() -> None:
        nonlocal lattice
        lattice = vw.Network.cubic([150, 150, 150])

    seconds = least(1, cubic)
    assert lattice is not None
    print(f"Lattice of {len(lattice)} constrictions: {seconds:.2f} s to draw and hand out")
    out = least(3, lambda: lattice._native.diameter())
    print(f"  its diameters out as float64: {1e3 * out:.0f} ms")
    del lattice

    small = vw.Network.cubic([4, 4, 4])
    call = least(200, lambda: vw.walk(small, 0.1, n_base=10, increments=1, runs=1, replicates=1, threads=1))
    print(f"The smallest walk: {1e3 * call:.2f} ms a call")
    soil = vw.Gradation.linear(1.5)
    print(f"Gradation.d: {1e6 * least(10, lambda: [soil.d(15) for _ in range(1000)]) / 1000:.2f} us a call")

    program = os.environ.get("VOIDWALK_PROGRAM", "target/release/voidwalk")
    if Path(program).exists():
        settings = {"network.nx": 30, "network.ny": 30, "record.sensitivity": [], "base.cu": 3}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "s.toml").write_text(vw.scene_text(settings=settings))
            line = [program, "run", f"{folder}/s.toml", "--out", f"{folder}/o", "--overwrite", "-q"]
            theirs = least(3, lambda: subprocess.run(line, check=True))
            ours = least(3, lambda: vw.run(f"{folder}/s.toml", out=f"{folder}/p", overwrite=True))
        print(f"A scene into a folder: {ours:.2f} s by Python, {theirs:.2f} s by the command line")
    print(f"import voidwalk: {least(3, lambda: subprocess.run([sys.executable, '-c', 'import voidwalk'], check=True)):.2f} s", end="")
    print(f", import numpy: {least(3, lambda: subprocess.run([sys.executable, '-c', 'import numpy'], check=True)):.2f} s")


if __name__ == "__main__":
    main()
