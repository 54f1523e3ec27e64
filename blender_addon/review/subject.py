"""What the picture shows: vehicle, ground, beams, frustums and the sensors themselves."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from ..overlay.beams import Beams, shown_beams
from ..overlay.colors import PAPER, Rgba
from ..overlay.geometry import (
    Primitives,
    beam_lines,
    frustum_faces,
    frustum_lines,
    frustum_points,
)
from . import shapes
from .camera import View
from .page import GHOST
from .shapes import Faces
from .stage import Stage

if TYPE_CHECKING:
    import pe_core as pe

Floats = NDArray[np.float64]

BEAMS, CHANNELS = 900, 14
"""Beams drawn over all LiDARs, and of how many channels each: a pattern, not a wall."""
BEAM_M, FRUSTUM_M = 5.5, 2.2
VIEW_SHARE = 0.72
"""How much of a beam has to be in the picture: its end is faint."""
LINE_PX, STOPPED_PX, FRAME_PX = 1.3, 1.3, 1.8
MARKER_M = 0.07
RINGS_M = (5.0, 10.0, 15.0)
RING: Rgba = (0.55, 0.58, 0.62, 0.5)
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

    @property
    def moved(self) -> bool:
        """Whether a sensor stands elsewhere than at the start."""
        return bool(self._moves())

    def points_in_view(self) -> Floats:
        """(N, 3) points that the picture has to hold [m]."""
        points = [self._positions(), *(p[None] for _, p in self._moves())]
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

    def build(self, stage: Stage, view: View, vehicle: bpy.types.Collection | None) -> None:
        """Put everything on the stage."""
        self._build_vehicle(stage, vehicle)
        for radius in RINGS_M:
            stage.add_faces("Ring", shapes.ribbons(shapes.ring(radius, RING), view, 1.2), view)
        for sensor in self.study.rig:
            self._build_view(stage, view, sensor)
        self._build_markers(stage)
        trails = [np.array([start, end]) for start, end in self._moves()]
        for points in trails:
            line = Primitives(points.astype(np.float32), np.tile(np.float32(GHOST), (2, 1)))
            stage.add_faces("Move", shapes.ribbons(line, view, 2.0), view)

    def _build_vehicle(self, stage: Stage, vehicle: bpy.types.Collection | None) -> None:
        if vehicle is not None:
            stage.scene.collection.children.link(vehicle)
        elif self.study.vehicle is not None:
            corners = self.study.vehicle.triangles
            stage.add_faces("Vehicle", Faces(corners, np.tile(VEHICLE, (len(corners), 1))))
        if self.study.vehicle is not None:
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
        beams = self.beams[sensor.name]
        for stopped, width in ((False, LINE_PX), (True, STOPPED_PX)):
            lines = beam_lines(sensor, beams[beams.stopped == stopped], BEAM_M, PAPER)
            stage.add_faces("Beams", shapes.ribbons(lines, view, width), view)

    def _build_markers(self, stage: Stage) -> None:
        """A ball for each sensor, and a ghost of it where it stood at the start."""
        colors = {"lidar": PAPER.free, "camera": PAPER.camera}
        for sensor in self.study.rig:
            color = (*colors[sensor.kind][:3], 1.0)
            stage.add_faces("Sensor", shapes.ball(sensor.pose.position, MARKER_M, color))
        for start, _ in self._moves():
            stage.add_faces("Start", shapes.ball(start, MARKER_M, GHOST))

    def _positions(self) -> Floats:
        return np.array([sensor.pose.position for sensor in self.study.rig])

    def _moves(self) -> list[tuple[Floats, Floats]]:
        """Start and end (3,) [m] of each sensor that was moved."""
        if self.start is None:
            return []
        pairs = zip(self.start, self.study.rig, strict=True)
        places = [(np.array(a.pose.position), np.array(b.pose.position)) for a, b in pairs]
        return [(a, b) for a, b in places if not np.array_equal(a, b)]
