"""The types of tables: the columns of the CSV files of a run, of boundaries and of a campaign."""

from __future__ import annotations

from typing import Dict, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

__all__ = ["Blockings", "Column", "Flow", "Layers", "RetainedByVoid", "Series", "Sizes", "Table", "Walked"]

#: Numbers with a point.
Floats = NDArray[np.float64]
#: Counts.
Counts = NDArray[np.uint64]
#: Whole numbers, of which -1 stands for what has no number.
Whole = NDArray[np.int64]
#: Words.
Words = NDArray[np.str_]

#: A column of a table whose columns depend on what was asked for.
Column = Union[Floats, Counts, Whole, Words]

#: Such a table: its columns by their names.
Table = Dict[str, Column]


class Series(TypedDict):
    """Counts of particles after each recorded increment: ``series.csv``.

    Keys
    ----
    replicate
        Counts from 1.
    run
        1 or 2.
    increment
        Counts from 1.
    inserted
        Particles inserted so far in this run.
    moving
        Particles still moving.
    eroded
        Particles eroded so far in this run.
    retained_in_constrictions
        Particles stopped by a constriction so far in this run.
    retained_in_voids
        Particles retained in voids so far in this run.
    trapped
        Particles trapped in closed loops.
    blocked
        Constrictions blocked.
    eroded_mass_fraction
        Mass eroded so far over the mass that the whole run inserts.
    """

    replicate: Counts
    run: Counts
    increment: Counts
    inserted: Counts
    moving: Counts
    eroded: Counts
    retained_in_constrictions: Counts
    retained_in_voids: Counts
    trapped: Counts
    blocked: Counts
    eroded_mass_fraction: Floats


class Layers(TypedDict):
    """Each layer when a run has ended: ``layers.csv``.

    Keys
    ----
    replicate
        Counts from 1.
    run
        1 or 2.
    layer
        Counts from 0 where particles come in.
    constrictions
        Constrictions that leave the voids of this layer.
    blocked
        Those of them that are blocked.
    retained_in_constrictions
        Particles of this run stopped by them.
    retained_in_voids
        Particles of this run retained in the voids of this layer.
    """

    replicate: Counts
    run: Counts
    layer: Counts
    constrictions: Counts
    blocked: Counts
    retained_in_constrictions: Counts
    retained_in_voids: Counts


class Sizes(TypedDict):
    """Size curves of what is retained, or eroded, so far: ``retained.csv``, ``eroded.csv``.

    Keys
    ----
    replicate
        Counts from 1.
    run
        1 or 2.
    increment
        The increment after which the curve was taken.
    diameter_mm
        Size (mm).
    percent_finer_by_mass
        Percent of the mass in particles no larger.
    percent_finer_by_number
        Percent of the number in particles no larger.
    """

    replicate: Counts
    run: Counts
    increment: Counts
    diameter_mm: Floats
    percent_finer_by_mass: Floats
    percent_finer_by_number: Floats


class Flow(TypedDict):
    """The permeability when the flow was solved: ``flow.csv``; empty without water.

    Keys
    ----
    replicate
        Counts from 1.
    run
        1 or 2.
    increment
        Increments that were done.
    k_over_k0
        Permeability over that of the clean filter.
    closed_flow_fraction
        Part of the inflow that went through constrictions which had closed since the flow was solved before,
        summed over the filter: so many on the mean way of a particle.
    """

    replicate: Counts
    run: Counts
    increment: Counts
    k_over_k0: Floats
    closed_flow_fraction: Floats


class RetainedByVoid(TypedDict):
    """What each void of the first replicate retained: ``retained_by_void.csv``; empty without ``record.voids``.

    Keys
    ----
    run
        1 or 2.
    increment
        Increments that were done.
    void
        The void, from 0; -1 is the reservoir before the filter.
    retained_in_constrictions
        Particles stopped by its constrictions so far in this run.
    retained_in_voids
        Particles retained in it so far in this run for want of an open exit.
    """

    run: Counts
    increment: Counts
    void: Whole
    retained_in_constrictions: Counts
    retained_in_voids: Counts


class Blockings(TypedDict):
    """Which constriction of the first replicate was blocked when: ``blocked.csv``; empty without ``record.voids``.

    Keys
    ----
    run
        1 or 2.
    increment
        The increment in which a particle stopped there.
    constriction
        The constriction, from 0.
    """

    run: Counts
    increment: Counts
    constriction: Counts


class Walked(TypedDict):
    """Every ratio that a search of boundaries walked: ``boundary.csv``.

    Keys
    ----
    density
        Density of the filter, as in ``boundaries``.
    thickness
        Thickness of the filter, as in ``boundaries``.
    network
        Network, counted from 1.
    d15f_over_d85b
        The ratio D15F/D85B.
    eroded_first
        Mass eroded in the first run over the mass inserted.
    eroded_second
        The same in the second run; NaN where it was not walked.
    d85b_of
        Which base D85B is of: as sampled, or the size that it was regraded on; empty without a size.
    """

    density: Words
    thickness: Words
    network: Counts
    d15f_over_d85b: Floats
    eroded_first: Floats
    eroded_second: Floats
    d85b_of: Words
