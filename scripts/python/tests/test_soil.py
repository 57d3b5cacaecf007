"""Gradations and curves, from wherever they come."""

from __future__ import annotations

import inspect
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import table

import voidwalk as vw

SIZES, PERCENTS = [0.1, 0.4, 1.0, 2.0], [0.0, 20.0, 60.0, 100.0]


def test_a_linear_gradation_is_its_formula() -> None:
    soil = vw.Gradation.linear(3.0, 0.5)
    for percent in (0, 10, 50, 85, 100):
        assert soil.d(percent) == pytest.approx(0.5 * 3.0 ** (percent / 50), rel=1e-12)
        assert soil.percent_finer(soil.d(percent)) == pytest.approx(percent, abs=1e-9)
    assert soil.d_by_number(50) < soil.d(50)


def test_arrays_a_file_and_a_data_frame_make_one_gradation(tmp_path: Path) -> None:
    soil = vw.Gradation(SIZES, PERCENTS)
    assert vw.Gradation.from_file(table(tmp_path, "soil", (SIZES, PERCENTS))) == soil
    assert vw.Gradation(SIZES[::-1], PERCENTS[::-1]) == soil
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"mm": SIZES, "finer": PERCENTS}).sample(frac=1, random_state=1)
    assert vw.Gradation.from_dataframe(frame, "mm", "finer") == soil
    with pytest.raises(ValueError, match="no column 'percent_finer'"):
        vw.Gradation.from_dataframe(frame, "mm")


def test_what_lies_in_the_pan_is_not_known() -> None:
    soil = vw.Gradation([0.075, 1.0], [30.0, 100.0])
    assert soil.pan_fraction == pytest.approx(0.3)
    with pytest.raises(ValueError, match="D10 is not known"):
        soil.cu
    assert vw.Gradation([0.075, 1.0], [30.0, 100.0], d0_mm=0.01).cu > 1


def test_gradations_and_curves_are_pickled_whole() -> None:
    for soil in (
        vw.Gradation.linear(3.0, 0.5),
        vw.Gradation.single(0.3),
        vw.Gradation([0.075, 1.0], [30.0, 100.0]),
        vw.Gradation(SIZES, PERCENTS),
    ):
        again = pickle.loads(pickle.dumps(soil))
        assert again == soil and again.d(85) == soil.d(85)
    curve = vw.Curve.shipped("cu1.5-loose", d0_mm=2.0)
    again_curve = pickle.loads(pickle.dumps(curve))
    assert np.array_equal(again_curve.points(), curve.points())
    assert again_curve.grains_per_void == curve.grains_per_void is not None


def test_a_shipped_curve_is_scaled_with_its_filter() -> None:
    one, two = vw.Curve.shipped("cu1.5-loose"), vw.Curve.shipped("cu1.5-loose", d0_mm=2.0)
    assert two.dc(50) == pytest.approx(2 * one.dc(50)) and one.cu == pytest.approx(two.cu)
    assert one.percent_smaller(one.dc(35)) == pytest.approx(35, abs=1e-6)


def test_a_walk_takes_a_soil_as_the_other_calls_do(tmp_path: Path) -> None:
    network = vw.Network.cubic([6, 6, 9])
    sizes, percents = [0.1, 0.3], [0.0, 100.0]
    soils = [vw.Gradation(sizes, percents), (sizes, percents), table(tmp_path, "base", (sizes, percents))]
    eroded = [vw.walk(network, soil, n_base=500, replicates=1).eroded_mass_fraction()[0] for soil in soils]
    assert eroded[0] == eroded[1] == eroded[2]


def test_sizes_and_percents_that_are_no_pair_are_refused_with_the_form_of_a_soil() -> None:
    for call in (vw.judge, vw.rules):
        with pytest.raises(ValueError, match=r"base = \[0.1, 0.5\] is not allowed; .* as \(\[0.1, 0.5\], \[0, 100\]\)"):
            call([0.1, 0.5], [0, 100])  # type: ignore[operator]


def test_help_says_what_each_key_of_a_dict_is() -> None:
    from voidwalk import columns, records, settings

    for module in (columns, records, settings):
        for name in module.__all__:
            of = getattr(module, name)
            keys = getattr(of, "__annotations__", None)
            # As help() reads it: from CPython 3.13 on a docstring has no indentation of its own.
            text = inspect.getdoc(of) or ""
            if keys and "Keys" in text:
                missing = [key for key in keys if re.search(rf"\n{key}\n    \S", text) is None]
                assert not missing, (name, missing)
    assert "eroded_mass_fraction" in (columns.Series.__doc__ or "")
