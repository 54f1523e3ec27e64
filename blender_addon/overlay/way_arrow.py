"""The best way of a sensor: an arrow along its surface, arcs of turns, and a ghost; no GPU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..engine import Floats, graphics
from .annotations import MARK, ghost_sensors

if TYPE_CHECKING:
    from ..engine import advice, pe

ARROW_M = 0.6
BARB_M = 0.1
"""Length of the arrow and of its barbs."""
ARC_M = 0.6
ARC_RAD = np.radians(30.0)
ARC_POINTS = 12
"""Radius, angle and points of an arc that shows a turn."""
BELOW_M = 0.4
"""How far below the ghost its text is: the sensor's name is above."""
BETTER: graphics.Rgba = (0.42, 0.75, 1.0, 1.0)
"""Blue is better, as in the read-out."""
AXES = {"yaw": (0, 1), "pitch": (0, 2)}
"""Axes of the sensor's frame in whose plane a turn is: from, to."""
SENSES = {"left": 1.0, "right": -1.0, "nose up": 1.0, "nose down": -1.0}


@dataclass(frozen=True, slots=True, eq=False)
class WayShape(graphics.LayerShape):
    """The drawn best way, and what it is drawn of."""

    found: advice.SteepestWay | None = None


def way_arrow(found: advice.SteepestWay, sensor: pe.Sensor) -> WayShape:
    """Return the best way of a sensor as it is drawn. Nothing is drawn of what is not clear."""
    at = np.array(found.at)
    lines = []
    labels = []
    if found.direction is not None and found.along is not None:
        tip = at + ARROW_M * np.array(found.direction)
        lines.append(_with_barbs(np.array([at, tip])))
        text = f"this way: {found.along.change:+.3f} nats per 5 cm"
        labels.append(graphics.Tag(text, tuple(tip.tolist()), MARK, strong=True))
    for turn in found.clear_turns:
        axis, _, sense = turn.name.partition(" ")
        arc = _arc(sensor.pose, axis, SENSES[sense])
        lines.append(_with_barbs(arc))
        text = f"{turn.name}: {turn.change:+.3f} nats per deg"
        labels.append(graphics.Tag(text, tuple(arc[-1].tolist()), MARK, strong=True))
    through = [graphics.Primitives.of(each, BETTER) for each in lines]
    if (better := found.better) is not None:
        ghost = ghost_sensors((sensor.moved(better.pose),), (sensor,))
        through.append(ghost.through)
        text = f"best within 20 cm: {better.change:+.3f} nats (M)"
        x, y, z = better.pose.position
        labels.append(graphics.Tag(text, (x, y, z - BELOW_M), MARK, strong=True))
    return WayShape(through=graphics.Primitives.joined(through), labels=tuple(labels), found=found)


def _arc(pose: pe.Pose, axis: str, sense: float) -> Floats:
    """Return points (N, 3) of an arc before a sensor, in the sense of a turn."""
    start, side = (pose.ground_from_sensor[:, k] for k in AXES[axis])
    angles = np.linspace(0.0, ARC_RAD, ARC_POINTS)[:, None]
    arc: Floats = ARC_M * (np.cos(angles) * start + sense * np.sin(angles) * side)
    return arc + np.array(pose.position)


def _with_barbs(points: Floats) -> Floats:
    """Return the segments (2 E, 3) of a line through points (N, 3), with an arrow's barbs."""
    tip = points[-1]
    along = tip - points[-2]
    along = along / np.sqrt((along**2).sum())
    aside = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
    aside = aside / np.sqrt((aside**2).sum())
    ends = [tip - BARB_M * along + sign * 0.5 * BARB_M * aside for sign in (1.0, -1.0)]
    barbs = [end for each in ends for end in (tip, each)]
    return np.concatenate([graphics.polyline(points), np.array(barbs)])
