#!/usr/bin/env python3
"""Permeability of simple, body-centred and face-centred cubic arrays of equal spheres in creeping flow.

The steady Stokes equations

    nu lap(u) - grad(p) + F = 0,    div(u) = 0,    u = 0 on the spheres,

are solved in the periodic cell by a lattice-Boltzmann scheme: nineteen velocities, an equilibrium linear in
the velocity, two relaxation times whose magic parameter 3/16 makes the steady state independent of the
viscosity nu, and a body force F along a cube edge. The no-slip wall lies at its true place on every link, by
central linear interpolation (Ginzburg, Verhaeghe and d'Humieres, Commun. Comput. Phys. 3 (2008) 427), so the
error falls as the square of the grid spacing; where the node this needs is solid, the wall is taken half-way.

Darcy's law gives the permeability k, with <u> the mean velocity over the whole cell, spheres included:

    k = nu <u> / F,    k / D^2 = 1 / (18 c K),

where D is the spheres' diameter, c the solid fraction and K the force on a sphere over 6 pi mu (D / 2) <u>,
Stokes's drag at the mean velocity. The solver's unit of length is the grid spacing; all printed numbers are
dimensionless.

Only one sphere's share of space is solved: half the cube of the body-centred lattice and a quarter of that of
the face-centred one, closed by the lattice's own translations. Each value is the mean over a few positions of
the spheres relative to the grid; its scatter is the standard deviation over them. The extrapolated k is k0 of

    k = k0 + slope / cells^2,

fitted to the three finest grids. Its uncertainty is the largest of: the change of k0 when the fit is made
without the finest grid, half the distance from k0 to the finest grid's k, and twice the standard error of the
finest grid's mean.

Needs NumPy and a C compiler; runs in one thread.
"""

import argparse
import ctypes
import math
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

KERNEL = r"""
#include <stddef.h>

enum { Q = 19 };
/* Velocities 2m - 1 and 2m are opposite; 0 is rest. */
static const int CX[Q] = {0, 1,-1, 0, 0, 0, 0, 1,-1, 1,-1, 1,-1, 1,-1, 0, 0, 0, 0};
static const int CY[Q] = {0, 0, 0, 1,-1, 0, 0, 1,-1,-1, 1, 0, 0, 0, 0, 1,-1, 1,-1};
static const int CZ[Q] = {0, 0, 0, 0, 0, 1,-1, 0, 0, 0, 0, 1,-1,-1, 1, 1,-1,-1, 1};
static int opposite(int q) { return q == 0 ? 0 : (q % 2 ? q + 1 : q - 1); }

/* Advances by some steps under unit force along x; returns the x velocity summed over the fluid nodes, as the
   mean of the last two steps: nodes shut in beside a contact keep a part that changes its sign every step. */
double flow_run(int nodes, const int *sources, const int *first_link, const int *link_velocity, const int *link_behind,
                const double *link_weight, double *now, double *next, int steps, double viscosity, double magic) {
    const double even = 1.0 / (3.0 * viscosity + 0.5), odd = 1.0 / (magic / (3.0 * viscosity) + 0.5);
    double total = 0.0, before = 0.0;
    for (int step = 0; step < steps; step++) {
        before = total;
        total = 0.0;
        for (int i = 0; i < nodes; i++) {
            const int *source = sources + (size_t)i * Q;
            double p[Q], density = 0.0, ux = 0.5, uy = 0.0, uz = 0.0;
            for (int q = 0; q < Q; q++) p[q] = now[source[q]];
            for (int l = first_link[i]; l < first_link[i + 1]; l++) {
                const int q = link_velocity[l];
                const double gap = now[link_behind[l] * Q + opposite(q)] - now[i * Q + q];
                p[q] += link_weight[l] * gap;
            }
            for (int q = 0; q < Q; q++) density += p[q];
            for (int q = 1; q < Q; q++) { ux += CX[q] * p[q]; uy += CY[q] * p[q]; uz += CZ[q] * p[q]; }
            total += ux;
            double *out = next + (size_t)i * Q;
            out[0] = p[0] - even * (p[0] - density / 3.0);
            for (int q = 1; q < Q; q += 2) {
                const double w = q < 7 ? 1.0 / 18.0 : 1.0 / 36.0;
                const double half_sum = 0.5 * (p[q] + p[q + 1]), half_gap = 0.5 * (p[q] - p[q + 1]);
                const double change_even = even * (half_sum - w * density);
                const double along = CX[q] * ux + CY[q] * uy + CZ[q] * uz;
                const double push = (1.0 - 0.5 * odd) * 3.0 * w * CX[q];
                const double change_odd = odd * (half_gap - 3.0 * w * along) - push;
                out[q] = p[q] - change_even - change_odd;
                out[q + 1] = p[q + 1] - change_even + change_odd;
            }
        }
        double *swap = now; now = next; next = swap;
    }
    return 0.5 * (before + total);
}
"""


