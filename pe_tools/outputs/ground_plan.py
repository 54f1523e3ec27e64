"""The ground plan of a rig, and its footprints as GeoJSON.

A footprint is the cross-section of `free_solid` at z = 0: the ground within the field of view and
the range that the vehicle's body does not occlude.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats, Ints
from pe_core.base.errors import InputError
from pe_core.scene import PerceptionSpace, Pose, Vehicle
from pe_core.scoring.sight.ground_cells import chained, outlines
from pe_core.sensors import kind_of

from ..exchange import Written
from ..graphics import Rgb, sensor_colors_on_paper
from .request import OutputRequest, plain_names
from .solid import Solid, free_solid, mounted_view

STEP = math.radians(0.5)
REACH_M = 30.0
"""Default maximum range of footprints [m]: they fit on a sheet of A1 at 1:100."""
CELL_M = 0.02
"""Side of the grid cells from which the vehicle's outline is traced [m]."""
AT_ONCE_M = 100.0
"""For a vehicle longer than this [m], grid cells are larger."""
ClosedLines = tuple[Floats, ...]
FILE = "footprints.geojson"
DECIMALS = 3  # Of coordinates [m]
COORDINATES = "metres on the ground: x forward, y left of the vehicle's centre; no longitudes"


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
        plain = names[sensor.name]
        color = colors[sensor.name]
        reach = request.reach(sensor, REACH_M)
        view = mounted_view(sensor, request.study.vehicle, reach, STEP)
        loops = () if view is None else level_outlines(free_solid(plain, view), 0.0)
        model = f"{sensor.model.name}, {kind_of(sensor).label}"
        footprint = GroundFootprint(
            name=sensor.name,
            plain=plain,
            model=model,
            color=color,
            pose=sensor.pose,
            reach=reach,
            outlines=loops,
        )
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


def level_outlines(solid: Solid, height: float) -> tuple[Floats, ...]:
    """Return the closed outlines (N, 2) of a solid's cross-section at a height [m]. The inside is
    on the left. The last point repeats the first. A corner at exactly this height counts as
    above."""
    above = solid.points[solid.faces][..., 2] >= height
    cut = above.any(axis=1) & ~above.all(axis=1)
    faces = solid.faces[cut]
    above = above[cut]
    # Counter-clockwise from outside: an outline comes in where an edge leads down through the
    # plane, and goes on to the triangle beside where one leads up.
    down = _leading(faces, above)
    up = _leading(faces, ~above)
    # The points (E, 2) where edges (E, 2) cross a height [m].
    start = solid.points[down[:, 0]]
    end = solid.points[down[:, 1]]
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    points = start[:, :2] + share[:, None] * (end - start)[:, :2]
    numbers, back = (edge.min(axis=1) * len(solid.points) + edge.max(axis=1) for edge in (down, up))
    row = {number: k for k, number in enumerate(numbers.tolist())}
    return tuple(points[[row[number] for number in loop]] for loop in chained(numbers, back))


def _leading(faces: Ints, first: Ints) -> Ints:
    """Return the edge (T, 2) of each triangle that runs from a flagged to an unflagged corner."""
    corner = np.argmax(first & ~np.roll(first, -1, axis=1), axis=1)
    row = np.arange(len(faces))
    return np.stack([faces[row, corner], faces[row, (corner + 1) % 3]], axis=1)


def outline_from_above(vehicle: Vehicle) -> ClosedLines:
    """Return closed outlines (N, 2) of a vehicle as it is seen from above [m]."""
    low, high = (corner[:2] for corner in vehicle.bounds)
    cell = CELL_M * max(1.0, float((high - low).max()) / AT_ONCE_M)
    first = np.floor(low / cell) - 1
    last = np.ceil(high / cell) + 1
    x, y = ((a * cell, b * cell) for a, b in zip(first.tolist(), last.tolist(), strict=True))
    space = PerceptionSpace(x, y, (0.0, cell), cell)
    filled = np.isfinite(vehicle.top(space))
    return outlines(filled.astype(float), 0.5, space.centers(0), space.centers(1))


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the plan as polygons, and messages on what it lacks. Outer rings run counter-clockwise
    and holes clockwise (RFC 7946), but coordinates are metres of the ground frame."""
    plan, lines = ground_plan(request)
    features = [
        _feature(
            footprint.name,
            footprint.outlines,
            what="footprint",
            kind=sensor.kind,
            model=sensor.model.name,
            reach_m=footprint.reach,
            position=[round(value, DECIMALS) for value in footprint.pose.position],
        )
        for footprint, sensor in zip(plan.footprints, request.study.rig, strict=True)
    ]
    for name, loops in (("vehicle", plan.vehicle), ("blind ground", plan.blind)):
        if loops:
            features.append(_feature(name, loops, what=name))
    data = {"type": "FeatureCollection", "about": COORDINATES, "features": features}
    return {FILE: (json.dumps(data, ensure_ascii=False, indent=1) + "\n").encode()}, lines


def _feature(name: str, loops: ClosedLines, **properties: Any) -> dict[str, Any]:
    area = round(sum(map(signed_area, loops)), DECIMALS)
    rings = [[np.round(ring, DECIMALS).tolist() for ring in polygon] for polygon in polygons(loops)]
    return {
        "type": "Feature",
        "properties": {"name": name, **properties, "area_m2": area},
        "geometry": {"type": "MultiPolygon", "coordinates": rings},
    }


def signed_area(loop: Floats) -> float:
    """Return the area of a closed outline (N, 2) [m2]; negative where it runs clockwise."""
    a = loop[:-1]
    b = loop[1:]
    return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) / 2.0


def polygons(loops: ClosedLines) -> list[list[Floats]]:
    """Return outlines, whose inside is on the left, as polygons: an outer ring, then its holes. A
    hole belongs to the smallest ring that it is in."""
    outer = sorted((loop for loop in loops if signed_area(loop) > 0.0), key=signed_area)
    found = [[loop] for loop in outer]
    for loop in loops:
        if signed_area(loop) < 0.0:
            home = next((polygon for polygon in found if _contains(polygon[0], loop[0])), None)
            if home is not None:
                home.append(loop)
    return found[::-1]


def _contains(ring: Floats, point: Floats) -> bool:
    """Whether a point (2,) is in a closed ring: a ray from it crosses the ring oddly often."""
    a = ring[:-1]
    b = ring[1:]
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a = a[spans]
    b = b[spans]
    share = (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1])
    crossing = a[:, 0] + share * (b[:, 0] - a[:, 0])
    return bool((crossing > point[0]).sum() % 2)
