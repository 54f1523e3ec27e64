"""Reads a scene into a wish: the only part of the overlay that looks at Blender's data."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Hashable
from typing import NamedTuple

import bpy
import numpy as np

from .. import asking, body, bridge, roster, searching
from ..engine import pe
from ..live import latest
from .layers import LAYERS
from .wish import (
    AVERAGE,
    FocusRegion,
    MountFaces,
    PictureWish,
    SceneSensor,
    SearchBox,
    ViewSettings,
)

LEAST_LENGTH_M = 0.1
BEST_SO_FAR = "best so far"
HEAVY_S = 0.05
"""A vehicle that took longer to read is not read again while it is being moved."""


class Judged(NamedTuple):
    """What a scene's rigs are judged by; `key` tells it from others."""

    prior: pe.Prior | None
    space: pe.PerceptionSpace | None
    model: pe.PerceptionModel | None
    key: Hashable


class SceneReader:
    """Remembers what is dear to read, by plain keys; never a Blender object."""

    def __init__(self) -> None:
        self._judged: dict[str, Judged] = {}
        self._bodies: dict[str, body.Body] = {}
        self._faces: dict[str, dict[Hashable, np.ndarray]] = {}
        self._took_s = 0.0

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self.__init__()

    def wish(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool = False
    ) -> PictureWish:
        """Return what is to be shown of a scene."""
        sensors = _mounted(scene, depsgraph)
        vehicle, body_key = self._vehicle(scene, depsgraph, moving) if sensors else body.NOTHING
        judged = self._judged_by(scene)
        others, name = _ghosts(scene)
        compared, compared_name = _compared(scene)
        answer = asking.answer(scene)
        mounts = self._mounts(scene, depsgraph, sensors, vehicle, body_key)
        return PictureWish(
            *(sensors, vehicle, body_key, judged.prior, judged.key, view_of(scene), moving),
            scored=_scored(scene, sensors, judged.space),
            space=judged.space,
            model=judged.model,
            targets=bridge.targets_of(scene.perception_entropy),
            ghosts=others,
            ghosts_name=name,
            searching=bool(searching.best(scene.name)),
            place=None if answer is None else answer.place,
            mounts=mounts,
            boxes=_boxes(scene, sensors, vehicle, mounts),
            compared=compared,
            compared_name=compared_name,
            focus=tuple(FocusRegion(*row) for row in bridge.focus_rows(scene)),
            reference=bridge.reference_of(scene.perception_entropy),
        )

    def _mounts(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        sensors: tuple[SceneSensor, ...],
        vehicle: pe.Vehicle | None,
        body_key: Hashable,
    ) -> tuple[MountFaces, ...]:
        """Surfaces of the scene's mounts; read again when they, or the vehicle, are others."""
        if vehicle is None:
            return ()
        objects = (scene.objects.get(each.sensor.name) for each in sensors if each.selected)
        chosen = {obj.perception_entropy.mount for obj in objects if obj is not None}
        known, found, shown = self._faces.get(scene.name, {}), {}, []
        for row in scene.perception_entropy.mounts:
            if (said := bridge.mount_key(row)) is None:
                continue
            key = said, body_key
            faces = known.get(key)
            if faces is None:
                faces = bridge.mount_faces(scene, depsgraph, row, vehicle)
            found[key] = faces
            if len(faces):
                shown.append(MountFaces(row.name, key, faces, row.name in chosen))
        self._faces[scene.name] = found
        return tuple(shown)

    def _judged_by(self, scene: bpy.types.Scene) -> Judged:
        """Prior, space and AP curves; no prior where there is a mistake, which a score tells."""
        settings, space = scene.perception_entropy, None
        try:
            space, model = bridge.space_of(settings), bridge.perception_of(settings)
            key = bridge.prior_key(scene), space, model, bridge.targets_of(settings)
            known = self._judged.get(scene.name)
            if known is None or known.key != key:
                known = Judged(bridge.prior_from_scene(scene), space, model, key)
        except pe.InputError as error:
            known = Judged(None, space, None, str(error))
        self._judged[scene.name] = known
        return known

    def _vehicle(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool
    ) -> body.Body:
        known = self._bodies.get(scene.name)
        if known is not None and moving and self._took_s > HEAVY_S:
            return known
        start = time.perf_counter()
        found = self._bodies[scene.name] = body.shared.read(scene, depsgraph)
        if known is None or found.key != known.key:
            self._took_s = time.perf_counter() - start
        return found


