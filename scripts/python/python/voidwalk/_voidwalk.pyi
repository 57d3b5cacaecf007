"""What the classes of voidwalk call: the library, with arrays for columns and JSON for records."""

import os
from typing import Callable, Dict, List, Optional, Tuple, Union, final

import numpy as np
from numpy.typing import NDArray

from ._grains import Reached
from .columns import Table

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]
_Path = Union[str, os.PathLike[str]]
_Cell = Optional[Tuple[float, float, float]]
_Grains = Tuple[_Floats, _Floats, _Cell]
_Tables = Dict[str, Table]
#: Memory (bytes), threads, how often progress is saved, and what the manifest says.
_Manner = Tuple[Optional[int], Optional[int], Optional[str], str]
#: Density, pack, quick, as sampled, as given, and settings.
_TableOptions = Tuple[Optional[str], bool, bool, bool, bool, List[str]]
#: Densities, pack, thicknesses, and the range of D15F/D85B.
_Search = Tuple[List[str], bool, List[str]]
#: Manifest, scene, and the record of a packing.
_Texts = Tuple[str, str, Optional[str]]
_Callback = Optional[Callable[[Progress], object]]

__all__ = [
    "command",
    "measure",
    "pack",
    "read_packing",
    "Network",
    "note_sentences",
    "report",
    "run_brief",
    "run_page",
    "walk_brief",
    "walk_page",
    "VoidwalkError",
    "rules",
    "Scene",
    "campaign",
    "init_text",
    "resume",
    "run",
    "run_in_memory",
    "Curve",
    "Gradation",
    "boundary",
    "percolation",
    "schema",
    "soils",
    "specification",
    "specification_words",
    "replicate_seed",
    "walk",
    "Progress",
    "__version__",
]

__version__: str

class VoidwalkError(Exception): ...

@final
class Progress:
    @property
    def stage(self) -> str: ...
    @property
    def done(self) -> int: ...
    @property
    def total(self) -> int: ...
    @property
    def replicate(self) -> int: ...
    @property
    def run(self) -> int: ...
    @property
    def increment(self) -> int: ...
    @property
    def moving(self) -> int: ...
    @property
    def finished(self) -> bool: ...

@final
class Gradation:
    @staticmethod
    def linear(percent: float, size_mm: float, cu: float) -> Gradation: ...
    @staticmethod
    def single(size_mm: float) -> Gradation: ...
    @staticmethod
    def from_points(size_mm: _Floats, percent_finer: _Floats, d0_mm: Optional[float] = None) -> Gradation: ...
    @staticmethod
    def in_file(path: _Path, d0_mm: Optional[float] = None) -> List[Tuple[str, Gradation]]: ...
    def d(self, percent: float) -> Optional[float]: ...
    def d_by_number(self, percent: float) -> Optional[float]: ...
    def percent_finer(self, size_mm: float) -> float: ...
    @property
    def cu(self) -> Optional[float]: ...
    @property
    def pan_fraction(self) -> float: ...
    def points(self) -> Tuple[_Floats, _Floats]: ...
    def base_particles(self, filter: Gradation, mass_ratio: float, grains_per_void: float, voids: int) -> int: ...

@final
class Curve:
    @staticmethod
    def from_points(percent_smaller: _Floats, diameter_mm: _Floats) -> Curve: ...
    @staticmethod
    def shipped(name: str, d0_mm: float) -> Tuple[Curve, Gradation, float]: ...
    @staticmethod
    def from_file(path: _Path, d0_mm: float) -> Curve: ...
    def dc(self, percent: float) -> Optional[float]: ...
    def percent_smaller(self, diameter_mm: float) -> float: ...
    @property
    def cu(self) -> float: ...
    def points(self) -> Tuple[_Floats, _Floats]: ...

@final
class Network:
    @staticmethod
    def from_columns(
        pores: int,
        conns: _Ints,
        diameter: _Floats,
        conductance: Optional[_Floats],
        inlets: _Ints,
        outlets: _Ints,
        exit: str,
        rho: float,
        unit_mm: float,
    ) -> Network: ...
    @staticmethod
    def cubic(
        shape: Tuple[int, int, int],
        curve: Curve,
        unit_mm: float,
        seed: int,
        exit: str,
        rho: float,
        exponent: Optional[float],
    ) -> Network: ...
    @staticmethod
    def of_packing(
        grains: _Grains,
        merge_overlap: float,
        copies: int,
        exit: str,
        rho: float,
        unit_mm: Optional[float],
    ) -> Network: ...
    @staticmethod
    def from_csv(path: _Path, unit_mm: float) -> Network: ...
    def to_csv(self) -> bytes: ...
    @property
    def pores(self) -> int: ...
    @property
    def throats(self) -> int: ...
    @property
    def unit_mm(self) -> float: ...
    @property
    def exit(self) -> str: ...
    @property
    def layers(self) -> int: ...
    @property
    def fingerprint(self) -> str: ...
    def conns(self) -> _Ints: ...
    def diameter(self) -> _Floats: ...
    def conductance(self) -> _Floats: ...
    def inlets(self) -> _Ints: ...
    def outlets(self) -> _Ints: ...
    def layer(self) -> _Ints: ...
    def first_passage(self, diameter_mm: float) -> Tuple[float, float]: ...
    def flow(self) -> Tuple[_Floats, _Floats]: ...

