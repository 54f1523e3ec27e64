"""Fingerprint of a scene: shows whether a stored result is still valid for the scene."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from bpy.types import Object, Scene

from ..engine import pe
from .conditions import conditions_signature
from .own_sensors import own_sensors_signature
from .prior import prior_signature
from .rig import last_written_pose, pose_of_matrix, sensor_objects, view_layer_of
from .study_table import signature_of, value_at

SensorState = tuple[object, ...]
"""Model, fusion group, pose and its own AP curve or None; empty for a hidden sensor."""


@dataclass(frozen=True)
class Fingerprint:
    """The states of a scene's sensors by name, and a text of everything else a score depends on."""

    sensors: dict[str, SensorState]
    rest: str

    @property
    def text(self) -> str:
        """The text that is stored with a result."""
        content = repr((sorted(self.sensors.items()), self.rest))
        return hashlib.sha256(content.encode()).hexdigest()

    @property
    def surroundings(self) -> str:
        """The text that is stored with a variant's score: everything but its sensors."""
        return hashlib.sha256(self.rest.encode()).hexdigest()

    def with_rig(self, rig: pe.Rig) -> "Fingerprint":
        """Return the fingerprint of the same scene with its sensors placed as in a rig."""
        placed = {s.name: _placed(self.sensors[s.name], s.pose) for s in rig}
        return replace(self, sensors={**self.sensors, **placed})


def fingerprint(
    scene: Scene, shape: str = "", sensors: Sequence[Object] | None = None
) -> Fingerprint:
    """Return the fingerprint of a scene. `shape` is a cache key of the vehicle's geometry;
    `sensors` are the scene's sensors by name, if the caller has already read them."""
    settings = scene.perception_entropy
    layer = view_layer_of(scene)
    objects = sensor_objects(scene) if sensors is None else sensors
    states = {obj.name: _sensor_state(obj, obj.visible_get(view_layer=layer)) for obj in objects}
    own = [*signature_of(settings), *own_sensors_signature(scene), *conditions_signature(settings)]
    rest = prior_signature(scene), shape, own
    return Fingerprint(states, repr(rest))


def _sensor_state(obj: Object, visible: bool) -> SensorState:
    if not visible:
        return ()
    own = obj.perception_entropy.table
    placement = np.array(obj.matrix_world, dtype=float)
    try:
        held = last_written_pose(obj.perception_entropy.placed, placement)
        where: object = _numbers(pose_of_matrix(placement) if held is None else held)
    except pe.InputError:  # a sensor that cannot be scored has a fingerprint, too
        where = placement.tolist()
    model, fusion, curve = (value_at(own, (key,)) for key in ("model", "fusion", "ap"))
    return model, fusion, where, curve


def _placed(state: SensorState, pose: pe.Pose) -> SensorState:
    return (*state[:2], _numbers(pose), *state[3:])


def _numbers(pose: pe.Pose) -> tuple[float, ...]:
    return (*pose.position, *pose.rotation_deg)
