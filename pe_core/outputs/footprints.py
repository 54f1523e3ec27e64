"""Footprints: what each sensor sees of the ground, the vehicle from above, what nobody sees.

A footprint is what `free_solid` fills at z = 0: within the field of view and the range, and not
behind the vehicle's body as seen from the sensor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..graphics import sensor_color_on_paper
from ..kinds import kind_of
from ..scene import PerceptionSpace, Pose, Sensor, Vehicle
from ..sight.outline import outlines
from .colors import Rgb
from .names import plain_names
from .request import OutputRequest
from .slicing import level_outlines
from .solid import Floats, free_solid
from .views import mounted_view

STEP = math.radians(0.5)
REACH_M = 30.0
"""How far footprints go unless told: a sheet of A1 at 1:100 holds them."""
CELL_M = 0.02
"""The vehicle's outline is followed on squares of this side."""
AT_ONCE_M = 100.0
"""A longer vehicle is followed on larger squares."""

ClosedLines = tuple[Floats, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SeenGround:
    """What a sensor sees of the ground: closed `outlines`, it on their left; and what to call it.

    `plain` is the name in plain letters, `model` what people call the model.
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

    footprints: tuple[SeenGround, ...]
    vehicle: ClosedLines
    blind: ClosedLines


def ground_plan(wanted: OutputRequest) -> tuple[GroundPlan, list[str]]:
    """Return a study's plan from above, and lines on what is not in it."""
    study = wanted.study
    names, _ = plain_names([sensor.name for sensor in study.rig])
    found: list[SeenGround] = []
    lines: list[str] = []
    for number, sensor in enumerate(study.rig):
        one = _footprint(wanted, sensor, names[sensor.name], sensor_color_on_paper(number))
        if not one.outlines:
            lines.append(f"{sensor.name}: sees no ground within {one.reach:g} m")
        found.append(one)
    if study.vehicle is None:
        lines.append("no vehicle: nothing is hidden, and there is no blind ground round it")
        return GroundPlan(tuple(found), (), ()), lines
    blind, more = _blind(wanted)
    return GroundPlan(tuple(found), outline_from_above(study.vehicle), blind), lines + more


def _footprint(wanted: OutputRequest, sensor: Sensor, plain: str, color: Rgb) -> SeenGround:
    reach = wanted.reach(sensor, REACH_M)
    view = mounted_view(sensor, wanted.study.vehicle, reach, STEP)
    seen = () if view is None else level_outlines(free_solid(plain, view), 0.0)
    model = f"{sensor.model.name}, {kind_of(sensor).label}"
    return SeenGround(sensor.name, plain, model, color, sensor.pose, reach, seen)


def _blind(wanted: OutputRequest) -> tuple[ClosedLines, list[str]]:
    """Return outlines of the blind ground near the vehicle; or why there are none to tell."""
    try:
        return wanted.study.sight().blind(wanted.study.rig, 0.0).outlines, []
    except InputError as error:
        return (), [f"no blind ground: {error}"]


def outline_from_above(vehicle: Vehicle) -> ClosedLines:
    """Return closed outlines (N, 2) of a vehicle as it is seen from above [m]."""
    low, high = (corner[:2] for corner in vehicle.bounds)
    cell = CELL_M * max(1.0, float((high - low).max()) / AT_ONCE_M)
    first, last = np.floor(low / cell) - 1, np.ceil(high / cell) + 1
    x, y = ((a * cell, b * cell) for a, b in zip(first.tolist(), last.tolist(), strict=True))
    space = PerceptionSpace(x, y, (0.0, cell), cell)
    filled = np.isfinite(vehicle.top(space))
    return outlines(filled.astype(float), 0.5, space.centers(0), space.centers(1))
