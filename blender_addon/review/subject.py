"""What the picture shows: vehicle, ground, beams, frustums and the sensors themselves."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from ..bridge.rig import mounted_on_sensor, view_layer_of
from ..bridge.vehicle import visible_members
from ..overlay.beams import Beams, shown_beams
from ..overlay.colors import PAPER, Rgba
from ..overlay.geometry import (
    beam_lines,
    frustum_faces,
    frustum_lines,
    frustum_points,
)
from . import shapes
from .camera import View
from .shapes import Faces
from .stage import Stage

if TYPE_CHECKING:
    import pe_core as pe

Floats = NDArray[np.float64]

BEAMS, CHANNELS = 760, 12
"""Beams drawn over all LiDARs, and of how many channels each: a pattern, not a wall."""
BEAM_M, FRUSTUM_M = 5.5, 2.0
VIEW_SHARE = 0.62
"""How much of a beam has to be in the picture: its end is faint."""
LINE_PX, FRAME_PX, RING_PX = 1.3, 1.8, 1.2
CLEAR_M = 0.22
"""Beams begin this far from the sensor, so that it is not lost among them."""
RINGS_M = (5.0, 10.0)
RING: Rgba = (0.55, 0.58, 0.62, 0.5)
RING_TEXT: Rgba = (0.45, 0.48, 0.52, 1.0)
VEHICLE: Rgba = (0.72, 0.75, 0.78, 1.0)
SHADOW_LAYERS = 10
SHADOW: Rgba = (0.0, 0.0, 0.0, 0.05)


@dataclass(frozen=True, slots=True)
class Subject:
    """A rig on its vehicle, and where it stood at the start (None when nothing was moved)."""

    study: pe.Study
    start: pe.Rig | None
    beams: dict[str, Beams]

    @classmethod
    def of(cls, study: pe.Study, outcome: pe.Outcome) -> Subject:
        """Choose the beams to be shown."""
        lidars = [sensor for sensor in study.rig if sensor.kind == "lidar"]
        beams = {
            each.name: shown_beams(each, study.vehicle, BEAMS // len(lidars), CHANNELS)
            for each in lidars
        }
        return cls(study, outcome.start.rig if outcome.kind == "optimize" else None, beams)

    @property
    def any_stopped(self) -> bool:
        """Whether the vehicle stops a beam."""
        return any(beams.stopped.any() for beams in self.beams.values())

    def moves(self) -> list[tuple[Floats, Floats]]:
        """Start and end (3,) [m] of each sensor that was moved."""
        if self.start is None:
            return []
        pairs = zip(self.start, self.study.rig, strict=True)
        places = [(np.array(a.pose.position), np.array(b.pose.position)) for a, b in pairs]
        return [(a, b) for a, b in places if not np.array_equal(a, b)]

    def points_in_view(self) -> Floats:
        """(N, 3) points that the picture has to hold [m]."""
        points = [self._positions(), *(p[None] for _, p in self.moves())]
        if self.study.vehicle is not None:
            points.append(np.array(list(product(*zip(*self.study.vehicle.bounds, strict=True)))))
        for sensor in self.study.rig:
            if sensor.kind == "camera":
                points.append(frustum_points(sensor, FRUSTUM_M))
            else:
                ends = beam_lines(sensor, self.beams[sensor.name], BEAM_M, PAPER).points[1::2]
                start = np.array(sensor.pose.position)
                points.append(start + VIEW_SHARE * (ends - start))
        return np.vstack(points)

    def build(self, stage: Stage, view: View, scene: bpy.types.Scene) -> None:
        """Put everything on the stage; the vehicle's objects are those of the user's scene."""
        self._build_vehicle(stage, vehicle_objects(scene))
        for radius in RINGS_M:
            stage.add_faces("Ring", shapes.ribbons(shapes.ring(radius, RING), view, RING_PX), view)
        for sensor in self.study.rig:
            self._build_view(stage, view, sensor)

    def _build_vehicle(self, stage: Stage, objects: list[bpy.types.Object]) -> None:
        if self.study.vehicle is None:
            return
        for each in objects:
            stage.scene.collection.objects.link(each)
        if not objects:
            corners = self.study.vehicle.triangles
            stage.add_faces("Vehicle", Faces(corners, np.tile(VEHICLE, (len(corners), 1))))
        low, high = self.study.vehicle.bounds
        stage.add_faces("Shadow", shapes.shadow(low, high, SHADOW, SHADOW_LAYERS))

    def _build_view(self, stage: Stage, view: View, sensor: pe.Sensor) -> None:
        """What one sensor sees."""
        if sensor.kind == "camera":
            lines = frustum_lines(sensor, FRUSTUM_M, PAPER)
            stage.add_faces("Frustum", shapes.ribbons(lines, view, FRAME_PX), view)
            faces = shapes.triangles(frustum_faces(sensor, FRUSTUM_M, PAPER))
            stage.add_faces("Frustum", faces)
            return
        lines = beam_lines(sensor, self.beams[sensor.name], BEAM_M, PAPER)
        lines = shapes.begun_later(lines, CLEAR_M)
        stage.add_faces("Beams", shapes.ribbons(lines, view, LINE_PX), view)

    def _positions(self) -> Floats:
        return np.array([sensor.pose.position for sensor in self.study.rig])


def vehicle_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Objects of the vehicle that count: seen, and not riding on a sensor."""
    collection = scene.perception_entropy.vehicle
    if collection is None:
        return []
    members = visible_members(collection, view_layer_of(scene))
    return [each for each in members if not mounted_on_sensor(each)]
