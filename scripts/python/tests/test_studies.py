"""What the command line's studies are from Python: the same numbers and words for the same tables and options."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest
from conftest import ACROSS, BASE, FILTER, SMALL, table

import voidwalk as vw

COARSE = ([3.0, 5.0, 9.0], [0.0, 50.0, 100.0])
#: A broadly graded base that practice regrades, and a sand beside it.
TILL = ([0.075, 0.425, 2.0, 4.75, 19.0], [35, 60, 82, 92, 100])
SAND = ([0.15, 0.3, 0.6, 1.18, 4.75], [4, 18, 42, 68, 100])

#: What is not of the answer: times, places, and what was called.
TIMES = ("seconds", "core_seconds", "started", "finished", "folder")


def answer(record: Any) -> Any:
    """A record without its times; of files that are named, the name alone."""
    if isinstance(record, dict):
        return {key: answer(of) for key, of in record.items() if key not in TIMES}
    if isinstance(record, str):
        return re.sub(r"(\S*/)?(\w+)\.csv", r"\2", record)
    return [answer(of) for of in record] if isinstance(record, list) else record


def said(program: str, folder: Path, *words: str) -> Any:
    """What the command line prints as JSON for the same."""
    smaller = {"judge": SMALL, "boundary": ACROSS}.get(words[0], {})
    small = [word for key, value in smaller.items() for word in ("--set", f"{key}={value}")]
    done = subprocess.run([program, *words, *small, "--json"], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_judge_is_that_of_the_command_line(program: str, tmp_path: Path) -> None:
    base, filter = table(tmp_path, "base", BASE), table(tmp_path, "filter", FILTER)
    words = ["--quick", "--density", "dense", "--dispersive", "--joint-mm", "2", "--quiet", "--out", "o"]
    wanted = said(program, tmp_path, "judge", "base.csv", "filter.csv", *words)
    options: Dict[str, Any] = dict(quick=True, density="dense", dispersive=True, joint_mm=2.0, settings=SMALL)
    of_files = vw.judge(base, filter, **options)
    of_arrays = vw.judge(BASE, vw.Gradation(*FILTER), tmp_path / "out", **options)
    assert answer(of_files.outcome) == answer(wanted)
    assert answer(of_arrays.outcome) == answer(wanted) and of_arrays.outcome["inputs"]["base"]["name"] == "base"
    row, eroded = of_arrays.row(), wanted["summary"][0]["eroded_mass_fraction"]
    assert row["verdict"] == wanted["model"]["class"] and row["headline"] == wanted["headline"] and row["eroded_1"] == eroded["mean"]
    assert row["d15f_over_d85b"] == pytest.approx(wanted["ratios"]["d15f_over_d85b"])
    # A second call finds its results there.
    with pytest.raises(ValueError, match="overwrite=True"):
        vw.judge(BASE, FILTER, tmp_path / "out", **options)
    again = vw.judge(BASE, FILTER, tmp_path / "out", overwrite=True, **options)
    assert again.folder is not None and answer(again.outcome) == answer(wanted)


def test_a_specification_is_that_of_the_command_line(program: str, tmp_path: Path) -> None:
    sizes = [0.002, 0.005, 0.012, 0.03, 0.075, 0.18, 0.425, 0.85, 2.0, 4.75, 9.5, 19.0]
    core = (sizes, [0.0, 13.0, 28.0, 43.0, 60.0, 68.0, 75.0, 82.0, 90.0, 94.0, 97.0, 100.0])
    table(tmp_path, "base", core)
    wanted = said(program, tmp_path, "design", "base.csv", "--dispersive", "--sieves", "iso", "--quiet", "--out", "o")
    found = vw.specification(core, dispersive=True, sieves="iso")
    kept = vw.specification(tmp_path / "base.csv", tmp_path / "kept", dispersive=True, sieves="iso")
    for of in (found, kept, vw.read(tmp_path / "kept"), vw.read(tmp_path / "o")):
        assert isinstance(of, vw.Specification)
        # The name of the one curve is that of its file, or the argument's.
        assert answer(of.outcome) == answer(wanted)
        assert list(of.tables["limits"]["sieve"]) == [limit["sieve"] for limit in wanted["limits"]]
        shown = of.tables["limits"]["max_percent_finer"].tolist()
        # Sieves that have no limit are NaN in a column of numbers.
        assert [value if value == value else None for value in shown] == [limit["max_percent_finer"] for limit in wanted["limits"]]
        assert list(of.fits) == [product["product"] for product in wanted["products"]]
    assert found.folder is None and kept.report().name == "specification.html"
    assert found.d15f_max_mm == wanted["d15f_max_mm"] and found.band == wanted["band"] and found.no_band is None
    assert len(found.to_pandas("steps")) >= len(found.steps) == len(wanted["steps"])
    assert found.note is not None and found.answer in repr(found) and found.limits[0]["sieve"] in found._repr_html_()
    with pytest.raises(ValueError, match="table = all is not allowed; one of limits, steps, products"):
        found.to_pandas("all")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="sieves = din is not allowed; us or iso"):
        vw.specification(core, sieves="din")  # type: ignore[arg-type]


def test_a_specification_without_a_band_says_why() -> None:
    # Coarser than 0.075 mm, and its finest sieve lets half of it through: how much of it is fines is not known.
    found = vw.specification(([0.3, 1.0], [50.0, 100.0]))
    assert found.band is None and found.limits == [] and found.note is None
    assert found.answer == f"No band. {found.no_band}" and found.set_by is None
    assert found.outcome["no_band"]["id"] == "limit_not_known"


def test_boundaries_are_those_of_the_command_line(program: str, tmp_path: Path) -> None:
    table(tmp_path, "base", BASE), table(tmp_path, "filter", FILTER)
    words = ["--filter", "filter.csv", "--density", "dense", "--thickness", "10layers"]
    more = ["--set", "replicates=2", "--seed", "3", "--quiet", "--out", "o"]
    wanted = said(program, tmp_path, "boundary", "base.csv", *words, *more)
    options: Dict[str, Any] = dict(density="dense", thickness="10layers", replicates=2, seed=3)
    found = vw.boundary(BASE, FILTER, tmp_path / "d", settings=ACROSS, **options)
    # The settings say in their own order and form what was given.
    assert answer({**found.outcome, "settings": []}) == answer({**wanted, "settings": []})
    assert len(found.walks["d15f_over_d85b"]) == len(found.walks["eroded_first"]) > 2
    assert found.report().name == "boundary.html"
    again = vw.read(tmp_path / "d")
    assert isinstance(again, vw.Boundaries) and again.boundaries == found.boundaries and repr(found) == repr(again)


def test_percolation_and_soil_are_those_of_the_command_line(program: str, tmp_path: Path) -> None:
    wanted = said(program, tmp_path, "percolation", "--sizes", "6,8,6x6x10", "--realisations", "5", "--quiet")
    found = vw.percolation([6, 8, (6, 6, 10)], realisations=5)
    assert answer(found) == answer(wanted)
    path = table(tmp_path, "soil", BASE)
    assert vw.soil(path) == said(program, tmp_path, "soil", "soil.csv")["soils"]
    assert vw.soil(BASE) == vw.soil(vw.Gradation(*BASE)) == vw.soil(path)


def test_rules_are_those_of_the_command_line(program: str, tmp_path: Path) -> None:
    files = table(tmp_path, "base", TILL), table(tmp_path, "filter", SAND)
    of_files = vw.rules(*files, joint_mm=2.0)
    assert vw.rules(vw.Gradation(*TILL), vw.Gradation(*SAND), joint_mm=2.0) == of_files
    assert of_files["base"]["category"] == 3
    assert said(program, tmp_path, "rules", "base.csv", "filter.csv", "--joint-mm", "2") == of_files
    assert vw.rules(SAND, TILL, as_given=True)["notes"][0]["id"] == "files_exchanged"


def test_exchanged_tables_are_refused_everywhere(tmp_path: Path) -> None:
    calls: List[Any] = [
        lambda: vw.judge(FILTER, BASE),
        lambda: vw.judge(table(tmp_path, "f", FILTER), table(tmp_path, "b", BASE)),
        lambda: vw.rules(SAND, TILL),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="exchanged.*as_given=True") as refused:
            call()
        assert "--" not in str(refused.value) and "voidwalk-" not in str(refused.value)


def test_errors_name_what_python_calls_it() -> None:
    wrong: List[Any] = [
        (lambda: vw.judge(BASE, FILTER, settings={"base.uc": 3}), "there is no setting `base.uc`"),
        (lambda: vw.judge(BASE, FILTER, density="dens"), "density = dens is not allowed"),
        (lambda: vw.judge(BASE, FILTER, seed=1, settings={"seed": 2}), "seed and settings\\['seed'\\] say the same"),
        (lambda: vw.judge(BASE, FILTER, as_sampled=True, settings={"base.regrade": "no"}), "as_sampled=True and"),
        (lambda: vw.judge(BASE, vw.Gradation.single(1.0)), "filter has a single size"),
        (lambda: vw.rules(BASE, FILTER, joint_mm=-1), "joint_mm = -1"),
        (lambda: vw.judge(3, FILTER), "base = int is not allowed"),  # type: ignore[arg-type]
        (lambda: vw.boundary(BASE, density="thick"), "density thick: allowed"),
        (lambda: vw.boundary(BASE, thickness="thick"), "thickness thick: allowed"),
        (lambda: vw.boundary(BASE, thickness=50, settings={"network.nz": 10}), "thickness and settings network.nz"),
        (lambda: vw.percolation([0]), "sizes = 0 is not allowed"),
        (lambda: vw.run(settings={"base.uc": 3}), "there is no setting `base.uc`"),
        (lambda: vw.Gradation([1, 2], [0, 90]), "percent_finer"),
        (lambda: vw.walk(vw.Network.cubic([4, 4, 4]), None), "base = NoneType is not allowed"),  # type: ignore[arg-type]
        (lambda: vw.walk(vw.Network.cubic([4, 4, 4]), "b"), "b: cannot be read: No such file"),
        (lambda: vw.Packing.from_file(__file__), "."),
    ]
    for call, words in wrong:
        with pytest.raises(ValueError, match=words) as refused:
            call()
        said = str(refused.value)
        assert "--" not in said and "line 2" not in said, said


def test_a_study_is_a_table_with_a_row_a_case(small: Dict[str, Any]) -> None:
    pytest.importorskip("pandas")
    cases = {"base.cu": [1.5, 3.0], "seed": [1, 2]}
    found = vw.study(cases, small)
    assert list(found["base.cu"]) == [1.5, 1.5, 3.0, 3.0] and list(found["seed"]) == [1, 2, 1, 2]
    one = vw.run(small, settings={"base.cu": 3.0, "seed": 2})
    assert found["eroded_1"].iloc[3] == one.summary[0]["eroded_mass_fraction"]["mean"]
    network, base = vw.Network.cubic([6, 6, 9]), vw.Gradation.linear(1.5, 0.2, percent=85)
    listed = vw.study(
        [{"n": 500}, {"n": 1000}], lambda n: vw.walk(network, base, n_base=n, replicates=2), progress=True
    )
    assert list(listed["n"]) == list(listed["n_base"]) == [500, 1000] and not listed["verdict"].isna().any()


def test_networks_and_curves_compare_by_what_they_are() -> None:
    one, same, other = (vw.Network.cubic([6, 6, 9], seed=seed) for seed in (1, 1, 2))
    assert one == same and one != other and hash(one) == hash(same) and one != 3
    curve = vw.Curve([0, 100], [0.1, 0.3])
    assert curve == vw.Curve([0, 100], [0.1, 0.3]) and curve != vw.Curve([0, 100], [0.1, 0.4])
    assert vw.Curve.shipped("cu1.5-loose") == vw.Curve.shipped("cu1.5-loose") != vw.Curve.shipped("cu3-loose")


@pytest.mark.parametrize("exit", ["area", "flux", "area-along-flow"])
def test_a_network_without_constrictions_has_them_closed(exit: str) -> None:
    network = vw.Network.cubic([6, 6, 9], exit=exit)
    nothing = network.without(np.zeros(len(network), dtype=bool))
    for walked in (network, nothing):
        assert vw.walk(walked, 0.2, n_base=2000, replicates=2).verdict == "continuing erosion"
    probability, moves = network.first_passage(0.1)
    assert nothing.first_passage(0.1) == pytest.approx((probability, moves))
    closed = vw.walk(network, 0.3, n_base=2000, replicates=1).blocked
    assert closed is not None
    less = network.without(closed[0, 0])
    assert int((less.diameter == 0).sum()) == int(closed[0, 0].sum()) > 0
    assert less.grains_per_void == network.grains_per_void and less.filter == network.filter
    for wrong in (np.zeros(3, dtype=bool), np.zeros(len(network))):
        with pytest.raises(ValueError, match="mask is"):
            network.without(wrong)


def test_boxes_say_what_a_thing_is() -> None:
    assert "<strong>Gradation</strong>" in vw.Gradation(*BASE)._repr_html_()
    assert "finer than the finest sieve" in vw.Gradation([0.075, 1.0], [20, 100])._repr_html_()
    assert "324" in vw.Network.cubic([6, 6, 9])._repr_html_()


def test_a_judgement_of_arrays_that_was_stopped_goes_on(tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def enough(progress: vw.Progress) -> None:
        if progress.done > 1:
            raise Enough

    options: Dict[str, Any] = dict(density="dense", replicates=40, settings={**SMALL, "record.sensitivity": []})
    with pytest.raises(Enough):
        vw.judge(BASE, COARSE, tmp_path / "out", progress=enough, **options)
    assert not (tmp_path / "out" / "outcome.json").exists()
    gone_on = vw.judge(BASE, COARSE, tmp_path / "out", **options)
    assert answer(gone_on.summary) == answer(vw.judge(BASE, COARSE, **options).summary)
