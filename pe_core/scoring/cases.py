"""Several rigs judged together: what they share is measured once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..errors import InputError
from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor
from .score import rounded


class Cases:
    """Rigs whose sensors are alike but for their poses, or that lack some of them.

    Parameters
    ----------
    rigs : sequence of Rig
        A sensor of the same name and pose in several of them is one sensor.

    Attributes
    ----------
    parts : tuple of Rig
        The rigs, with numbers for names: one for each sensor at each of its poses.
    all : Rig
        Every sensor of the parts once. From one call to the next, numbers stand for the same ones
        as long as the rigs come in the same order.

    Raises
    ------
    InputError
        When there is no rig.
    """

    def __init__(self, rigs: Sequence[Rig]) -> None:
        if not rigs:
            raise InputError("evaluator", "rigs", "at least one rig", "none")
        self._known: dict[tuple[str, Pose], Sensor] = {}
        self._counts: dict[str, int] = {}
        self.parts = tuple(Rig([self._numbered(sensor) for sensor in rig]) for rig in rigs)
        self.all = Rig(list(self._known.values()))

    def _numbered(self, sensor: Sensor) -> Sensor:
        """Return a sensor of a pose under a name of its own, in the fusion group that it is in."""
        key = sensor.name, sensor.pose
        if key not in self._known:
            pose = self._counts.get(sensor.name, 0)
            self._counts[sensor.name] = pose + 1
            number = list(self._counts).index(sensor.name)
            self._known[key] = replace(sensor, name=f"{number}.{pose}", fusion=sensor.group)
        return self._known[key]


def together(entropies: Sequence[float], worst: bool) -> float:
    """Return what several rigs are worth: the mean of their entropies, or the highest [nats]."""
    return max(entropies) if worst else rounded(float(np.mean(entropies)))
