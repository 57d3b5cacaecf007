"""How pip builds the package: by maturin. In a checkout the types of records and settings and the licence texts of the crates are made
first; a source distribution has them."""

from __future__ import annotations

import subprocess
import sys
from typing import Any, Callable

import maturin
import records
from maturin import get_requires_for_build_editable, get_requires_for_build_sdist, get_requires_for_build_wheel

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_wheel",
]


def with_licences(build: Callable[..., str]) -> Callable[..., str]:
    """The same, after the licence texts are made, which metadata name."""

    def built(*given: Any, **named: Any) -> str:
        if not (records.ROOT / "PKG-INFO").exists():
            program, file = records.ROOT / "scripts/install/third_party.py", records.ROOT / "scripts/python/third-party.txt"
            subprocess.run([sys.executable, program, file], check=True)
        return build(*given, **named)

    return built


def with_types(build: Callable[..., str]) -> Callable[..., str]:
    """The same, after the types are made, too."""

    def built(*given: Any, **named: Any) -> str:
        if not (records.ROOT / "PKG-INFO").exists():
            records.write()
        return with_licences(build)(*given, **named)

    return built


prepare_metadata_for_build_wheel = with_licences(maturin.prepare_metadata_for_build_wheel)
build_editable = with_types(maturin.build_editable)
build_sdist = with_types(maturin.build_sdist)
build_wheel = with_types(maturin.build_wheel)