def pack(
    gradation: Gradation,
    density: Union[str, float],
    grains: Optional[int],
    seed: int,
    threads: Optional[int],
    progress: _Callback,
) -> Tuple[_Grains, Reached]: ...
def read_packing(
    path: _Path, unit: Optional[str], cell: Optional[str]
) -> Tuple[_Grains, List[str]]: ...
def measure(
    grains: _Grains, merge_overlap: float, on_both_hulls: bool, threads: Optional[int]
) -> Tuple[Dict[str, Union[_Floats, _Ints]], str]: ...
def replicate_seed(seed: int, replicate: int) -> int: ...
def walk(
    networks: List[Network],
    base: Gradation,
    n_base: Optional[int],
    increments: int,
    engine: str,
    sampling: str,
    seed: int,
    runs: int,
    replicates: int,
    series_every: int,
    size_curves: List[int],
    size_classes: int,
    filter: Optional[Tuple[Gradation, bool]],
    grains_per_void: Optional[float],
    mass_ratio: float,
    as_given: bool,
    threads: Optional[int],
    progress: _Callback,
) -> Tuple[str, _Tables, NDArray[np.bool_]]: ...
def rules(
    bases: List[Tuple[str, Gradation]],
    filters: List[Tuple[str, Gradation]],
    dispersive: bool,
    joint_mm: Optional[float],
    as_given: bool,
) -> str: ...
def command(words: List[str], again: List[str]) -> int: ...
def init_text() -> str: ...
@final
class Scene:
    @staticmethod
    def built_in(settings: List[str]) -> Scene: ...
    @staticmethod
    def of_tables(base: _Path, filter: _Path, tables: _TableOptions) -> Scene: ...
    @staticmethod
    def from_file(path: _Path, settings: List[str]) -> Scene: ...
    @staticmethod
    def from_json(text: str, settings: List[str]) -> Scene: ...
    @staticmethod
    def from_toml(text: str, name: str, settings: List[str]) -> Scene: ...
    @property
    def name(self) -> str: ...
    def to_toml(self) -> str: ...
    def to_json(self) -> str: ...

def run(
    scene: Scene, out: _Path, overwrite: bool, packings: _Path, manner: _Manner, progress: _Callback
) -> os.PathLike[str]: ...
def run_in_memory(
    scene: Scene, packings: _Path, manner: _Manner, progress: _Callback
) -> Tuple[str, _Tables, _Texts]: ...
def resume(folder: _Path, manner: _Manner, progress: _Callback) -> None: ...
def campaign(
    path: _Path,
    json: Optional[str],
    out: _Path,
    packings: Optional[_Path],
    manner: _Manner,
    progress: _Callback,
) -> None: ...
def schema(name: str) -> str: ...
def soils(path: _Path, d0_mm: Optional[float]) -> str: ...
def boundary(
    base: Optional[_Path],
    filter: Optional[str],
    search: _Search,
    settings: List[str],
    as_sampled: bool,
    as_given: bool,
    out: _Path,
    overwrite: bool,
    packings: _Path,
    manner: _Manner,
    progress: _Callback,
) -> str: ...
def specification(
    base: _Path,
    dispersive: bool,
    finer: bool,
    sieves: str,
    out: _Path,
    overwrite: bool,
    progress: _Callback,
) -> str: ...
def specification_words(
    record: str,
) -> Tuple[Optional[str], Optional[str], Optional[str], Optional[str], List[Optional[bool]]]: ...
def note_sentences(notes: str, scale_free: bool = False) -> List[str]: ...
def percolation(
    shapes: List[Tuple[int, int, int]],
    realisations: int,
    seed: int,
    out: _Path,
    overwrite: bool,
    threads: Optional[int],
    progress: _Callback,
) -> str: ...
def report(folder: _Path) -> os.PathLike[str]: ...
def run_page(outcome: str, texts: _Texts, tables: _Tables) -> str: ...
def run_brief(outcome: str) -> str: ...
def walk_page(record: str, tables: _Tables) -> str: ...
def walk_brief(record: str) -> str: ...
