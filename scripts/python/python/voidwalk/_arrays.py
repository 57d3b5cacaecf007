"""Columns as they come in: turned into what the library takes, or refused in words."""

from __future__ import annotations

from typing import Optional, Tuple, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: The kind of an array's entries.
Scalar = TypeVar("Scalar", bound=np.generic)


def _array(name: str, value: object, kinds: str, wanted: str) -> NDArray[np.generic]:
    if isinstance(value, np.ma.MaskedArray) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name} has masked entries; every entry must be {wanted}")
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no array of one shape: {error}") from None
    if array.dtype.kind not in kinds and array.size > 0:
        raise ValueError(f"{name} has entries of type {array.dtype}; every entry must be {wanted}")
    return array


def _shaped(name: str, array: NDArray[Scalar], shape: Tuple[Optional[int], ...]) -> NDArray[Scalar]:
    if array.size == 0 and shape[0] is None and array.ndim == 1:
        array = array.reshape((0,) + tuple(n or 0 for n in shape[1:]))
    fits = array.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, array.shape))
    if not fits:
        letters = ", ".join("n" if n is None else str(n) for n in shape)
        wanted = f"({letters},)" if len(shape) == 1 else f"({letters})"
        raise ValueError(f"{name} has shape {array.shape}; {wanted} is needed")
    return array


def floats(name: str, value: object, *shape: Optional[int], finite: bool = True) -> Floats:
    """Numbers of this shape (``None`` is any length), in one piece of memory: the caller's own where it will do."""
    array = _shaped(name, _array(name, value, "fiu", "a number"), shape)
    column = np.ascontiguousarray(array, dtype=np.float64)
    if finite and not np.isfinite(column).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(column))[0])
        where = at[0] if len(at) == 1 else at
        raise ValueError(f"{name}[{where}] = {column[at]} is not allowed; a finite number is needed")
    return column


def ints(name: str, value: object, *shape: Optional[int]) -> Ints:
    """Whole numbers of this shape, in one piece of memory: the caller's own where it will do."""
    array = _shaped(name, _array(name, value, "iu", "a whole number"), shape)
    if array.dtype.kind == "u" and array.size and int(array.max()) > np.iinfo(np.int64).max:
        raise ValueError(f"{name} has entries above {np.iinfo(np.int64).max}")
    return np.ascontiguousarray(array, dtype=np.int64)


def pores(name: str, value: object, count: int) -> Ints:
    """Numbers of pores, given as such or as a mask of all of them."""
    array = np.asarray(value)
    if array.dtype.kind == "b":
        return np.flatnonzero(_shaped(name, array, (count,))).astype(np.int64)
    numbers = ints(name, np.atleast_1d(array), None)
    if numbers.size and (int(numbers.min()) < 0 or int(numbers.max()) >= count):
        wrong = int(numbers[(numbers < 0) | (numbers >= count)][0])
        raise ValueError(f"{name} has pore {wrong}, but there are {count} pores, counted from 0")
    return numbers


def cell_lengths(cell: Optional[ArrayLike]) -> Optional[Tuple[float, float, float]]:
    """Lengths of a periodic cell (mm), or ``None`` where there is none."""
    if cell is None:
        return None
    array = floats("cell", np.broadcast_to(cell, (3,)) if np.ndim(cell) == 0 else cell, 3)
    if (array <= 0).any():
        raise ValueError(f"cell = {array.tolist()} is not allowed; three lengths above 0 are needed")
    return float(array[0]), float(array[1]), float(array[2])


def cell_as_in_files(cell: Union[str, ArrayLike, None]) -> Optional[str]:
    """A cell as a file of grains states it: text as it is, lengths as ``"Lx, Ly, Lz"``."""
    if cell is None or isinstance(cell, str):
        return cell
    return ", ".join(repr(length) for length in cell_lengths(cell) or ())


def frozen(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """A view of an array that nothing is written through."""
    view = array.view()
    view.flags.writeable = False
    return view


def whole(name: str, value: object, least: int = 0) -> int:
    """A whole number that a 64-bit count can hold."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise ValueError(f"{name} = {value!r} is not allowed; a whole number from {least} is needed")
    if not least <= int(value) < 2**64:
        raise ValueError(f"{name} = {value} is not allowed; a whole number from {least} to {2**64 - 1}")
    return int(value)


def threads_or_none(threads: Optional[int]) -> Optional[int]:
    """A number of threads, or ``None`` for one per core."""
    if threads is None:
        return None
    number = whole("threads", threads, 1)
    if number > 4096:
        raise ValueError(f"threads = {number} is not allowed; a whole number from 1 to 4096")
    return number
