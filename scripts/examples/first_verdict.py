"""The built-in scene, smaller: the model's class, its uncertainty, and how the base leaves the filter.

    python scripts/examples/first_verdict.py [FIGURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import voidwalk as vw

result = vw.run(settings={"network.nx": 20, "network.ny": 20, "network.nz": 30, "record.sensitivity": []})
print(result)
for run in result.summary:
    eroded = run["eroded_mass_fraction"]
    low, high = eroded["low"], eroded["high"]
    # One replicate has no interval.
    interval = "" if low is None or high is None else f", {100 * low:.2f} to {100 * high:.2f} % at 95 %"
    print(f"run {run['run']}: {100 * eroded['mean']:.2f} % of the mass eroded{interval}")

figure, axes = plt.subplots(layout="constrained")
result.plot("progress", axes)
axes.set_title(f"Model: {result.model['class']}")
path = sys.argv[1] if len(sys.argv) > 1 else "first_verdict.png"
figure.savefig(path, dpi=150)
print(path)
