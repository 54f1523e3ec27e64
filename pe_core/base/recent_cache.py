"""A cache of the values that were used last."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class RecentCache(Generic[T]):
    """The values that were used last, by keys that are compared; threads may share it.

    A thread that asks while another makes a value waits.
    """

    def __init__(self, most: int = 1) -> None:
        self._most = most
        self._kept: list[tuple[Any, T]] = []
        self._lock = RLock()

    def get(self, key: Any) -> T | None:
        """Return the value of a key, None where there is none; it was used last then."""
        with self._lock:
            for number in reversed(range(len(self._kept))):  # what was used last is asked for most
                if self._kept[number][0] == key:
                    self._kept.append(self._kept.pop(number))
                    return self._kept[-1][1]
        return None

    def put(self, key: Any, value: T) -> None:
        """Keep a value; drop those that were used longest ago where there are too many."""
        with self._lock:
            self._kept = [*(each for each in self._kept if each[0] != key), (key, value)]
            self._kept = self._kept[-self._most :]

    def made(self, key: Any, make: Callable[[], T]) -> T:
        """Return the value of a key; make it where there is none."""
        with self._lock:
            found = self.get(key)
            if found is None:
                self._kept = self._kept[len(self._kept) - self._most + 1 :]  # it may be large
                found = make()
                self.put(key, found)
            return found

    def clear(self) -> None:
        """Drop all values; work in progress keeps its own, and is not waited for."""
        self._kept = []
