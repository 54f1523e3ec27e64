"""A cache of the values that were used last."""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class RecentCache(Generic[T]):
    """The values that were used last, by keys that are compared. Threads may share it: one that
    asks while another makes a value makes one, too."""

    def __init__(self, most: int = 1) -> None:
        self._most = most
        self._kept: tuple[tuple[Any, T], ...] = ()

    def get(self, key: Any) -> T | None:
        """Return the value of a key, None where there is none; it was used last then."""
        kept = self._kept
        found = next((each for each in reversed(kept) if each[0] == key), None)
        if found is None:
            return None
        if found is not kept[-1]:
            self._kept = (*(each for each in kept if each is not found), found)
        return found[1]

    def put(self, key: Any, value: T) -> None:
        """Keep a value; drop those that were used longest ago where there are too many."""
        others = (each for each in self._kept if each[0] != key)
        self._kept = (*others, (key, value))[-self._most :]

    def made(self, key: Any, make: Callable[[], T]) -> T:
        """Return the value of a key; make it where there is none."""
        found = self.get(key)
        if found is None:
            first = max(len(self._kept) - self._most + 1, 0)
            self._kept = self._kept[first:]  # it may be large
            found = make()
            self.put(key, found)
        return found

    def clear(self) -> None:
        """Drop all values; work in progress keeps its own."""
        self._kept = ()
