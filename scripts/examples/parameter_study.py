"""A parameter study in a data frame: how coarse may the filter be for a base? A new network for each replicate.

    python scripts/examples/parameter_study.py [FIGURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import voidwalk as vw

filter, curve = vw.Gradation.linear(1.5), vw.Curve.shipped("cu1.5-loose")


def walked(cu: float, ratio: float) -> vw.WalkResult:
    """A base of this Cu, on a filter of this D15F/D85B."""
    base = vw.Gradation.linear(cu, filter.d(15) / ratio, percent=85)
    made = lambda seed: vw.Network.cubic([16, 16, 24], curve, seed=seed)
    return vw.walk(made, base, filter=filter, grains_per_void=curve.grains_per_void, replicates=5)


frame = vw.study({"cu": [1.5, 3.0], "ratio": [3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0]}, walked)
print(frame.pivot(index="ratio", columns="cu", values=["eroded_1", "eroded_2"]).mul(100).round(2))
print(frame.pivot(index="ratio", columns="cu", values="verdict"))

figure, axes = plt.subplots(layout="constrained")
for cu, part in frame.groupby("cu"):
    for run, style in (("eroded_1", "-"), ("eroded_2", "--")):
        mean, low, high = (100 * part[name] for name in (run, f"{run}_low", f"{run}_high"))
        axes.errorbar(part["ratio"], mean, yerr=[mean - low, high - mean], marker="o", ls=style, label=f"Cu {cu}, {run}")
axes.axhline(7.5, color="grey", lw=0.8, label="7.5 %")
axes.set(xlabel="D15F / D85B", ylabel="base eroded (% of its mass)", title="Filter of Cu 1.5, loose")
axes.legend()
path = sys.argv[1] if len(sys.argv) > 1 else "parameter_study.png"
figure.savefig(path, dpi=150)
print(path)
