"""The examples, as a reader starts them: each ends well, says what came out, and draws."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Dict, List

import pytest
from conftest import ROOT

#: What each says of its results, and the modules besides NumPy and matplotlib that it cannot do without.
SAID: Dict[str, List[str]] = {
    "first_verdict": ["model: continuing erosion", "run 2:"],
    "sieve_curves": ["D15F / D85B", "Result("],
    "dem_packing": ["Packing(2000 grains", "grains per void", "Dc85"],
    "openpnm_clogging": ["Network(", "WalkResult("],
    "parameter_study": ["eroded_1", "continuing erosion"],
    "paper_figure_13": [f"{words} erosion: Result(model: " for words in ("continuing", "some", "no")],
}
NEEDS = {"parameter_study": "pandas"}


def test_every_example_is_here() -> None:
    # The others are for the program: the gallery, which `.ci/run` makes.
    of_the_package = [
        path for path in (ROOT / "scripts" / "examples").glob("*.py") if "\nimport voidwalk" in path.read_text()
    ]
    assert {path.stem for path in of_the_package} == set(SAID)


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", SAID)
def test_an_example_runs_and_draws(name: str, tmp_path: Path) -> None:
    image = pytest.importorskip("matplotlib.image")
    pytest.importorskip(NEEDS.get(name, "numpy"))
    script = ROOT / "scripts" / "examples" / f"{name}.py"
    environment = {**os.environ, "MPLCONFIGDIR": str(tmp_path / "matplotlib")}
    # What a reader should know is said by the example itself: nothing is warned of.
    command = [sys.executable, "-W", "error", str(script)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for words in SAID[name]:
        assert words in done.stdout
    # A picture with something on it: a blank one has one colour.
    picture = image.imread(tmp_path / f"{name}.png")
    colours = {tuple(colour) for colour in picture.reshape(-1, picture.shape[-1])[::7].tolist()}
    assert min(picture.shape[:2]) > 400 and len(colours) > 20
