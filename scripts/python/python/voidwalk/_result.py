"""What came of a walk: classes, statistics, columns."""

from __future__ import annotations

import csv
import json
import os
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Dict, List, Literal, Optional, Sequence, Tuple, Union, cast

import numpy as np
from numpy.typing import NDArray

from . import _voidwalk
from ._plots import Axes, plot_result
from .columns import Blockings, Column, Flow, Layers, RetainedByVoid, Series, Sizes, Table
from .records import Model, Note, Outcome, Practice, Replicate, RowNote, RunSummary, WalkOutcome

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped,import-not-found,unused-ignore]
    import xarray  # type: ignore[import-untyped,import-not-found,unused-ignore]

__all__ = ["CampaignResult", "Result", "WalkResult"]

#: The facts of a case, by name.
Row = Dict[str, Union[None, str, int, float]]

#: Columns of the tables that are no whole numbers.
_FRACTIONS = ("eroded_mass_fraction", "diameter_mm", "percent_finer_by_mass", "percent_finer_by_number", "k_over_k0")

#: What a result draws.
Figure = Literal["progress", "layers", "curves", "rules"]

#: The names of its tables.
TableName = Literal["series", "layers", "retained", "eroded", "flow", "retained_by_void", "blockings"]

#: The tables of a result, and their files.
_TABLES = {
    **{name: f"{name}.csv" for name in ("series", "layers", "retained", "eroded", "flow", "retained_by_void")},
    "blockings": "blocked.csv",
}


