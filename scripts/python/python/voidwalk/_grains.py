"""Packings of filter grains, and the constrictions between them."""

from __future__ import annotations

import json
import os
from typing import Dict, Iterator, Literal, Mapping, Optional, Tuple, TypedDict, Union, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _voidwalk
from ._arrays import Floats, Ints, cell_as_in_files, cell_lengths, floats, frozen, threads_or_none, whole
from ._plots import Axes
from ._progress import Follower, Following
from ._soil import Curve, Gradation
from .records import ConstrictionsSummary

__all__ = ["Constrictions", "Packing", "constrictions", "pack"]

#: Overlap of two inscribed spheres from which their tetrahedra are one void.
MERGE_OVERLAP = 0.1


class Reached(TypedDict, total=False):
    """What a compression reached; empty for grains that were not packed here."""

    #: Volume of voids over volume of grains.
    void_ratio: float
    #: Mean pressure (kPa).
    pressure_kpa: float
    #: Mean number of contacts of a grain.
    coordination: float
    #: Share of the grains that bear nothing.
    rattlers: float
    #: Friction between grains during compression, which sets the density.
    friction: float
    #: Seed of sizes and start positions.
    seed: int
    #: Steps of the compression.
    steps: int


class Packing:
    """Grains of a filter.

    Parameters
    ----------
    coords : array_like of float, shape (n, 3)
        Centres x, y, z (mm).
    diameter : array_like of float, shape (n,)
        Diameters (mm).
    cell : None, float or array_like of float, shape (3,)
        Lengths (mm) of a periodic cell with a corner at the origin; ``None`` for grains without one.

    Attributes
    ----------
    coords, diameter : ndarray
        As given, read-only.
    cell : tuple of float or None
        As given.
    reached : dict
        Of a packing that :func:`pack` made: void ratio, pressure (kPa), coordination number, share of
        rattlers, steps, friction and seed; else empty.

    Examples
    --------
    >>> import numpy as np, voidwalk as vw
    >>> grid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3)
    >>> vw.Packing(grid, np.ones(27), cell=3.0)
    Packing(27 grains, 1 to 1 mm, cell 3 x 3 x 3 mm)
    """

    __slots__ = {
        "coords": "Centres (mm), shape (n, 3), read-only.",
        "diameter": "Diameters (mm), shape (n,), read-only.",
        "cell": "Lengths (mm) of the periodic cell, or None.",
        "reached": "What a compression reached: void ratio, pressure (kPa), coordination number and more.",
    }

    def __init__(self, coords: ArrayLike, diameter: ArrayLike, cell: Optional[ArrayLike] = None) -> None:
        self.coords = frozen(floats("coords", coords, None, 3))
        self.diameter = frozen(floats("diameter", diameter, len(self.coords)))
        if (self.diameter <= 0).any():
            grain = int(np.argmax(self.diameter <= 0))
            raise ValueError(f"diameter[{grain}] = {self.diameter[grain]} is not allowed; a size above 0 is needed")
        self.cell = cell_lengths(cell)
        self.reached: Reached = {}

    @property
    def _columns(self) -> Tuple[Floats, Floats, Optional[Tuple[float, float, float]]]:
        """The grains as the library takes them."""
        return self.coords, self.diameter, self.cell

    @classmethod
    def from_file(
        cls, path: Union[str, os.PathLike[str]], unit: Optional[str] = None, cell: Union[str, ArrayLike, None] = None
    ) -> Packing:
        """Grains from a CSV file with the columns x_mm, y_mm, z_mm and diameter_mm below a first line ``# cell_mm =
        Lx, Ly, Lz`` or ``# cell = none`` (or the columns of ParaView and MFIX), from a text dump of LAMMPS or
        LIGGGHTS (the last frame, `radius` or `diameter`), from Yade's ``export.text``, a ``.data`` of
        MercuryDPM, or points of VTK with an array called diameter or radius (.vtk, .vtp, .vtu). Each may be packed by
        gzip.

        Parameters
        ----------
        path : str or path
            The file.
        unit : {"m", "cm", "mm", "um", "nm"}, optional
            Unit of its lengths. A file that does not say its unit is refused without it.
        cell : str, float or array_like of float, shape (3,), optional
            Lengths of a periodic cell in the unit of the file, with a corner at the origin, also as text
            ``"Lx, Ly, Lz"``; ``"none"`` for free boundaries, ``"bounds"`` for a periodic cell between the bounds that
            the file gives. A file that does not say its boundaries is refused without it.

        What a user must know of how the file was understood is warned of.
        """
        import warnings

        (coords, diameter, lengths), notes = _voidwalk.read_packing(os.fspath(path), unit, cell_as_in_files(cell))
        for note in notes:
            warnings.warn(note, stacklevel=2)
        return cls(coords, diameter, lengths)

    from_lammps = from_file

    def constrictions(
        self, *, merge_overlap: float = MERGE_OVERLAP, facets: str = "all", threads: Optional[int] = None
    ) -> Constrictions:
        """:func:`constrictions` of this packing."""
        return constrictions(self, merge_overlap=merge_overlap, facets=facets, threads=threads)

    def __len__(self) -> int:
        return len(self.diameter)

    def __reduce__(self) -> Tuple[object, ...]:
        return _packing, (np.asarray(self.coords), np.asarray(self.diameter), self.cell, self.reached)

    def __repr__(self) -> str:
        cell = "no cell"
        if self.cell is not None:
            cell = "cell " + " x ".join(f"{length:g}" for length in self.cell) + " mm"
        sizes = f"{self.diameter.min():g} to {self.diameter.max():g} mm" if len(self) else "no sizes"
        return f"Packing({len(self)} grains, {sizes}, {cell})"


