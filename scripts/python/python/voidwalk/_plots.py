"""Figures by matplotlib, which is imported when one is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Dict, List, Optional, Sequence, Tuple, Union, cast

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, Ints
from .columns import Counts, Layers, Series, Sizes, Walked
from .records import Boundaries, Outcome, Specification, WalkOutcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes  # type: ignore[import-not-found,unused-ignore]
else:
    Axes = "matplotlib.axes.Axes"

#: What a result draws.
FIGURES = ("progress", "layers", "curves", "rules")

_PERCENT_BY_MASS = "Percent finer by mass"
_SIZE = "Size (mm)"


def axes(ax: Optional[Axes], width: float = 6.4) -> Axes:
    """The axes that a figure is drawn in: those given, or new ones."""
    if ax is not None:
        return ax
    try:
        pyplot = import_module("matplotlib.pyplot")
    except ImportError:
        raise ImportError("plot draws by matplotlib: install matplotlib") from None
    _, new = pyplot.subplots(figsize=(width, 4.0), layout="constrained")
    made: Axes = new
    return made


def _semi_log(ax: Axes, x: str, y: str, has_legend: bool = True) -> Axes:
    """Sizes along a logarithmic x, percents from 0 to 100 along y."""
    ax.set(xscale="log", ylim=(0, 100), xlabel=x, ylabel=y)
    ax.grid(True, which="both", alpha=0.25)
    if has_legend:
        ax.legend()
    return ax


def plot_gradation(sizes: Floats, percents: Floats, label: Optional[str], ax: Optional[Axes]) -> Axes:
    """Percent finer by mass against size."""
    drawn = axes(ax)
    drawn.plot(sizes, percents, marker=".", label=label)
    return _semi_log(drawn, _SIZE, _PERCENT_BY_MASS, label is not None)


def plot_curve(percents: Floats, sizes: Floats, label: Optional[str], ax: Optional[Axes]) -> Axes:
    """Percent smaller by number against the diameter of constrictions."""
    drawn = axes(ax)
    drawn.plot(sizes, percents, label=label)
    return _semi_log(drawn, "Constriction diameter (mm)", "Percent smaller by number", label is not None)


def plot_network(diameter: Floats, layer: Ints, blocked: Optional[NDArray[np.bool_]], ax: Optional[Axes]) -> Axes:
    """The sizes of constrictions; or, of those that are blocked, the share by layer."""
    if blocked is None:
        sizes = np.sort(diameter[diameter > 0])
        return plot_curve(100 * np.arange(1, len(sizes) + 1) / max(len(sizes), 1), sizes, None, ax)
    if blocked.shape != diameter.shape:
        raise ValueError(f"blocked has shape {blocked.shape}; {diameter.shape} is needed, a bool by constriction")
    layers = np.unique(layer[layer >= 0])
    share = [100 * float(blocked[layer == one].mean()) for one in layers]
    drawn = axes(ax)
    drawn.step(layers, share, where="mid")
    drawn.set(xlabel="Layer, along the flow", ylabel="Blocked constrictions (%)", ylim=(0, None))
    return drawn


def plot_result(outcome: Outcome, tables: Tuple[Series, Layers, Sizes, Sizes], what: str, ax: Optional[Axes]) -> Axes:
    """One of the figures of a result, whose tables are its series, layers, retained and eroded sizes."""
    series, layers, retained, eroded = tables
    if what == "progress":
        return _progress(series, outcome["threshold"], ax)
    if what == "layers":
        return _layers(layers, ax)
    if what == "curves":
        return _curves(outcome, retained, eroded, ax)
    if what == "rules":
        return _rules(outcome, ax)
    raise ValueError(f"what = {what!r} is not allowed; one of {', '.join(FIGURES)}")


def _by_run(ax: Axes, table: Union[Series, Layers], along: Counts, value: Floats) -> None:
    """Mean and range over the replicates of each run. A replicate that has come to rest keeps what it had."""
    for run in np.unique(table["run"]):
        of_run = table["run"] == run
        places = np.unique(along[of_run])
        rows = []
        for replicate in np.unique(table["replicate"][of_run]):
            own = of_run & (table["replicate"] == replicate)
            last = np.searchsorted(along[own], places, side="right") - 1
            rows.append(np.where(last < 0, 0.0, value[own][np.maximum(last, 0)]))
        by_replicate = np.array(rows)
        (line,) = ax.plot(places, by_replicate.mean(axis=0), label=f"Run {run}, mean and range of replicates")
        ax.fill_between(places, by_replicate.min(axis=0), by_replicate.max(axis=0), alpha=0.2, color=line.get_color())


def _progress(series: Series, threshold: float, ax: Optional[Axes]) -> Axes:
    drawn = axes(ax)
    _by_run(drawn, series, series["increment"], 100 * series["eroded_mass_fraction"])
    drawn.axhline(100 * threshold, color="black", linestyle="--", linewidth=1, label="Erosion begins")
    drawn.set(xlabel="Increment", ylabel="Eroded mass (% of the mass inserted)", ylim=(0, None))
    drawn.legend()
    return drawn


def _layers(layers: Layers, ax: Optional[Axes]) -> Axes:
    drawn = axes(ax)
    _by_run(drawn, layers, layers["layer"], 100 * layers["blocked"] / np.maximum(layers["constrictions"], 1))
    drawn.set(xlabel="Layer, along the flow", ylabel="Blocked constrictions (%)", ylim=(0, None))
    drawn.legend()
    return drawn


def _curves(outcome: Outcome, retained: Sizes, eroded: Sizes, ax: Optional[Axes]) -> Axes:
    drawn = axes(ax)
    inputs = outcome.get("inputs")
    lines: Dict[str, Sequence[Sequence[float]]] = {}
    if inputs is None:
        lines["Base, as walked"] = cast(WalkOutcome, outcome)["base"]["gradation"]
    else:
        lines["Base, as walked"] = inputs["base"]["gradation"]
        lines["Filter"] = inputs["filter"]["gradation"]
        lines["Constrictions, by number"] = inputs["filter"]["constrictions"]
    for label, points in lines.items():
        drawn.plot([point[0] for point in points], [point[1] for point in points], label=label)
    for table, label in ((retained, "Retained, run 1"), (eroded, "Eroded, run 1")):
        chosen = (table["run"] == 1) & (table["replicate"] == 1) if len(table.get("run", ())) else np.zeros(0, bool)
        if chosen.any():
            chosen &= table["increment"] == table["increment"][chosen].max()
            sizes, percents = table["diameter_mm"][chosen], table["percent_finer_by_mass"][chosen]
            drawn.plot(sizes, percents, linestyle="--", label=label)
    return _semi_log(drawn, _SIZE, f"{_PERCENT_BY_MASS} (constrictions: smaller by number)")


def _rules(outcome: Outcome, ax: Optional[Axes]) -> Axes:
    rules = outcome.get("rules")
    if rules is None:
        raise ValueError("a walk on a network has no rules of practice in its outcome: voidwalk.rules gives them")
    ratios: List[float] = []
    names: List[str] = []
    colours: List[str] = []
    for rule in rules:
        value, limit = rule["value"], rule["limit"]
        if value and limit:
            ratios.append(limit / value if rule["at_least"] else value / limit)
            names.append(rule["name"])
            # A boundary of continuing erosion that is not reached is no limit that is kept.
            met = None if rule["met"] and rule["role"] == "continuation" else rule["met"]
            colours.append({True: "tab:green", False: "tab:red", None: "tab:gray"}[met])
    drawn = axes(ax, 8.0)
    places = list(range(len(names)))
    drawn.scatter(ratios, places, c=colours)
    drawn.axvline(1, color="black", linewidth=1)
    drawn.set(xscale="log", xlabel="Value over limit (for a least value, limit over value); kept up to 1")
    drawn.set_yticks(places, names)
    drawn.invert_yaxis()
    drawn.grid(True, axis="x", which="both", alpha=0.25)
    return drawn


def plot_specification(outcome: Specification, ax: Optional[Axes]) -> Axes:
    """The curves of the base, as sampled and regraded, and both sides of the band."""
    drawn = axes(ax)
    several = len(outcome["curves"]) > 1
    for number, curve in enumerate(outcome["curves"]):
        name, colour = curve["curve"] if several else "Base", f"C{number % 10}"
        regraded = curve.get("regraded")
        label, style = (f"{name}, as sampled", "--") if regraded else (name, "-")
        drawn.plot(*zip(*curve["gradation"]), style, color=colour, label=label)
        if regraded:
            drawn.plot(*zip(*regraded), color=colour, label=f"{name}, regraded")
    band = outcome["band"]
    if band is not None:
        drawn.plot(*zip(*band["fine_side"]), color="black", label="Filter, fine side")
        drawn.plot(*zip(*band["coarse_side"]), "-.", color="black", label="Filter, coarse side")
        drawn.fill(*zip(*band["fine_side"], *band["coarse_side"][::-1]), color="black", alpha=0.1)
    return _semi_log(drawn, _SIZE, _PERCENT_BY_MASS)


def plot_boundaries(outcome: Boundaries, walks: Walked, ax: Optional[Axes]) -> Axes:
    """Eroded mass of the first run against D15F/D85B, and the boundaries of no and of continuing erosion."""
    drawn = axes(ax)
    for row in outcome["boundaries"]:
        chosen = (walks["density"] == row["density"]) & (walks["thickness"] == row["thickness"])
        points = drawn.scatter(
            walks["d15f_over_d85b"][chosen], 100 * walks["eroded_first"][chosen], s=12,
            label=f"{row['density']}, {row['thickness']}",
        )
        colour = points.get_facecolor()[0]
        for boundary, style in ((row["no_erosion"], "-"), (row["continuing"], ":")):
            if boundary is not None:
                drawn.axvline(boundary["median"], color=colour, linestyle=style, linewidth=1)
    drawn.axhline(100 * outcome["threshold"], color="black", linestyle="--", linewidth=1, label="Erosion begins")
    drawn.plot([], [], color="gray", label="No erosion up to, median")
    drawn.plot([], [], color="gray", linestyle=":", label="Continuing erosion from, median")
    drawn.set(xscale="log", xlabel="D15F/D85B", ylabel="Eroded mass of the first run (%)", ylim=(0, None))
    drawn.legend()
    return drawn
