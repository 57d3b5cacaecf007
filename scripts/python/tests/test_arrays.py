"""What arrays are taken, and how those that are not are refused."""

from __future__ import annotations

from typing import Any, Callable, Dict

import numpy as np
import pytest

import voidwalk as vw

CONNS = np.array([[0, 1], [1, 2], [0, 2]])
DIAMETER = np.array([0.5, 0.25, 0.75])


def network(**changes: Any) -> vw.Network:
    given: Dict[str, Any] = {"conns": CONNS, "diameter": DIAMETER, "inlets": [0], "outlets": [2]}
    return vw.Network(**{**given, **changes})


def strided(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    wide = np.zeros((2 * len(array),) + array.shape[1:], dtype=array.dtype)
    wide[::2] = array
    return wide[::2]


def read_only(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    array = array.copy()
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "changes",
    [
        {"conns": CONNS.tolist(), "diameter": DIAMETER.tolist()},
        {"conns": CONNS.astype(np.int32), "diameter": DIAMETER.astype(np.float32)},
        {"conns": CONNS.astype(np.uint8), "diameter": DIAMETER.astype(">f8")},
        {"conns": CONNS.astype(np.uint64), "diameter": DIAMETER.astype(np.float16)},
        {"conns": np.asfortranarray(CONNS)},
        {"conns": strided(CONNS), "diameter": strided(DIAMETER)},
        {"conns": CONNS[::-1][::-1], "diameter": DIAMETER[::-1][::-1]},
        {"conns": read_only(CONNS), "diameter": read_only(DIAMETER)},
        {"inlets": np.array([True, False, False]), "outlets": [False, False, True]},
        {"inlets": 0, "outlets": np.int64(2)},
        {"conns": np.ma.array(CONNS), "diameter": np.ma.array(DIAMETER)},
    ],
)
def test_arrays_of_one_meaning_make_one_network(changes: Dict[str, Any]) -> None:
    made = network(**changes)
    assert made.fingerprint == network().fingerprint
    assert made.diameter.tolist() == DIAMETER.tolist() and made.conns.tolist() == CONNS.tolist()


def test_what_comes_in_is_not_copied_where_it_will_do_and_never_written() -> None:
    made = network()
    assert np.shares_memory(made.diameter, DIAMETER) and DIAMETER.flags.writeable
    with pytest.raises(ValueError):
        made.diameter[0] = 1.0


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"conns": CONNS[:2]}, r"diameter has shape \(3,\); \(2,\) is needed"),
        ({"conns": CONNS.ravel()}, r"conns has shape \(6,\); \(n, 2\) is needed"),
        ({"conns": np.zeros((3, 3), dtype=int)}, r"conns has shape \(3, 3\)"),
        ({"conns": CONNS + 0.5}, "conns has entries of type float64; every entry must be a whole number"),
        ({"conns": CONNS.astype(bool)}, "conns has entries of type bool"),
        ({"conns": CONNS.astype(object)}, "conns has entries of type object"),
        ({"conns": CONNS.astype(str)}, "conns has entries of type <U"),
        ({"conns": np.array([[0, 1], [1, 2], [0, 2**64 - 1]], dtype=np.uint64)}, "entries above"),
        ({"conns": [[0, 1], [1]]}, "conns is no array of one shape"),
        ({"conns": [[0, 1], [1, 2], [-1, -1]]}, "constriction 2 joins no void"),
        ({"conns": [[0, 1], [1, 2], [0, 9]], "count": 3}, "leads to void 9, but there are 3 voids"),
        ({"conns": np.empty((0, 2), dtype=int), "diameter": [], "count": 3}, "no constriction"),
        ({"diameter": [0.5, np.nan, 0.5]}, r"diameter\[1\] = nan is not allowed"),
        ({"diameter": [0.5, 0.5, np.inf]}, r"diameter\[2\] = inf is not allowed"),
        ({"diameter": [-0.5, 0.5, 0.5]}, "constriction 0 has diameter -0.5"),
        ({"diameter": DIAMETER.astype(complex)}, "type complex128; every entry must be a number"),
        ({"diameter": ["a", "b", "c"]}, "diameter has entries of type <U1"),
        ({"diameter": np.ma.array(DIAMETER, mask=[0, 1, 0])}, "diameter has masked entries"),
        ({"diameter": DIAMETER[:, None]}, r"diameter has shape \(3, 1\)"),
        ({"inlets": []}, "no inlet"),
        ({"outlets": []}, "no outlet"),
        ({"inlets": [0, 0]}, "void 0 is made an inlet twice"),
        ({"inlets": [-1]}, "inlets has pore -1"),
        ({"outlets": [3], "count": 3}, "outlets has pore 3, but there are 3 pores"),
        ({"inlets": [True, False], "count": 3}, r"inlets has shape \(2,\); \(3,\) is needed"),
        ({"conductance": [1.0, -1.0, 1.0]}, "constriction 1 has conductance -1"),
        ({"conductance": [1.0]}, r"conductance has shape \(1,\)"),
        ({"conductance": DIAMETER, "exit": "area"}, "conductance says nothing"),
        ({"rho": 1.0}, "rho = 1"),
        ({"rho": float("nan")}, "rho = NaN"),
        ({"exit": "depth"}, "exit = depth is not allowed; one of area, flux"),
        ({"exit": "height"}, "by height"),
        ({"reference_mm": 0.0}, "the unit of length is 0 mm"),
        ({"coords": np.zeros((2, 3)), "count": 3}, r"coords has shape \(2, 3\); \(3, 3\) is needed"),
    ],
)
def test_what_is_no_network_is_refused(changes: Dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        network(**changes)


@pytest.mark.parametrize("as_given", [np.asfortranarray, strided, read_only, lambda a: a.astype(">f8"), np.ndarray.tolist])
def test_grains_and_soils_take_arrays_as_they_come(
    as_given: Callable[[Any], Any], grid: "tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]"
) -> None:
    coords, diameter = grid
    plain, given = vw.Packing(coords, diameter, 4.0), vw.Packing(as_given(coords), as_given(diameter), 4.0)
    assert given.coords.tolist() == plain.coords.tolist() and given.diameter.tolist() == plain.diameter.tolist()
    assert vw.constrictions(given)["throat.diameter"].tolist() == vw.constrictions(plain)["throat.diameter"].tolist()
    sizes, percents = np.array([0.5, 1.0, 2.0]), np.array([0.0, 40.0, 100.0])
    assert vw.Gradation(as_given(sizes), as_given(percents)).d(15) == vw.Gradation(sizes, percents).d(15)
    narrow, wide = np.array([0.0, 50.0, 100.0]), np.array([0.1, 0.2, 0.3])
    assert vw.Curve(as_given(narrow), as_given(wide)).dc(35) == vw.Curve(narrow, wide).dc(35)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda x, d: vw.Packing(x[:, :2], d, 4.0), r"coords has shape \(64, 2\); \(n, 3\) is needed"),
        (lambda x, d: vw.Packing(x, d[1:], 4.0), r"diameter has shape \(63,\); \(64,\) is needed"),
        (lambda x, d: vw.Packing(x, -d, 4.0), r"diameter\[0\] = -1.0 is not allowed"),
        (lambda x, d: vw.Packing(x, 0 * d, 4.0), r"diameter\[0\] = 0.0 is not allowed"),
        (lambda x, d: vw.Packing(x * np.nan, d, 4.0), r"coords\[\(0, 0\)\] = nan is not allowed"),
        (lambda x, d: vw.Packing(x, d, [4.0, 4.0]), r"cell has shape \(2,\); \(3,\) is needed"),
        (lambda x, d: vw.Packing(x, d, [4.0, 4.0, 0.0]), "three lengths above 0"),
        (lambda x, d: vw.constrictions(x), "diameter is missing"),
        (lambda x, d: vw.constrictions(vw.Packing(x, d, 4.0), d), "those of the packing"),
        (lambda x, d: vw.constrictions(x[:3], d[:3], 4.0), "a triangulation needs at least 4"),
        (lambda x, d: vw.constrictions(x, d, 1.5), "at least twice the largest grain"),
        (lambda x, d: vw.constrictions(x, d, 4.0, merge_overlap=-1.0), "merge_overlap = -1"),
        (lambda x, d: vw.constrictions(x, d, 4.0, facets="some"), "facets = some is not allowed"),
        (lambda x, d: vw.constrictions(x, d, 4.0, threads=0), "threads = 0 is not allowed"),
        (lambda x, d: vw.Gradation([1.0, 2.0], [0.0]), "size_mm has 2 entries, but percent_finer has 1"),
        (lambda x, d: vw.Gradation([1.0, 2.0], [50.0, 20.0]), "percent"),
        (lambda x, d: vw.Gradation.linear(0.5), "cu"),
        (lambda x, d: vw.Gradation.single(-1.0), "d_mm"),
        (lambda x, d: vw.Curve([0, 50], [0.1, 0.2]), "100"),
        (lambda x, d: vw.Curve.shipped("no such"), "no such"),
        (lambda x, d: vw.Network.cubic([0, 3, 3]), "every length must be at least 1"),
        (lambda x, d: vw.Network.cubic([3, 3]), r"shape has shape \(2,\)"),
        (lambda x, d: vw.Network.from_packing(vw.Packing(x, d)), "no periodic cell"),
        (lambda x, d: vw.Network.from_packing(vw.Packing(x, d, 4.0), exit="area"), "area alone leads nowhere"),
        (lambda x, d: vw.pack(vw.Gradation.linear(1.5), "tight"), "density = tight is not allowed; dense, medium"),
        (lambda x, d: vw.pack(vw.Gradation.linear(1.5), grains=3), "at least 2.2 times|cell|grains"),
        (lambda x, d: vw.pack(vw.Gradation.linear(1.5), "medium", grains=3), "at least 2.2 times|cell|grains"),
        (lambda x, d: vw.Packing.from_file("no such file"), "no such file"),
        (lambda x, d: vw.read("no such folder"), "name a finished folder"),
    ],
)
def test_what_cannot_be_is_refused(
    make: Callable[[Any, Any], object], words: str, grid: "tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]"
) -> None:
    with pytest.raises(ValueError, match=words):
        make(*grid)
