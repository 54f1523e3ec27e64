"""Lone objects: how far each class is found by a rig, where nothing but the vehicle hides it."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from ..kinds import ObjectsByName, PerceptionModel
from ..metric.entropy import ap_of_entropy
from ..scene.sensors import Rig
from ..scene.vehicle import Vehicle
from .drawing import DrawnObjects
from .fusing import FusedObjects
from .rings import FOUND_AP, SECTORS, reach, ring_objects

Floats = NDArray[np.float64]


class LoneObjects:
    """Objects of every class of a study, alone in rings round the vehicle.

    A sensor that has not moved is not measured again.

    Parameters
    ----------
    drawn : DrawnObjects
        Their classes have the mean sizes of these.
    vehicle : Vehicle or None
    model : PerceptionModel
        AP curves by class and kind, and the fusion rule.
    """

    def __init__(
        self, drawn: DrawnObjects, vehicle: Vehicle | None, model: PerceptionModel
    ) -> None:
        self._rings = ring_objects(drawn, vehicle)
        counted = drawn.weights_by_class[self._rings.objects.labels]
        self._fused = FusedObjects(self._rings.objects, counted, model)
        self._sensors = ObjectsByName(self._rings.objects, vehicle, False)
        self.class_names = tuple(drawn.objects.class_names)

    def ap(self, rig: Rig, members: Collection[str] | None = None) -> Floats:
        """AP (N,) of each object, of the whole rig or of some of its sensors.

        Raises
        ------
        InputError
            When a sensor has a curve of its own, or a class has none.
        """
        self._fused.check(rig)
        entropies, _ = self._fused.entropies(rig, self._sensors.measure(rig), members)
        return ap_of_entropy(entropies)

    def reach(self, class_name: str, ap: Floats, least: float = FOUND_AP) -> Mapping[str, float]:
        """How far a class is found with at least so much AP, by direction [m]; `ap` as above.

        0 in every direction for a class that no object is of.
        """
        if class_name not in self.class_names:
            return dict.fromkeys(SECTORS, 0.0)
        return reach(self._rings, self.class_names.index(class_name), ap, least)