class _Walked:
    """The numbers and tables of a walk, on a scene's networks or on given ones."""

    def __init__(self, outcome: Union[Outcome, WalkOutcome], tables: Dict[str, Table]) -> None:
        self.outcome = outcome
        self.series, self.layers = cast(Series, tables["series"]), cast(Layers, tables["layers"])
        self.retained, self.eroded = cast(Sizes, tables["retained"]), cast(Sizes, tables["eroded"])
        self.flow = cast(Flow, tables.get("flow", {}))
        self.retained_by_void = cast(RetainedByVoid, tables.get("retained_by_void", {}))
        self.blockings = cast(Blockings, tables.get("blockings", {}))

    @property
    def notes(self) -> List[Note]:
        """What else to know, in a fixed order: each a dict of id and numbers, with the unit in their names."""
        return self.outcome["notes"]

    @property
    def note_sentences(self) -> List[str]:
        """The sentence of each of the notes, in their order."""
        return sentences_of(self.notes)

    @property
    def summary(self) -> List[RunSummary]:
        """Statistics over the replicates, a dict for each run: each a dict of mean, sd and the 95 % interval low to
        high. The ``summary`` of ``outcome.json``."""
        return self.outcome["summary"]

    @property
    def replicates(self) -> List[Replicate]:
        """Every replicate: its seed, verdict and runs."""
        return self.outcome["replicates"]

    def eroded_mass_fraction(self, run: int = 1) -> NDArray[np.float64]:
        """Mass eroded over mass inserted in a run (1 or 2), shape (replicates,)."""
        return np.array([replicate["runs"][run - 1]["eroded_mass_fraction"] for replicate in self.replicates])

    def row(self) -> Row:
        """The facts of the walk in a flat dict, for a table with a row a case.

        Returns
        -------
        dict
            ``verdict`` (the model's class), ``headline`` (the answer of practice; not of a walk on a given network),
            ``replicates``, ``n_base``, ``grains_per_void``, ``d85b_mm``, ``d15f_mm``, ``d15f_over_d85b``, ``voids``,
            ``thickness_mm``, ``seed``; and for each run, such as the first, ``eroded_1`` (mean of the mass eroded over
            the mass inserted), ``eroded_1_sd``, ``eroded_1_low`` and ``eroded_1_high`` (95 % interval of the mean),
            ``blocked_1`` (mean of the share of constrictions that are blocked). ``None`` is what is not known.

        Examples
        --------
        >>> import voidwalk as vw
        >>> row = vw.walk(vw.Network.cubic([6, 6, 9]), 0.2, n_base=1000, replicates=2).row()
        >>> row["verdict"], row["n_base"], row["d85b_mm"]
        ('continuing erosion', 1000, 0.2)
        """
        row = self._case()
        for run in self.summary:
            name, eroded = f"eroded_{run['run']}", run["eroded_mass_fraction"]
            row[name] = eroded["mean"]
            row[f"{name}_sd"], row[f"{name}_low"], row[f"{name}_high"] = eroded["sd"], eroded["low"], eroded["high"]
            row[f"blocked_{run['run']}"] = run["blocked_fraction"]["mean"]
        return row

    def _case(self) -> Row:
        """The facts of a row that are of no run."""
        raise NotImplementedError

    def _facts(self, d85b: Optional[float], d15f: Optional[float], voids: int, thickness: Optional[float]) -> Row:
        """What every row has, behind its class."""
        outcome = self.outcome
        return {
            "replicates": len(self.replicates),
            "n_base": outcome["n_base"],
            "grains_per_void": outcome["grains_per_void"],
            "d85b_mm": d85b,
            "d15f_mm": d15f,
            "d15f_over_d85b": None if d15f is None or d85b is None else d15f / d85b,
            "voids": voids,
            "thickness_mm": thickness,
            "seed": outcome["seed"],
        }

    def plot(self, what: Figure = "progress", ax: Optional[Axes] = None) -> Axes:
        """Draws a figure of the walk by matplotlib.

        Parameters
        ----------
        what : {"progress", "layers", "curves", "rules"}
            Eroded mass against increments; blocked constrictions by layer; gradations and constrictions with what
            was retained and eroded; how near each rule of practice is to its limit.
        ax : matplotlib.axes.Axes, optional
            Where to; a new figure without it.
        """
        return plot_result(cast(Outcome, self.outcome), (self.series, self.layers, self.retained, self.eroded), what, ax)

    def to_pandas(self, table: TableName = "series") -> "pandas.DataFrame":
        """One of the tables (series, layers, retained, eroded, flow, ...) as a pandas.DataFrame."""
        if table not in _TABLES:
            raise ValueError(f"table = {table} is not allowed; one of {', '.join(_TABLES)}")
        frame: pandas.DataFrame = import_module("pandas").DataFrame(getattr(self, table))
        return frame

    def to_xarray(self, table: TableName = "series") -> "xarray.Dataset":
        """One of the tables as an xarray.Dataset over replicate, run and increment, or layer, size, void."""
        over = {
            "layers": ["replicate", "run", "layer"],
            "retained": ["replicate", "run", "increment", "diameter_mm"],
            "eroded": ["replicate", "run", "increment", "diameter_mm"],
            "retained_by_void": ["run", "increment", "void"],
            "blockings": ["run", "increment", "constriction"],
        }
        found: xarray.Dataset = self.to_pandas(table).set_index(over.get(table, ["replicate", "run", "increment"])).to_xarray()
        return found

    def report(self, path: Union[None, str, os.PathLike[str]] = None) -> Path:
        """Writes the page of the walk: its class, figures, tables, what the model leaves out.

        Parameters
        ----------
        path : path-like, optional
            Where to. Without it the ``report.html`` in the folder of the run, written again from the files
            there.

        Returns
        -------
        pathlib.Path
            The page: one file that shows itself alone.

        Raises
        ------
        ValueError
            No `path`, of a result without a folder; or a result whose outcome or tables were changed until
            they do not fit together.

        Examples
        --------
        >>> import tempfile, voidwalk as vw
        >>> result = vw.walk(vw.Network.cubic([6, 6, 9]), 0.2, n_base=1000, replicates=2)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     page = result.report(f"{folder}/page.html").read_text(encoding="utf-8")
        >>> "What the model leaves out" in page
        True
        """
        if path is None:
            raise ValueError('path is missing: this result has no folder; report("page.html") writes the page there')
        return _written(Path(path), self._page().encode("utf-8"))

    def _page(self) -> str:
        """The page of a walk in memory."""
        raise NotImplementedError

    def _tables(self) -> Dict[str, Table]:
        """Its tables by name."""
        return {name: getattr(self, name) for name in _TABLES if getattr(self, name)}

    def _runs(self) -> str:
        """Runs and replicates in a line, and the number of notes."""
        means = ((run["run"], 100 * run["eroded_mass_fraction"]["mean"]) for run in self.summary)
        rows = [f"run {run}: {mean:.2f} % of the mass eroded" for run, mean in means]
        count = len(self.replicates)
        rows.append(f"{count} {'replicate' if count == 1 else 'replicates'}")
        if self.notes:
            rows.append(counted_notes(self.notes))
        return "; ".join(rows)