#: The velocities of the kernel, and the opposite of each.
VELOCITIES = np.array([[int(number) for number in row.split(",")] for row in re.findall(r"C[XYZ]\[Q\] = \{(.*)\}", KERNEL)]).T
OPPOSITE = np.array([0, *(q + 1 if q % 2 else q - 1 for q in range(1, 19))])


class Lattice:
    """A cubic lattice: the spheres in its unit cube and the block, one sphere's share, that is solved."""

    def __init__(self, centres, contact, parts, y_wrap_x, z_wrap, refinement):
        self.centres = centres
        self.contact = contact  # diameter over cube edge at contact
        self.parts = parts  # blocks per cube along y and z
        self.y_wrap_x = y_wrap_x  # offset along x that goes with one block along y, in cube edges
        self.z_wrap = z_wrap  # offsets along x and y that go with one block along z, in cube edges
        self.refinement = refinement  # cells per cube edge over those of the simple cubic lattice

    def fraction(self, diameter_ratio=1.0):
        """Solid fraction at a diameter given in terms of the one at contact."""
        return len(self.centres) * math.pi / 6 * (self.contact * diameter_ratio) ** 3

    def diameter(self, fraction):
        """Sphere diameter over cube edge at a solid fraction."""
        return (6 * fraction / (math.pi * len(self.centres))) ** (1 / 3)


LATTICES = {
    "SC": Lattice([(0, 0, 0)], 1.0, (1, 1), 0, (0, 0), 1.0),
    "BCC": Lattice([(0, 0, 0), (0.5, 0.5, 0.5)], math.sqrt(0.75), (1, 2), 0, (0.5, 0.5), 1.5),
    "FCC": Lattice(
        [(0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0)], math.sqrt(0.5), (2, 2), 0.5, (0.5, 0), 2.0
    ),
}

# Known drag: (lattice, solid fraction, K). Simple cubic from Zick and Homsy, J. Fluid Mech. 115 (1982) 13,
# table 2; body-centred cubic from the series of Sangani and Acrivos, Int. J. Multiphase Flow 8 (1982) 343, at
# diameters 0.6, 0.7 and 0.8 of that at contact, where its thirty-one terms suffice.
KNOWN_DRAG = [
    ("SC", 0.027, 2.008),
    ("SC", 0.064, 2.810),
    ("SC", 0.125, 4.292),
    ("SC", 0.216, 7.442),
    ("SC", 0.343, 15.4),
    ("SC", 0.45, 28.1),
    ("BCC", LATTICES["BCC"].fraction(0.6), 5.108),
    ("BCC", LATTICES["BCC"].fraction(0.7), 8.565),
    ("BCC", LATTICES["BCC"].fraction(0.8), 16.85),
]

# The same at contact.
KNOWN_CONTACT_DRAG = {"SC": 42.1}

MAGIC = 3 / 16
CHECK_EVERY = 100  # steps


def load_kernel(compiler, folder):
    """Compiles the solver and declares its function."""
    source, library = Path(folder, "kernel.c"), Path(folder, "kernel.so")
    source.write_text(KERNEL)
    options = ["-O3", "-march=native", "-shared", "-fPIC"]
    subprocess.run([compiler, *options, "-o", library, source, "-lm"], check=True)
    run = ctypes.CDLL(str(library)).flow_run
    whole, real = np.ctypeslib.ndpointer(np.int32), np.ctypeslib.ndpointer(np.float64)
    run.argtypes = [ctypes.c_int, whole, whole, whole, whole, real, real, real, ctypes.c_int, ctypes.c_double, ctypes.c_double]
    run.restype = ctypes.c_double
    return run


def grid_shift(number):
    """Offset of the spheres from the grid, in cells: points that fill the unit cube evenly."""
    return [(number + 1) * step % 1 for step in (0.8191725134, 0.6710436067, 0.5497004779)]


