"""Scenes by Python and by the command line: every file equal but for times and the command."""

from __future__ import annotations

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest

import voidwalk as vw

SCENES: Dict[str, List[str]] = {
    "as it is": [],
    "counts": ["engine=counts", "base.cu=3"],
    "particles": ["engine=particles", "base.cu=2"],
    "expected": ["engine=expected", "base.cu=3"],
    "stratified": ["sampling=stratified"],
    "one run": ["runs=1", "replicates=3"],
    "a study of sensitivity": ["record.sensitivity=[0.5, 2]", "record.sensitivity_replicates=2"],
    "constrictions from the gradation": ["filter.curve=", "filter.estimate=0.5", "filter.cu=3"],
    "a packed filter": [
        "filter.curve=", "filter.density=dense", "filter.cu=1.2", "packing.grains=200", "base.d85_at_dc=30",
    ],
    "water through the voids of a packing": [
        "filter.curve=", "filter.density=dense", "filter.cu=1.2", "packing.grains=200", "network.kind=graph",
        "network.nx=", "network.ny=", "network.nz=", "network.copies=2", "base.d85_at_dc=30",
    ],
    "water through a lattice": ["walk.exit=flux"],
    "what each void came to": ["record.voids=[1, 5]"],
    "arches": ["walk.arching=zuriguel-2005", "base.d85_at_dc=2"],
    "arches in a suspension": ["walk.arching=marin-2018", "walk.concentration=0.05"],
}  # fmt: skip

#: Numbers and words that no two calls share.
OWN = [
    (r'"(seconds|started|finished|command|commit|core_seconds)": .*', r'"\1": ...'),
    (r"\d\d\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ", "..."),
    # A packing's record holds the time that it took.
    (r'(packing\.json"[^}]*"xxh3": )"[0-9a-f]+"', r"\1..."),
    (r"packing\.json \(XXH3 [0-9a-f]{16}\)", "packing.json"),
    (r">[^<>]*\ss<", ">... s<"),
    (r">[^<>]*(voidwalk run|voidwalk\.run)[^<>]*<", ">...<"),
    (r"0\.1\.0 \((commit )?[0-9a-f]{12}\)", "0.1.0"),
    (r"commit [0-9a-f]{12}|[0-9.e-]+ (?:min|h|core-s)\b", "..."),
]


