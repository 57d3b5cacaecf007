"""Finished folders, read back."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Union, cast

from ._grains import Packing, Reached
from ._result import CampaignResult, Result, read_csv, read_run
from ._specification import Specification, read_specification
from ._studies import Boundaries
from .columns import Walked

__all__ = ["read"]


def read(
    folder: Union[str, "os.PathLike[str]"],
) -> Union[Result, CampaignResult, Boundaries, Specification, Packing]:
    """What lies in a finished folder of a run, a campaign, a study of boundaries, a specification or a packing."""
    place = Path(folder)

    def record(name: str) -> str:
        return (place / name).read_text(encoding="utf-8")

    if (place / "outcome.json").is_file():
        return read_run(place)
    if (place / "cases.csv").is_file():
        return CampaignResult(place)
    if (place / "boundary.json").is_file():
        return Boundaries(json.loads(record("boundary.json")), cast(Walked, read_csv(place / "boundary.csv")), place)
    if (place / "specification.json").is_file():
        return read_specification(place, record("specification.json"), place)
    if (place / "packing.json").is_file():
        packing = Packing.from_file(place / "grains.csv")
        recorded = json.loads(record("packing.json"))
        packing.reached = cast(Reached, {**recorded.get("after", {}), "seed": recorded.get("seed")})
        return packing
    raise ValueError(
        f"{place}: holds no outcome.json, cases.csv, boundary.json, specification.json or packing.json; "
        "name a finished folder"
    )