def _packing(coords: Floats, diameter: Floats, cell: Optional[Tuple[float, float, float]], reached: Reached) -> Packing:
    packing = Packing(coords, diameter, cell)
    packing.reached = reached
    return packing


def pack(
    gradation: Gradation,
    density: Union[str, float] = "loose",
    grains: Optional[int] = None,
    seed: int = 1,
    threads: Optional[int] = None,
    progress: Follower = None,
) -> Packing:
    """Packs grains of a gradation into a periodic cube, to the same bits as ``voidwalk pack``.

    Cubes only, and always the whole gradation: nothing stands here for ``packing.aspect`` and ``packing.coarsest``,
    and of a filter so broad that ``voidwalk pack`` takes its finer part, all is packed.

    Parameters
    ----------
    gradation : Gradation
        Of the filter.
    density : {"loose", "medium", "intermediate", "dense"} or float
        How dense; or the friction between grains while they are compressed (0.3, 0.1, 0.1 and 0).
    grains : int, optional
        How many; enough for a cell 5.4 times as wide as the largest grain without it, 9,000 to 60,000.
    seed : int
        The same seed gives the same bits.
    threads : int, optional
        One per core without it.
    progress : callable, True or None
        Told of each look at the work, a :class:`Progress`; ``True`` shows a bar where tqdm is installed.

    Raises
    ------
    ValueError
        What is refused before any work.
    VoidwalkError
        Grains that do not come to rest.

    Examples
    --------
    >>> import voidwalk as vw
    >>> packing = vw.pack(vw.Gradation.linear(1.2), density="dense", grains=100)
    >>> packing.coords.shape, packing.diameter.shape
    ((100, 3), (100,))
    """
    number = None if grains is None else whole("grains", grains, 1)
    with Following(progress) as callback:
        (coords, diameter, cell), reached = _voidwalk.pack(
            gradation._native, density, number, whole("seed", seed), threads_or_none(threads), callback
        )
    return _packing(coords, diameter, cell, reached)


#: Keys of constrictions whose arrays are of whole numbers.
WholeKey = Literal["throat.conns", "throat.shift"]

#: Keys of those whose arrays are of numbers with a point.
FloatKey = Literal[
    "pore.coords", "pore.diameter", "pore.volume", "throat.coords", "throat.diameter", "throat.conductance",
    "csd.percent_smaller", "csd.diameter",
]


