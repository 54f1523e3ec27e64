"""Where a new sensor is put and what it looks like in the scene, by kind."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from .. import bridge
from ..engine import catalog, kinds, pe
from ..properties import DEFAULT_MODEL

ROOF_DEPTH_M = 0.1
"""What lies this near to the vehicle's highest point is its roof."""


@dataclass(frozen=True, slots=True)
class Mount:
    """How sensors of one kind are added.

    `usual` is the model of the kind's button, None for the first of the catalogue. On a roof a
    sensor stands `above_roof_m` over it, at its front edge or over its middle; without a vehicle at
    `height_m`. `display` and `size_m` are its empty's.
    """

    usual: str | None
    above_roof_m: float
    at_front: bool
    height_m: float
    display: str
    size_m: float


MOUNTS = {
    "lidar": Mount(DEFAULT_MODEL, 0.3, False, 1.8, "SPHERE", 0.12),
    "camera": Mount("Camera 90 deg", 0.05, True, 1.5, "ARROWS", 0.25),
}
OTHER = Mount(None, 0.05, True, 1.5, "ARROWS", 0.25)
"""Of a kind that has no row."""


@dataclass(frozen=True, slots=True)
class Offer:
    """A kind of sensor to choose from: its name, what people call it, and its models."""

    kind: str
    label: str
    usual: str
    models: tuple[str, ...]


def offers() -> Iterator[Offer]:
    """Yield the engine's kinds that have a model in the catalogue."""
    for kind in kinds.KINDS.values():
        models = tuple(catalog.names(kind.name))
        if models:
            usual = mount_of(kind.name).usual
            yield Offer(kind.name, kind.label, usual or models[0], models)


def mount_of(kind: str) -> Mount:
    """Return how sensors of a kind are added."""
    return MOUNTS.get(kind, OTHER)


def sensible_place(context: bpy.types.Context, mount: Mount) -> Vector:
    """Return the 3D cursor, or while that is at the origin a place on the vehicle's roof."""
    cursor = context.scene.cursor.location
    collection = context.scene.perception_entropy.vehicle
    if cursor.length > 0.0:
        return cursor.copy()
    if collection is None:
        return Vector((0.0, 0.0, mount.height_m))
    vehicle = bridge.vehicle_from_collection(collection, context.evaluated_depsgraph_get())
    return Vector(on_roof(vehicle, mount))


def on_roof(vehicle: pe.Vehicle, mount: Mount) -> tuple[float, float, float]:
    """Return a place above the middle of the roof, or above its front edge."""
    corners = vehicle.triangles.reshape(-1, 3)
    top = corners[:, 2].max()
    roof = corners[corners[:, 2] > top - ROOF_DEPTH_M]
    low, high = roof.min(axis=0), roof.max(axis=0)
    middle = (low + high) / 2.0
    place = (high[0] if mount.at_front else middle[0], middle[1], top + mount.above_roof_m)
    x, y, z = np.round(place, 2).tolist()
    return x, y, z
