"""The vehicle in glTF: a node a part, named and nested as ASAM OpenMATERIAL 3D has it."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..scene import Reference, Vehicle
from .colors import BODY, GLASS
from .glb import GlbScene, y_up

EXTERIOR, STATIC, DYNAMIC = "Grp_Exterior", "Grp_Exterior_Static", "Grp_Exterior_Dynamic"
REAR_AXLE = "Grp_Rear_Axle_Center"
GLASS_ALPHA = 0.45


def add_vehicle(
    scene: GlbScene,
    vehicle: Vehicle | None,
    reference: Reference | None,
    taken: Collection[str] = (),
) -> list[int]:
    """Add the vehicle's parts and rear axle, where they are known; return what holds them.

    A part whose name is `taken` is called so with more.
    """
    below = []
    if vehicle is not None:
        below.append(scene.add_node(STATIC, _parts(scene, vehicle, taken)))
    if reference is not None:
        place = np.array([reference.rear_axle_x, 0.0, reference.rear_axle_z])
        axle = scene.add_node(REAR_AXLE, translation=y_up(place).tolist())
        below.append(scene.add_node(DYNAMIC, [axle]))
    return [scene.add_node(EXTERIOR, below)] if below else []


def _parts(scene: GlbScene, vehicle: Vehicle, taken: Collection[str]) -> list[int]:
    looks = (scene.add_material("body", BODY), scene.add_material("glass", GLASS, GLASS_ALPHA))
    nodes = []
    for number, name in enumerate(vehicle.part_names):
        corners = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(corners):
            points, index = np.unique(corners, axis=0, return_inverse=True)
            look = looks[name in vehicle.glass]
            mesh = scene.add_mesh(name, points, index.reshape(-1, 3), look)
            nodes.append(scene.add_node(f"{name} (body)" if name in taken else name, mesh=mesh))
    return nodes
