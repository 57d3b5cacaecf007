"""Packings and their constrictions."""

from __future__ import annotations

import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import voidwalk as vw


def test_a_cubic_packing_has_the_constrictions_of_geometry(grid: Any) -> None:
    found = vw.constrictions(*grid, cell=4.0)
    assert found["pore.coords"].shape == (64, 3) and found["throat.conns"].shape == (192, 2)
    assert found["throat.diameter"] == pytest.approx(np.sqrt(2) - 1)
    assert found["pore.diameter"] == pytest.approx(np.sqrt(3) - 1)
    assert found["pore.volume"] == pytest.approx(1 - np.pi / 6)
    assert found.grains_per_void == 1.0 and found.curve.dc(50) == pytest.approx(np.sqrt(2) - 1)
    # Two voids lie a cell apart where their constriction says so.
    between = (
        found["pore.coords"][found["throat.conns"][:, 1]]
        + 4.0 * found["throat.shift"]
        - found["pore.coords"][found["throat.conns"][:, 0]]
    )
    assert np.linalg.norm(between, axis=1) == pytest.approx(1.0)
    on_hulls = vw.constrictions(*grid, cell=4.0, facets="on_both_hulls")
    assert "throat.shift" not in on_hulls and len(on_hulls["throat.diameter"]) == 192


def test_units_carry_through(grid: Any) -> None:
    small = vw.constrictions(grid[0] / 1000, grid[1] / 1000, cell=4.0 / 1000)
    assert 1000 * small["throat.diameter"] == pytest.approx(np.sqrt(2) - 1)
    si = small.to_openpnm()
    assert si["throat.diameter"] == pytest.approx(small["throat.diameter"] / 1000)


def test_a_packing_is_that_of_the_command_line(program: str, tmp_path: Path) -> None:
    (tmp_path / "filter.toml").write_text(
        'filter.d0_mm = 0.8\nfilter.cu = 1.3\nfilter.density = "dense"\npacking.grains = 200\npacking.seed = 5\n'
    )
    subprocess.run([program, "pack", "filter.toml", "--out", "packing", "-q"], cwd=tmp_path, check=True)
    theirs = vw.read(tmp_path / "packing")
    ours = vw.pack(vw.Gradation.linear(1.3, 0.8), "dense", grains=200, seed=5)
    assert isinstance(theirs, vw.Packing)
    assert np.array_equal(ours.coords, theirs.coords) and np.array_equal(ours.diameter, theirs.diameter)
    assert ours.cell == theirs.cell and ours.reached["void_ratio"] == theirs.reached["void_ratio"]
    subprocess.run(
        [program, "constrictions", "packing/grains.csv", "--out", "c"], cwd=tmp_path, check=True, capture_output=True
    )
    rows = np.loadtxt(tmp_path / "c" / "constrictions.csv", delimiter=",", skiprows=1)
    found = ours.constrictions()
    assert np.array_equal(rows, np.stack([found["csd.percent_smaller"], found["csd.diameter"]], axis=1))


def test_a_packing_is_pickled_whole_and_read_only(grid: Any) -> None:
    packing = vw.pack(vw.Gradation.linear(1.2), "loose", grains=60, threads=1)
    again = pickle.loads(pickle.dumps(packing))
    assert np.array_equal(again.coords, packing.coords) and again.cell == packing.cell
    assert again.reached == packing.reached and packing.reached["seed"] == 1
    with pytest.raises(ValueError):
        packing.coords[0, 0] = 1.0
    found = pickle.loads(pickle.dumps(vw.constrictions(*grid, cell=4.0)))
    assert found.grains_per_void == 1.0


def test_a_dump_of_lammps_is_read(tmp_path: Path, grid: Any) -> None:
    rows = "".join(f"{i + 1} {x} {y} {z} 0.5\n" for i, (x, y, z) in enumerate(grid[0]))
    box = "".join(f"0 {length}\n" for length in (4.0, 4.0, 4.0))
    text = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n64\nITEM: BOX BOUNDS pp pp pp\n{box}"
    (tmp_path / "dump.txt").write_text(text + "ITEM: ATOMS id x y z radius\n" + rows)
    with pytest.raises(ValueError, match="does not say the unit of its lengths"):
        vw.Packing.from_lammps(tmp_path / "dump.txt")
    packing = vw.Packing.from_lammps(tmp_path / "dump.txt", unit="mm")
    assert packing.cell == (4.0, 4.0, 4.0) and len(packing) == 64
    assert vw.constrictions(packing)["throat.diameter"] == pytest.approx(np.sqrt(2) - 1)


def test_the_cell_of_a_file_is_text_or_lengths(tmp_path: Path, grid: Any) -> None:
    file = tmp_path / "spheres.txt"
    rows = "".join(f"{x / 1000} {y / 1000} {z / 1000} 0.0005\n" for x, y, z in grid[0])
    file.write_text("#format x_y_z_r\n" + rows)
    with pytest.raises(ValueError):
        vw.Packing.from_file(file, unit="m")
    for cell in ("0.004, 0.004, 0.004", (0.004, 0.004, 0.004), np.full(3, 0.004), 0.004):
        assert vw.Packing.from_file(file, unit="m", cell=cell).cell == pytest.approx((4.0, 4.0, 4.0))
    assert vw.Packing.from_file(file, unit="m", cell="none").cell is None
    with pytest.raises(ValueError, match=r"three lengths above 0"):
        vw.Packing.from_file(file, unit="m", cell=(0.004, 0.0, 0.004))


def test_the_voids_of_a_packing_are_walked() -> None:
    packing = vw.pack(vw.Gradation.linear(1.2), "dense", grains=150, seed=2)
    found = packing.constrictions()
    network = vw.Network.from_packing(found, copies=2)
    assert network.count == 2 * len(found["pore.coords"]) and network.exit == "flux"
    sizes = np.sort(found["throat.diameter"])
    nearest = sizes[np.clip(np.searchsorted(sizes, network.diameter * (1 - 1e-6)), 0, len(sizes) - 1)]
    assert network.diameter == pytest.approx(nearest, rel=1e-5)
    fine = vw.walk(network, 0.9 * float(found["throat.diameter"].min()), n_base=500, replicates=2)
    assert fine.eroded_mass_fraction().tolist() == [1.0, 1.0]
    again = pickle.loads(pickle.dumps(network))
    assert again.fingerprint == network.fingerprint
