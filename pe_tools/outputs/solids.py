"""Fields of view as closed solids, written as STL and for glTF."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from pe_core.sensors import kind_of

from ..exchange import Written
from ..graphics import Rgb, sensor_colors_on_paper
from .blind_volume import blind_volume
from .glb import GlbScene, add_vehicle
from .request import BLIND, HIDDEN, NO_RANGE_M, OutputRequest, plain_names
from .solid import Solid, free_solid, hidden_solid, mounted_view, whole_solid

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 80


def stl_bytes(solid: Solid) -> bytes:
    """Return a solid as a file; its normals point outwards."""
    corners = solid.points.astype(np.float32)[solid.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(float)
    length = np.sqrt((normal**2).sum(axis=1, keepdims=True))
    facets = np.zeros(len(corners), FACET)
    facets["corners"] = corners
    facets["normal"] = normal / np.where(length > 0.0, length, 1.0)
    # The name last: "solid" is how an ASCII file begins.
    header = f"metres, x forward, y left, z up: {solid.name}".encode("ascii", "replace")
    count = len(facets).to_bytes(4, "little")
    return header[:HEADER_BYTES].ljust(HEADER_BYTES) + count + facets.tobytes()


FILE = "solids.glb"
STEP = math.radians(1.0)
"""Approximate angular size of the triangles, seen from the sensor [rad]."""
FREE_ALPHA, HIDDEN_ALPHA, BLIND_ALPHA = 0.25, 0.5, 0.4
BLIND_NAME = "blind_volume"
ROOT = "Grp_Root"

Coloured = tuple[Solid, Rgb, float]


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return one glTF of all solids and an STL of each, and lines on what is not in them."""
    names, lines = plain_names([sensor.name for sensor in request.study.rig])
    files: dict[str, bytes] = {}
    shown: list[Coloured] = []
    colors = sensor_colors_on_paper(request.study.rig)
    for sensor in request.study.rig:
        reach, plain = request.reach(sensor), names[sensor.name]
        view = mounted_view(sensor, request.study.vehicle, reach, STEP)
        if view is None:
            lines.append(f"{sensor.name}: no field of view of a {kind_of(sensor).label} is known")
            continue
        if request.range_m is None and math.isinf(getattr(sensor.model, "max_range", math.inf)):
            ends = f"its solids end at {NO_RANGE_M:g} m (--range)"
            lines.append(f"{sensor.name}: has no range of its own; {ends}")
        files[f"{plain}_field.stl"] = stl_bytes(whole_solid(f"{plain}_field", view))
        free, hidden = free_solid(f"{plain}_free", view), hidden_solid(f"{plain}_hidden", view)
        shown.append((free, colors[sensor.name], FREE_ALPHA))
        shown += [(hidden, HIDDEN, HIDDEN_ALPHA)] if hidden is not None else []
    vehicle = request.study.vehicle
    if vehicle is None:
        lines.append("no vehicle: nothing is occluded, and there is no blind volume near it")
    elif (blind := blind_volume(BLIND_NAME, request.study.rig, vehicle)) is None:
        lines.append("no blind volume: all of it is seen")
    else:
        shown.append((blind, BLIND, BLIND_ALPHA))
    files |= {f"{solid.name}.stl": stl_bytes(solid) for solid, _, _ in shown}
    return {FILE: _together(request, shown), **files}, lines


def _together(request: OutputRequest, solids: Iterable[Coloured]) -> bytes:
    scene = GlbScene()
    nodes = add_vehicle(scene, request.study.vehicle, request.study.reference)
    for solid, color, alpha in solids:
        material = scene.add_material(solid.name, color, alpha)
        mesh = scene.add_mesh(solid.name, solid.points, solid.faces, material)
        nodes.append(scene.add_node(solid.name, mesh=mesh, extras={"volume_m3": solid.volume}))
    return scene.encoded(scene.add_node(ROOT, nodes))