class Constrictions(Mapping[str, Union[Floats, Ints]]):
    """Voids and constrictions of a packing as arrays by key; lengths in mm.

    ==========================  ==========  ========================================================
    key                         shape       what
    ==========================  ==========  ========================================================
    ``pore.coords``             (v, 3)      centre of the largest sphere of each void (mm)
    ``pore.diameter``           (v,)        its diameter (mm); 0 where there is none
    ``pore.volume``             (v,)        volume outside the grains (mm3); periodic cells only
    ``throat.conns``            (c, 2)      the two voids that each constriction joins
    ``throat.shift``            (c, 3)      cells by which the second stands aside; periodic only
    ``throat.coords``           (c, 3)      its centre (mm)
    ``throat.diameter``         (c,)        its diameter (mm)
    ``throat.conductance``      (c,)        conductance times viscosity (mm3); periodic only
    ``csd.percent_smaller``     (k,)        the curve of constriction sizes by number
    ``csd.diameter``            (k,)        its diameters (mm)
    ==========================  ==========  ========================================================

    Attributes
    ----------
    summary : dict
        The figures that ``voidwalk constrictions`` writes as constrictions.json, without permeability.
    """

    __slots__ = {
        "_arrays": "",
        "summary": "The figures that constrictions.json holds, without permeability.",
        "packing": "The grains that were measured.",
        "merge_overlap": "Overlap of two inscribed spheres from which they were one void.",
    }

    def __init__(
        self,
        arrays: Dict[str, Union[Floats, Ints]],
        summary: ConstrictionsSummary,
        packing: Packing,
        merge_overlap: float,
    ) -> None:
        self._arrays, self.summary, self.packing = arrays, summary, packing
        self.merge_overlap = merge_overlap

    @overload
    def __getitem__(self, key: FloatKey) -> Floats: ...
    @overload
    def __getitem__(self, key: WholeKey) -> Ints: ...
    @overload
    def __getitem__(self, key: str) -> Union[Floats, Ints]: ...
    def __getitem__(self, key: str) -> Union[Floats, Ints]:
        return self._arrays[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    @property
    def grains_per_void(self) -> float:
        """Filter grains per void, N_p / N_voids of Eq. (2)."""
        return float(self.summary["grains_per_void"])

    @property
    def curve(self) -> Curve:
        """The curve of constriction sizes by number, as a :class:`Curve`."""
        curve = Curve(self["csd.percent_smaller"], self["csd.diameter"])
        curve.grains_per_void = self.grains_per_void
        return curve

    def plot(self, ax: Optional[Axes] = None, *, label: Optional[str] = None) -> Axes:
        """Draws the curve of constriction sizes, as :meth:`Curve.plot`."""
        return self.curve.plot(ax, label=label)

    def to_openpnm(self) -> Dict[str, Union[Floats, Ints]]:
        """The voids and constrictions as a dict that OpenPNM's ``Network`` is updated with; lengths in m."""
        si: Dict[FloatKey, float] = {
            "pore.coords": 1e-3,
            "pore.diameter": 1e-3,
            "throat.diameter": 1e-3,
            "pore.volume": 1e-9,
        }
        named: Dict[str, Union[Floats, Ints]] = {key: self[key] * si[key] for key in si if key in self}
        return {**named, "throat.conns": self["throat.conns"]}

    def __repr__(self) -> str:
        voids, constrictions = len(self["pore.coords"]), len(self["throat.conns"])
        return f"Constrictions({voids} voids, {constrictions} constrictions)"


def constrictions(
    coords: Union[Packing, ArrayLike],
    diameter: Optional[ArrayLike] = None,
    cell: Optional[ArrayLike] = None,
    *,
    merge_overlap: float = MERGE_OVERLAP,
    facets: str = "all",
    threads: Optional[int] = None,
) -> Constrictions:
    """Measures the voids and constrictions between grains.

    Parameters
    ----------
    coords : Packing, or array_like of float, shape (n, 3)
        Grains, or their centres x, y, z (mm).
    diameter : array_like of float, shape (n,)
        Their diameters (mm); not with a packing.
    cell : None, float or array_like of float, shape (3,)
        Lengths (mm) of their periodic cell; not with a packing.
    merge_overlap : float
        Overlap of two inscribed spheres, by the radius of the smaller, from which they are one void.
    facets : {"all", "on_both_hulls"}
        Which facets between two voids count as constrictions.
    threads : int, optional
        One per core without it.

    Returns
    -------
    Constrictions
        A mapping with ``pore.coords``, ``pore.diameter``, ``throat.conns``, ``throat.diameter`` and more.

    Raises
    ------
    ValueError
        Grains that cannot be triangulated.

    Examples
    --------
    >>> import numpy as np, voidwalk as vw
    >>> grid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3)
    >>> found = vw.constrictions(grid, np.ones(27), cell=3.0)
    >>> found
    Constrictions(27 voids, 81 constrictions)
    >>> round(float(found["throat.diameter"].max()), 6)
    0.414214
    """
    if isinstance(coords, Packing):
        if diameter is not None or cell is not None:
            raise ValueError("diameter and cell are those of the packing: give neither")
        packing = coords
    elif diameter is None:
        raise ValueError("diameter is missing: an array of shape (n,), in mm")
    else:
        packing = Packing(coords, diameter, cell)
    if facets not in ("all", "on_both_hulls"):
        raise ValueError(f"facets = {facets} is not allowed; one of all, on_both_hulls")
    arrays, summary = _voidwalk.measure(
        packing._columns, merge_overlap, facets == "on_both_hulls", threads_or_none(threads)
    )
    return Constrictions(arrays, json.loads(summary), packing, merge_overlap)
