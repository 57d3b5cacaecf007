"""A packing from discrete elements to its voids and constrictions, for ParaView.

    python scripts/examples/dem_packing.py [DUMP or CSV]

Without a file 2,000 grains are packed here. Writes dem_packing.vtu (voids as points, constrictions as lines) and
dem_packing.png; the .vtu needs nothing but NumPy, PyVista shows it where it is installed.
"""

from __future__ import annotations

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import ArrayLike, NDArray

import voidwalk as vw


def write_vtu(path: str, found: vw.Constrictions) -> None:
    """Voids and the constrictions between those that lie in one cell, as an unstructured grid in text."""
    conns = found["throat.conns"]
    keep: NDArray[np.bool_] = np.ones(len(conns), dtype=bool)
    if "throat.shift" in found:
        keep = np.all(found["throat.shift"] == 0, axis=1)
    points, lines = found["pore.coords"], conns[keep]
    columns = {"PointData": ("void_diameter_mm", found["pore.diameter"]),
               "CellData": ("constriction_diameter_mm", found["throat.diameter"][keep])}
    def array(name: str, kind: str, values: ArrayLike, parts: int = 1) -> str:
        text = " ".join(map(str, np.ravel(values).tolist()))
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{parts}" format="ascii">{text}</DataArray>\n'
    with open(path, "w") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n'
                   f'<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(lines)}">\n')
        file.write(f'<Points>{array("points", "Float64", points, 3)}</Points>\n<Cells>')
        file.write(array("connectivity", "Int64", lines))
        file.write(array("offsets", "Int64", 2 * np.arange(1, len(lines) + 1)))
        file.write(array("types", "UInt8", np.full(len(lines), 3)) + "</Cells>\n")
        for where, (name, values) in columns.items():
            file.write(f"<{where}>{array(name, 'Float64', values)}</{where}>\n")
        file.write("</Piece></UnstructuredGrid></VTKFile>\n")


if len(sys.argv) > 1:
    packing = vw.Packing.from_file(sys.argv[1])
else:
    packing = vw.pack(vw.Gradation.linear(1.5), "dense", grains=2000)
found = packing.constrictions()
print(packing)
print(found, f"{found.grains_per_void:.3f} grains per void")
curve = found.curve
print("  ".join(f"Dc{percent} {curve.dc(percent):.4f} mm" for percent in (5, 35, 50, 85)))
write_vtu("dem_packing.vtu", found)
try:
    import pyvista  # type: ignore[import-not-found,unused-ignore]  # pyright: ignore

    print(pyvista.read("dem_packing.vtu"))
except ImportError:
    pass

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
found.plot(left).set_title("Constriction sizes")
connectivity = np.bincount(found["throat.conns"].ravel(), minlength=len(found["pore.coords"]))
right.scatter(found["pore.diameter"], connectivity, s=4, alpha=0.3)
right.set(xlabel="void diameter (mm)", ylabel="constrictions of the void", title="Voids")
figure.savefig("dem_packing.png", dpi=150)
print("dem_packing.vtu dem_packing.png")
