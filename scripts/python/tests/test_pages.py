"""Pages of results, and scenes and results that go from process to process."""

from __future__ import annotations

import multiprocessing
import re
from pathlib import Path
from typing import Any, Dict, Tuple

import numpy as np
import pytest
from conftest import lattice

import voidwalk as vw

#: What stands beside the verdict on every page.
LEFT_OUT = "What the model leaves out"


def without_times(page: str) -> str:
    """A page without the rows of facts that no two walks share."""
    page = re.sub(r"<td class=\"n\">[^<]*(?:\s|&nbsp;|\u202f)(?:s|ms|min)</td>", "", page)
    return re.sub(r"<tr><th>(Wall time[^<]*|Command|Started, finished)</th><td>[^<]*</td></tr>", "", page)


def test_a_walk_on_a_network_has_a_page(tmp_path: Path) -> None:
    result = vw.walk(lattice(), vw.Gradation.linear(1.5, 0.2, 85), n_base=5000, replicates=3)
    page = result.report(tmp_path / "page.html")
    text = page.read_text(encoding="utf-8")
    assert page == tmp_path / "page.html" and result.verdict in text.lower() and LEFT_OUT in text
    for part in ["each a new walk on the same network", "Blocked constrictions by layer", "324, 972, 9", "<svg"]:
        assert part in text, part
    assert "<script" not in text and "Content-Security-Policy" in text
    several = vw.walk(lambda seed: lattice(seed), 0.2, n_base=1000, replicates=2, filter=vw.Gradation.linear(1.5))
    text = several.report(tmp_path / "several.html").read_text(encoding="utf-8")
    assert "each a walk on a network of its own" in text and "Largest particle eroded, over D15F" in text


def test_a_walk_with_water_has_a_page(tmp_path: Path) -> None:
    ring = vw.Network([[0, 1], [1, 2], [0, 3], [3, 2]], [1.0, 1.0, 0.4, 0.4], inlets=[0], outlets=[2])
    result = vw.walk(ring, 0.5, n_base=1000, replicates=2, runs=1)
    text = result.report(tmp_path / "ring.html").read_text(encoding="utf-8")
    assert "hydraulics except direction" in text and "4, 4, 3" in text


def test_a_run_in_memory_has_the_page_of_its_folder(small: Dict[str, Any], tmp_path: Path) -> None:
    kept = vw.run(small, out=tmp_path / "run", threads=2)
    in_memory = vw.run(small, threads=2)
    page = in_memory.report(tmp_path / "page.html").read_text(encoding="utf-8")
    in_folder = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert without_times(page) == without_times(in_folder)
    assert kept.report(tmp_path / "copy.html").read_text(encoding="utf-8") == in_folder
    with pytest.raises(ValueError, match="path is missing"):
        in_memory.report()


