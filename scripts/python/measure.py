"""Measures what the Python package costs: handing arrays in and out beside the walk, memory beside the command line's.

    target/python/bin/python scripts/python/measure.py [handing memory]

Every figure is the median of several runs (RUNS of the environment, else 3), each of handing and of memory in a process of
its own. The program is target/release/voidwalk, or what VOIDWALK_PROGRAM names.
"""

from __future__ import annotations

import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any, Dict, List

import numpy as np

import voidwalk as vw

#: Runs of which a median is taken.
RUNS = int(os.environ.get("RUNS", "3"))

#: Lattices by the number of their constrictions, which are handed in and out as arrays.
LATTICES = {"1e6": (69, 69, 70), "1e7": (408, 408, 20)}

#: The base that is walked, and what Eq. (2) takes of the filter.
FILTER, BASE = vw.Gradation.linear(1.5), vw.Gradation.linear(1.5, 0.2, 85)
GRAINS_PER_VOID = vw.Curve.shipped("cu1.5-loose").grains_per_void


def said_by(*arguments: str) -> Dict[str, Any]:
    """What this script says when it is started again in a process of its own."""
    line = [sys.executable, __file__, *arguments]
    said: Dict[str, Any] = json.loads(subprocess.run(line, check=True, capture_output=True, text=True).stdout)
    return said


def one_handing(shape: List[int]) -> Dict[str, float]:
    """Processor seconds of handing a network in, of its walk, and of handing out what came of it.

    The walk of a single particle costs what is around a walk: the record, the columns, the blocked constrictions.
    """
    lattice = vw.Network.cubic(shape)
    # Fresh arrays, as another program would have them.
    conns, diameter = np.array(lattice.conns), np.array(lattice.diameter)
    inlets, outlets, count = np.array(lattice.inlets), np.array(lattice.outlets), lattice.count
    del lattice
    usual = {"runs": 1, "replicates": 1, "threads": 1}
    n_base = BASE.base_particles(FILTER, count, GRAINS_PER_VOID)
    marks = [time.process_time()]
    network = vw.Network(conns, diameter, inlets, outlets, exit="area", count=count)
    marks.append(time.process_time())
    vw.walk(network, BASE, n_base=1, increments=1, **usual)
    marks.append(time.process_time())
    result = vw.walk(network, BASE, n_base=n_base, **usual)
    marks.append(time.process_time())
    out = network._native.conns(), network._native.diameter(), result.blocked.copy()
    marks.append(time.process_time())
    taken_in, around, walk, taken_out = np.diff(marks).tolist()
    found = {"in": taken_in, "around": around, "walk": walk - around, "out": taken_out}
    return {**found, "throats": len(out[1]), "particles": n_base, "share": (taken_in + around + taken_out) / found["walk"]}


def handing() -> None:
    print(f"handing arrays in and out, beside the walk of one run (processor seconds on one thread, median of {RUNS}):")
    for name, shape in LATTICES.items():
        runs = [said_by("one_handing", json.dumps(shape)) for _ in range(RUNS)]
        found = {key: median(run[key] for run in runs) for key in runs[0]}
        print(
            f"  {name} ({found['throats']:,.0f} constrictions, {found['particles']:,.0f} particles): "
            f"in {found['in']:.2f} s, around the walk {found['around']:.2f} s, out {found['out']:.2f} s; "
            f"walk {found['walk']:.1f} s: {100 * found['share']:.2f} % of it",
            flush=True,
        )


def peak_mb(line: List[str]) -> float:
    """Most memory that a program has had when it ends."""
    child = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(line)}: ended with {status}")
    return usage.ru_maxrss / 1024


#: A large lattice, of which memory is compared: what base there is changes little of it, unless each particle is followed.
LARGE = {"network.nx": 100, "network.ny": 100, "network.nz": 40, "runs": 1}

#: Scenes whose peak memory is compared; a small one shows what interpreter and NumPy take.
SCENES: Dict[str, Dict[str, Any]] = {
    "20 x 20 x 30 voids": {"network.nx": 20, "network.ny": 20, "network.nz": 30, "runs": 1},
    "100 x 100 x 40 voids": {**LARGE, "base.n_base": 1_000_000},
    "the same, 1e7 particles one by one": {**LARGE, "engine": "particles", "base.n_base": 10_000_000},
}


def memory() -> None:
    program = os.environ.get("VOIDWALK_PROGRAM", "target/release/voidwalk")
    print("most memory, of the same scene by both, two threads, one replicate:")
    for name, settings in SCENES.items():
        scene = vw.Scene(settings={**settings, "replicates": 1, "record.sensitivity": []})
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scene.toml"
            file.write_text(scene.to_toml())
            theirs = [program, "run", str(file), "--out", f"{folder}/cli", "--overwrite", "--threads", "2", "-q"]
            code = f"import voidwalk; voidwalk.run({str(file)!r}, out={folder + '/python'!r}, overwrite=True, threads=2)"
            in_memory = f"import voidwalk; voidwalk.run({str(file)!r}, threads=2)"
            lines = {"command line": theirs, "Python": [sys.executable, "-c", code], "Python, in memory": [sys.executable, "-c", in_memory]}
            peaks = {side: median(peak_mb(line) for _ in range(RUNS)) for side, line in lines.items()}
        said = ", ".join(f"{side} {peak:.0f} MB" for side, peak in peaks.items())
        least = peaks["command line"]
        ratios = ", ".join(f"{peaks[side] / least:.2f}" for side in list(peaks)[1:])
        print(f"  {name}: {said}: {ratios} times")


def main() -> None:
    if sys.argv[1:2] == ["one_handing"]:
        print(json.dumps(one_handing(json.loads(sys.argv[2]))))
        return
    load = ", ".join(f"{of:.1f}" for of in os.getloadavg())
    print(f"voidwalk {vw.__version__}, Python {platform.python_version()}, NumPy {np.__version__}, load {load}")
    for part in sys.argv[1:] or ["handing", "memory"]:
        {"handing": handing, "memory": memory}[part]()
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"load {os.getloadavg()[0]:.1f} at the end; the largest child took {peak:.0f} MB")


if __name__ == "__main__":
    main()