def files(folder: Path) -> Dict[str, str]:
    """What a run folder holds, without what no two calls share."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not path.name.startswith("."):
            text = path.read_text(encoding="utf-8")
            for pattern, instead in OWN:
                text = re.sub(pattern, instead, text)
            found[str(path.relative_to(folder))] = text
    return found


def stated(small: Dict[str, Any], settings: List[str]) -> Dict[str, Any]:
    """A scene as a dict: the small one with these settings, those without a value taken away."""
    scene: Dict[str, Any] = json.loads(json.dumps(small))
    for setting in settings:
        key, value = setting.split("=")
        section, _, name = key.rpartition(".")
        table = scene.setdefault(section, {}) if section else scene
        if value:
            table[name] = json.loads(value) if value[0] in "[0123456789" else value
        else:
            del table[name]
    return scene


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_gives_the_same_files_as_the_command_line(
    name: str, small: Dict[str, Any], program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = stated(small, SCENES[name])
    for side in ("theirs", "ours"):
        (tmp_path / side).mkdir()
        (tmp_path / side / "scene.toml").write_text(vw.scene_text(scene))
    command = [program, "run", "scene.toml", "--out", "run", "--threads", "2", "-q"]
    subprocess.run(command, cwd=tmp_path / "theirs", check=True, capture_output=True)
    monkeypatch.chdir(tmp_path / "ours")
    ours = vw.run("scene.toml", out="run", threads=2)
    left, right = files(tmp_path / "theirs" / "run"), files(tmp_path / "ours" / "run")
    assert left.keys() == right.keys() and {"outcome.json", "series.csv", "report.html"} <= left.keys()
    for file in left:
        assert left[file] == right[file], file
    said = json.loads((tmp_path / "ours" / "run" / "outcome.json").read_text())
    assert (ours.model, ours.summary, ours.outcome) == (said["model"], said["summary"], said)
    # Once more from the dict, in memory: the same columns.
    memory = vw.run(scene, threads=1)
    assert memory.summary == ours.summary and memory.folder is None
    for table in ("series", "layers", "retained", "eroded", "flow", "retained_by_void", "blockings"):
        kept, read = getattr(memory, table), getattr(ours, table)
        assert kept.keys() == read.keys()
        for key in kept:
            assert kept[key].dtype == read[key].dtype and np.array_equal(kept[key], read[key]), (table, key)


def test_errors_have_the_words_of_the_command_line(small: Dict[str, Any], program: str, tmp_path: Path) -> None:
    for broken in [
        'seed = "one"\n',
        "sed = 1\n",
        "[filter\n",
        '[filter]\ncurve = "no such"\n[base]\ncu = 1.5\nd85_at_dc = 5\n',
        "[base]\ncu = 0.5\nd85_at_dc = 5\n",
        "[network]\nnx = 0\n",
    ]:
        file = tmp_path / "broken.toml"
        file.write_text(broken)
        said = subprocess.run([program, "run", str(file), "--out", str(tmp_path / "o")], capture_output=True, text=True)
        assert said.returncode == 2
        with pytest.raises(ValueError) as error:
            vw.run(file, out=tmp_path / "o")
        assert said.stderr == f"refused: {error.value}\n"
        assert not (tmp_path / "o").exists()


def test_a_folder_with_results_is_replaced_only_when_asked(small: Dict[str, Any], tmp_path: Path) -> None:
    first = vw.run(small, out=tmp_path / "run")
    with pytest.raises(ValueError, match="holds a run already"):
        vw.run(small, out=tmp_path / "run")
    again = vw.run(small, out=tmp_path / "run", overwrite=True)
    assert again.summary == first.summary
    with pytest.raises(ValueError, match="this run is finished"):
        vw.resume(tmp_path / "run")


def test_a_file_too_large_is_a_failure_with_its_way_out(small: Dict[str, Any], tmp_path: Path) -> None:
    code = (
        "import json, resource, sys, voidwalk as vw\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))\n"
        "try:\n    vw.run(json.loads(sys.argv[1]), out=sys.argv[2])\n"
        "except vw.VoidwalkError as error:\n    print(error)\n"
    )
    command = [sys.executable, "-c", code, json.dumps(small), str(tmp_path / "run")]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "File too large" in said and "ulimit -f" in said


@pytest.mark.parametrize(
    "scene, words",
    [
        ({"seed": float("nan")}, "JSON"),
        ({"seed": {1, 2}}, "is not allowed in a scene"),
        ({"filter": {"colour": "blue"}}, "colour"),
        ({"seed": "one"}, "seed"),
        ([1, 2], "PathLike"),
    ],
)
def test_what_is_no_scene_is_refused(scene: Any, words: str) -> None:
    with pytest.raises((ValueError, TypeError), match=words):
        vw.run(scene)


def test_settings_change_a_scene_as_set_does(small: Dict[str, Any]) -> None:
    numpy_scene = {**small, "seed": np.int64(11), "base": {"cu": np.float64(1.5), "d85_at_dc": 5, "d85_mm": None}}
    assert vw.scene_text(numpy_scene) == vw.scene_text(small)
    changed = vw.scene_text(small, {"base.cu": 3.0, "filter.thickness_mm": None, "record.sensitivity": [2.0]})
    assert "cu = 3.0" in changed and "sensitivity = [2.0]" in changed
    assert vw.init_text().startswith("#")


def test_results_are_read_pickled_and_tabulated(small: Dict[str, Any], tmp_path: Path) -> None:
    made = vw.run(small, out=tmp_path / "run")
    read = vw.read(tmp_path / "run")
    assert isinstance(read, vw.Result)
    for result in (read, pickle.loads(pickle.dumps(made))):
        assert result.outcome == made.outcome and np.array_equal(result.series["eroded"], made.series["eroded"])
    assert made.model["class"] in repr(made)
    pandas = pytest.importorskip("pandas")
    frame = made.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(made.series["eroded"])
    with pytest.raises(ValueError, match="table = rows"):
        made.to_pandas("rows")
    pytest.importorskip("xarray")
    cube = made.to_xarray()
    assert cube["eroded"].dims == ("replicate", "run", "increment")
    assert made.to_xarray("layers")["blocked"].shape == (2, 2, 16)


def test_a_campaign_is_walked_and_read(small: Dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "base.toml").write_text(vw.scene_text(small))
    plan = (
        'title = "two bases"\nscene = "base.toml"\n\n[[factor]]\nname = "cu"\n'
        'setting = "base.cu"\nvalues = [1.5, 2]\n'
    )
    (tmp_path / "plan.toml").write_text(plan)
    done = vw.campaign(tmp_path / "plan.toml", out=tmp_path / "campaign")
    assert len(done) == 2 and done.cases["case"].tolist() == ["cu=1.5", "cu=2"]
    again = vw.read(tmp_path / "campaign")
    assert isinstance(again, vw.CampaignResult) and again.cases.keys() == done.cases.keys()
