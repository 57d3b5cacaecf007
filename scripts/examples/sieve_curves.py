"""Your own sieve curves: two soils from arrays, the filter's constrictions guessed from its gradation.

    python scripts/examples/sieve_curves.py [FIGURE.png]
"""

import csv
import sys
import tempfile
import warnings
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import voidwalk as vw

FILTER = ([0.5, 1.0, 2.0, 4.0, 8.0], [0, 12, 45, 80, 100])
BASE = ([0.075, 0.15, 0.25, 0.5, 1.0], [0, 15, 45, 85, 100])

filter, base = vw.Gradation(*FILTER), vw.Gradation(*BASE)
print(f"filter: D15 {filter.d(15):.3f} mm, Cu {filter.cu:.2f}; base: D85 {base.d(85):.3f} mm, Cu {base.cu:.2f}")
print(f"D15F / D85B = {filter.d(15) / base.d(85):.2f}")

with tempfile.TemporaryDirectory() as folder:
    for name, (sizes, percents) in {"filter": FILTER, "base": BASE}.items():
        with open(Path(folder) / f"{name}.csv", "w", newline="") as file:
            csv.writer(file).writerows([("opening_mm", "percent_finer"), *zip(sizes, percents)])
    scene = {
        "replicates": 5,
        "filter": {"sieve": f"{folder}/filter.csv", "estimate": 0.5},
        "base": {"sieve": f"{folder}/base.csv"},
        "network": {"nx": 20, "ny": 20, "nz": 30},
        "record": {"sensitivity": []},
    }
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        result = vw.run(scene)
for warning in said:
    print("warning:", warning.message)
print(result)

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for name, soil in {"filter": filter, "base": base}.items():
    axes.plot(*soil.points(), marker="o", label=name)
first = (result.eroded["replicate"] == 1) & (result.eroded["run"] == 1)
end = first & (result.eroded["increment"] == result.eroded["increment"][first].max())
axes.plot(result.eroded["diameter_mm"][end], result.eroded["percent_finer_by_mass"][end], label="eroded, run 1")
axes.set(xscale="log", xlabel="size (mm)", ylabel="finer by mass (%)", title=f"Practice: {result.headline}")
axes.legend()
path = sys.argv[1] if len(sys.argv) > 1 else "sieve_curves.png"
figure.savefig(path, dpi=150)
print(path)
