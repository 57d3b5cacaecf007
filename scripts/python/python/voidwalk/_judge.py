"""Two sieve tables in, the whole answer out; what practice says of them; and what is understood of a table."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Dict, List, Optional, Tuple, Union

from . import _voidwalk
from ._progress import Follower, Following
from .records import PairRules, SoilSummary
from ._result import Result, read_run
from ._scene import Setting, Settings
from ._soil import Gradation
from ._tables import Soil, changes, curves, gradation, workplace
from ._walk import manner

__all__ = ["judge", "rules", "soil"]


def judge(
    base: Soil,
    filter: Soil,
    out: Union[None, str, "os.PathLike[str]"] = None,
    threads: Optional[int] = None,
    *,
    density: Optional[str] = None,
    pack: bool = False,
    quick: bool = False,
    as_sampled: bool = False,
    as_given: bool = False,
    dispersive: bool = False,
    joint_mm: Optional[float] = None,
    seed: Optional[int] = None,
    replicates: Optional[int] = None,
    settings: Optional[Settings] = None,
    overwrite: bool = False,
    packings: Union[str, "os.PathLike[str]"] = "voidwalk-packings",
    memory: Optional[int] = None,
    checkpoint_every: Optional[str] = None,
    progress: Follower = None,
) -> Result:
    """Judges whether a filter holds a base, as ``voidwalk judge BASE FILTER`` does, to the same bits.

    Parameters
    ----------
    base, filter : Gradation, path-like, or a pair of array_like
        The soil to be retained, and the soil that retains it: a gradation, a file, or a pair of sizes (mm) and
        percents finer by mass. A file is a sieve table in CSV (two columns: opening in mm, percent finer), .xlsx,
        .ods or AGS4; ``"FILE#NAME"`` takes one of several soils.
    out : path-like, optional
        Folder for the results. A run that was stopped there goes on. Without it everything stays in memory.
    threads : int, optional
        One per core without it; they change no bit.
    density : {"loose", "medium", "dense"}, optional
        Density of the filter, whose constrictions come from the library of packings. Loose and dense are both
        walked without it.
    pack : bool
        Pack the grains of this very filter and measure its constrictions; loose without a density. A warning calls
        it the setting ``filter.density``.
    quick : bool
        A first look: five replicates.
    as_sampled : bool
        Walk the base as sampled, not as filter practice regrades it.
    as_given : bool
        Take the two as they are given, though they look exchanged.
    dispersive : bool
        The base is dispersive: stricter limits if it has many fines.
    joint_mm : float, optional
        Width (mm) of an open joint at the exit: adds the probability of continuing erosion into it.
    seed : int, optional
        The same seed gives the same bits.
    replicates : int, optional
        Walks with random numbers of their own.
    settings : mapping, optional
        Further settings of the scene, as ``{"network.nx": 20}``. A name with a point in a message, as
        ``filter.d0_mm``, is one of them; ``filter.sieve`` and ``base.sieve`` are the files given here.
    overwrite, packings, memory, checkpoint_every, progress
        As for :func:`run`.

    Returns
    -------
    Result
        ``headline`` and ``practice`` (filter practice), ``model`` (the walk), ``notes`` (what else to know; in
        words ``note_sentences``), ``summary`` and ``outcome``, which has everything.

    Raises
    ------
    ValueError
        The two look exchanged; a table or a setting that is refused.
    VoidwalkError
        Work that failed.

    Examples
    --------
    >>> import voidwalk as vw
    >>> base, filter = ([0.08, 0.3], [0, 100]), ([0.5, 2.0], [0, 100])
    >>> small = {"network.nx": 10, "network.ny": 10, "network.nz": 12}
    >>> result = vw.judge(base, filter, density="dense", quick=True, settings=small)
    >>> result.headline, result.model["class"]
    ('does not meet practice', 'no erosion')
    """
    options: Dict[str, Tuple[str, Optional[Setting]]] = {
        "dispersive": ("base.dispersive", True if dispersive else None),
        "joint_mm": ("filter.joint_mm", joint_mm),
        "seed": ("seed", seed),
        "replicates": ("replicates", replicates),
    }
    stated = changes(settings, options)
    tables = (density, bool(pack), bool(quick), bool(as_sampled), bool(as_given), stated)
    how = manner("judge", memory, threads, checkpoint_every)
    with workplace() as place, Following(progress) as callback:
        scene = _voidwalk.Scene.of_tables(place.table("base", base), place.table("filter", filter), tables)
        if out is None:
            said, columns, texts = _voidwalk.run_in_memory(scene, os.fspath(packings), how, callback)
            return Result(json.loads(said), columns, texts=texts)
        folder = _voidwalk.run(scene, os.fspath(out), bool(overwrite), os.fspath(packings), how, callback)
    return read_run(Path(folder))


def rules(
    base: Soil,
    filter: Soil,
    *,
    dispersive: bool = False,
    joint_mm: Optional[float] = None,
    as_given: bool = False,
) -> PairRules:
    """Every rule of filter practice on a base and a filter, as ``voidwalk rules BASE FILTER --json`` prints it.

    Parameters
    ----------
    base, filter : Gradation, path-like, or a pair of array_like
        The soil to be retained, and the soil that retains it, as for :func:`judge`. Several soils in a file are
        the curves of one envelope; ``"FILE#NAME"`` takes one.
    dispersive : bool
        The base is a dispersive clay or silt.
    joint_mm : float, optional
        Width of an open joint beside the base (mm).
    as_given : bool
        Take the two as they are given, though they look exchanged.

    Returns
    -------
    dict
        ``"base"`` and ``"filter"`` (their sizes), ``"rules"``, each with ``id``, ``name``, ``value``, ``limit``,
        ``met`` and ``source``, ``"headline"`` and ``"practice"`` (``None`` where the limit of design was not
        applied), and ``"notes"``; see :class:`voidwalk.records.PairRules`.

    Raises
    ------
    ValueError
        The two look exchanged; a file that is refused.

    Examples
    --------
    >>> import voidwalk as vw
    >>> base = vw.Gradation([0.08, 0.155, 0.3], [0, 50, 100])
    >>> filter = vw.Gradation([0.5, 1.0, 2.0], [0, 50, 100])
    >>> pair = vw.rules(base, filter)
    >>> [rule["met"] for rule in pair["rules"] if rule["id"] == "sherard-dunnigan"]
    [True]
    >>> [rule["id"] for rule in pair["rules"] if "NRCS" in rule.get("stated_by", [])]
    ['sherard-dunnigan', 'permeability']
    """
    bases, filters = curves("base", base), curves("filter", filter)
    found: PairRules = json.loads(_voidwalk.rules(bases, filters, dispersive, joint_mm, as_given))
    return found


def soil(soil: Soil, *, d0_mm: Optional[float] = None) -> List[SoilSummary]:
    """What is understood of a soil, or of every soil in a file, as ``voidwalk soil FILE --json`` prints it.

    Parameters
    ----------
    soil : Gradation, path-like, or a pair of array_like
        A file, a gradation, or sizes (mm) and percents finer by mass.
    d0_mm : float, optional
        Size (mm) at which a curve whose finest sieve lets some mass through goes on to 0 %.

    Returns
    -------
    list of dict
        For each soil its name, points, sizes (mm, ``None`` where they are finer than the finest sieve), Cu, Cc,
        fines and gravel (%), its class by ASTM D2487, and notes on what was assumed.

    Examples
    --------
    >>> import voidwalk as vw
    >>> (sand,) = vw.soil(([0.075, 0.25, 0.5, 2.0], [2, 20, 60, 100]))
    >>> round(sand["d15_mm"], 3), sand["fines_percent"], sand["class"]
    (0.179, 2.0, 'poorly graded sand: SP')
    """
    with workplace() as place:
        if isinstance(soil, Gradation) or not isinstance(soil, (str, os.PathLike)):
            soil = gradation("soil", soil)
        found: List[SoilSummary] = json.loads(_voidwalk.soils(place.table("soil", soil), d0_mm))
    return found
