"""How long calls behave: Ctrl-C, callbacks, threads, processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import sysconfig
import threading
import time
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest
from conftest import LONG, lattice

import voidwalk as vw

#: Makes a call, and says how it ended and when.
CHILD = """
import signal, sys, time, voidwalk as vw
# A shell that starts something in the background has it ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
print("begun", flush=True)
try:
    eval(sys.argv[1])
    print("ended")
except KeyboardInterrupt as error:
    print("interrupted", time.time(), error)
"""


def interrupted(call: str, folder: Path, after: float = 2.0) -> "tuple[float, str]":
    """Seconds from Ctrl-C, so long after it began, to the end of a call in a process of its own, and what it said."""
    child = subprocess.Popen([sys.executable, "-c", CHILD, call], stdout=subprocess.PIPE, text=True, cwd=folder)
    assert child.stdout is not None and child.stdout.readline() == "begun\n"
    time.sleep(after)
    sent = time.time()
    child.send_signal(signal.SIGINT)
    word, at, *text = child.communicate(timeout=60)[0].split(maxsplit=2)
    assert word == "interrupted"
    return float(at) - sent, " ".join(text)


def test_ctrl_c_loses_nothing_that_was_saved(small: Dict[str, Any], tmp_path: Path) -> None:
    scene = {**small, "replicates": 3, "engine": "particles"}
    scene["base"] = {**small["base"], "n_base": 6_000_000}
    # It takes some seconds on a quick machine.
    _, text = interrupted(f"vw.run({scene!r}, out='run', checkpoint_every='1s')", tmp_path, after=0.4)
    assert "progress saved" in text and not (tmp_path / "run" / "outcome.json").exists()
    resumed = vw.resume(tmp_path / "run")
    whole = vw.run(scene)
    assert resumed.summary == whole.summary
    for key in whole.series:
        assert np.array_equal(resumed.series[key], whole.series[key]), key


#: Long calls, and the seconds in which Ctrl-C ends them: of a packing after fifty steps of nine
#: thousand grains, which take a few seconds in a build without optimisation.
LONG_CALLS = {
    f"vw.run({LONG!r})": 1.0,
    "vw.pack(vw.Gradation.linear(1.5), grains=9000)": 10.0,
    "vw.walk(vw.Network.cubic([20, 20, 30]), 0.2, n_base=2_000_000, replicates=500, engine='particles')": 1.0,
    "vw.campaign({'title': 't', 'set': {'replicates': 500, 'engine': 'particles', 'base.n_base': 2_000_000},"
    " 'case': [{'name': 'a', 'set': {'base.cu': 3}}]}, out='campaign')": 1.0,
}


@pytest.mark.parametrize("call", LONG_CALLS, ids=["run", "pack", "walk", "campaign"])
def test_ctrl_c_ends_every_long_call(call: str, tmp_path: Path) -> None:
    seconds, _ = interrupted(call, tmp_path)
    assert seconds < LONG_CALLS[call]


def test_other_threads_run_while_a_walk_walks(small: Dict[str, Any]) -> None:
    ticks: List[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.perf_counter()
    vw.walk(lattice(), vw.Gradation.linear(1.5, 0.2, 85), n_base=6_000_000, replicates=2, engine="particles", threads=1)
    ended = time.perf_counter()
    done.set()
    thread.join()
    inside = [t for t in ticks if begun < t < ended]
    assert ended - begun > 0.2 and len(inside) > (ended - begun) / 0.005 / 10


def test_a_callback_is_told_how_far_the_walk_is(small: Dict[str, Any]) -> None:
    told: List[vw.Progress] = []
    vw.run(small, progress=told.append)
    last = told[-1]
    assert (last.stage, last.done, last.total, last.finished) == ("walking", 4, 4, True)
    assert all(not p.finished for p in told[:-1]) and "stage='walking'" in repr(last)
    packed: List[vw.Progress] = []
    vw.pack(vw.Gradation.linear(1.2), grains=60, progress=packed.append)
    assert packed[-1].finished and packed[-1].increment > 0


def test_an_exception_in_a_callback_ends_the_walk_and_is_raised() -> None:
    class Enough(Exception):
        pass

    def enough(progress: vw.Progress) -> None:
        if progress.increment > 0:
            raise Enough(progress.increment)

    begun = time.time()
    with pytest.raises(Enough):
        vw.run(LONG, progress=enough)
    assert time.time() - begun < 30
    with pytest.raises(Enough):
        vw.walk(lattice(), 0.2, n_base=10_000, replicates=100_000, progress=enough)
    with pytest.raises(ValueError, match="progress = 3 is not allowed"):
        vw.walk(lattice(), 0.2, progress=3)  # type: ignore[arg-type]


def test_a_bar_is_shown_where_there_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("tqdm")
    vw.walk(lattice(), 0.2, n_base=1000, replicates=2, progress=True)
    assert "run" in capsys.readouterr().err


def test_threads_change_no_bit() -> None:
    base = vw.Gradation.linear(3.0, 0.25, 85)
    first, *others = (vw.walk(lattice(), base, n_base=20_000, replicates=3, threads=n) for n in (1, 2, 5, None))
    for other in others:
        assert other.summary == first.summary and np.array_equal(other.blocked, first.blocked)


def test_threads_of_python_share_everything() -> None:
    """Eight threads at once on the same soil, network, scene and callback: what comes is what one thread gets."""
    soil, network, scene = vw.Gradation.linear(1.5, 0.2, 85), lattice(), vw.Scene()
    told: List[vw.Progress] = []

    def all_of_it() -> "tuple[object, ...]":
        walked = vw.walk(network, soil, n_base=3000, replicates=2, threads=1, progress=told.append)
        page = walked._repr_html_()
        probability, _ = network.first_passage(0.2)
        return soil.d(15), probability, network.fingerprint, scene.to_toml(), page, walked.blocked.tobytes()

    expected = all_of_it()
    found: List["tuple[object, ...]"] = []
    barrier = threading.Barrier(8)

    def together() -> None:
        barrier.wait(60)
        found.extend(all_of_it() for _ in range(5))

    threads = [threading.Thread(target=together) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert len(found) == 40 and all(one == expected for one in found) and len(told) > 40


@pytest.mark.skipif(not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="an interpreter with a global lock")
def test_the_package_leaves_a_free_threaded_interpreter_free() -> None:
    """A module that does not say that it needs no lock has the interpreter take one, and says so in a warning."""
    code = "import sys, voidwalk\nprint(sys._is_gil_enabled())"
    said = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout == "False\n"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_in_a_callback_lets_both_go_on() -> None:
    """The child ends at once; what waits for the walk is the parent alone."""
    children: List[int] = []

    def fork(progress: vw.Progress) -> None:
        if not children:
            child = os.fork()
            if child == 0:
                os._exit(7)
            children.append(child)

    vw.walk(lattice(), 0.2, n_base=50_000, replicates=5, progress=fork)
    assert os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]) == 7
