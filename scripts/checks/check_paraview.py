#!/usr/bin/env python3
"""Reads what `voidwalk export` wrote for ParaView with two other readers.

    pip install meshio vtk
    scripts/checks/check_paraview.py RUN/export

RUN has kept its voids (`record.voids`). Every moment that `voids.pvd` and `constrictions.pvd` name is read by VTK and by meshio; both must
see the same points, cells and numbers, lines of two ends, as many constrictions blocked as `blocked_at` says, and none that opens
again. Not part of the tests: VTK is large.
"""

import argparse
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import meshio
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def moments(series):
    """Times and files of a `.pvd`."""
    sets = ElementTree.parse(series).getroot().iter("DataSet")
    return [(float(one.get("timestep")), series.parent / one.get("file")) for one in sets]


def read(path):
    """A grid by VTK, and the same numbers by meshio."""
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid, other = reader.GetOutput(), meshio.read(path)
    if not numpy.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), other.points):
        sys.exit(f"{path}: other points by meshio")
    columns = {}
    for index in range(grid.GetCellData().GetNumberOfArrays()):
        array = grid.GetCellData().GetArray(index)
        columns[array.GetName()] = vtk_to_numpy(array)
        if not numpy.array_equal(columns[array.GetName()], other.cell_data[array.GetName()][0]):
            sys.exit(f"{path}: other {array.GetName()} by meshio")
    if sum(len(block.data) for block in other.cells) != grid.GetNumberOfCells():
        sys.exit(f"{path}: other cells by meshio")
    return grid, columns


def check(folder):
    """Both series."""
    before = None
    for kind, cell in [("voids", vtk.VTK_VERTEX), ("constrictions", vtk.VTK_LINE)]:
        times = moments(folder / f"{kind}.pvd")
        if [t for t, _ in times] != sorted({t for t, _ in times}):
            sys.exit(f"{kind}.pvd: times do not rise")
        for time, path in times:
            grid, columns = read(path)
            if grid.GetNumberOfCells() and {grid.GetCellType(i) for i in (0, grid.GetNumberOfCells() - 1)} != {cell}:
                sys.exit(f"{path}: other cells than asked for")
            if kind == "constrictions":
                blocked, at = columns["blocked"] == 1, columns["blocked_at"]
                if not (numpy.array_equal(blocked, at >= 0) and at.max(initial=-1) <= time):
                    sys.exit(f"{path}: blocked and blocked_at differ")
                if before is not None and numpy.any(before & ~blocked):
                    sys.exit(f"{path}: a blocked constriction is open again")
                before = blocked
                print(f"{path.name}: time {time:g}, {len(blocked)} constrictions, {blocked.sum()} blocked")
            else:
                held = columns["retained_in_constrictions_in_this_run"] + columns["retained_in_voids_in_this_run"]
                print(f"{path.name}: time {time:g}, {len(held)} voids, {held.sum():g} particles in {(held > 0).sum()} of them")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    check(parser.parse_args().folder)


if __name__ == "__main__":
    main()