def view_of(scene: bpy.types.Scene) -> ViewSettings:
    """Return the settings of what is shown, as plain values."""
    settings = scene.perception_entropy
    view = settings.view
    on = settings.show_overlay
    layers = (each.name for each in LAYERS if on and getattr(view, f"show_{each.name}"))
    same = ("ground_quantity", "ground_opacity", "reach_class", "reach_of", "beams_of", "channels")
    same += ("beam_colors", "rings", "footprints", "view_range")
    same += ("ground_range", "ground_difference")
    return ViewSettings(
        layers=frozenset(layers),
        ground_height=_height(view.ground_height),
        entropy_range=tuple(view.entropy_range),
        coverage_range=tuple(view.coverage_range),
        blind_height=_height(view.blind_height) or 0.0,
        channel=view.every if view.channels == "EVERY" else view.channel,
        beam_limit=settings.beam_limit,
        beam_length=max(LEAST_LENGTH_M, settings.beam_length),  # also of what is no number
        **{name: getattr(view, name) for name in same},
    )


def _mounted(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> tuple[SceneSensor, ...]:
    """Sensors without those that are not possible; a score says what is wrong there."""
    layer, found = depsgraph.view_layer, []
    active = layer.objects.active
    for number, obj in enumerate(roster.sensors(scene)):
        with contextlib.suppress(pe.InputError):
            sensor = bridge.sensor_from_object(obj, depsgraph)
            selected = obj == active or obj.select_get(view_layer=layer)
            drawn, counted = obj.perception_entropy.show, obj.visible_get(view_layer=layer)
            found.append(SceneSensor(sensor, number, selected, drawn, counted))
    return tuple(found)


def _boxes(
    scene: bpy.types.Scene,
    sensors: tuple[SceneSensor, ...],
    vehicle: pe.Vehicle | None,
    mounts: tuple[MountFaces, ...],
) -> tuple[SearchBox, ...]:
    """No-go areas, and the bounds of the selected sensors; a search says what is wrong there."""
    found: list[bridge.LimitBox] = []
    faces = {each.name: each.triangles for each in mounts}
    with contextlib.suppress(pe.InputError):
        found += bridge.no_go_boxes(scene)
    for each in sensors:
        if each.selected and (obj := scene.objects.get(each.sensor.name)) is not None:
            with contextlib.suppress(pe.InputError):
                around = faces.get(obj.perception_entropy.mount)
                box = bridge.bounds_box(obj, each.sensor, vehicle, around)
                found += [] if box is None else [box]
    return tuple(SearchBox(*box) for box in found)


def _scored(
    scene: bpy.types.Scene, sensors: tuple[SceneSensor, ...], space: pe.PerceptionSpace | None
) -> pe.GroundMap | None:
    """The last score's ground map, if the scene is not known to be another one since."""
    found = latest.scored(scene.name)
    if found is None or scene.perception_entropy.result_stale or found.study.space != space:
        return None
    now = {(e.sensor.name, e.sensor.model, e.sensor.pose) for e in sensors if e.counted}
    then = {(each.name, each.model, each.pose) for each in found.study.rig}
    return found.score.ground_map if now == then else None


def _ghosts(scene: bpy.types.Scene) -> tuple[tuple[pe.Sensor, ...], str]:
    """Sensors that are shown beside the scene's own, and what they are: the best that a search has
    found so far, else another variant."""
    if best := searching.best(scene.name):
        return best, BEST_SO_FAR
    key = scene.perception_entropy.view.ghost_key
    for row in scene.perception_entropy.variants if key else ():
        if row.key == key:
            with contextlib.suppress(pe.InputError):
                return tuple(bridge.rig_of(bridge.records_of(row))), row.name
    return (), ""


def _compared(scene: bpy.types.Scene) -> tuple[tuple[pe.Sensor, ...], str]:
    """Sensors that the difference map compares with, and what they are: those of the live score;
    without it, the variant that this is set to."""
    settings = scene.perception_entropy
    if not settings.view.ground_difference:
        return (), ""
    reading = latest.reading(scene.name) if settings.live.on else None
    found = None if reading is None else reading.reference
    if found is not None and found.rig is not None:
        return tuple(found.rig), found.label
    for row in settings.variants if settings.live.against else ():
        if row.key == settings.live.against:
            with contextlib.suppress(pe.InputError):
                return tuple(bridge.rig_of(bridge.records_of(row))), row.name
    return (), ""


def _height(choice: str) -> float | None:
    return None if choice == AVERAGE else int(choice.removeprefix("H")) / 100.0
