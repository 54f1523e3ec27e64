"""Arrays: their types, by what they hold (shapes stand in docstrings), and read-only values.

A value that was checked cannot change afterwards."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Singles = NDArray[np.float32]


def join_columns(parts: Iterable[Iterable[NDArray[Any]]]) -> tuple[NDArray[Any], ...]:
    """Return the columns of a table, whose parts have one array of rows for each column."""
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


class ReadOnlyDict(dict[str, Any]):
    """A read-only deep copy of a mapping, which can be pickled (`MappingProxyType` cannot)."""

    def __init__(self, values: Mapping[str, Any] = {}) -> None:
        super().__init__({key: read_only_data(value) for key, value in values.items()})

    def _refused(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("this mapping is read-only; make another one")

    __setitem__ = __delitem__ = __ior__ = _refused  # type: ignore[assignment]
    clear = pop = popitem = setdefault = update = _refused  # type: ignore[assignment]

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[object, ...]:
        return ReadOnlyDict, (dict(self),)


def read_only_data(value: Any) -> Any:
    """Return plain data with its mappings read-only and its lists as tuples."""
    if isinstance(value, Mapping):
        return ReadOnlyDict(value)
    return tuple(map(read_only_data, value)) if isinstance(value, (list, tuple)) else value


def read_only_copy(values: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """Return a read-only copy of an array; an array that owns read-only data is returned itself."""
    array = np.asarray(values, dtype=dtype)
    if array.flags.writeable or not array.flags.owndata or not array.flags.c_contiguous:
        array = np.array(array, order="C")
    return read_only(array)


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array read-only, in place, and return it."""
    array.flags.writeable = False
    return array


def mapped(function: Callable[[float], float], values: Floats) -> Floats:
    """Return what a function of Python gives for each value (N,): unlike those of NumPy it has the
    same bits in all builds."""
    return np.array([*map(function, values.tolist())], dtype=np.float64)
