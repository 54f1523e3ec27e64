"""What holds rigs to requirements, shared by the 3D view, Check Requirements and scores.

It keeps what sensors measured, so whoever asks second measures nothing.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

from .engine import pe, requirements

MAX_KEPT = 2


class CheckerCache:
    """The checkers that were used last; threads may share it."""

    def __init__(self) -> None:
        self._kept: list[tuple[tuple[Any, ...], requirements.RequirementChecker]] = []
        self._lock = threading.Lock()

    def checker(
        self,
        wanted: Sequence[requirements.Requirement],
        vehicle: pe.Vehicle | None,
        model: pe.PerceptionModel | None,
        reference: pe.Reference | None,
        space: pe.PerceptionSpace | None,
    ) -> requirements.RequirementChecker:
        """Return what holds rigs to some requirements as drawn, round a vehicle."""
        key = tuple(wanted), vehicle, model, reference, space
        with self._lock:
            for each in self._kept:
                if each[0] == key:
                    self._kept.remove(each)
                    self._kept.append(each)
                    return each[1]
            made = requirements.RequirementChecker(
                wanted, vehicle, model=model, reference=reference, space=space
            )
            self._kept = [*self._kept, (key, made)][-MAX_KEPT:]
            return made

    def of_study(self, study: pe.Study) -> requirements.RequirementChecker:
        """Return what holds rigs to the requirements of a study."""
        return self.checker(
            study.requirements, study.vehicle, study.model, study.reference, study.space
        )

    def clear(self) -> None:
        """Drop everything."""
        with self._lock:
            self._kept = []


shared = CheckerCache()
