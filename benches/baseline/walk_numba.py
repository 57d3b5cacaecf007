"""The walk, plainly, with Numba: see README.md beside this file."""

import sys
import time

import numba
import numpy as np

from walk_numpy import scene


@numba.njit
def insert(rng, node, size, moving, new, plane, y0, y1):
    for i in range(moving, moving + new):
        node[i] = int(rng.random() * plane)
        size[i] = (y0 + rng.random() * (y1 - y0)) ** (-1 / 3)


@numba.njit
def increment(rng, node, size, moving, diameter, target, blocked, retained, newly):
    """Moves every particle once; how many still move, how many left, their mass, how many were stopped."""
    kept = eroded = stopped = 0
    mass = 0.0
    for i in range(moving):
        v, d = node[i], size[i]
        total = 0.0
        for e in range(3):
            if not blocked[v, e]:
                total += diameter[v, e] ** 2
        if total == 0.0:
            retained[v] += 1
            continue
        draw = rng.random() * total
        exit = -1
        for e in range(3):
            if not blocked[v, e]:
                exit = e
                draw -= diameter[v, e] ** 2
                if draw < 0.0:
                    break
        if d > diameter[v, exit]:
            retained[v] += 1
            newly[stopped, 0] = v
            newly[stopped, 1] = exit
            stopped += 1
            continue
        to = target[v, exit]
        if to < 0:
            eroded += 1
            mass += d**3
            continue
        node[kept] = to
        size[kept] = d
        kept += 1
    for i in range(stopped):
        blocked[newly[i, 0], newly[i, 1]] = True
    return kept, eroded, mass


def run(n, until, rng, diameter, target, y0, y1):
    increments, plane = 100, 1600
    blocked = np.zeros(diameter.shape, dtype=np.bool_)
    node, size = np.zeros(n, dtype=np.int32), np.zeros(n)
    newly = np.zeros((n, 2), dtype=np.int32)
    retained = np.zeros(len(diameter), dtype=np.int64)
    moving = steps = steps_after = eroded = 0
    eroded_mass = time_after = 0.0
    begin = time.process_time()
    t = 0
    while (t < increments or moving) and (until == 0 or t < until):
        t += 1
        began = time.process_time()
        if t <= increments:
            new = n * t // increments - n * (t - 1) // increments
            insert(rng, node, size, moving, new, plane, y0, y1)
            moving += new
        attempts = moving
        steps += attempts
        moving, out, mass = increment(rng, node, size, moving, diameter, target, blocked, retained, newly)
        eroded += out
        eroded_mass += mass
        if t > increments:
            time_after += time.process_time() - began
            steps_after += attempts
    spent = time.process_time() - begin
    return (
        f"steps {steps} ns_step_all {spent / steps * 1e9:.4f} steps_after {steps_after} "
        f"ns_step_after {time_after / max(steps_after, 1) * 1e9:.4f} eroded {eroded} "
        f"blocked {int(blocked.sum())} eroded_mass {eroded_mass:.6g}"
    )


def main():
    run(1000, *scene(sys.argv[1:])[1:])  # compiles
    print(run(*scene(sys.argv[1:])))


if __name__ == "__main__":
    main()
