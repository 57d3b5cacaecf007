"""What the tests share: small networks, small scenes, and the program to compare with."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any, Dict, Tuple

import numpy as np
import pytest

import voidwalk as vw

ROOT = Path(__file__).resolve().parents[3]

#: A soil and a filter of sizes (mm) and percents finer, and a network that is walked in a moment.
BASE = ([0.06, 0.12, 0.2, 0.3], [0.0, 30.0, 70.0, 100.0])
FILTER = ([0.5, 1.0, 2.0], [0.0, 50.0, 100.0])
SMALL = {"network.nx": 8, "network.ny": 8, "network.nz": 12}
ACROSS = {"network.nx": 8, "network.ny": 8}


#: A scene that takes minutes, in increments of a fraction of a second.
LONG: Dict[str, Any] = {
    "seed": 11,
    "replicates": 500,
    "engine": "particles",
    "filter": {"curve": "shire2016-cu1.5-loose"},
    "base": {"cu": 3.0, "d85_at_dc": 5, "n_base": 2_000_000},
    "network": {"nx": 20, "ny": 20, "nz": 30},
    "record": {"sensitivity": []},
}


def table(folder: Path, name: str, soil: Tuple[Any, Any]) -> Path:
    """The sieve table of a soil as a file."""
    rows = "".join(f"{size},{percent}\n" for size, percent in zip(*soil))
    path = folder / f"{name}.csv"
    path.write_text("opening_mm,percent_finer\n" + rows)
    return path


@pytest.fixture
def small() -> Dict[str, Any]:
    """A scene that is walked in a moment."""
    return {
        "seed": 11,
        "replicates": 2,
        "filter": {"curve": "shire2016-cu1.5-loose"},
        "base": {"cu": 1.5, "d85_at_dc": 5},
        "network": {"nx": 10, "ny": 10, "nz": 16},
        "record": {"sensitivity": []},
    }


@pytest.fixture
def grid() -> "tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]":
    """Simple cubic: 4 x 4 x 4 touching grains of 1 mm, in a periodic cell of 4 mm."""
    axes = np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, 3), np.ones(64)


@pytest.fixture(scope="session")
def program() -> str:
    """The command line of the same checkout."""
    named = os.environ.get("VOIDWALK_PROGRAM", str(ROOT / "target" / "release" / "voidwalk"))
    found = shutil.which(named)
    if found is None:
        pytest.skip(f"{named} is not there: cargo build --release, or name it as VOIDWALK_PROGRAM")
    return found


def lattice(seed: int = 7) -> vw.Network:
    """The paper's lattice, small."""
    return vw.Network.cubic([6, 6, 9], "cu1.5-loose", seed=seed)
