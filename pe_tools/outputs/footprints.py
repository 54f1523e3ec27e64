"""Ground plan: the footprint of each sensor, the vehicle's outline, and the blind ground.

A footprint is the cross-section of `free_solid` at z = 0: the ground within the field of view and
the range that the vehicle's body does not occlude.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.scene import PerceptionSpace, Pose, Sensor, Vehicle
from pe_core.scoring.sight.ground_cells import outlines
from pe_core.sensors import kind_of

from ..graphics import Rgb, sensor_colors_on_paper
from .blind_volume import level_outlines
from .request import OutputRequest, plain_names
from .solid import free_solid, mounted_view

STEP = math.radians(0.5)
REACH_M = 30.0
"""Default maximum range of footprints [m]: they fit on a sheet of A1 at 1:100."""
CELL_M = 0.02
"""Side of the grid cells from which the vehicle's outline is traced [m]."""
AT_ONCE_M = 100.0
"""For a vehicle longer than this [m], grid cells are larger."""

ClosedLines = tuple[Floats, ...]


@dataclass(frozen=True, slots=True, eq=False)
class GroundFootprint:
    """Footprint of a sensor: closed `outlines` (N, 2) [m] with the visible ground on the left.

    `plain` is the name for files and layers, `model` the label of the model, `reach` the maximum
    range of the drawing [m].
    """

    name: str
    plain: str
    model: str
    color: Rgb
    pose: Pose
    reach: float
    outlines: ClosedLines


@dataclass(frozen=True, slots=True, eq=False)
class GroundPlan:
    """A rig from above, ground frame [m]: `vehicle` and `blind` are closed outlines."""

    footprints: tuple[GroundFootprint, ...]
    vehicle: ClosedLines
    blind: ClosedLines


def ground_plan(request: OutputRequest) -> tuple[GroundPlan, list[str]]:
    """Return a study's ground plan, and messages on what it lacks."""
    study = request.study
    names, _ = plain_names([sensor.name for sensor in study.rig])
    footprints: list[GroundFootprint] = []
    lines: list[str] = []
    colors = sensor_colors_on_paper(study.rig)
    for sensor in study.rig:
        footprint = _footprint(request, sensor, names[sensor.name], colors[sensor.name])
        if not footprint.outlines:
            lines.append(f"{sensor.name}: sees no ground within {footprint.reach:g} m")
        footprints.append(footprint)
    if study.vehicle is None:
        lines.append("no vehicle: nothing is occluded, and there is no blind ground round it")
        return GroundPlan(tuple(footprints), (), ()), lines
    blind: ClosedLines = ()
    try:
        blind = study.sight().blind(study.rig, 0.0).outlines
    except InputError as error:
        lines.append(f"no blind ground: {error}")
    return GroundPlan(tuple(footprints), outline_from_above(study.vehicle), blind), lines


def _footprint(request: OutputRequest, sensor: Sensor, plain: str, color: Rgb) -> GroundFootprint:
    reach = request.reach(sensor, REACH_M)
    view = mounted_view(sensor, request.study.vehicle, reach, STEP)
    loops = () if view is None else level_outlines(free_solid(plain, view), 0.0)
    model = f"{sensor.model.name}, {kind_of(sensor).label}"
    return GroundFootprint(sensor.name, plain, model, color, sensor.pose, reach, loops)


def outline_from_above(vehicle: Vehicle) -> ClosedLines:
    """Return closed outlines (N, 2) of a vehicle as it is seen from above [m]."""
    low, high = (corner[:2] for corner in vehicle.bounds)
    cell = CELL_M * max(1.0, float((high - low).max()) / AT_ONCE_M)
    first, last = np.floor(low / cell) - 1, np.ceil(high / cell) + 1
    x, y = ((a * cell, b * cell) for a, b in zip(first.tolist(), last.tolist(), strict=True))
    space = PerceptionSpace(x, y, (0.0, cell), cell)
    filled = np.isfinite(vehicle.top(space))
    return outlines(filled.astype(float), 0.5, space.centers(0), space.centers(1))
