"""Walks: of networks, of scenes, of campaigns."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Callable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _voidwalk
from ._arrays import threads_or_none, whole
from ._network import Network
from ._progress import Follower, Following
from ._result import CampaignResult, Result, WalkResult, read_run
from ._scene import Scene, Settings, Stated, as_json, native_scene
from ._soil import Gradation
from ._tables import Soil, gradation

__all__ = ["campaign", "replicate_seed", "resume", "run", "walk"]

def replicate_seed(seed: int, replicate: int) -> int:
    """Seed of the network and the walk of a replicate, counted from 1, of a scene with this seed.

    Examples
    --------
    >>> import voidwalk as vw
    >>> vw.replicate_seed(1, 1) != vw.replicate_seed(1, 2)
    True
    """
    return _voidwalk.replicate_seed(whole("seed", seed), whole("replicate", replicate, 1))


def walk(
    network: Union[Network, Callable[[int], Network]],
    base: Union[Soil, float],
    *,
    n_base: Optional[int] = None,
    filter: Optional[Soil] = None,
    grains_per_void: Optional[float] = None,
    mass_ratio: float = 0.05,
    as_given: bool = False,
    engine: str = "auto",
    sampling: str = "independent",
    seed: int = 1,
    runs: int = 2,
    replicates: int = 10,
    increments: int = 100,
    series_every: int = 1,
    size_curves: Sequence[int] = (),
    size_classes: int = 64,
    threads: Optional[int] = None,
    progress: Follower = None,
) -> WalkResult:
    """Walks base particles through a network, as a scene does through one that it names, to the same bits.

    Parameters
    ----------
    network : Network or callable
        The network of all replicates; or what makes the network of each from its seed, as the paper does.
    base : Gradation, path-like, pair of array_like, or float
        The base, as for :func:`judge`, or the one size (mm) of its particles.
    n_base : int, optional
        Base particles of a run. The class of erosion follows from their number: without it that of the paper's
        Eq. (2), for which `filter` and `grains_per_void` are given or known to the network.
    filter : Gradation, path-like, or pair of array_like, optional
        The filter, as for :func:`judge`, which rules of practice are asked about. Without it the network's own,
        where it knows it: of lattices with a shipped curve.
    grains_per_void : float, optional
        Filter grains per void, of Eq. (2). Without it the network's own, where it knows it: of lattices with a
        shipped or measured curve, and of packings.
    mass_ratio : float
        Mass of the base over that of the filter, of Eq. (2), see :meth:`Gradation.base_particles`.
    as_given : bool
        Walk a `filter` that is so much finer than the base that the two look exchanged.
    engine : {"auto", "particles", "counts", "expected"}
        How passive particles, which can block nothing, are walked; "expected" follows their expectation only.
    sampling : {"independent", "stratified"}
        Sampling of sizes and start nodes.
    seed : int
        The same seed gives the same bits, for any number of threads.
    runs : {1, 2}
        The second offers fresh base to what the first left blocked.
    replicates : int
        Walks with random numbers of their own.
    increments : int
        Equal parts in which the base is inserted.
    series_every : int
        The series has every such increment, and the last; 0 the last only.
    size_curves : sequence of int
        Increments whose size curves are recorded besides the last one's.
    size_classes : int
        Points of a size curve.
    threads : int, optional
        One per core without it.
    progress : callable, True or None
        Told of the walk some twenty times a second, a :class:`Progress`; an exception in it ends the walk and
        is raised. ``True`` shows a bar where tqdm is installed.

    Raises
    ------
    ValueError
        What is refused before any work: also a walk without a number of base particles, where it cannot be worked
        out.
    VoidwalkError
        Work that failed.
    KeyboardInterrupt
        After Ctrl-C, when the increment under way is done.

    Examples
    --------
    >>> import voidwalk as vw
    >>> base = vw.Gradation.linear(1.5, 0.2, percent=85)
    >>> result = vw.walk(vw.Network.cubic([10, 10, 20]), base, n_base=20_000, replicates=3)
    >>> result.verdict, len(result.summary), result.blocked.shape
    ('continuing erosion', 2, (3, 2, 6000))
    >>> result.outcome["n_base"], result.outcome["n_base_eq2"]
    (20000, 61979)

    A lattice with a shipped curve knows its filter, and so how many particles Eq. (2) asks for:

    >>> vw.walk(vw.Network.cubic([10, 10, 20]), base, replicates=3).outcome["n_base"]
    61979

    A new network for each replicate:

    >>> made = lambda seed: vw.Network.cubic([10, 10, 20], "cu1.5-loose", seed=seed)
    >>> vw.walk(made, base, n_base=20_000, replicates=3).verdict
    'continuing erosion'
    """
    if isinstance(base, (int, float, np.integer, np.floating)):
        soil = Gradation.single(float(base))
    else:
        soil = gradation("base", base)
    seed, count = whole("seed", seed), whole("replicates", replicates, 1)
    if count > 100_000:
        raise ValueError(f"replicates = {count} is not allowed; a whole number from 1 to 100000")
    networks: List[Network]
    if isinstance(network, Network):
        networks = [network]
    elif callable(network):
        networks = [network(replicate_seed(seed, replicate)) for replicate in range(1, count + 1)]
    else:
        raise ValueError(f"network = {type(network).__name__} is not allowed; a Network, or what makes one")
    # What is given goes before what the network knows; a line that was assumed is no sieve curve.
    of, is_measured = (gradation("filter", filter), True) if filter is not None else (networks[0].filter, False)
    grains = networks[0].grains_per_void if grains_per_void is None else float(grains_per_void)
    if n_base is None and (of is None or grains is None):
        missing = " and ".join(name for name, known in [("filter", of), ("grains_per_void", grains)] if known is None)
        raise ValueError(
            "n_base is missing: the class of erosion follows from how many base particles there are. Give n_base, or "
            f"{missing}, which this network does not know, for the number of the paper's Eq. (2)"
        )
    with Following(progress) as callback:
        said, tables, blocked = _voidwalk.walk(
            [network._native for network in networks], soil._native,
            None if n_base is None else whole("n_base", n_base, 1), whole("increments", increments, 1), engine,
            sampling, seed, whole("runs", runs, 1), count, whole("series_every", series_every),
            [whole("size_curves", increment, 1) for increment in size_curves], whole("size_classes", size_classes, 1),
            None if of is None else (of._native, is_measured), grains, float(mass_ratio), bool(as_given),
            threads_or_none(threads), callback,
        )
    return WalkResult(json.loads(said), tables, blocked)


def manner(
    call: str, memory: Optional[int], threads: Optional[int], checkpoint_every: Optional[str]
) -> Tuple[Optional[int], Optional[int], Optional[str], str]:
    """How a long call is done, checked; the manifest says that the work was started with this one."""
    return (
        None if memory is None else whole("memory", memory, 1), threads_or_none(threads), checkpoint_every,
        f"voidwalk.{call} of Python {sys.version_info.major}.{sys.version_info.minor}",
    )


def run(
    scene: Union[Scene, Stated] = None,
    out: Union[None, str, os.PathLike[str]] = None,
    threads: Optional[int] = None,
    *,
    settings: Optional[Settings] = None,
    overwrite: bool = False,
    packings: Union[str, os.PathLike[str]] = "voidwalk-packings",
    memory: Optional[int] = None,
    checkpoint_every: Optional[str] = None,
    progress: Follower = None,
) -> Result:
    """Walks a scene, as ``voidwalk run`` does, to the same bits.

    Parameters
    ----------
    scene : Scene, path-like, mapping or None
        As for :class:`Scene`: a scene, its file, or a dict with what that would say; the built-in scene without
        one.
    out : path-like, optional
        Folder for the results: all files that ``voidwalk run`` writes, the page too. A run that was stopped
        there goes on. Without it everything stays in memory.
    threads : int, optional
        One per core, or as a cluster's job has, without it; they change no bit.
    settings : mapping, optional
        Settings that change the scene, as ``{"base.cu": 3}``.
    overwrite : bool
        Whether the results of an earlier run in `out` are replaced.
    packings : path-like
        Folder in which packings of filters are kept.
    memory : int, optional
        Bytes that the walks may take.
    checkpoint_every : str, optional
        How often the walks are saved, as ``"30s"`` or ``"10min"``.
    progress : callable, True or None
        As for :func:`walk`.

    Returns
    -------
    Result
        With ``headline``, ``practice``, ``model``, ``summary`` and ``outcome``, and the columns of the CSV files.

    Raises
    ------
    ValueError
        What is refused before any work, in the words of the command line.
    VoidwalkError
        Work that failed.
    KeyboardInterrupt
        After Ctrl-C, when the increment under way is done: with `out` the progress is saved, and the same call
        goes on.

    Examples
    --------
    >>> import voidwalk as vw
    >>> small = {"network": {"nx": 8, "ny": 8, "nz": 12}, "record": {"sensitivity": []}, "replicates": 2}
    >>> filter, base = {"curve": "shire2016-cu1.5-loose"}, {"cu": 1.5, "d85_at_dc": 5}
    >>> vw.run({**small, "filter": filter, "base": base}).model["class"]
    'continuing erosion'
    """
    native = native_scene(scene, settings)
    how = manner("run", memory, threads, checkpoint_every)
    with Following(progress) as callback:
        if out is None:
            said, tables, texts = _voidwalk.run_in_memory(native, os.fspath(packings), how, callback)
            return Result(json.loads(said), tables, texts=texts)
        folder = _voidwalk.run(native, os.fspath(out), bool(overwrite), os.fspath(packings), how, callback)
    return read_run(Path(folder))


def resume(
    folder: Union[str, os.PathLike[str]],
    threads: Optional[int] = None,
    *,
    memory: Optional[int] = None,
    checkpoint_every: Optional[str] = None,
    progress: Follower = None,
) -> Result:
    """Continues a run that was stopped or killed, with the same bits, as ``voidwalk resume`` does.

    Parameters
    ----------
    folder : path-like
        Its folder.
    threads, memory, checkpoint_every, progress
        As for :func:`run`.
    """
    how = manner("resume", memory, threads, checkpoint_every)
    with Following(progress) as callback:
        _voidwalk.resume(os.fspath(folder), how, callback)
    return read_run(Path(folder))


def campaign(
    plan: Union[str, os.PathLike[str], Settings],
    out: Union[str, os.PathLike[str]] = "voidwalk-campaign",
    threads: Optional[int] = None,
    *,
    packings: Union[None, str, os.PathLike[str]] = None,
    memory: Optional[int] = None,
    checkpoint_every: Optional[str] = None,
    progress: Follower = None,
) -> CampaignResult:
    """Walks the cases of a plan, each once, as ``voidwalk campaign`` does.

    Parameters
    ----------
    plan : path-like or mapping
        The plan's file, or a dict with what it would say.
    out : path-like
        Folder for the campaign; cases that are done there are not walked again.
    threads, memory, checkpoint_every, progress
        As for :func:`run`; progress counts cases.
    packings : path-like, optional
        Folder in which packings of filters are kept; one in `out` without it.

    Raises
    ------
    ValueError
        What is refused before any work.
    VoidwalkError
        Cases that could not be walked; the others are done.
    """
    path, text = ("plan.toml", as_json(plan)) if isinstance(plan, Mapping) else (os.fspath(plan), None)
    how = manner("campaign", memory, threads, checkpoint_every)
    kept = None if packings is None else os.fspath(packings)
    with Following(progress) as callback:
        _voidwalk.campaign(path, text, os.fspath(out), kept, how, callback)
    return CampaignResult(Path(out))
