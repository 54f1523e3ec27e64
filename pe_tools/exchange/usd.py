"""OpenUSD: a rig as the prims of NVIDIA's sensor schemas (OmniLidar, OmniRadar, OmniAcoustic) and
USD's Camera.

A Camera looks along -z, y is up. An Omni prim looks along x with z up, as in Isaac Sim; one whose y
axis is vertical instead is read as ovrtx has it: along -z, y up. Attributes of the schemas are in
degrees, metres and hertz, and of single precision; poses have double precision. What no schema has
(name, model, fusion group, ranges of a camera, the table of a radar) is in attributes of this
project, `OURS`.
"""

import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pe_core.base.arrays import Floats

from .frames import pose_of, product
from .portable import ForeignRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR, RADAR, ULTRASONIC
from .usd_models import MODEL_READERS, PHYSX_LIDAR, PrimValues, by_table
from .usd_schema import MARKET_NAME, OURS
from .usd_stage import PlacedPrim, UsdStage, numbers_of, read_stage, rotation_of, text_of, value_of
from .usd_text import PrimPath

KINDS = {"Camera": CAMERA, "OmniLidar": LIDAR, "OmniRadar": RADAR, "OmniAcoustic": ULTRASONIC}
OTHER_KINDS = {"IsaacImuSensor": "imu", "IsaacContactSensor": "contact"}
"""Types of prims that are sensors of kinds without a model here."""
LEGACY = (LIDAR, RADAR)
"""Kinds that Isaac Sim before 5 has as a Camera: the token of `cameraSensorType` is the kind."""
EDITOR = "OmniverseKit_"  # Beginning of the names of an editor's own cameras
GENERIC = re.compile("(camera|lidar|radar|acoustic|sensor|omni[a-z]*)(_\\d+)?", re.IGNORECASE)
"""Names of prims that do not tell one sensor from another."""
BODY_FROM_CAMERA = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""A camera's frame (x right, y up, looking along -z) in the sensor frame."""
VERTICAL = math.cos(math.radians(45.0))
AXES_NOTE = "its y axis is vertical: it is read as looking along -z, as ovrtx has it"


def read(path: Path) -> ForeignRig:
    """Read the sensors of a stage, from a layer (.usda, .usd; .usdc and .usdz by usd-core)."""
    stage = read_stage(path)
    sizes = _picture_sizes(stage)
    found = [each for each in stage.prims.values() if _kind(each) and not _is_editors(each)]
    lines = list(stage.lines)
    instancers = [p for p, each in stage.prims.items() if each.prim.type == "PointInstancer"]
    for instancer in instancers:
        below = [each for each in found if each.path.startswith(f"{instancer}/")]
        if below:
            found = [each for each in found if each not in below]
            lines.append(f"{instancer}: sensors that a PointInstancer places are left out")
    names = _names(found)
    sensors = []
    for each, name in zip(found, names, strict=True):
        sensor, more = _sensor(path, each, name, sizes.get(each.path))
        sensors.append(sensor)
        lines += more
    return ForeignRig(tuple(sensors), lines)


def _kind(placed: PlacedPrim) -> str:
    """Return the kind of a prim that is a sensor; empty for others."""
    kind = KINDS.get(placed.prim.type) or OTHER_KINDS.get(placed.prim.type, "")
    if placed.prim.type == PHYSX_LIDAR:
        return LIDAR
    if kind == CAMERA:
        token = value_of(placed.prim, "cameraSensorType")
        return token if token in LEGACY else kind
    return kind or text_of(placed, f"{OURS}kind")


def _is_editors(placed: PlacedPrim) -> bool:
    return placed.name.startswith(EDITOR)


def _names(found: Sequence[PlacedPrim]) -> list[str]:
    """Return a name for each sensor: ours, or the prim's own. Where several prims have the name,
    those above them that not all share are put in front; a name that tells no sensor from another
    is replaced by theirs, or by that of the prim above."""
    groups: dict[str, list[set[str]]] = {}
    for each in found:
        groups.setdefault(each.name, []).append(set(_above(each)))
    names = []
    for each in found:
        stated = text_of(each, f"{OURS}name")
        above = _above(each)
        group = groups[each.name]
        apart = [name for name in above if not all(name in others for others in group)]
        if not apart and len(group) == 1 and len(above) > 1 and GENERIC.fullmatch(each.name):
            apart = above[-1:]
        own = [] if apart and GENERIC.fullmatch(each.name) else [each.name]
        names.append(stated or "_".join([*apart, *own]))
    return names


def _above(placed: PlacedPrim) -> list[str]:
    """Return the names of the prims above a prim, the outermost first."""
    return placed.path.strip("/").split("/")[:-1]


def _picture_sizes(stage: UsdStage) -> dict[str, tuple[int, int]]:
    """Return the sizes [px] of pictures by the path of their camera, of all render products."""
    sizes: dict[str, tuple[int, int]] = {}
    for placed in stage.prims.values():
        if placed.prim.type != "RenderProduct":
            continue
        size = numbers_of("USD", placed, "resolution", 2)
        targets = value_of(placed.prim, CAMERA)  # the relationship has the kind's name
        for target in targets if isinstance(targets, list) else [targets]:
            if size is not None and isinstance(target, PrimPath):
                path = _absolute(placed.path, target.text)
                sizes.setdefault(path, (int(size[0]), int(size[1])))
    return sizes


def _absolute(base: str, path: str) -> str:
    """Return a path of a stage that may be relative to a prim."""
    if path.startswith("/"):
        return path
    parts = base.strip("/").split("/")
    for step in path.split("/"):
        if step == "..":
            parts = parts[:-1]
        else:
            parts.append(step)
    return "/" + "/".join(parts)


def _sensor(
    source: Path, placed: PlacedPrim, name: str, size: tuple[int, int] | None
) -> tuple[PortableSensor, list[str]]:
    """Return the sensor of a prim, and messages on it."""
    kind = _kind(placed)
    rotation = rotation_of(source, placed)
    note = ""
    if placed.prim.type == "Camera" and kind == CAMERA:
        rotation = product(rotation, BODY_FROM_CAMERA.T)
    elif placed.prim.type in KINDS and _is_y_up(rotation):
        rotation = product(rotation, BODY_FROM_CAMERA.T)
        note = AXES_NOTE
    pose = pose_of(rotation, placed.world[:3, 3].tolist())
    model = text_of(placed, f"{OURS}model") or text_of(placed, MARKET_NAME)
    model = model or text_of(placed, "sensorModelConfig")
    sensor = PortableSensor(
        name, pose, kind, model or None, fusion=text_of(placed, f"{OURS}fusion") or None, told=note
    )
    return MODEL_READERS.get(kind, by_table)(PrimValues(source, placed), sensor, size)


def _is_y_up(rotation: Floats) -> bool:
    """Whether an Omni prim has a camera's axes: its y axis is the vertical one, not its z axis."""
    up = rotation[2]
    return abs(float(up[1])) > VERTICAL and abs(float(up[1])) > abs(float(up[2]))
