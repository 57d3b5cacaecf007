"""How pip builds the package: by maturin. In a checkout the types of records and settings are made first; a source distribution has
them."""

from __future__ import annotations

from typing import Any, Callable

import maturin
import records
from maturin import get_requires_for_build_editable, get_requires_for_build_sdist, get_requires_for_build_wheel
from maturin import prepare_metadata_for_build_wheel

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_wheel",
]


def with_types(build: Callable[..., str]) -> Callable[..., str]:
    """The same, after the types are made."""

    def built(*given: Any, **named: Any) -> str:
        if not (records.ROOT / "PKG-INFO").exists():
            records.write()
        return build(*given, **named)

    return built


build_editable = with_types(maturin.build_editable)
build_sdist = with_types(maturin.build_sdist)
build_wheel = with_types(maturin.build_wheel)
