"""The rules of practice, and the guard against exchanged soils."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

import voidwalk as vw

TILL = ([0.075, 0.425, 2.0, 4.75, 19.0], [35, 60, 82, 92, 100])
SAND = ([0.15, 0.3, 0.6, 1.18, 4.75], [4, 18, 42, 68, 100])


def test_rules_are_those_of_the_command_line(tmp_path: Path) -> None:
    files = []
    for name, (sizes, percents) in {"base": TILL, "filter": SAND}.items():
        rows = "".join(f"{size},{percent}\n" for size, percent in zip(sizes, percents))
        files.append(tmp_path / f"{name}.csv")
        files[-1].write_text("opening_mm,percent_finer\n" + rows)
    of_files = vw.rules(*files, joint_mm=2.0)
    of_arrays = vw.rules(vw.Gradation(*TILL), vw.Gradation(*SAND), joint_mm=2.0)
    assert of_arrays == of_files and of_files["base"]["category"] == 3
    program = os.environ.get("VOIDWALK_PROGRAM")
    if program:
        said = subprocess.run([program, "rules", *files, "--joint-mm", "2", "--json"], capture_output=True, check=True)
        assert json.loads(said.stdout) == of_files


def test_exchanged_soils_are_refused_unless_they_are_as_given() -> None:
    base, filter = vw.Gradation(*TILL), vw.Gradation(*SAND)
    with pytest.raises(ValueError, match="are the two files exchanged.*as_given=True"):
        vw.rules(filter, base)
    assert vw.rules(filter, base, as_given=True)["notes"][0]["id"] == "files_exchanged"
    with pytest.raises(ValueError, match="joint_mm = -1"):
        vw.rules(base, filter, joint_mm=-1)
