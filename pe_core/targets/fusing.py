"""Equations 4 to 8 on objects: with the curve of each object's class, group by group."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..kinds import PerceptionModel
from ..metric.entropy import H_BLIND
from ..metric.fusion import Fusion, early_fusion
from ..scene.objects import Objects
from ..scene.sensors import Rig

Floats = NDArray[np.float64]


class FusedObjects:
    """Fuses measurements of objects under one perception model; what weighs nothing is left out."""

    def __init__(self, objects: Objects, weights: Floats, model: PerceptionModel) -> None:
        self._model, self._fusion, self._count = model, Fusion(model), len(objects)
        self._rows = {
            name: rows
            for c, name in enumerate(objects.class_names)
            if len(rows := np.flatnonzero((objects.labels == c) & (weights > 0.0)))
        }

    def check(self, rig: Rig) -> None:
        """Complain of sensors with a curve of their own, and of classes without one."""
        for sensor in rig:
            if sensor.curve is not None:
                expected = f"none: objects have curves by class, [ap.{sensor.kind}.objects.CLASS]"
                raise InputError(f"sensor {sensor.name!r}", "ap", expected, "a curve of voxels")
            for name in self._rows:
                self._model.object_curve(sensor.kind, name)

    def entropies(
        self, rig: Rig, m: Mapping[str, Floats], members: Collection[str] | None = None
    ) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy (N,) of each object [nats], and whether any group sees it.

        Of some sensors of the rig alone, if they are named.
        """
        entropies, seen = np.full(self._count, H_BLIND), np.zeros(self._count, bool)
        groups = _summed(rig, m, members)
        if not groups:
            return entropies, seen
        for name, rows in self._rows.items():
            own = [(self._model.object_curve(kind, name), total[rows]) for kind, total in groups]
            entropies[rows], seen[rows] = self._fusion.entropies(own)
        return entropies, seen


def _summed(
    rig: Rig, m: Mapping[str, Floats], members: Collection[str] | None
) -> list[tuple[str, Floats]]:
    """Kind and sum (N,) of each fusion group, eq. 6."""
    groups = []
    for sensors in rig.groups.values():
        present = [m[s.name] for s in sensors if members is None or s.name in members]
        if present:
            groups.append((sensors[0].kind, early_fusion(present)))
    return groups
