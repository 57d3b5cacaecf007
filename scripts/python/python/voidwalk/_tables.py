"""Soils as files, arrays or gradations, made into the sieve tables that the library reads."""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _voidwalk
from ._scene import Setting, Settings, assignments
from ._soil import Gradation

#: A soil: its file (``"FILE#NAME"`` for one of several), a gradation, or sizes (mm) and percents finer by mass.
Soil = Union[Gradation, str, "os.PathLike[str]", Tuple[ArrayLike, ArrayLike]]

#: A name that stands for a soil is the name of a file, too.
_NOT_IN_NAMES = '/\\#:*?"<>|\0'


def gradation(name: str, soil: Soil) -> Gradation:
    """A soil as a gradation."""
    if isinstance(soil, Gradation):
        return soil
    if isinstance(soil, (str, os.PathLike)):
        return Gradation.from_file(soil)
    if isinstance(soil, (tuple, list)) and len(soil) == 2 and all(np.ndim(column) == 1 for column in soil):
        return Gradation(*soil)
    given = repr(soil) if isinstance(soil, (tuple, list)) and len(soil) < 4 else type(soil).__name__
    raise ValueError(
        f"{name} = {given} is not allowed; a file, a Gradation, or a pair of sizes (mm) and percents finer, as "
        "([0.1, 0.5], [0, 100])"
    )


def curves(name: str, soil: Soil) -> List[Tuple[str, _voidwalk.Gradation]]:
    """Every curve of a soil, by name: those of an envelope in a file, or the one."""
    if isinstance(soil, (str, os.PathLike)):
        return _voidwalk.Gradation.in_file(os.fspath(soil))
    return [(name, gradation(name, soil)._native)]


class Workplace:
    """A folder for the sieve tables, and for the results, of a call that names none."""

    def __init__(self, folder: str) -> None:
        self.folder = Path(folder)
        self._names: Dict[str, str] = {}

    def table(self, name: str, soil: Soil) -> str:
        """The file of a soil: its own, or one that is written here."""
        if isinstance(soil, (str, os.PathLike)):
            return os.fspath(soil)
        if not name or any(c in _NOT_IN_NAMES for c in name):
            raise ValueError(f"{name!r} is not allowed as the name of a soil: it names a file, too")
        sizes, percents = gradation(name, soil).points()
        if len(sizes) == 2 and sizes[0] == sizes[1]:
            raise ValueError(f"{name} has a single size; a sieve curve has two sizes or more")
        rows = "".join(f"{size!r},{percent!r}\n" for size, percent in zip(sizes.tolist(), percents.tolist()))
        # As a run keeps its inputs: the library then calls them by their names, not by their places here.
        inputs = self.folder / "inputs"
        inputs.mkdir(exist_ok=True)
        file = inputs / f"{name}.csv"
        file.write_text("opening_mm,percent_finer\n" + rows, encoding="utf-8")
        self._names[file.name] = name
        (inputs / "names.json").write_text(json.dumps(self._names), encoding="utf-8")
        return str(file)

    def named(self, record: str) -> str:
        """A record of the library in which soils have their names, not their places here."""
        for file, name in self._names.items():
            place = json.dumps(str(self.folder / "inputs" / file))[1:-1]
            record = record.replace(place, name)
        return record

    def out(self, out: Union[None, str, "os.PathLike[str]"]) -> str:
        """Where results go: where a user says, or here."""
        return str(self.folder / "results") if out is None else os.fspath(out)


@contextmanager
def workplace() -> Iterator[Workplace]:
    """A folder that is gone after the call, and that no error names."""
    with tempfile.TemporaryDirectory(prefix="voidwalk-") as folder:
        try:
            yield Workplace(folder)
        except (ValueError, _voidwalk.VoidwalkError) as error:
            said = str(error)
            if folder not in said:
                raise
            inputs = os.path.join(folder, "inputs") + os.sep
            raise type(error)(said.replace(inputs, "").replace(folder, "memory")) from None


def changes(settings: Optional[Settings], options: Mapping[str, Tuple[str, Optional[Setting]]]) -> List[str]:
    """Settings and arguments that stand for one, as the library takes them."""
    all_of_them: Dict[str, object] = dict(settings or {})
    for argument, (key, value) in options.items():
        if value is None:
            continue
        if all_of_them.get(key) is not None:
            raise ValueError(f"{argument} and settings[{key!r}] say the same thing twice: give one")
        all_of_them[key] = value
    return assignments(all_of_them)
