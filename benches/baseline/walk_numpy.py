"""The walk, plainly, with NumPy: see README.md beside this file."""

import sys
import time

import numpy as np


def read_curve(path):
    rows = [line.split(",") for line in open(path) if line[0].isdigit()]
    return np.array(rows, dtype=float).T


def scene(arguments):
    """Everything that does not move: n, until, generator, diameters, targets, D^-3 of both ends of the base."""
    n, path, name, seed, until = arguments
    rng = np.random.default_rng(int(seed))
    percent, size = read_curve(path)
    nx, ny, nz = 40, 40, 60
    voids = nx * ny * nz
    diameter = np.interp(100.0 * rng.random(3 * voids), percent, size).reshape(voids, 3)
    v = np.arange(voids)
    x, y, z = v % nx, v // nx % ny, v // (nx * ny)
    target = np.stack(
        [v - x + (x + 1) % nx, v + ((y + 1) % ny - y) * nx, np.where(z + 1 == nz, -1, v + nx * ny)], axis=1
    ).astype(np.int32)
    cu = 4.5
    d0 = 0.16 / cu**2 if name == "passive" else np.interp(5.0, percent, size) / cu**1.7
    return int(n), int(until), rng, diameter, target, d0**-3.0, (d0 * cu**2) ** -3.0


def main():
    n, until, rng, diameter, target, y0, y1 = scene(sys.argv[1:])
    increments, plane = 100, 1600
    blocked = np.zeros(diameter.shape, dtype=bool)
    node = np.empty(0, dtype=np.int32)
    size = np.empty(0)
    retained = np.zeros(len(diameter), dtype=np.int64)
    steps = steps_after = eroded = 0
    eroded_mass = time_after = 0.0
    begin = time.process_time()
    t = 0
    while (t < increments or len(node)) and (until == 0 or t < until):
        t += 1
        began = time.process_time()
        if t <= increments:
            new = n * t // increments - n * (t - 1) // increments
            node = np.append(node, rng.integers(0, plane, new, dtype=np.int32))
            size = np.append(size, (y0 + rng.random(new) * (y1 - y0)) ** (-1 / 3))
        moving = len(node)
        steps += moving
        area = np.where(blocked, 0.0, diameter**2)
        bound = np.cumsum(area, axis=1)
        draw = rng.random(moving) * bound[node, 2]
        exit = (draw >= bound[node, 0]).astype(np.int32) + (draw >= bound[node, 1])
        closed = bound[node, 2] == 0.0
        stopped = ~closed & (size > diameter[node, exit])
        to = target[node, exit]
        out = ~closed & ~stopped & (to < 0)
        eroded += int(out.sum())
        eroded_mass += float((size[out] ** 3).sum())
        np.add.at(retained, node[closed | stopped], 1)
        blocked[node[stopped], exit[stopped]] = True
        stay = ~(closed | stopped | out)
        node, size = to[stay], size[stay]
        if t > increments:
            time_after += time.process_time() - began
            steps_after += moving
    spent = time.process_time() - begin
    print(
        f"steps {steps} ns_step_all {spent / steps * 1e9:.4f} steps_after {steps_after} "
        f"ns_step_after {time_after / max(steps_after, 1) * 1e9:.4f} eroded {eroded} "
        f"blocked {int(blocked.sum())} eroded_mass {eroded_mass:.6g}"
    )


if __name__ == "__main__":
    main()
