"""Several walks: boundaries of the model, and studies of parameters."""

from __future__ import annotations

import itertools
import json
import os
from importlib import import_module
from pathlib import Path
from typing import (
    TYPE_CHECKING, Callable, Dict, Iterable, List, Literal, Mapping, Optional, Sequence, Tuple, Union, cast,
)

from . import _voidwalk
from ._arrays import threads_or_none, whole
from ._plots import Axes, plot_boundaries
from ._progress import Follower, Following
from .records import Boundaries as BoundariesRecord, BoundaryRow, PercolationStudy, RowNote
from ._boxes import box
from ._result import Result, Row, WalkResult, counted_notes, page_of, read_csv, sentences_of
from ._scene import Scene, Settings, Stated
from ._tables import Soil, changes, workplace
from ._walk import manner, run
from .columns import Walked

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped,import-not-found,unused-ignore]

__all__ = ["Boundaries", "boundary", "percolation", "study"]

_Path = Union[str, "os.PathLike[str]"]


class Boundaries:
    """The boundaries of the model: where it begins to erode a base, and where erosion continues.

    Attributes
    ----------
    outcome : dict
        Everything that ``boundary.json`` says.
    walks : dict of ndarray
        The columns of ``boundary.csv``: a row a ratio D15F/D85B that was walked on a network.
    folder : pathlib.Path or None
        Folder of the study, where it has one.
    """

    def __init__(self, outcome: BoundariesRecord, walks: Walked, folder: Optional[Path] = None) -> None:
        self.outcome, self.walks, self.folder = outcome, walks, folder

    @property
    def notes(self) -> List[RowNote]:
        """What else to know of the model, as :attr:`Result.notes`: of a part alone each has its name as ``row``."""
        return self.outcome.get("notes", [])

    @property
    def note_sentences(self) -> List[str]:
        """The sentence of each of the notes, in their order."""
        return sentences_of(self.notes)

    @property
    def boundaries(self) -> List[BoundaryRow]:
        """One for each density and thickness: where no erosion turns into some, and some into continuing."""
        return self.outcome["boundaries"]

    def to_pandas(self) -> "pandas.DataFrame":
        """Every ratio that was walked, as a pandas.DataFrame: the columns of ``boundary.csv``."""
        frame: pandas.DataFrame = import_module("pandas").DataFrame(self.walks)
        return frame

    def plot(self, ax: Optional[Axes] = None) -> Axes:
        """Draws the eroded mass against D15F/D85B on every network, and both boundaries, by matplotlib: in `ax`, or in a new
        figure."""
        return plot_boundaries(self.outcome, self.walks, ax)

    def report(self) -> Path:
        """Writes the page of a study that has a folder again, and gives its path."""
        return page_of(self.folder)

    def __repr__(self) -> str:
        return f"Boundaries({self.outcome['base']['name']}; {counted_notes(self.notes)})"

    def _repr_html_(self) -> str:
        def ratio(row: BoundaryRow, name: Literal["no_erosion", "continuing"]) -> str:
            boundary = row[name]
            return "" if boundary is None else f"{boundary['median']:.2f}"

        facts: Dict[str, str] = {}
        for note, words in zip(self.notes, self.note_sentences):
            name = note.get("row") or "Notes"
            facts[name] = f"{facts[name]} {words}" if name in facts else words
        heading = ("Density", "Thickness", "No erosion up to D15F/D85B", "Continuing erosion from D15F/D85B")
        rows = [
            (row["density"], row["thickness"], ratio(row, "no_erosion"), ratio(row, "continuing"))
            for row in self.boundaries
        ]
        return box("Boundaries", facts, heading, rows)


def _words(given: Union[None, str, float, Sequence[Union[str, float]]]) -> List[str]:
    """One or several densities or thicknesses, as on the command line."""
    if given is None:
        return []
    several = [given] if isinstance(given, (str, int, float)) else list(given)
    return [word if isinstance(word, str) else repr(float(word)) for word in several]


def boundary(
    base: Optional[Soil] = None,
    filter: Union[None, Soil, float] = None,
    out: Optional[_Path] = None,
    threads: Optional[int] = None,
    *,
    density: Union[None, str, Sequence[str]] = None,
    pack: bool = False,
    thickness: Union[None, str, float, Sequence[Union[str, float]]] = None,
    as_sampled: bool = False,
    as_given: bool = False,
    seed: Optional[int] = None,
    replicates: Optional[int] = None,
    settings: Optional[Settings] = None,
    overwrite: bool = False,
    packings: _Path = "voidwalk-packings",
    memory: Optional[int] = None,
    progress: Follower = None,
) -> Boundaries:
    """Finds the boundaries of the model, for research, as ``voidwalk boundary`` does, to the same bits.

    Parameters
    ----------
    base : soil, optional
        As for :func:`judge`; from the settings without it.
    filter : soil, float or str, optional
        The filter's shape, whose size is searched: a soil, its Cu, or the name of a shipped curve.
    out : path-like, optional
        Folder for the results; a search that was stopped there goes on. Without it everything stays in memory.
    threads : int, optional
        One per core without it; they change no bit.
    density : str or sequence of str, optional
        "dense", "medium", "loose" or "unknown" from the library of packings; "friction=F" packs with that
        friction, "estimate=D" guesses the constrictions at that relative density.
    pack : bool
        Pack the grains of this very filter and measure its constrictions.
    thickness : str, float or sequence of them, optional
        "60layers", "75D50F", "500mm", "24in" or a number of mm; 60 layers without it.
    as_sampled, as_given, seed, replicates, settings
        As for :func:`judge`.
    overwrite, packings, memory, progress
        As for :func:`run`.

    Raises
    ------
    ValueError
        What is refused before any work.
    VoidwalkError
        Work that failed.

    Examples
    --------
    >>> import voidwalk as vw
    >>> base = vw.Gradation([0.08, 0.3], [0, 100])
    >>> found = vw.boundary(base, "cu1.5-loose", thickness="10layers", replicates=2,
    ...                     settings={"network.nx": 8, "network.ny": 8})
    >>> len(found.boundaries), found.boundaries[0]["thickness"]
    (1, '10 layers')
    """
    options = {"seed": ("seed", seed), "replicates": ("replicates", replicates)}
    how = manner("boundary", memory, threads, None)
    stated = changes(settings, options)
    search = (_words(density), bool(pack), _words(thickness))
    with workplace() as place, Following(progress) as callback:
        shape: Optional[str] = None
        if isinstance(filter, (int, float)):
            shape = repr(float(filter))
        elif filter is not None:
            shape = place.table("filter", filter)
        place_of_results = Path(place.out(out))
        said = _voidwalk.boundary(
            None if base is None else place.table("base", base), shape, search, stated, bool(as_sampled),
            bool(as_given), place_of_results, bool(overwrite), os.fspath(packings), how, callback,
        )
        return Boundaries(
            json.loads(place.named(said)), cast(Walked, read_csv(place_of_results / "boundary.csv")),
            None if out is None else place_of_results,
        )


