"""Ground that a rig sees: squares marked by its sensors, kept while these do not move."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..scene.sensors import Rig, Sensor
from .ground_kernel import Flags, GroundKernel, GroundView, VisibleGround
from .table import kind_of


class VisibleGroundCache:
    """Marks squares for the sensors of a rig; one that has not moved is not asked again.

    Parameters
    ----------
    view : GroundView
    known : dict
        What kernels know besides, by kind, for several of these on one vehicle.
    """

    def __init__(self, view: GroundView, known: dict[str, Any]) -> None:
        self.view, self._known = view, known
        self._kernels: dict[str, GroundKernel] = {}  # by kind
        self._seen: dict[str, VisibleGround] = {}  # by sensor name: those of the last rig

    def marked(self, rig: Rig, draft: bool = False) -> tuple[Flags, bool]:
        """Squares (NX, NY) that any sensor marks, and whether any of that is a draft."""
        self._seen = {s.name: self._one(s, draft) for s in rig}
        for kernel in self._kernels.values():
            kernel.forget_all_but(rig.sensors)
        marked = np.zeros(self.view.grid.shape, bool)
        for seen in self._seen.values():
            marked |= seen.marked
        return marked, any(seen.draft for seen in self._seen.values())

    def _one(self, sensor: Sensor, draft: bool) -> VisibleGround:
        last = self._seen.get(sensor.name)
        if last is not None and (draft or not last.draft):
            same = last.sensor.model is sensor.model and last.sensor.pose == sensor.pose
            if same:
                return last
        kind = kind_of(sensor)
        if kind.name not in self._kernels:
            kernel = self._kernels[kind.name] = kind.on_ground(self.view)
            kernel.share(self._known.setdefault(kind.name, kernel.known))
        return self._kernels[kind.name].see(sensor, draft)
