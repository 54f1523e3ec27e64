"""Fields of view as solids for CAD: what each sensor sees, what the body takes, what is blind."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ..exchange import Written
from ..graphics import sensor_color_on_paper
from ..kinds import kind_of
from .blind_volume import blind_volume
from .colors import BLIND, HIDDEN, Rgb
from .glb import GlbScene
from .glb_vehicle import add_vehicle
from .names import plain_names
from .request import NO_RANGE_M, OutputRequest
from .solid import Solid, free_solid, hidden_solid, whole_solid
from .stl import stl_bytes
from .views import mounted_view

FILE = "solids.glb"
STEP = math.radians(1.0)
"""Triangles are about so wide as seen from the sensor [rad]."""
FREE_ALPHA, HIDDEN_ALPHA, BLIND_ALPHA = 0.25, 0.5, 0.4
BLIND_NAME = "blind_volume"
ROOT = "Grp_Root"

Coloured = tuple[Solid, Rgb, float]


def write(wanted: OutputRequest) -> tuple[Written, list[str]]:
    """Return one glTF of all solids and an STL of each, and lines on what is not in them."""
    names, lines = plain_names([sensor.name for sensor in wanted.study.rig])
    files: dict[str, bytes] = {}
    shown: list[Coloured] = []
    for number, sensor in enumerate(wanted.study.rig):
        reach, plain = wanted.reach(sensor), names[sensor.name]
        view = mounted_view(sensor, wanted.study.vehicle, reach, STEP)
        if view is None:
            lines.append(f"{sensor.name}: no field of view of a {kind_of(sensor).label} is known")
            continue
        lines += _end(wanted, sensor.name, sensor.model)
        files[f"{plain}_field.stl"] = stl_bytes(whole_solid(f"{plain}_field", view))
        free, hidden = free_solid(f"{plain}_free", view), hidden_solid(f"{plain}_hidden", view)
        shown.append((free, sensor_color_on_paper(number), FREE_ALPHA))
        shown += [(hidden, HIDDEN, HIDDEN_ALPHA)] if hidden is not None else []
    near, more = _near(wanted)
    shown += [(near, BLIND, BLIND_ALPHA)] if near is not None else []
    files |= {f"{solid.name}.stl": stl_bytes(solid) for solid, _, _ in shown}
    return {FILE: _together(wanted, shown), **files}, lines + more


def _end(wanted: OutputRequest, name: str, model: object) -> list[str]:
    """Say where the solid of a sensor ends that sees as far as there is something to see."""
    endless = math.isinf(getattr(model, "max_range", math.inf))
    if wanted.range_m is not None or not endless:
        return []
    return [f"{name}: has no range of its own; its solids end at {NO_RANGE_M:g} m (--range)"]


def _near(wanted: OutputRequest) -> tuple[Solid | None, list[str]]:
    vehicle = wanted.study.vehicle
    if vehicle is None:
        return None, ["no vehicle: nothing is hidden, and there is no blind volume near it"]
    near = blind_volume(BLIND_NAME, wanted.study.rig, vehicle)
    return near, [] if near is not None else ["no blind volume: all of it is seen"]


def _together(wanted: OutputRequest, solids: Iterable[Coloured]) -> bytes:
    scene = GlbScene()
    nodes = add_vehicle(scene, wanted.study.vehicle, wanted.study.reference)
    for solid, color, alpha in solids:
        material = scene.add_material(solid.name, color, alpha)
        mesh = scene.add_mesh(solid.name, solid.points, solid.faces, material)
        nodes.append(scene.add_node(solid.name, mesh=mesh, extras={"volume_m3": solid.volume}))
    return scene.encoded(scene.add_node(ROOT, nodes))
