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

Needs Python 3.8 or later and a C compiler; runs in one thread.
"""

import argparse
import ctypes
import math
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KERNEL = r"""
#include <math.h>
#include <stdlib.h>

enum { Q = 19 };
/* Velocities 2m - 1 and 2m are opposite; 0 is rest. */
static const int CX[Q] = {0, 1,-1, 0, 0, 0, 0, 1,-1, 1,-1, 1,-1, 1,-1, 0, 0, 0, 0};
static const int CY[Q] = {0, 0, 0, 1,-1, 0, 0, 1,-1,-1, 1, 0, 0, 0, 0, 1,-1, 1,-1};
static const int CZ[Q] = {0, 0, 0, 0, 0, 1,-1, 0, 0, 0, 0, 1,-1,-1, 1, 1,-1,-1, 1};
static int opposite(int q) { return q == 0 ? 0 : (q % 2 ? q + 1 : q - 1); }

typedef struct {
    int size[3];            /* grid cells of the block along x, y, z */
    int y_wrap_x;           /* x offset that goes with one block step along y */
    int z_wrap_x, z_wrap_y; /* x and y offsets that go with one block step along z */
    double side;            /* edge of the cube, in grid cells */
    double radius;
    int centres;
    double centre[4][3];
} Array;

typedef struct {
    int nodes;
    int *source;            /* nodes x Q: where each population is pulled from */
    int *first_link;        /* nodes + 1: the wall links of each node */
    int *link_velocity;     /* velocity that comes from the wall */
    int *link_behind;       /* the fluid node one step away from the wall */
    double *link_weight;
    double *now, *next;
} Flow;

static int floor_div(int a, int b) { int d = a / b; return (a % b < 0) ? d - 1 : d; }

static int block_index(const Array *a, int x, int y, int z) {
    int step = floor_div(z, a->size[2]);
    z -= step * a->size[2]; x -= step * a->z_wrap_x; y -= step * a->z_wrap_y;
    step = floor_div(y, a->size[1]);
    y -= step * a->size[1]; x -= step * a->y_wrap_x;
    x -= floor_div(x, a->size[0]) * a->size[0];
    return (z * a->size[1] + y) * a->size[0] + x;
}

/* Share of the link from a fluid node to a solid one that lies in the fluid. */
static double wall_distance(const Array *a, const int node[3], int q) {
    const double c[3] = {CX[q], CY[q], CZ[q]};
    double nearest = 1.0;
    for (int s = 0; s < a->centres; s++) {
        double cc = 0.0, cd = 0.0, dd = 0.0;
        for (int k = 0; k < 3; k++) {
            /* The image of the sphere that is nearest to the link's solid end. */
            double d = node[k] + c[k] - a->centre[s][k];
            d -= a->side * floor(d / a->side + 0.5);
            d -= c[k];
            cc += c[k] * c[k]; cd += c[k] * d; dd += d * d;
        }
        double root = cd * cd - cc * (dd - a->radius * a->radius);
        if (root < 0.0) continue;
        double t = (-cd - sqrt(root)) / cc;
        if (t >= 0.0 && t < nearest) nearest = t;
    }
    return nearest;
}

static int inside_sphere(const Array *a, int x, int y, int z) {
    const double p[3] = {x, y, z};
    for (int s = 0; s < a->centres; s++) {
        double dd = 0.0;
        for (int k = 0; k < 3; k++) {
            double d = p[k] - a->centre[s][k];
            d -= a->side * floor(d / a->side + 0.5);
            dd += d * d;
        }
        if (dd < a->radius * a->radius) return 1;
    }
    return 0;
}

Flow *flow_new(const Array *a) {
    const int sx = a->size[0], sy = a->size[1], sz = a->size[2], cells = sx * sy * sz;
    int *number = malloc(sizeof(int) * cells);
    Flow *f = calloc(1, sizeof(Flow));
    for (int z = 0, i = 0; z < sz; z++)
        for (int y = 0; y < sy; y++)
            for (int x = 0; x < sx; x++, i++)
                number[i] = inside_sphere(a, x, y, z) ? -1 : f->nodes++;
    const int n = f->nodes;
    f->source = malloc(sizeof(int) * n * Q);
    f->first_link = malloc(sizeof(int) * (n + 1));
    int room = 1024, links = 0;
    f->link_velocity = malloc(sizeof(int) * room);
    f->link_behind = malloc(sizeof(int) * room);
    f->link_weight = malloc(sizeof(double) * room);
    for (int z = 0, i = 0; z < sz; z++)
        for (int y = 0; y < sy; y++)
            for (int x = 0; x < sx; x++, i++) {
                const int me = number[i], node[3] = {x, y, z};
                if (me < 0) continue;
                f->first_link[me] = links;
                for (int q = 0; q < Q; q++) {
                    const int from = number[block_index(a, x - CX[q], y - CY[q], z - CZ[q])];
                    if (from >= 0) { f->source[me * Q + q] = from * Q + q; continue; }
                    f->source[me * Q + q] = me * Q + opposite(q);
                    const int behind = number[block_index(a, x + CX[q], y + CY[q], z + CZ[q])];
                    if (behind < 0) continue;
                    if (links == room) {
                        room *= 2;
                        f->link_velocity = realloc(f->link_velocity, sizeof(int) * room);
                        f->link_behind = realloc(f->link_behind, sizeof(int) * room);
                        f->link_weight = realloc(f->link_weight, sizeof(double) * room);
                    }
                    const double t = wall_distance(a, node, opposite(q));
                    f->link_velocity[links] = q;
                    f->link_behind[links] = behind;
                    f->link_weight[links++] = (1.0 - 2.0 * t) / (1.0 + 2.0 * t);
                }
            }
    f->first_link[n] = links;
    free(number);
    f->now = calloc((size_t)n * Q, sizeof(double));
    f->next = calloc((size_t)n * Q, sizeof(double));
    return f;
}

