"""Figures: what is drawn, with which words and units."""

from __future__ import annotations

import subprocess
import sys
from typing import Any, List

import numpy as np
import pytest
from conftest import ACROSS, BASE, FILTER, SMALL

import voidwalk as vw

matplotlib: Any = pytest.importorskip("matplotlib")
matplotlib.use("Agg")


def words(ax: Any) -> List[str]:
    legend = ax.get_legend()
    return [ax.get_xlabel(), ax.get_ylabel(), *(t.get_text() for t in (legend.get_texts() if legend else []))]


def drawn(ax: Any) -> bytes:
    """The picture itself, as it is drawn."""
    ax.figure.canvas.draw()
    picture = bytes(ax.figure.canvas.buffer_rgba())
    matplotlib.pyplot.close(ax.figure)
    return picture


def test_soils_and_curves_are_drawn_with_units() -> None:
    from matplotlib import pyplot

    soil = vw.Gradation(*FILTER)
    ax = soil.plot(label="Filter")
    assert vw.Gradation(*BASE).plot(ax, label="Base") is ax
    assert words(ax) == ["Size (mm)", "Percent finer by mass", "Filter", "Base"] and ax.get_xscale() == "log"
    assert np.array_equal(ax.lines[0].get_xdata(), soil.points()[0])
    curve = vw.Curve.shipped("cu1.5-loose").plot()
    assert words(curve) == ["Constriction diameter (mm)", "Percent smaller by number"]
    _, given = pyplot.subplots()
    assert soil.plot(given) is given
    assert drawn(soil.plot()) == drawn(soil.plot()) != drawn(vw.Gradation(*BASE).plot())


def test_a_network_is_drawn_by_size_and_by_layer() -> None:
    network = vw.Network.cubic([6, 6, 9])
    assert words(network.plot()) == ["Constriction diameter (mm)", "Percent smaller by number"]
    blocked = vw.walk(network, 0.3, n_base=2000, replicates=1).blocked
    assert blocked is not None
    ax = network.plot(blocked=blocked[0, 0])
    assert words(ax) == ["Layer, along the flow", "Blocked constrictions (%)"]
    assert max(ax.lines[0].get_ydata()) > 0 and len(ax.lines[0].get_xdata()) == 9
    with pytest.raises(ValueError, match="blocked has shape"):
        network.plot(blocked=[True])


def test_a_result_is_drawn_in_four_ways() -> None:
    result = vw.judge(BASE, FILTER, density="dense", quick=True, settings=SMALL)
    progress = words(result.plot())
    assert progress[:2] == ["Increment", "Eroded mass (% of the mass inserted)"] and "Erosion begins" in progress
    assert words(result.plot("layers"))[1] == "Blocked constrictions (%)"
    assert {"Base, as walked", "Filter", "Constrictions, by number"} <= set(words(result.plot("curves")))
    rules = result.plot("rules")
    assert len(rules.get_yticks()) > 3 and "kept up to 1" in rules.get_xlabel()
    # A boundary of continuing erosion that is not reached is no good news.
    at = [label.get_text() for label in rules.get_yticklabels()].index("Foster and Fell: boundary of continuing erosion")
    assert tuple(rules.collections[0].get_facecolors()[at][:3]) == (127 / 255, 127 / 255, 127 / 255)
    with pytest.raises(ValueError, match="what = 'all' is not allowed; one of progress, layers, curves, rules"):
        result.plot("all")
    walked = vw.walk(vw.Network.cubic([6, 6, 9]), 0.2, n_base=1000, replicates=2)
    for what in ("progress", "layers", "curves"):
        walked.plot(what)
    # Replicates come to rest at different increments; nothing that has eroded comes back.
    of_run = walked.series["run"] == 1
    ends = [walked.series["increment"][of_run & (walked.series["replicate"] == one)].max() for one in (1, 2)]
    assert ends[0] != ends[1]
    mean = walked.plot("progress").lines[0].get_ydata()
    assert np.all(np.diff(mean) >= 0)
    assert mean[-1] == pytest.approx(100 * walked.summary[0]["eroded_mass_fraction"]["mean"])
    with pytest.raises(ValueError, match="voidwalk.rules gives them"):
        walked.plot("rules")
    matplotlib.pyplot.close("all")


def test_studies_are_drawn() -> None:
    found = vw.boundary(BASE, FILTER, density="dense", thickness="10layers", replicates=2, settings=ACROSS)
    assert words(found.plot())[:2] == ["D15F/D85B", "Eroded mass of the first run (%)"]
    matplotlib.pyplot.close("all")


def test_a_specification_is_drawn_with_its_band() -> None:
    sizes = [0.002, 0.005, 0.0125, 0.03, 0.075, 0.15, 0.3, 0.6, 1.2, 2.0, 4.75, 9.5, 19.0]
    found = vw.specification((sizes, [0, 15, 30, 45, 60, 66, 72, 79, 85, 90, 94, 97, 100]))
    ax = found.plot()
    said = words(ax)
    assert said[:2] == ["Size (mm)", "Percent finer by mass"] and ax.get_xscale() == "log"
    assert {"Base, as sampled", "Base, regraded", "Filter, fine side", "Filter, coarse side"} <= set(said)
    band = found.band
    assert band is not None
    (coarse,) = [line for line in ax.lines if line.get_label() == "Filter, coarse side"]
    assert list(coarse.get_xdata()) == [point[0] for point in band["coarse_side"]]
    bare = vw.specification(([0.3, 1.0], [50, 100]))
    assert "Filter, fine side" not in words(bare.plot())
    matplotlib.pyplot.close("all")


def test_matplotlib_is_imported_when_a_figure_is_asked_for() -> None:
    code = "import sys, voidwalk; assert not {'matplotlib', 'pandas', 'xarray'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
