"""A parameter study in a data frame: how coarse may the filter be for a base? A new network for each replicate.

    python scripts/examples/parameter_study.py [FIGURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import pandas

import voidwalk as vw

filter, curve = vw.Gradation.linear(1.5), vw.Curve.shipped("cu1.5-loose")
rows = []
for cu in (1.5, 3.0):
    for ratio in (3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0):
        base = vw.Gradation.linear(cu, filter.d(15) / ratio, percent=85)
        made = lambda seed: vw.Network.cubic([16, 16, 24], curve, seed=seed)
        result = vw.walk(made, base, filter=filter, grains_per_void=curve.grains_per_void, replicates=5)
        for run in result.summary:
            rows.append({"Cu of the base": cu, "D15F/D85B": ratio, "run": run["run"], "verdict": result.verdict,
                         **run["eroded_mass_fraction"]})
frame = pandas.DataFrame(rows)
print(frame.pivot_table(index="D15F/D85B", columns=["Cu of the base", "run"], values="mean").mul(100).round(2))
print(frame[frame["run"] == 1].pivot(index="D15F/D85B", columns="Cu of the base", values="verdict"))

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for (of_cu, of_run), part in frame.groupby(["Cu of the base", "run"]):
    low, high = 100 * (part["mean"] - part["low"]), 100 * (part["high"] - part["mean"])
    axes.errorbar(part["D15F/D85B"], 100 * part["mean"], yerr=[low, high], marker="o", ms=4, capsize=2,
                  ls="-" if of_run == 1 else "--", color="C0" if of_cu == 1.5 else "C1", label=f"Cu {of_cu}, run {of_run}")
axes.axhline(7.5, color="grey", lw=0.8)
axes.annotate("7.5 %", (0.995, 7.5), xycoords=("axes fraction", "data"), ha="right", va="bottom", color="grey", fontsize=8)
axes.set(xlabel="D15F / D85B", ylabel="base eroded (% of its mass)", title="Filter of Cu 1.5, loose")
axes.legend()
path = sys.argv[1] if len(sys.argv) > 1 else "parameter_study.png"
figure.savefig(path, dpi=150)
print(path)
