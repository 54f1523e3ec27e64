"""Reach of a study on objects: how far lone objects of a class are found, by eighths of the circle.

It is the reach that a score on objects tells (`targets.rings`), so that maps, views and tables of
one study tell the same metres.
"""

from __future__ import annotations

import math

import numpy as np

from ..scene.frozen import frozen
from ..scene.sensors import Rig
from ..scoring.object_score import FARTHEST_M
from ..targets.lone import LoneObjects
from ..targets.rings import SECTORS
from .reach import Reach

SECTOR_RAD = 2.0 * math.pi / len(SECTORS)


def object_reach(lone: LoneObjects, rig: Rig, class_name: str, least: float) -> Reach:
    """Return how far a class is found with at least so much AP, by the rig and by each sensor."""

    def metres(members: list[str] | None) -> np.ndarray:
        found = lone.reach(class_name, lone.ap(rig, members), least)
        return frozen(np.array([found[way] for way in SECTORS]))

    bearings = frozen(np.arange(len(SECTORS)) * SECTOR_RAD)
    alone = {s.name: metres([s.name]) for s in rig}
    limit = frozen(np.full(len(SECTORS), FARTHEST_M))
    return Reach(class_name, least, bearings, metres(None), alone, limit, sector=SECTOR_RAD)