class Block:
    """The block that is solved: its grid nodes, and the spheres in the cube."""

    def __init__(self, lattice, cells, radius, shift):
        self.side, self.radius = cells, radius
        self.size = [cells, cells // lattice.parts[0], cells // lattice.parts[1]]
        self.y_wrap_x = round(lattice.y_wrap_x * cells)
        self.z_wrap_x, self.z_wrap_y = [round(wrap * cells) for wrap in lattice.z_wrap]
        self.centres = np.array(lattice.centres, dtype=float) * cells + np.array(shift)
        z, y, x = np.meshgrid(*[np.arange(n) for n in self.size[::-1]], indexing="ij")
        nodes = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
        inside = [(self.to_nearest(nodes, centre) ** 2).sum(axis=1) < radius * radius for centre in self.centres]
        is_fluid = ~np.any(inside, axis=0)
        #: The number of each node among those in the fluid; -1 in a sphere.
        self.number = np.where(is_fluid, np.cumsum(is_fluid) - 1, -1)
        self.nodes = nodes[is_fluid]

    def to_nearest(self, points, centre):
        """From the nearest image of a sphere to these points."""
        away = points - centre
        return away - self.side * np.floor(away / self.side + 0.5)

    def number_at(self, points):
        """The numbers of nodes of which some lie outside the block."""
        x, y, z = points.T
        step = z // self.size[2]
        x, y, z = x - step * self.z_wrap_x, y - step * self.z_wrap_y, z - step * self.size[2]
        step = y // self.size[1]
        x, y = (x - step * self.y_wrap_x) % self.size[0], y - step * self.size[1]
        return self.number[(z * self.size[1] + y) * self.size[0] + x]

    def wall_distance(self, nodes, velocity):
        """Share of the link from a fluid node to a solid one that lies in the fluid."""
        nearest, cc = np.ones(len(nodes)), float((velocity**2).sum())
        for centre in self.centres:
            # The image of the sphere that is nearest to the link's solid end.
            away = self.to_nearest(nodes + velocity, centre) - velocity
            cd, dd = (away * velocity).sum(axis=1), (away**2).sum(axis=1)
            root = cd * cd - cc * (dd - self.radius * self.radius)
            at = (-cd - np.sqrt(np.maximum(root, 0.0))) / cc
            nearest = np.where((root >= 0.0) & (at >= 0.0), np.minimum(nearest, at), nearest)
        return nearest

    def flow(self):
        """Where each population is pulled from, the wall links in the order of their nodes, and populations at rest: as the kernel wants them."""
        me, source, links = np.arange(len(self.nodes)), [], []
        for q, velocity in enumerate(VELOCITIES):
            behind_wall = self.number_at(self.nodes - velocity)
            source.append(np.where(behind_wall >= 0, behind_wall * 19 + q, me * 19 + OPPOSITE[q]))
            behind = self.number_at(self.nodes + velocity)
            at = np.flatnonzero((behind_wall < 0) & (behind >= 0))
            share = self.wall_distance(self.nodes[at], VELOCITIES[OPPOSITE[q]])
            links.append((at, np.full(len(at), q), behind[at], (1.0 - 2.0 * share) / (1.0 + 2.0 * share)))
        node, velocities, behind, weights = (np.concatenate(part) for part in zip(*links))
        order = np.argsort(node, kind="stable")
        first = np.concatenate([[0], np.cumsum(np.bincount(node, minlength=len(me)))])
        whole = [np.ascontiguousarray(part, dtype=np.int32) for part in (np.stack(source, axis=1), first, velocities[order], behind[order])]
        return [len(me), *whole, np.ascontiguousarray(weights[order]), *(np.zeros(len(me) * 19) for _ in range(2))]


def permeability(kernel, lattice, fraction, cells, shift, tolerance):
    """k / D^2 on one grid, and the number of steps to the steady state."""
    diameter = lattice.diameter(fraction) * cells
    block = Block(lattice, cells, diameter / 2, shift)
    viscosity = min(2.0, 0.25 / fraction)  # sets the pace to the steady state, not the result
    flow, steps, mean, change = block.flow(), 0, 0.0, math.inf
    while not change <= tolerance:
        # An even number of steps ends in the array in which it began.
        before, mean = mean, kernel(*flow, CHECK_EVERY, viscosity, MAGIC) / math.prod(block.size)
        steps += CHECK_EVERY
        if not math.isfinite(mean):
            raise SystemExit(f"no steady flow on {cells} cells per edge: the velocity is {mean}")
        change = abs(mean - before) / abs(mean)
    return viscosity * mean / diameter**2, steps


def grid_sequence(kernel, name, fraction, sizes, arguments):
    """Per grid: cells per cube edge, k / D^2, its standard deviation over the shifts, steps and seconds."""
    lattice, rows = LATTICES[name], []
    for size in sizes:
        cells, start = round(size * lattice.refinement), time.process_time()
        runs = [
            permeability(kernel, lattice, fraction, cells, grid_shift(number), arguments.tolerance)
            for number in range(arguments.shifts)
        ]
        values = [value for value, _ in runs]
        scatter = statistics.stdev(values) if len(values) > 1 else 0.0
        seconds = time.process_time() - start
        rows.append((cells, statistics.fmean(values), scatter, max(steps for _, steps in runs), seconds))
        note = f"{name} c = {fraction:.4f}, {cells} cells per edge: {seconds:.0f} s"
        print(note, file=sys.stderr, flush=True)
    return rows


def intercept(rows):
    """k0 of k = k0 + slope / cells^2 through the last three of the given grids, by least squares."""
    across = [1 / row[0] ** 2 for row in rows[-3:]]
    values = [row[1] for row in rows[-3:]]
    middle, mean = statistics.fmean(across), statistics.fmean(values)
    spread = sum((x - middle) ** 2 for x in across)
    slope = sum((x - middle) * (y - mean) for x, y in zip(across, values)) / spread
    return mean - slope * middle


def extrapolate(rows, shifts):
    """Extrapolated k / D^2 and its uncertainty."""
    limit = intercept(rows)
    _, finest, scatter, _, _ = rows[-1]
    parts = (abs(limit - intercept(rows[:-1])), abs(limit - finest) / 2, 2 * scatter / math.sqrt(shifts))
    return limit, max(parts)


def drag(fraction, value):
    """K that belongs to k / D^2."""
    return 1 / (18 * fraction * value)


def validation_table(kernel, arguments):
    """Markdown lines: computed and known drag."""
    lines = [
        "| lattice | c | K, finest grid | K, extrapolated | uncertainty | K, known | difference |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, fraction, known in KNOWN_DRAG:
        rows = grid_sequence(kernel, name, fraction, arguments.validation_cells, arguments)
        limit, uncertainty = extrapolate(rows, arguments.shifts)
        value = drag(fraction, limit)
        lines.append(
            f"| {name} | {fraction:.4f} | {drag(fraction, rows[-1][1]):.4g} | {value:.4g} "
            f"| {100 * uncertainty / limit:.2f} % | {known:.4g} | {100 * (value / known - 1):+.2f} % |"
        )
    return lines


def contact_tables(kernel, arguments):
    """Markdown lines: touching spheres on every grid, and extrapolated."""
    grids = [
        "| lattice | cells per edge | cells per D | k / D^2 | scatter | K | steps | seconds |",
        "|---|---|---|---|---|---|---|---|",
    ]
    limits = ["| lattice | c | k / D^2 | K | uncertainty | K, known |", "|---|---|---|---|---|---|"]
    for name, lattice in LATTICES.items():
        fraction = lattice.fraction()
        rows = grid_sequence(kernel, name, fraction, arguments.cells, arguments)
        for cells, value, scatter, steps, seconds in rows:
            grids.append(
                f"| {name} | {cells} | {cells * lattice.contact:.1f} | {value:.4e} "
                f"| {100 * scatter / value:.2f} % | {drag(fraction, value):.2f} | {steps} | {seconds:.1f} |"
            )
        limit, uncertainty = extrapolate(rows, arguments.shifts)
        limits.append(
            f"| {name} | {fraction:.4f} | {limit:.4e} | {drag(fraction, limit):.2f} "
            f"| {100 * uncertainty / limit:.2f} % | {KNOWN_CONTACT_DRAG.get(name, '')} |"
        )
    return grids, limits


def parse_arguments():
    """Reads the command line. Grids are multiples of four, so that every lattice's block is a whole number of cells."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="Cells are counted per cube edge of the simple cubic lattice; the body-centred one takes 1.5 "
        "times and the face-centred one twice as many, which makes their fluid nodes about equal in number.",
    )
    grids = dict(type=int, nargs="+", choices=range(8, 1000, 4), metavar="CELLS")
    parser.add_argument("--cells", default=[32, 48, 64, 80], help="grids for touching spheres", **grids)
    parser.add_argument("--validation-cells", default=[16, 24, 32, 40], help="grids for the comparison with known drag", **grids)
    parser.add_argument("--shifts", type=int, default=3, help="positions of the spheres relative to the grid")
    parser.add_argument("--tolerance", type=float, default=1e-6, help=f"relative change of the mean velocity in {CHECK_EVERY} steps at rest")
    arguments = parser.parse_args()
    arguments.cells.sort()
    arguments.validation_cells.sort()
    if min(len(arguments.cells), len(arguments.validation_cells)) < 4:
        parser.error("the extrapolation and its uncertainty need four grids or more")
    return arguments


def main():
    """Prints the tables."""
    arguments = parse_arguments()
    with tempfile.TemporaryDirectory() as folder:
        kernel = load_kernel("cc", folder)
        validation = validation_table(kernel, arguments)
        grids, limits = contact_tables(kernel, arguments)
    sections = {"Comparison with known drag": validation, "Touching spheres, every grid": grids, "Touching spheres, extrapolated": limits}
    for title, lines in sections.items():
        print(f"## {title}\n\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