void flow_free(Flow *f) {
    free(f->source); free(f->first_link);
    free(f->link_velocity); free(f->link_behind); free(f->link_weight);
    free(f->now); free(f->next); free(f);
}

/* Advances by some steps under unit force along x; returns the x velocity summed over the fluid nodes, as the
   mean of the last two steps: nodes shut in beside a contact keep a part that changes its sign every step. */
double flow_run(Flow *f, int steps, double viscosity, double magic) {
    const double even = 1.0 / (3.0 * viscosity + 0.5), odd = 1.0 / (magic / (3.0 * viscosity) + 0.5);
    double total = 0.0, before = 0.0;
    for (int step = 0; step < steps; step++) {
        before = total;
        total = 0.0;
        for (int i = 0; i < f->nodes; i++) {
            const int *source = f->source + (size_t)i * Q;
            double p[Q], density = 0.0, ux = 0.5, uy = 0.0, uz = 0.0;
            for (int q = 0; q < Q; q++) p[q] = f->now[source[q]];
            for (int l = f->first_link[i]; l < f->first_link[i + 1]; l++) {
                const int q = f->link_velocity[l];
                const double gap = f->now[f->link_behind[l] * Q + opposite(q)] - f->now[i * Q + q];
                p[q] += f->link_weight[l] * gap;
            }
            for (int q = 0; q < Q; q++) density += p[q];
            for (int q = 1; q < Q; q++) { ux += CX[q] * p[q]; uy += CY[q] * p[q]; uz += CZ[q] * p[q]; }
            total += ux;
            double *out = f->next + (size_t)i * Q;
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
        double *swap = f->now; f->now = f->next; f->next = swap;
    }
    return 0.5 * (before + total);
}
"""


class Array(ctypes.Structure):
    """The block that is solved and the spheres in its cube, as the kernel wants them."""

    _fields_ = [
        ("size", ctypes.c_int * 3),
        ("y_wrap_x", ctypes.c_int),
        ("z_wrap_x", ctypes.c_int),
        ("z_wrap_y", ctypes.c_int),
        ("side", ctypes.c_double),
        ("radius", ctypes.c_double),
        ("centres", ctypes.c_int),
        ("centre", (ctypes.c_double * 3) * 4),
    ]


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
    """Compiles the solver and declares its functions."""
    source, library = Path(folder, "kernel.c"), Path(folder, "kernel.so")
    source.write_text(KERNEL)
    options = ["-O3", "-march=native", "-shared", "-fPIC"]
    subprocess.run([compiler, *options, "-o", library, source, "-lm"], check=True)
    kernel = ctypes.CDLL(str(library))
    kernel.flow_new.argtypes, kernel.flow_new.restype = [ctypes.POINTER(Array)], ctypes.c_void_p
    kernel.flow_free.argtypes, kernel.flow_free.restype = [ctypes.c_void_p], None
    kernel.flow_run.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_double, ctypes.c_double]
    kernel.flow_run.restype = ctypes.c_double
    return kernel


def grid_shift(number):
    """Offset of the spheres from the grid, in cells: points that fill the unit cube evenly."""
    return [(number + 1) * step % 1 for step in (0.8191725134, 0.6710436067, 0.5497004779)]


def permeability(kernel, lattice, fraction, cells, shift, tolerance):
    """k / D^2 on one grid, and the number of steps to the steady state."""
    diameter = lattice.diameter(fraction) * cells
    array = Array()
    array.size[:] = [cells, cells // lattice.parts[0], cells // lattice.parts[1]]
    array.y_wrap_x = round(lattice.y_wrap_x * cells)
    array.z_wrap_x, array.z_wrap_y = [round(wrap * cells) for wrap in lattice.z_wrap]
    array.side, array.radius, array.centres = cells, diameter / 2, len(lattice.centres)
    for number, centre in enumerate(lattice.centres):
        array.centre[number][:] = [place * cells + offset for place, offset in zip(centre, shift)]
    block = math.prod(array.size)
    viscosity = min(2.0, 0.25 / fraction)  # sets the pace to the steady state, not the result
    flow = kernel.flow_new(ctypes.byref(array))
    steps, mean, change = 0, 0.0, math.inf
    while not change <= tolerance:
        before, mean = mean, kernel.flow_run(flow, CHECK_EVERY, viscosity, MAGIC) / block
        steps += CHECK_EVERY
        if not math.isfinite(mean):
            raise SystemExit(f"no steady flow on {cells} cells per edge: the velocity is {mean}")
        change = abs(mean - before) / abs(mean)
    kernel.flow_free(flow)
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
