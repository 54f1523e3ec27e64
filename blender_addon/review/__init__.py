"""The review picture of a result: vehicle, sensors, fields of view and figures."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import bridge
from ..engine import graphics
from . import picture_geometry
from .captions import (
    caption_of,
    frame_of,
    legend_of,
    mark_moves,
    mark_rings,
    mark_sensors,
    write_page,
)
from .picture_geometry import Faces, View, look_at
from .stage import Lettering, Stage, stage

if TYPE_CHECKING:
    from ..engine import pe

__all__ = ["picture_of", "render_review"]

DEFAULT_SIZE = (1600, 900)


def render_review(
    scene: bpy.types.Scene,
    study: pe.Study,
    outcome: pe.Outcome,
    path: str | Path,
    size: tuple[int, int] = DEFAULT_SIZE,
) -> Path:
    """Render the review picture of an outcome, with Workbench; also without a window.

    The picture is built in a temporary scene; `scene` is not changed.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its settings name the vehicle's collection; without one the study's mesh is shown.
    study : Study
        The rig to show, usually ``outcome.study``.
    outcome : Outcome
        The figures, and the start of the search.
    path : path
        PNG to write, atomically.
    size : (width, height)
        [px].

    Raises
    ------
    InputError
        When the picture cannot be written there.
    """
    words = caption_of(study, outcome)
    subject = Subject.of(study, outcome)
    with stage() as on:
        view = look_at(subject.points_in_view(), frame_of(len(words.table), size))
        on.set_camera(view)
        subject.build(on, view, scene)
        pen = Lettering.on(on, view)
        legend = legend_of(study.rig, stopped=subject.any_stopped, moved=bool(subject.moves()))
        write_page(pen, words, legend)
        mark_rings(pen, RINGS_M, RING_TEXT)
        mark_moves(pen, subject.moves())
        mark_sensors(pen, study.rig, subject.moves())
        on.render(Path(path))
    return Path(path)


def picture_of(scene: bpy.types.Scene, outcome: pe.Outcome) -> bytes:
    """Return the review picture of an outcome as the bytes of a PNG, with the same errors."""
    with tempfile.TemporaryDirectory(prefix="perception-entropy-") as folder:
        path = Path(folder, "review.png")
        return render_review(scene, outcome.study, outcome, path).read_bytes()


Floats = NDArray[np.float64]

BEAMS = 760
"""Beams drawn over all LiDARs, of a few channels each: a pattern, not a wall."""
RING_PX = 1.2
RINGS_M = (5.0, 10.0)
RING: graphics.Rgba = (0.55, 0.58, 0.62, 0.5)
RING_TEXT: graphics.Rgba = (0.45, 0.48, 0.52, 1.0)
VEHICLE: graphics.Rgba = (0.72, 0.75, 0.78, 1.0)
SHADOW_LAYERS = 10
SHADOW: graphics.Rgba = (0.0, 0.0, 0.0, 0.05)


@dataclass(frozen=True, slots=True)
class Subject:
    """A rig on its vehicle, and the rig at the start (None if no sensor was moved)."""

    study: pe.Study
    start: pe.Rig | None
    sketches: dict[str, graphics.Sketch]

    @classmethod
    def of(cls, study: pe.Study, outcome: pe.Outcome) -> Subject:
        """Return the subject of an outcome; the beams to be shown are chosen."""
        rig, budget = study.rig, graphics.beam_budget(list(study.rig), BEAMS)
        choice = graphics.BeamChoice(budget, graphics.ChannelMode.FEW)
        sketches = {
            sensor.name: graphics.drawing_of(sensor.kind).sketch(sensor, study.vehicle, choice)
            for sensor in rig
        }
        return cls(study, outcome.start.rig if outcome.kind == "optimize" else None, sketches)

    @property
    def any_stopped(self) -> bool:
        """Whether the vehicle occludes a beam."""
        return any(sketch.stopped for sketch in self.sketches.values())

    def moves(self) -> list[tuple[Floats, Floats]]:
        """Start and end position (3,) [m] of each sensor that was moved."""
        if self.start is None:
            return []
        pairs = zip(self.start, self.study.rig, strict=True)
        positions = [(np.array(a.pose.position), np.array(b.pose.position)) for a, b in pairs]
        return [(a, b) for a, b in positions if not np.array_equal(a, b)]

    def points_in_view(self) -> Floats:
        """(N, 3) points that have to be inside the picture [m]."""
        points = [self._positions(), *(p[None] for _, p in self.moves())]
        if self.study.vehicle is not None:
            points.append(np.array(list(product(*zip(*self.study.vehicle.bounds, strict=True)))))
        for sensor in self.study.rig:
            points.append(self.sketches[sensor.name].points(_look(sensor).length_m))
        return np.vstack(points)

    def build(self, stage: Stage, view: View, scene: bpy.types.Scene) -> None:
        """Add everything to the stage; the vehicle's objects are those of the user's scene."""
        self._build_vehicle(stage, vehicle_objects(scene))
        for radius in RINGS_M:
            stage.add_faces(
                "Ring",
                picture_geometry.ribbons(picture_geometry.ground_ring(radius, RING), view, RING_PX),
                view,
            )
        for sensor in self.study.rig:
            self._build_view(stage, view, sensor)

    def _build_vehicle(self, stage: Stage, objects: list[bpy.types.Object]) -> None:
        if self.study.vehicle is None:
            return
        for obj in objects:
            stage.scene.collection.objects.link(obj)
        if not objects:
            corners = self.study.vehicle.triangles
            stage.add_faces("Vehicle", Faces(corners, np.tile(VEHICLE, (len(corners), 1))))
        low, high = self.study.vehicle.bounds
        stage.add_faces("Shadow", picture_geometry.shadow(low, high, SHADOW, SHADOW_LAYERS))

    def _build_view(self, stage: Stage, view: View, sensor: pe.Sensor) -> None:
        """Add the field of view of a sensor."""
        sketch, look = self.sketches[sensor.name], _look(sensor)
        lines = sketch.lines(look.length_m, graphics.PAPER)
        if look.clear_m:
            lines = picture_geometry.starting_farther(lines, look.clear_m)
        stage.add_faces("View", picture_geometry.ribbons(lines, view, look.line_px), view)
        stage.add_faces(
            "View", picture_geometry.triangles(sketch.faces(look.length_m, graphics.PAPER))
        )

    def _positions(self) -> Floats:
        return np.array([sensor.pose.position for sensor in self.study.rig])


def _look(sensor: pe.Sensor) -> graphics.Look:
    return graphics.drawing_of(sensor.kind).look


def vehicle_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Objects of the vehicle that are scored: visible, and not mounted on a sensor."""
    collection = scene.perception_entropy.vehicle
    if collection is None:
        return []
    members = bridge.visible_members(collection, bridge.view_layer_of(scene))
    return [obj for obj in members if not bridge.mounted_on_sensor(obj)]