def test_a_packed_filter_is_on_the_page_of_a_run_in_memory(small: Dict[str, Any], tmp_path: Path) -> None:
    scene = {**small, "filter": {"density": "dense", "cu": 1.2}, "packing": {"grains": 200}}
    scene["base"] = {"cu": 1.5, "d85_at_dc": 30}
    result = vw.run(scene, packings=tmp_path / "packings")
    assert "200 grains, friction 0" in result.report(tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_page_that_cannot_be_written_leaves_the_older_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = vw.walk(lattice(), 0.2, n_base=1000, replicates=2)
    page = result.report(tmp_path / "page.html")
    older = page.read_bytes()

    def full(path: Path, content: Any, *_: Any, **__: Any) -> int:
        with open(path, "wb") as file:
            file.write(b"half")
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", full)
        patched.setattr(Path, "write_text", full)
        with pytest.raises(OSError, match="No space"):
            result.report(page)
    assert page.read_bytes() == older and list(tmp_path.iterdir()) == [page]
    assert result.report(page).read_bytes() == older


def test_results_show_themselves_in_a_notebook(small: Dict[str, Any]) -> None:
    run, walk = vw.run(small), vw.walk(lattice(), 0.2, n_base=1000, replicates=2)
    for result, words in ((run, run.model["class"]), (walk, walk.verdict)):
        shown = result._repr_html_()
        assert f"<b>Model (research)</b>: {words}" in shown and "data:image/svg+xml;base64," in shown
        assert "95 % interval" in shown and "The model leaves out: " in shown and "<script" not in shown
        percent = 100 * result.summary[0]["eroded_mass_fraction"]["mean"]
        assert f"{percent:.3g}"[:3] in shown


def test_a_result_that_was_changed_is_refused(tmp_path: Path) -> None:
    def walked() -> vw.WalkResult:
        return vw.walk(lattice(), 0.2, n_base=1000, replicates=2)

    def refused(result: vw.WalkResult, words: str) -> None:
        with pytest.raises(ValueError, match=words):
            result.report(tmp_path / "page.html")
        assert not (tmp_path / "page.html").exists()

    result = walked()
    result.series["increment"] = result.series["increment"][::-1]
    refused(result, "series.csv.*increment is")
    result = walked()
    result.series["increment"] = result.series["increment"][1:]
    refused(result, "the columns of series differ in length")
    result = walked()
    result.layers["blocked"] = result.layers["blocked"].astype(np.float32)
    refused(result, "layers.*blocked.* is not the column that the walk gave")
    result = walked()
    del result.outcome["summary"]
    refused(result, "summary")
    with pytest.raises(ValueError, match="summary"):
        result._repr_html_()


def test_a_scene_is_what_it_says(small: Dict[str, Any], tmp_path: Path) -> None:
    scene = vw.Scene(small)
    assert scene.to_toml() == vw.scene_text(small) and scene.settings["replicates"] == 2
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    read = vw.Scene(tmp_path / "scene.toml")
    assert read == scene and hash(read) == hash(scene) and read != vw.Scene() and read != scene.to_toml()
    assert "seed 11, replicates 2" in repr(read) and "scene.toml" in repr(read)
    changed = vw.Scene(scene, {"base.cu": 3, "replicates": 1})
    assert changed.settings["base"]["cu"] == 3.0 and scene.settings["base"]["cu"] == 1.5
    assert vw.Scene.from_toml(scene.to_toml()) == scene
    settings = scene.settings
    settings["replicates"] = 99
    assert scene.settings["replicates"] == 2
    with pytest.raises(ValueError, match="base.cu: `0.1` is not allowed"):
        vw.Scene(scene, {"base.cu": 0.1})
    with pytest.raises(ValueError, match="my words"):
        vw.Scene.from_toml("[filter\n", "my words")
    with pytest.raises(AttributeError):
        scene.seed = 3  # type: ignore[attr-defined]


def test_scenes_walk_as_their_files_do(small: Dict[str, Any]) -> None:
    scene = vw.Scene(small)
    walked = [vw.run(scene), vw.run(small), vw.run(scene, settings={"replicates": 2})]
    assert all(result.summary == walked[0].summary for result in walked)
    assert vw.run(scene, settings={"seed": 12}).summary != walked[0].summary


def walked_elsewhere(scene: vw.Scene) -> Tuple[vw.Result, vw.WalkResult, vw.Scene]:
    """What a child process makes of a scene that it is handed."""
    return vw.run(scene), vw.walk(lattice(), 0.25, n_base=2000, replicates=2), scene


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_scenes_and_results_go_from_process_to_process(method: str, small: Dict[str, Any], tmp_path: Path) -> None:
    """After a walk here, so that a pool of threads that outlived it would hang a forked child."""
    scene = vw.Scene(small)
    here = walked_elsewhere(scene)
    context: Any = multiprocessing.get_context(method)
    with context.Pool(1) as pool:
        there = pool.apply_async(walked_elsewhere, (scene,)).get(timeout=120)
    assert there[2] == scene
    for ours, theirs in zip(here[:2], there[:2]):
        assert theirs.summary == ours.summary and repr(theirs) == repr(ours)
        for table in ("series", "layers", "retained", "eroded"):
            for key, column in getattr(ours, table).items():
                assert np.array_equal(getattr(theirs, table)[key], column), (table, key)
    assert np.array_equal(there[1].blocked, here[1].blocked)
    # What came back has its page, from what was pickled alone.
    for name, result in zip(("run", "walk"), there[:2]):
        assert LEFT_OUT in result.report(tmp_path / f"{name}.html").read_text(encoding="utf-8")
