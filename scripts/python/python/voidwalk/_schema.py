"""The JSON Schemas of the files that the program writes."""

from __future__ import annotations

import json
from typing import Dict

from . import _voidwalk

__all__ = ["schema"]


def schema(name: str) -> Dict[str, object]:
    """The JSON Schema of a file, as ``voidwalk init --schema NAME`` prints it.

    Parameters
    ----------
    name : str
        The name of its form without number, as ``"outcome"`` for ``outcome.json``.

    Returns
    -------
    dict

    Examples
    --------
    >>> import voidwalk as vw
    >>> vw.schema("outcome")["title"]
    'outcome.json'
    """
    found: Dict[str, object] = json.loads(_voidwalk.schema(name))
    return found
