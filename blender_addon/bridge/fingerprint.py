"""What a score depends on, in short: tells whether a stored result still is that of the scene."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..engine import pe
from .advanced import advanced_signature
from .own_sensors import own_sensors_signature
from .prior import prior_signature
from .rig import held_pose, pose_of_matrix, sensor_objects, view_layer_of
from .targets import targets_signature

Standing = tuple[object, ...]
"""Model, fusion group, placement, perhaps an AP curve of its own; none where it does not count."""


@dataclass(frozen=True)
class Fingerprint:
    """A scene's sensors by name, and in one text all else that a score depends on."""

    sensors: dict[str, Standing]
    rest: str

    @property
    def text(self) -> str:
        """What is stored with a result."""
        seen = repr((sorted(self.sensors.items()), self.rest))
        return hashlib.sha256(seen.encode()).hexdigest()

    @property
    def surroundings(self) -> str:
        """What is stored with a variant's score: all that it depends on besides its sensors."""
        return hashlib.sha256(self.rest.encode()).hexdigest()

    def with_rig(self, rig: pe.Rig) -> Fingerprint:
        """Return that of the same scene with its sensors placed as a rig has them."""
        placed = {s.name: _placed(self.sensors[s.name], s.pose) for s in rig}
        return replace(self, sensors={**self.sensors, **placed})


def fingerprint(
    scene: bpy.types.Scene,
    shape: str = "",
    sensors: Sequence[bpy.types.Object] | None = None,
) -> Fingerprint:
    """Return what tells a scene's study from others.

    `shape` stands for the vehicle as the engine knows it; `sensors` are the scene's, by name, when
    they have been looked for already.
    """
    settings, layer = scene.perception_entropy, view_layer_of(scene)
    objects = sensor_objects(scene) if sensors is None else sensors
    standing = {obj.name: _standing(obj, obj.visible_get(view_layer=layer)) for obj in objects}
    more = [*advanced_signature(settings), *own_sensors_signature(scene)]
    more += targets_signature(settings)
    rest = (prior_signature(scene), settings.score_samples, shape, *([more] if more else []))
    return Fingerprint(standing, repr(rest))


def signature(
    scene: bpy.types.Scene,
    shape: str = "",
    sensors: Sequence[bpy.types.Object] | None = None,
) -> str:
    """Return the fingerprint as a text."""
    return fingerprint(scene, shape, sensors).text


def _standing(obj: bpy.types.Object, visible: bool) -> Standing:
    if not visible:
        return ()
    own, placement = obj.perception_entropy, np.array(obj.matrix_world, dtype=float)
    try:
        held = held_pose(obj, placement)
        where: object = _numbers(pose_of_matrix(placement) if held is None else held)
    except pe.InputError:  # what cannot be scored has a fingerprint all the same
        where = placement.tolist()
    curve = (own.curve_a, own.curve_b) if own.own_curve else None
    return (own.model, own.fusion, where, *([curve] if curve else []))


def _placed(standing: Standing, pose: pe.Pose) -> Standing:
    return (*standing[:2], _numbers(pose), *standing[3:])


def _numbers(pose: pe.Pose) -> tuple[float, ...]:
    return (*pose.position, *pose.rotation_deg)
