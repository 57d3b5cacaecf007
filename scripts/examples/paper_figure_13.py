"""Fig. 13 of the paper: how continuing, some and no erosion come about, increment by increment.

    python scripts/examples/paper_figure_13.py [FIGURE.png]

The cases of scripts/campaigns/progress.toml with their networks as large as there, and 5 replicates instead of 10:
fewer are warned of.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import voidwalk as vw

#: Filter, the filter whose Dc the base is scaled by, Cu of the base, the Dc that is its D85.
CASES = {
    "continuing erosion": ("cu3-dense", "cu3-loose", 1.5, 5),
    "some erosion": ("cu1.5-dense", "cu1.5-loose", 3.0, 5),
    "no erosion": ("cu1.5-loose", "cu1.5-loose", 1.5, 50),
}

figure, panels = plt.subplots(1, 3, figsize=(12, 4), sharey=True, layout="constrained")
for axes, (name, (filter, scale, cu, dc)) in zip(panels, CASES.items()):
    result = vw.run(settings={
        "seed": 2016, "replicates": 5, "record.sensitivity": [], "filter.curve": filter, "base.dc_curve": scale,
        "base.cu": cu, "base.d85_at_dc": dc,
    })
    print(f"{name}: {result}")
    result.plot("progress", axes)
    axes.set_title(name)
path = sys.argv[1] if len(sys.argv) > 1 else "paper_figure_13.png"
figure.savefig(path, dpi=150)
print(path)
