"""Reads a scene into a wish: the only part of the overlay that looks at Blender's data."""

from __future__ import annotations

import contextlib
import time

import bpy

from .. import asking, body, bridge, roster
from ..engine import pe
from ..live import latest
from .layers import LAYERS
from .wish import AVERAGE, Mounted, View, Wish

LEAST_LENGTH_M = 0.1
HEAVY_S = 0.05
"""A vehicle that took longer to read is not read again while it is being moved."""


class Reader:
    """Remembers what is dear to read, by plain keys; never a Blender object."""

    def __init__(self) -> None:
        self._prior: tuple[object, pe.Prior | None] = (None, None)
        self._body = body.NOTHING
        self._took_s = 0.0

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self.__init__()

    def wish(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool = False
    ) -> Wish:
        """Return what is to be shown of a scene."""
        sensors = _mounted(scene, depsgraph)
        vehicle, body_key = self._vehicle(scene, depsgraph, moving) if sensors else body.NOTHING
        key = bridge.prior_key(scene)
        if self._prior[0] != key:
            self._prior = key, _prior(scene)
        view, scored = view_of(scene), _scored(scene, sensors)
        others, name = _ghosts(scene)
        answer = asking.answer(scene)
        return Wish(
            *(sensors, vehicle, body_key, self._prior[1], key, view, moving, scored),
            ghosts=others,
            ghosts_name=name,
            place=None if answer is None else answer.place,
        )

    def _vehicle(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool
    ) -> body.Body:
        if not (moving and self._took_s > HEAVY_S):
            start = time.perf_counter()
            found = body.shared.read(scene, depsgraph)
            if found.key != self._body.key:
                self._took_s = time.perf_counter() - start
            self._body = found
        return self._body


def view_of(scene: bpy.types.Scene) -> View:
    """Return the settings of what is shown, as plain values."""
    settings = scene.perception_entropy
    view = settings.view
    on = settings.show_overlay
    layers = (each.name for each in LAYERS if on and getattr(view, f"show_{each.name}"))
    same = ("ground_quantity", "ground_opacity", "reach_class", "reach_of", "beams_of", "channels")
    same += ("beam_colors", "rings", "footprints", "view_range")
    return View(
        layers=frozenset(layers),
        ground_height=_height(view.ground_height),
        blind_height=_height(view.blind_height) or 0.0,
        channel=view.every if view.channels == "EVERY" else view.channel,
        beam_limit=settings.beam_limit,
        beam_length=max(LEAST_LENGTH_M, settings.beam_length),  # also of what is no number
        **{name: getattr(view, name) for name in same},
    )


def _mounted(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> tuple[Mounted, ...]:
    """Sensors without those that are not possible; a score says what is wrong there."""
    layer, found = depsgraph.view_layer, []
    active = layer.objects.active
    for number, obj in enumerate(roster.sensors(scene)):
        with contextlib.suppress(pe.InputError):
            sensor = bridge.sensor_from_object(obj, depsgraph)
            selected = obj == active or obj.select_get(view_layer=layer)
            drawn, counted = obj.perception_entropy.show, obj.visible_get(view_layer=layer)
            found.append(Mounted(sensor, number, selected, drawn, counted))
    return tuple(found)


def _scored(scene: bpy.types.Scene, sensors: tuple[Mounted, ...]) -> pe.GroundMap | None:
    """The last score's ground map, if the scene is not known to be another one since."""
    found = latest.scored(scene.name)
    if found is None or scene.perception_entropy.result_stale:
        return None
    now = {(e.sensor.name, e.sensor.model, e.sensor.pose) for e in sensors if e.counted}
    then = {(each.name, each.model, each.pose) for each in found.study.rig}
    return found.score.ground_map if now == then else None


def _ghosts(scene: bpy.types.Scene) -> tuple[tuple[pe.Sensor, ...], str]:
    """Sensors and name of the variant that is shown beside the scene's own."""
    key = scene.perception_entropy.view.ghost_key
    for row in scene.perception_entropy.variants if key else ():
        if row.key == key:
            with contextlib.suppress(pe.InputError):
                return tuple(bridge.rig_of(bridge.records_of(row))), row.name
    return (), ""


def _prior(scene: bpy.types.Scene) -> pe.Prior | None:
    """The scene's prior; none where there is a mistake in it, which a score tells."""
    with contextlib.suppress(pe.InputError):
        return bridge.prior_from_scene(scene)
    return None


def _height(choice: str) -> float | None:
    return None if choice == AVERAGE else int(choice.removeprefix("H")) / 100.0
