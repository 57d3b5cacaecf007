"""Gradations of soils, and curves of constriction sizes."""

from __future__ import annotations

import os
from typing import Optional, Protocol, Tuple, Union

from numpy.typing import ArrayLike

from . import _voidwalk
from ._arrays import Floats, floats, frozen
from ._boxes import box
from ._plots import Axes, plot_curve, plot_gradation

__all__ = ["Curve", "Gradation"]


def _known(value: Optional[float], name: str) -> float:
    if value is None:
        raise ValueError(
            f"{name} is not known: not a percentage from 0 to 100, or in the pan fraction (finer than the finest "
            "sieve); give d0_mm or finer sieves"
        )
    return value


class Frame(Protocol):
    """Columns that are had by their names, as of a pandas.DataFrame."""

    def __contains__(self, name: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> ArrayLike: ...


class Gradation:
    """A sieve curve: percent finer by mass against size, straight in percent against the logarithm of size.

    Parameters
    ----------
    size_mm : array_like of float, shape (n,)
        Openings of the sieves (mm), rising or falling.
    percent_finer : array_like of float, shape (n,)
        Percent of the mass that is finer than each, 0 to 100; 100 at the coarsest.
    d0_mm : float, optional
        Size (mm) at which a curve whose finest sieve lets some mass through goes on to 0 %. Without it
        that mass, the pan fraction, is counted by mass only.

    Raises
    ------
    ValueError
        Arrays that are no sieve curve, with the place and what is allowed there.

    Examples
    --------
    >>> import voidwalk as vw
    >>> sand = vw.Gradation([0.075, 0.25, 0.5, 2.0], [0, 20, 60, 100])
    >>> round(sand.d(15), 4), round(sand.cu, 3)
    (0.185, 3.651)
    """

    __slots__ = ("_native",)

    def __init__(self, size_mm: ArrayLike, percent_finer: ArrayLike, d0_mm: Optional[float] = None) -> None:
        sizes, percents = floats("size_mm", size_mm, None), floats("percent_finer", percent_finer, None)
        self._native = _voidwalk.Gradation.from_points(sizes, percents, d0_mm)

    @classmethod
    def _of(cls, native: _voidwalk.Gradation) -> Gradation:
        new = cls.__new__(cls)
        new._native = native
        return new

    @classmethod
    def linear(cls, cu: float, size_mm: float = 1.0, percent: float = 0.0) -> Gradation:
        """A gradation that is a straight line on semi-log paper: ``D_x = D_0 cu^(x / 50)``.

        Parameters
        ----------
        cu : float
            D60 / D10, 1 or more.
        size_mm : float
            One of its sizes (mm).
        percent : float
            Which one: `size_mm` is ``D_percent``; D0 by default.

        Examples
        --------
        >>> import voidwalk as vw
        >>> base = vw.Gradation.linear(3.0, 0.2, percent=85)
        >>> round(base.cu, 6), round(base.d(85), 6)
        (3.0, 0.2)
        """
        return cls._of(_voidwalk.Gradation.linear(percent, size_mm, cu))

    @classmethod
    def single(cls, size_mm: float) -> Gradation:
        """Particles of one size (mm).

        Examples
        --------
        >>> import voidwalk as vw
        >>> vw.Gradation.single(0.2).d(50)
        0.2
        """
        return cls._of(_voidwalk.Gradation.single(size_mm))

    @classmethod
    def from_file(
        cls, path: Union[str, os.PathLike[str]], soil: Optional[str] = None, d0_mm: Optional[float] = None
    ) -> Gradation:
        """A soil from a table as laboratories write them: CSV, .xlsx, .ods or AGS4.

        Parameters
        ----------
        path : path-like
            The file.
        soil : str, optional
            Which of several soils.
        d0_mm : float, optional
            As for the class.
        """
        soils = _voidwalk.Gradation.in_file(os.fspath(path), d0_mm)
        if soil is None and len(soils) == 1:
            return cls._of(soils[0][1])
        for name, native in soils:
            if name == soil:
                return cls._of(native)
        held = ", ".join(name for name, _ in soils)
        raise ValueError(f"{os.fspath(path)}: soil = {soil!r} is not allowed; one of {held}")

    @classmethod
    def from_dataframe(
        cls,
        frame: Frame,
        size: str = "opening_mm",
        percent: str = "percent_finer",
        d0_mm: Optional[float] = None,
    ) -> Gradation:
        """A soil from two columns of a data frame, rows in any order.

        Parameters
        ----------
        frame : pandas.DataFrame
            Anything whose columns are had by their names.
        size, percent : str
            Names of the columns with openings (mm) and percent finer by mass.
        d0_mm : float, optional
            As for the class.
        """
        for name in (size, percent):
            if name not in frame:
                raise ValueError(f"the data frame has no column {name!r}")
        sizes, percents = floats(size, frame[size], None), floats(percent, frame[percent], None)
        order = sizes.argsort(kind="stable")
        return cls(sizes[order], percents[order], d0_mm)

    def d(self, percent: float) -> float:
        """Size (mm) that `percent` of the mass is finer than or equal to.

        Raises
        ------
        ValueError
            No percentage from 0 to 100, or one in the pan fraction.
        """
        return _known(self._native.d(percent), f"D{percent:g}")

    def d_by_number(self, percent: float) -> float:
        """Size (mm) that `percent` of the particles, by number, are finer than or equal to."""
        return _known(self._native.d_by_number(percent), f"D{percent:g} by number")

    def percent_finer(self, size_mm: float) -> float:
        """Percent of the mass no coarser than `size_mm`."""
        return self._native.percent_finer(size_mm)

    @property
    def cu(self) -> float:
        """Coefficient of uniformity, D60 / D10."""
        return _known(self._native.cu, "D10")

    @property
    def pan_fraction(self) -> float:
        """Share of the mass, 0 to 1, finer than the finest sieve and of unknown size."""
        return self._native.pan_fraction

    def points(self) -> Tuple[Floats, Floats]:
        """Sizes (mm, rising) and percents finer by mass, each of shape (n,), as they are plotted."""
        return self._native.points()

    def plot(self, ax: Optional[Axes] = None, *, label: Optional[str] = None) -> Axes:
        """Draws percent finer by mass against size (mm) by matplotlib: in `ax`, or in a new figure; `label` is its name in the
        legend."""
        return plot_gradation(*self.points(), label, ax)

    def base_particles(self, filter: Gradation, voids: int, grains_per_void: float, mass_ratio: float = 0.05) -> int:
        """Number of particles of this base that a test inserts, by Eq. (2) of the paper.

        Parameters
        ----------
        filter : Gradation
            The filter.
        voids : int
            Voids of the network.
        grains_per_void : float
            Filter grains per void, as :func:`constrictions` measures it.
        mass_ratio : float
            Mass of the base over mass of the filter.

        Examples
        --------
        >>> import voidwalk as vw
        >>> vw.Gradation.single(0.1).base_particles(vw.Gradation.single(1.0), 96_000, 0.6)
        2880000
        """
        return self._native.base_particles(filter._native, mass_ratio, grains_per_void, voids)

    def __reduce__(self) -> Tuple[object, ...]:
        sizes, percents = self.points()
        if len(sizes) == 2 and sizes[0] == sizes[1]:
            return Gradation.single, (float(sizes[0]),)
        return Gradation, (sizes, percents)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Gradation):
            return NotImplemented
        return all((a.shape == b.shape and bool((a == b).all())) for a, b in zip(self.points(), other.points()))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        sizes, _ = self.points()
        return f"Gradation({len(sizes)} points, {sizes[0]:g} to {sizes[-1]:g} mm)"

    def _repr_html_(self) -> str:
        sizes, percents = self.points()
        known = {f"D{percent}": self._native.d(percent) for percent in (15, 50, 85)}
        cu = self._native.cu
        facts = {name: "finer than the finest sieve" if d is None else f"{d:.4g} mm" for name, d in known.items()}
        facts["Cu"] = "not known" if cu is None else f"{cu:.3g}"
        rows = [(f"{size:g} mm", f"{percent:g} %") for size, percent in zip(sizes[::-1], percents[::-1])]
        return box("Gradation", facts, ("Size", "Finer by mass"), rows)


