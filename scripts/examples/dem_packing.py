"""A packing from discrete elements to its voids and constrictions.

    python scripts/examples/dem_packing.py [DUMP or CSV]

Without a file 2,000 grains are packed here. Writes dem_packing.png. For ParaView `voidwalk constrictions` writes the grains and
the constrictions of such a file as .vtp.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import voidwalk as vw

if len(sys.argv) > 1:
    packing = vw.Packing.from_file(sys.argv[1])
else:
    packing = vw.pack(vw.Gradation.linear(1.5), "dense", grains=2000)
found = packing.constrictions()
print(packing)
print(found, f"{found.grains_per_void:.3f} grains per void")
curve = found.curve
print("  ".join(f"Dc{percent} {curve.dc(percent):.4f} mm" for percent in (5, 35, 50, 85)))

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
found.plot(left).set_title("Constriction sizes")
connectivity = np.bincount(found["throat.conns"].ravel(), minlength=len(found["pore.coords"]))
right.scatter(found["pore.diameter"], connectivity, s=4, alpha=0.3)
right.set(xlabel="void diameter (mm)", ylabel="constrictions of the void", title="Voids")
figure.savefig("dem_packing.png", dpi=150)
print("dem_packing.png")
