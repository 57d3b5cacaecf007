"""Fig. 13 of the paper: how continuing, some and no erosion come about, increment by increment.

    python scripts/examples/paper_figure_13.py [FIGURE.png]

The cases of scripts/campaigns/progress.toml with their networks as large as there, and 5 replicates instead of 10:
fewer are warned of.
"""

from __future__ import annotations

import sys
from typing import Tuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import voidwalk as vw
from voidwalk.columns import Series

#: Filter, the filter whose Dc the base is scaled by, Cu of the base, the Dc that is its D85.
CASES = {
    "continuing erosion": ("cu3-dense", "cu3-loose", 1.5, 5, "#d55e00"),
    "some erosion": ("cu1.5-dense", "cu1.5-loose", 3.0, 5, "#e69f00"),
    "no erosion": ("cu1.5-loose", "cu1.5-loose", 1.5, 50, "#009e73"),
}


def mean_progress(series: Series, run: int) -> Tuple[NDArray[np.uint64], NDArray[np.float64]]:
    """Mean of the eroded share by increment over the replicates; a walk that has ended stays where it is."""
    of_run = series["run"] == run
    increments = np.arange(series["increment"][of_run].max() + 1)
    curves = []
    for replicate in np.unique(series["replicate"]):
        rows = of_run & (series["replicate"] == replicate)
        at = np.searchsorted(series["increment"][rows], increments, side="right")
        curves.append(np.concatenate([[0.0], series["eroded_mass_fraction"][rows]])[at])
    share: NDArray[np.float64] = np.mean(curves, axis=0)
    return increments, share


figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
for name, (filter, scale, cu, dc, colour) in CASES.items():
    scene = vw.Scene(settings={
        "seed": 2016, "replicates": 5, "record.sensitivity": [], "filter.curve": filter, "base.dc_curve": scale,
        "base.cu": cu, "base.d85_at_dc": dc,
    })
    result = vw.run(scene)
    print(f"{name}: {result}")
    for run, style in [(1, "-"), (2, "--")]:
        increments, share = mean_progress(result.series, run)
        axes.plot(increments, 100 * share, style, color=colour, label=f"{name}, run {run}")
axes.axhline(7.5, color="grey", lw=0.8)
axes.annotate("7.5 %", (0.995, 7.5), xycoords=("axes fraction", "data"), ha="right", va="bottom", color="grey",
              fontsize=8)
axes.set(xlim=(0, 350), ylim=(0, None), xlabel="increment of the run", ylabel="base eroded (% of its mass)",
         title="Fig. 13: progress of erosion")
axes.legend(fontsize=8)
path = sys.argv[1] if len(sys.argv) > 1 else "paper_figure_13.png"
figure.savefig(path, dpi=150)
print(path)