class Curve:
    """Constriction sizes of a filter by number: percent smaller against diameter.

    Parameters
    ----------
    percent_smaller : array_like of float, shape (n,)
        Percent of the constrictions, by number, smaller than each diameter; ends at 100.
    diameter_mm : array_like of float, shape (n,)
        Diameters (mm), rising.

    Examples
    --------
    >>> import voidwalk as vw
    >>> curve = vw.Curve([0, 100], [0.15, 0.35])
    >>> round(curve.dc(50), 3)
    0.25
    """

    __slots__ = {
        "_native": "",
        "filter": "Gradation of the filter of a shipped curve, a straight line, or None.",
        "grains_per_void": "Filter grains per void where the curve was measured, or None.",
    }

    def __init__(self, percent_smaller: ArrayLike, diameter_mm: ArrayLike) -> None:
        percents = floats("percent_smaller", percent_smaller, None)
        self._native = _voidwalk.Curve.from_points(percents, floats("diameter_mm", diameter_mm, None))
        self.filter: Optional[Gradation] = None
        self.grains_per_void: Optional[float] = None

    @classmethod
    def _of(cls, native: _voidwalk.Curve, filter: Optional[Gradation], grains_per_void: Optional[float]) -> Curve:
        new = cls.__new__(cls)
        new._native, new.filter, new.grains_per_void = native, filter, grains_per_void
        return new

    @classmethod
    def shipped(cls, name: str, d0_mm: float = 1.0) -> Curve:
        """A curve that comes with the program.

        Parameters
        ----------
        name : str
            Its name, as ``"cu1.5-loose"``.
        d0_mm : float
            Smallest grain (mm) of the filter.

        Examples
        --------
        >>> import voidwalk as vw
        >>> round(vw.Curve.shipped("cu1.5-loose").dc(5), 3)
        0.204
        """
        native, filter, grains_per_void = _voidwalk.Curve.shipped(name, d0_mm)
        return cls._of(native, Gradation._of(filter), grains_per_void)

    @classmethod
    def from_file(cls, path: Union[str, os.PathLike[str]], d0_mm: float = 1.0) -> Curve:
        """A curve from a CSV file with the columns percent_smaller and diameter_mm (or diameter_over_d0f)."""
        return cls._of(_voidwalk.Curve.from_file(os.fspath(path), d0_mm), None, None)

    def dc(self, percent: float) -> float:
        """Diameter (mm) that `percent` of the constrictions are smaller than."""
        return _known(self._native.dc(percent), f"Dc{percent:g}")

    def percent_smaller(self, diameter_mm: float) -> float:
        """Percent of the constrictions smaller than a diameter."""
        return self._native.percent_smaller(diameter_mm)

    @property
    def cu(self) -> float:
        """Dc60 / Dc10."""
        return self._native.cu

    def points(self) -> Tuple[Floats, Floats]:
        """Percents smaller and diameters (mm), each of shape (n,)."""
        return self._native.points()

    def plot(self, ax: Optional[Axes] = None, *, label: Optional[str] = None) -> Axes:
        """Draws percent smaller by number against the diameter (mm) of constrictions, as :meth:`Gradation.plot`."""
        return plot_curve(*self.points(), label, ax)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Curve):
            return NotImplemented
        same = all(a.shape == b.shape and bool((a == b).all()) for a, b in zip(self.points(), other.points()))
        return same and (self.filter, self.grains_per_void) == (other.filter, other.grains_per_void)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> Tuple[object, ...]:
        return _curve, (*self.points(), self.grains_per_void, self.filter)

    def __repr__(self) -> str:
        percents, sizes = self.points()
        return f"Curve({len(percents)} points, {sizes[0]:g} to {sizes[-1]:g} mm)"


def _curve(
    percents: Floats, sizes: Floats, grains_per_void: Optional[float], filter: Optional[Gradation] = None
) -> Curve:
    curve = Curve(frozen(percents), frozen(sizes))
    curve.filter, curve.grains_per_void = filter, grains_per_void
    return curve