def percolation(
    sizes: Sequence[Union[int, Tuple[int, int, int]]] = (10, 20, 40, 80, 160),
    realisations: int = 100,
    *,
    seed: int = 1,
    out: Optional[_Path] = None,
    threads: Optional[int] = None,
    overwrite: bool = False,
    progress: Follower = None,
) -> PercolationStudy:
    """Finds the percolation threshold of lattices, as ``voidwalk percolation`` does, to the same bits.

    Parameters
    ----------
    sizes : sequence of int or of (int, int, int)
        Voids along each side of the cubes, or along x, y and z.
    realisations : int
        Realisations of each size.
    seed : int
        The same seed gives the same bits.
    out : path-like, optional
        Folder for the results; nothing is kept without it.
    threads, overwrite, progress
        As for :func:`run`.

    Returns
    -------
    dict
        What ``percolation.json`` says: sizes with the mean threshold and its interval, and both relations of
        finite size that were fitted.

    Examples
    --------
    >>> import voidwalk as vw
    >>> found = vw.percolation([8, 12], realisations=20)
    >>> 0.3 < found["sizes"][0]["threshold"]["mean"] < 0.5
    True
    """
    lengths = [size if isinstance(size, (tuple, list)) else (size, size, size) for size in sizes]
    shapes = [tuple(whole("sizes", length, 1) for length in of) for of in lengths]
    if any(len(shape) != 3 or max(shape) >= 2**32 for shape in shapes):
        raise ValueError("sizes: each is a whole number, or three, below 2**32")
    count = whole("realisations", realisations, 1)
    if count > 1_000_000:
        raise ValueError(f"realisations = {count} is not allowed; a whole number from 1 to 1000000")
    with workplace() as place, Following(progress) as callback:
        said = _voidwalk.percolation(
            [(x, y, z) for x, y, z in shapes], count, whole("seed", seed), place.out(out), bool(overwrite),
            threads_or_none(threads), callback,
        )
    found: PercolationStudy = json.loads(said)
    return found


def study(
    cases: Union[Mapping[str, Iterable[object]], Iterable[Mapping[str, object]]],
    walk: Union[None, Scene, Stated, Callable[..., Union[Result, WalkResult]]] = None,
    *,
    progress: bool = False,
) -> "pandas.DataFrame":
    """Walks every case of a parameter study, and gives a table with a row a case.

    Parameters
    ----------
    cases : mapping of sequences, or iterable of mappings
        Values by parameter, every one with every other; or the cases themselves, a dict of parameters each.
    walk : callable, Scene, path-like, mapping or None
        What is walked: a function that is called with the parameters of a case by name and gives a
        :class:`Result` or :class:`WalkResult`; or a scene as for :func:`run`, in which the parameters are settings.
    progress : bool
        Shows a bar over the cases where tqdm is installed.

    Returns
    -------
    pandas.DataFrame
        The parameters of each case, then the columns of :meth:`Result.row`.

    Examples
    --------
    >>> import voidwalk as vw
    >>> network = vw.Network.cubic([10, 10, 20], "cu1.5-loose")
    >>> found = vw.study(
    ...     {"d85_mm": [0.1, 0.2, 0.3]},
    ...     lambda d85_mm: vw.walk(network, vw.Gradation.linear(1.5, d85_mm, percent=85), n_base=5000, replicates=2),
    ... )
    >>> found["eroded_1"].is_monotonic_decreasing
    True
    """
    try:
        made = import_module("pandas")
    except ImportError:
        raise ImportError("study gives a pandas.DataFrame: install pandas") from None
    listed: List[Dict[str, object]]
    if isinstance(cases, Mapping):
        factors = cast(Mapping[str, Iterable[object]], cases)
        values = [list(of) for of in factors.values()]
        listed = [dict(zip(factors, levels)) for levels in itertools.product(*values)]
    else:
        listed = [dict(case) for case in cases]
    walked: Iterable[Dict[str, object]] = listed
    if progress:
        try:
            walked = import_module("tqdm.auto").tqdm(listed, unit="case", leave=False)
        except ImportError:
            pass
    rows: List[Dict[str, object]] = []
    for case in walked:
        if callable(walk):
            result: Union[Result, WalkResult] = walk(**case)
        else:
            result = run(walk, settings=case)
        row: Row = result.row()
        rows.append({**case, **row})
    frame: pandas.DataFrame = made.DataFrame(rows)
    return frame
