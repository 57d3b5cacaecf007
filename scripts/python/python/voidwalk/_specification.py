"""The specification of a filter by practice alone, without a walk."""

from __future__ import annotations

import json
import os
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Dict, List, Literal, Optional, Union

from . import _voidwalk
from ._boxes import box
from ._plots import Axes, plot_specification
from ._progress import Follower, Following
from ._result import page_of, read_csv
from ._tables import Soil, workplace
from .columns import Table
from .records import ProductMargin, SieveLimit, SizeBand, Specification as SpecificationRecord, SpecificationStep

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped,import-not-found,unused-ignore]

__all__ = ["Specification", "specification"]

#: The tables of a specification, and the file of each.
_TABLES = {"limits": "specification.csv", "steps": "specification_steps.csv", "products": "specification_products.csv"}


class Specification:
    """The specification of a filter for a base by the rules of practice: steps, band, limits sieve by sieve.

    Attributes
    ----------
    outcome : dict
        Everything that ``specification.json`` says (:class:`voidwalk.records.Specification`).
    tables : dict of dict of ndarray
        The columns of its CSV files: ``"limits"``, ``"steps"`` and ``"products"``.
    folder : pathlib.Path or None
        Folder of the specification, where it has one.
    """

    def __init__(self, outcome: SpecificationRecord, tables: Dict[str, Table], folder: Optional[Path] = None) -> None:
        self.outcome, self.tables, self.folder = outcome, tables, folder
        words = _voidwalk.specification_words(json.dumps(outcome))
        self._d15f, self._no_band, self._note, self._set_by, self._fits = words

    @property
    def answer(self) -> str:
        """D15F of the band, or why there is none, in short."""
        return self._d15f or f"No band. {self._no_band or ''}".rstrip()

    @property
    def steps(self) -> List[SpecificationStep]:
        """Every step: its name (``does``), formula, numbers, notes and source; ``tables["steps"]`` has it in words."""
        return self.outcome["steps"]

    @property
    def d15f_min_mm(self) -> Optional[float]:
        """Minimum D15F (mm) that drains the base; ``None`` where it is not known."""
        return self.outcome["d15f_min_mm"]

    @property
    def d15f_max_mm(self) -> Optional[float]:
        """Maximum D15F (mm) that retains the base; ``None`` where it is not known."""
        return self.outcome["d15f_max_mm"]

    @property
    def set_by(self) -> Optional[str]:
        """The rule that sets the maximum D15F; ``None`` where it is not known."""
        return self._set_by

    @property
    def band(self) -> Optional[SizeBand]:
        """Both sides of the band up to their D60, and their D5, D15 and D60 (mm); ``None`` where there is no band."""
        return self.outcome["band"]

    @property
    def no_band(self) -> Optional[str]:
        """Why there is no band, in words; ``None`` where there is one."""
        return self._no_band

    @property
    def limits(self) -> List[SieveLimit]:
        """Least and greatest percent finer at each sieve, the coarsest first; ``None`` above the D60 of the fine
        side, and empty without a band."""
        return self.outcome["limits"]

    @property
    def note(self) -> Optional[str]:
        """What a delivery must keep beside the limits, which alone are not enough; ``None`` without a band."""
        return self._note

    @property
    def products(self) -> List[ProductMargin]:
        """Standard products beside the specification, with their margins."""
        return self.outcome["products"]

    @property
    def fits(self) -> Dict[str, Optional[bool]]:
        """Whether both sides of each product keep every requirement, by its name; ``None`` where a limit of D15F
        that is not known decides."""
        return {of["product"]: fits for of, fits in zip(self.products, self._fits)}

    def to_pandas(self, table: Literal["limits", "steps", "products"] = "limits") -> "pandas.DataFrame":
        """One of the tables as a pandas.DataFrame: ``"limits"``, ``"steps"`` (a row a number) or ``"products"``."""
        if table not in _TABLES:
            raise ValueError(f"table = {table} is not allowed; one of {', '.join(_TABLES)}")
        frame: pandas.DataFrame = import_module("pandas").DataFrame(self.tables[table])
        return frame

    def plot(self, ax: Optional[Axes] = None) -> Axes:
        """Draws the curves of the base and both sides of the band, by matplotlib: in `ax`, or in a new figure."""
        return plot_specification(self.outcome, ax)

    def report(self) -> Path:
        """Writes the page of a specification that has a folder again, and gives its path."""
        return page_of(self.folder)

    def __repr__(self) -> str:
        return f"Specification({self.outcome['base']}: {self.answer})"

    def _repr_html_(self) -> str:
        facts = {"By the rules of practice alone": self.answer}
        if self.note is not None:
            facts["Beside the limits"] = self.note
        rows = []
        for of in self.limits:
            least, most = of["min_percent_finer"], of["max_percent_finer"]
            rows.append((of["sieve"], f"{of['opening_mm']:g}", f"{least:g}", "" if most is None else f"{most:g}"))
        heading = ("Sieve", "Opening (mm)", "Least finer (%)", "Greatest finer (%)")
        return box(f"Specification of a filter for {self.outcome['base']}", facts, heading, rows)


def read_specification(folder: Path, said: str, keep: Optional[Path]) -> Specification:
    """The specification in a folder, whose record is said."""
    tables = {name: read_csv(folder / file) for name, file in _TABLES.items()}
    return Specification(json.loads(said), tables, keep)


def specification(
    base: Soil,
    out: Union[None, str, "os.PathLike[str]"] = None,
    *,
    dispersive: bool = False,
    finer: bool = False,
    sieves: Literal["us", "iso"] = "us",
    overwrite: bool = False,
    progress: Follower = None,
) -> Specification:
    """Specifies a filter for a base by the rules of practice alone, as ``voidwalk design BASE`` does.

    Nothing is walked.

    Parameters
    ----------
    base : Gradation, path-like, or a pair of array_like
        The soil to be retained, as for :func:`judge`. Several soils in a file are the curves of one envelope;
        ``"FILE#NAME"`` takes one.
    out : path-like, optional
        Folder for the results: tables, page and workbook. Without it everything stays in memory.
    dispersive : bool
        The base is dispersive: stricter limits if it has many fines.
    finer : bool
        The band lies at the finer end of what is allowed: its maximum D15F is lowered, not its minimum raised.
    sieves : {"us", "iso"}
        Sieves at which the limits are stated: ASTM E11, or mm.
    overwrite : bool
        Whether the results of an earlier call in `out` are replaced.
    progress
        As for :func:`run`.

    Raises
    ------
    ValueError
        A table that is refused, or holds a filter as well.

    Examples
    --------
    >>> import voidwalk as vw
    >>> core = ([0.002, 0.005, 0.0125, 0.03, 0.075, 0.15, 0.3, 0.6, 1.2, 2.0], [0, 15, 30, 45, 60, 68, 77, 85, 94, 100])
    >>> found = vw.specification(core)
    >>> found
    Specification(base: D15F from 0.140 to 0.700 mm)
    >>> found.d15f_min_mm, found.d15f_max_mm, len(found.limits)
    (0.1, 0.7, 6)
    """
    with workplace() as place, Following(progress) as callback:
        place_of_results = Path(place.out(out))
        said = _voidwalk.specification(
            place.table("base", base), bool(dispersive), bool(finer), sieves, place_of_results, bool(overwrite),
            callback,
        )
        return read_specification(place_of_results, place.named(said), None if out is None else place_of_results)