class Result(_Walked):
    """The answer of practice and of the model for a base and a filter, or for a scene.

    Attributes
    ----------
    outcome : dict
        Everything that ``outcome.json`` says (:class:`voidwalk.records.Outcome`).
    series : dict of ndarray
        Counts of particles after each recorded increment, by replicate and run: inserted, moving, eroded,
        retained_in_constrictions, retained_in_voids, trapped, blocked (constrictions), eroded_mass_fraction.
    layers : dict of ndarray
        Constrictions, blocked ones and retained particles by replicate, run and layer.
    retained, eroded : dict of ndarray
        Size curves of the particles that were retained and that were eroded: diameter_mm,
        percent_finer_by_mass, percent_finer_by_number, by replicate, run and increment.
    flow : dict of ndarray
        Conductance of the network over its first one, by replicate, run and increment, where water flows.
    retained_by_void, blockings : dict of ndarray
        With ``record.voids``, of the first replicate: what each void retained, and which constriction was blocked in
        which increment, by run and increment.
    folder : pathlib.Path or None
        Folder of the run, where it has one.
    """

    outcome: Outcome

    def __init__(
        self,
        outcome: Outcome,
        tables: Dict[str, Table],
        folder: Optional[Path] = None,
        texts: Optional[Tuple[str, str, Optional[str]]] = None,
    ) -> None:
        super().__init__(outcome, tables)
        self.folder, self._texts = folder, texts

    @property
    def headline(self) -> Optional[str]:
        """The answer of filter practice, as ``"meets the rules checked"``; ``None`` without two sieve curves in mm."""
        return self.outcome.get("headline")

    @property
    def practice(self) -> Optional[Practice]:
        """What filter practice says of the pair, without the walk: class (``"meets"``, ``"does not meet"`` or ``"not
        known"``), D15F, its limit, and what tests showed; ``None`` without two sieve curves in mm."""
        return self.outcome.get("practice")

    @property
    def model(self) -> Model:
        """What the walk says, without practice: class, mass eroded (%) of each run from least to most, replicates and
        network. The class is ``"no erosion"`` (less than 7.5 % of the mass eroded in the first run), ``"some erosion"``
        (more in the first run, less in the second: the filter seals), ``"continuing erosion"`` (more in both), or
        ``"undecided"``."""
        return self.outcome["model"]

    @property
    def note_sentences(self) -> List[str]:
        """The sentence of each of the notes, in their order."""
        return sentences_of(self.notes, self.outcome["inputs"]["scale_free"])

    def report(self, path: Union[None, str, os.PathLike[str]] = None) -> Path:
        if self.folder is None:
            return super().report(path)
        page = Path(_voidwalk.report(os.fspath(self.folder)))
        return page if path is None else _written(Path(path), page.read_bytes())

    report.__doc__ = _Walked.report.__doc__

    def _case(self) -> Row:
        inputs = self.outcome["inputs"]
        network = inputs["network"]
        facts = self._facts(
            inputs["base"]["d85_mm"], inputs["filter"]["d15_mm"], network["voids"], network["thickness_mm"]
        )
        return {"verdict": self.model["class"], "headline": self.headline, **facts}

    def _page(self) -> str:
        if self._texts is None:
            raise ValueError("this result has neither a folder nor the texts of its scene, and so no page")
        return _voidwalk.run_page(json.dumps(self.outcome), self._texts, self._tables())

    def __repr__(self) -> str:
        practice = "" if self.headline is None else f"practice: {self.headline}; "
        return f"Result({practice}model: {self.model['class']}; {self._runs()})"

    def _repr_html_(self) -> str:
        return _voidwalk.run_brief(json.dumps(self.outcome))


