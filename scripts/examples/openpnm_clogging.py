"""A network of OpenPNM that clogs: where particles block it, and what water it still lets through.

    python scripts/examples/openpnm_clogging.py [FIGURE.png]

Without OpenPNM the same cubic network is built from arrays.
"""

from __future__ import annotations

import sys
from typing import Dict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import voidwalk as vw

SHAPE, draw = (16, 16, 24), np.random.default_rng(5)


def cubic_arrays() -> Dict[str, NDArray[np.generic]]:
    """Voids on a grid of 1 mm, each joined to its six neighbours, with the labels of OpenPNM."""
    number = np.arange(np.prod(SHAPE)).reshape(SHAPE)
    conns = np.concatenate([
        np.stack([number.take(range(n - 1), axis).ravel(), number.take(range(1, n), axis).ravel()], axis=1)
        for axis, n in enumerate(SHAPE)
    ])
    coords = 1e-3 * np.stack(np.meshgrid(*map(np.arange, SHAPE), indexing="ij"), axis=-1).reshape(-1, 3)
    z = coords[:, 2]
    return {"throat.conns": conns, "pore.coords": coords, "pore.bottom": z == 0, "pore.top": z == z.max()}


try:
    import openpnm as op  # type: ignore[import-untyped,import-not-found,unused-ignore]

    pn = op.network.Cubic(shape=SHAPE, spacing=1e-3)
except ImportError:
    pn = cubic_arrays()
count = len(pn["throat.conns"])
pn["throat.diameter"] = 1e-4 * draw.lognormal(mean=1.0, sigma=0.35, size=count)
network = vw.Network.from_openpnm(pn, "bottom", "top")
base = vw.Gradation.linear(2.0, float(np.quantile(network.diameter, 0.15)), percent=50)
result = vw.walk(network, base, n_base=200_000, replicates=4)
print(network)
print(result)

assert result.blocked is not None and network.coords is not None
blocked = result.blocked[:, 0].mean(axis=0)
ends = network.coords[network.conns][:, :, 2]
where, is_along = ends.mean(axis=1), np.abs(ends[:, 1] - ends[:, 0]) > 0.5
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
# Water runs downwards: more of it goes through the constrictions between two layers than through those within one.
for label, these, colour in [("between layers", is_along, "C0"), ("within a layer", ~is_along, "C1")]:
    depths = np.unique(np.round(where[these], 6))
    share = [100 * blocked[these & np.isclose(where, depth)].mean() for depth in depths]
    left.plot(share, depths, marker="o", ms=3, color=colour, label=label)
left.invert_yaxis()
left.legend(fontsize=8)
left.set(xlabel="constrictions blocked (%)", ylabel="depth (mm)", title="After the first run")
for replicate in range(1, 5):
    rows = (result.flow["replicate"] == replicate) & (result.flow["run"] == 1)
    right.plot(result.flow["increment"][rows], result.flow["k_over_k0"][rows], lw=0.9, label=f"replicate {replicate}")
right.set(xlabel="increment of the first run", ylabel="conductance over the first one", title="Water")
right.legend(fontsize=8)
path = sys.argv[1] if len(sys.argv) > 1 else "openpnm_clogging.png"
figure.savefig(path, dpi=150)
print(path)
