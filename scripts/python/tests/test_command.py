"""The command line that comes with the package: what it prints and how it ends is what the program prints and does."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, List

import pytest
from conftest import LONG

import voidwalk as vw

MODULE = [sys.executable, "-m", "voidwalk"]
BASE = "size_mm,percent\n0.5,100\n0.25,80\n0.125,45\n0.063,12\n"
FILTER = "size_mm,percent\n8,100\n4,85\n2,55\n1,25\n0.5,5\n"


def said(command: List[str], folder: Path, **more: Any) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=240, **more)


@pytest.fixture
def sheets(tmp_path: Path) -> Path:
    (tmp_path / "base.csv").write_text(BASE)
    (tmp_path / "filter.csv").write_text(FILTER)
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["--help"],
        ["judge", "-h"],
        ["jugde", "base.csv", "filter.csv"],
        ["rules", "base.csv", "filter.csv"],
        ["rules", "base.csv", "no-such-sheet.csv"],
        ["rules", "base.csv", "filter.csv", "--json"],
        ["init"],
        ["completions", "bash"],
    ],
)
def test_it_prints_and_ends_as_the_program_does(words: List[str], sheets: Path, program: str) -> None:
    ours, theirs = said([*MODULE, *words], sheets), said([program, *words], sheets)
    assert (ours.returncode, ours.stdout, ours.stderr) == (theirs.returncode, theirs.stdout, theirs.stderr)


def test_it_is_on_the_path_and_has_the_version_of_the_package(tmp_path: Path) -> None:
    script = Path(sys.executable).with_name("voidwalk.exe" if os.name == "nt" else "voidwalk")
    for command in ([str(script)], MODULE):
        done = said([*command, "--version"], tmp_path)
        assert done.returncode == 0 and done.stdout.startswith(f"voidwalk {vw.__version__}"), done


def test_a_reader_may_leave(tmp_path: Path) -> None:
    walking = subprocess.Popen([*MODULE, "init"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert walking.stdout is not None and walking.stderr is not None
    walking.stdout.close()
    assert (walking.wait(60), walking.stderr.read()) == (0, b"")
    walking.stderr.close()


@pytest.mark.skipif(os.name == "nt", reason="a signal is sent")
@pytest.mark.parametrize("asked", [signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_interrupted_ends_with_the_code_of_a_saved_run(
    asked: "signal.Signals", tmp_path: Path
) -> None:
    (tmp_path / "long.toml").write_text(vw.scene_text(LONG))
    walking = subprocess.Popen(
        [*MODULE, "run", "long.toml", "--out", "long"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "long" / "checkpoint").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    walking.send_signal(asked)
    _, errors = walking.communicate(timeout=120)
    assert walking.returncode == 3 and "voidwalk resume" in errors and "Traceback" not in errors, errors


@pytest.mark.skipif(os.name == "nt", reason="a signal is sent")
def test_the_page_is_served_until_ctrl_c(tmp_path: Path) -> None:
    serving = subprocess.Popen([*MODULE, "serve", "--port", "0"], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert serving.stdout is not None
    assert serving.stdout.readline().startswith("open http://127.0.0.1:")
    serving.send_signal(signal.SIGINT)
    assert serving.wait(60) == 0
    serving.stdout.close()


def test_a_run_names_the_command_that_began_it(small: Dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(vw.scene_text(small))
    words = ["run", "small.toml", "--out", "small", "--quiet"]
    assert said([*MODULE, *words], tmp_path).returncode == 0
    manifest = json.loads((tmp_path / "small" / "manifest.json").read_text())
    assert manifest["command"] == " ".join(["voidwalk", *words])


@pytest.mark.skipif(os.name == "nt", reason="scripts of a cluster are for sh")
def test_a_job_script_starts_the_package_again(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text('[[factor]]\nname = "cu"\nsetting = "base.cu"\nvalues = [1.5, 3]\n')
    done = said([*MODULE, "campaign", "plan.toml", "--out", "out", "--slurm"], tmp_path)
    assert done.returncode == 0, done.stderr
    script = (tmp_path / "out" / "slurm" / "array.sh").read_text()
    assert f"attempt.sh '{sys.executable}' '-m' 'voidwalk' campaign" in script, script
