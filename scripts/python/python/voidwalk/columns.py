"""The types of tables: the columns of the CSV files of a run, a design, a comparison and a campaign."""

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
    """Counts of particles after each recorded increment: ``series.csv``."""

    #: Counts from 1.
    replicate: Counts
    #: 1 or 2.
    run: Counts
    #: Counts from 1.
    increment: Counts
    #: Particles inserted so far in this run.
    inserted: Counts
    #: Particles still moving.
    moving: Counts
    #: Particles eroded so far in this run.
    eroded: Counts
    #: Particles stopped by a constriction so far in this run.
    retained_in_constrictions: Counts
    #: Particles retained in voids so far in this run.
    retained_in_voids: Counts
    #: Particles trapped in closed loops.
    trapped: Counts
    #: Constrictions blocked.
    blocked: Counts
    #: Mass eroded so far over the mass that the whole run inserts.
    eroded_mass_fraction: Floats


class Layers(TypedDict):
    """Each layer when a run has ended: ``layers.csv``."""

    #: Counts from 1.
    replicate: Counts
    #: 1 or 2.
    run: Counts
    #: Counts from 0 where particles come in.
    layer: Counts
    #: Constrictions that leave the voids of this layer.
    constrictions: Counts
    #: Those of them that are blocked.
    blocked: Counts
    #: Particles of this run stopped by them.
    retained_in_constrictions: Counts
    #: Particles of this run retained in the voids of this layer.
    retained_in_voids: Counts


class Sizes(TypedDict):
    """Size curves of what is retained, or eroded, so far: ``retained.csv``, ``eroded.csv``."""

    #: Counts from 1.
    replicate: Counts
    #: 1 or 2.
    run: Counts
    #: The increment after which the curve was taken.
    increment: Counts
    #: Size (mm).
    diameter_mm: Floats
    #: Percent of the mass in particles no larger.
    percent_finer_by_mass: Floats
    #: Percent of the number in particles no larger.
    percent_finer_by_number: Floats


class Flow(TypedDict):
    """The permeability when the flow was solved: ``flow.csv``; empty without water."""

    #: Counts from 1.
    replicate: Counts
    #: 1 or 2.
    run: Counts
    #: Increments that were done.
    increment: Counts
    #: Permeability over that of the clean filter.
    k_over_k0: Floats


class RetainedByVoid(TypedDict):
    """What each void of the first replicate retained: ``retained_by_void.csv``; empty without ``record.voids``."""

    #: 1 or 2.
    run: Counts
    #: Increments that were done.
    increment: Counts
    #: The void, from 0; -1 is the reservoir before the filter.
    void: Whole
    #: Particles stopped by its constrictions so far in this run.
    retained_in_constrictions: Counts
    #: Particles retained in it so far in this run for want of an open exit.
    retained_in_voids: Counts


class Blockings(TypedDict):
    """Which constriction of the first replicate was blocked when: ``blocked.csv``; empty without ``record.voids``."""

    #: 1 or 2.
    run: Counts
    #: The increment in which a particle stopped there.
    increment: Counts
    #: The constriction, from 0.
    constriction: Counts


class Walked(TypedDict):
    """Every ratio that a design walked: ``design.csv``."""

    #: Density of the filter, as in ``boundaries``.
    density: Words
    #: Thickness of the filter, as in ``boundaries``.
    thickness: Words
    #: Network, counted from 1.
    network: Counts
    #: The ratio D15F/D85B.
    d15f_over_d85b: Floats
    #: Mass eroded in the first run over the mass inserted.
    eroded_first: Floats
    #: The same in the second run; NaN where it was not walked.
    eroded_second: Floats
    #: Which base D85B is of: as sampled, or the size that it was regraded on; empty without a size.
    d85b_of: Words
