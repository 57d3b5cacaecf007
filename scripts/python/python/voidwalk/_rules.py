"""What filter practice says of two soils, without a walk."""

from __future__ import annotations

import json
from typing import Optional

from . import _voidwalk
from ._tables import Soil, curves
from .records import PairRules

__all__ = ["rules"]

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
