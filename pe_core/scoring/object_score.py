"""What a score on objects tells besides: in the terms of detectors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

FARTHEST_M = 80.0
"""How far away lone objects are looked for: a reach that equals it is "at least"."""
POINTS = (1, 5, 20)
"""Objects are counted that get at least so many points of all LiDARs together."""


@dataclass(frozen=True, slots=True)
class FoundClass:
    """How well a rig finds a class of objects.

    Attributes
    ----------
    objects : int
        How many were looked at.
    share : float
        Weight of the class in the score, 0 to 1.
    entropy, stderr : float
        Mean entropy of its objects [nats], and the standard error.
    ap, ap_stderr : float
        Expected AP, 0 to 1: the mean over its objects, and the standard error.
    points : mapping of int to float
        Share of its objects that get at least so many points, by number; empty without LiDARs.
    reach : mapping of str to float
        By direction, the distance up to which a lone object of the class is found with an AP of 0.5
        [m]: 0 where it is not, `FARTHEST_M` where it is found as far as was looked.
    """

    objects: int
    share: float
    entropy: float
    stderr: float
    ap: float
    ap_stderr: float
    points: Mapping[int, float]
    reach: Mapping[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {**asdict(self), "points": {str(n): s for n, s in self.points.items()}}


@dataclass(frozen=True, slots=True)
class ObjectScore:
    """Score of a rig on objects, beside entropy and coverage.

    Attributes
    ----------
    ap, ap_stderr : float
        Expected AP of all classes, by their weights, and its standard error.
    objects, scenes : int
        How many there are; labelled boxes that do not hide each other stand in a scene each.
    traffic : bool
        Whether the objects of a scene hide each other. Reach is that of a lone object all the same.
    per_class : dict of FoundClass
    """

    ap: float
    ap_stderr: float
    objects: int
    scenes: int
    traffic: bool
    per_class: dict[str, FoundClass]

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> ObjectScore:
        """Return what `to_dict` has written down."""
        found = {name: _found(own) for name, own in data["per_class"].items()}
        return cls(**{**data, "per_class": found})

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        found = {name: own.to_dict() for name, own in self.per_class.items()}
        return {**asdict(self), "per_class": found}


def _found(data: Mapping[str, Any]) -> FoundClass:
    points = {int(number): share for number, share in data["points"].items()}
    return FoundClass(**{**data, "points": points})
