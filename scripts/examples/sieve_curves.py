"""Your own sieve curves: two soils from arrays, judged by practice and by a walk, with constrictions from the library of packings.

    python scripts/examples/sieve_curves.py [FIGURE.png]
"""

import sys
import warnings

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import voidwalk as vw

filter = vw.Gradation([0.5, 1.0, 2.0, 4.0, 8.0], [0, 12, 45, 80, 100])
base = vw.Gradation([0.075, 0.15, 0.25, 0.5, 1.0], [0, 15, 45, 85, 100])
print(f"filter: D15 {filter.d(15):.3f} mm, Cu {filter.cu:.2f}; base: D85 {base.d(85):.3f} mm, Cu {base.cu:.2f}")
print(f"D15F / D85B = {filter.d(15) / base.d(85):.2f}")

with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    small = {"network.nx": 20, "network.ny": 20, "network.nz": 30}
    result = vw.judge(base, filter, density="loose", quick=True, settings=small)
for warning in said:
    print("warning:", warning.message)
print(result)

figure, axes = plt.subplots(layout="constrained")
result.plot("curves", axes)
axes.set_title(f"Practice: {result.headline}")
path = sys.argv[1] if len(sys.argv) > 1 else "sieve_curves.png"
figure.savefig(path, dpi=150)
print(path)