class WalkResult(_Walked):
    """The results of a walk on given networks.

    Attributes
    ----------
    outcome : dict
        The verdict with its notes, the summary, every replicate, what was walked with what, and what Eq. (2) asks
        for (:class:`voidwalk.records.WalkOutcome`).
    series, layers, retained, eroded : dict of ndarray
        As of a :class:`Result`.
    blocked : ndarray of bool, shape (replicates, runs, constrictions)
        Which constrictions were blocked at the end of each run.
    """

    outcome: WalkOutcome

    def __init__(self, outcome: WalkOutcome, tables: Dict[str, Table], blocked: NDArray[np.bool_]) -> None:
        super().__init__(outcome, tables)
        self.blocked = blocked

    @property
    def verdict(self) -> str:
        """Class of erosion in the walk, as the class of :attr:`Result.model`."""
        return self.outcome["verdict"]

    def _case(self) -> Row:
        walked = self.outcome
        facts = self._facts(walked["base"]["d85_mm"], walked["d15f_mm"], walked["network"]["voids"], None)
        return {"verdict": self.verdict, **facts}

    def _page(self) -> str:
        return _voidwalk.walk_page(json.dumps(self.outcome), self._tables())

    def __repr__(self) -> str:
        return f"WalkResult({self.verdict}; {self._runs()})"

    def _repr_html_(self) -> str:
        return _voidwalk.walk_brief(json.dumps(self.outcome))


def sentences_of(notes: Sequence[Union[Note, RowNote]], scale_free: bool = False) -> List[str]:
    """The sentence of each note; sizes are in mm, or multiples of D0F."""
    return _voidwalk.note_sentences(json.dumps(notes), scale_free)


def counted_notes(notes: Sequence[object]) -> str:
    """The number of notes."""
    return f"{len(notes)} {'note' if len(notes) == 1 else 'notes'}"


def page_of(folder: Optional[Path]) -> Path:
    """The page of a finished folder, written again from its files."""
    if folder is None:
        raise ValueError("these results have no folder, and so no page: name one by out")
    return Path(_voidwalk.report(os.fspath(folder)))


def _written(place: Path, content: bytes) -> Path:
    """Writes a file whole or not at all: an older one stays until all of the new one is there."""
    part = place.with_name(f"{place.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        os.replace(part, place)
    finally:
        part.unlink(missing_ok=True)
    return place


class CampaignResult:
    """The folder of a campaign.

    Attributes
    ----------
    folder : pathlib.Path
        The folder.
    cases : dict of ndarray
        The columns of ``cases.csv``: a row a case.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.cases = folder, read_csv(folder / "cases.csv")

    def to_pandas(self) -> "pandas.DataFrame":
        """The cases as a pandas.DataFrame."""
        frame: pandas.DataFrame = import_module("pandas").DataFrame(self.cases)
        return frame

    def __len__(self) -> int:
        return len(next(iter(self.cases.values()), []))

    def __repr__(self) -> str:
        return f"CampaignResult({len(self)} cases in {self.folder})"


def _column(name: str, cells: List[str]) -> Column:
    """A column of a CSV file: of whole numbers, of numbers (no number where a cell is empty), or of words."""
    try:
        if name == "void":
            return np.array(cells).astype(np.int64)
        if name not in _FRACTIONS:
            return np.array(cells).astype(np.uint64)
    except ValueError:
        pass
    try:
        return np.array([float("nan") if c == "" else c for c in cells]).astype(np.float64)
    except ValueError:
        return np.array(cells)


def read_csv(path: Path) -> Table:
    """The columns of a CSV file."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = rows[0]
    columns: List[List[str]] = [[row[i] for row in rows[1:]] for i in range(len(names))]
    return {name: _column(name, cells) for name, cells in zip(names, columns)}


def read_run(folder: Path) -> Result:
    """The result of a run folder."""
    outcome = json.loads((folder / "outcome.json").read_text(encoding="utf-8"))
    tables = {name: read_csv(folder / file) for name, file in _TABLES.items() if (folder / file).exists()}
    return Result(outcome, tables, folder=folder)
