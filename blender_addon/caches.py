"""Caches that threads share: what holds rigs to requirements, and vehicles of fewer triangles.

Requirements are checked by the 3D view, Check Requirements and scores. A checker keeps what sensors
measured, so whoever asks second measures nothing.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

from .engine import graphics, pe, requirements

T = TypeVar("T")


class RecentCache(Generic[T]):
    """The values that were used last, by keys that are compared; threads may share it.

    A thread that asks while another makes a value waits.
    """

    def __init__(self, most: int = 1) -> None:
        self._most = most
        self._kept: list[tuple[Any, T]] = []
        self._lock = threading.RLock()

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


MAX_TRIANGLES = 50_000
"""A vehicle of more is simplified for drawing: a picture shows no more detail."""
_checkers: RecentCache[requirements.RequirementChecker] = RecentCache(2)
_simplified: RecentCache[tuple[pe.Vehicle, pe.Vehicle]] = RecentCache()


def checker(
    wanted: Sequence[requirements.Requirement],
    vehicle: pe.Vehicle | None,
    model: pe.PerceptionModel | None,
    reference: pe.Reference | None,
    space: pe.PerceptionSpace | None,
) -> requirements.RequirementChecker:
    """Return what holds rigs to some requirements as drawn, round a vehicle."""
    return _checkers.made(
        (tuple(wanted), vehicle, model, reference, space),
        lambda: requirements.RequirementChecker(
            wanted, vehicle, model=model, reference=reference, space=space
        ),
    )


def checker_of_study(study: pe.Study) -> requirements.RequirementChecker:
    """Return what holds rigs to the requirements of a study."""
    return checker(study.requirements, study.vehicle, study.model, study.reference, study.space)


def simplified(vehicle: pe.Vehicle) -> pe.Vehicle:
    """Return a vehicle of at most `MAX_TRIANGLES`; the same one where it has no more.

    Simplifying takes seconds for millions of triangles. Objects are compared: pass the same one for
    the same vehicle.
    """
    if len(vehicle.triangles) <= MAX_TRIANGLES:
        return vehicle
    return _simplified.made(
        id(vehicle), lambda: (vehicle, graphics.simplified(vehicle, MAX_TRIANGLES, quick=True)[0])
    )[1]


def clear() -> None:
    """Drop everything: another file is opened."""
    _checkers.clear()
    _simplified.clear()
