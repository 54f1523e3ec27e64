"""The place that was asked about last in each scene, and what there is to tell of it.

It is kept here and not in a property: it is an answer of the moment, not part of the work. When
sensors or the vehicle have moved and rest, it is asked again.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy
from bpy.app.handlers import persistent

from . import body, bridge, changes, roster
from .engine import advice, pe
from .worker import desk

TOPIC = "place"
AskedPoint = tuple[float, float, float]


class Told(NamedTuple):
    """A point [m], and lines to tell of it; `place` is None where nothing could be told."""

    point: AskedPoint
    lines: tuple[str, ...]
    place: advice.AskedPlace | None = None


_answers: dict[str, Told] = {}
"""By the scene's name."""


def ask(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, point: AskedPoint) -> None:
    """Ask what the sensors, as they stand, make of a point; the answer comes soon."""
    name = scene.name
    vehicle = body.shared.read(scene, depsgraph).vehicle
    sensors = bridge.possible_sensors(roster.sensors(scene), depsgraph)
    settings = scene.perception_entropy
    try:
        space, model = bridge.space_of(settings), bridge.perception_of(settings)
        prior = bridge.prior_from_scene(scene)
        rig = pe.Rig(sensors)
    except pe.InputError as error:
        note(name, Told(point, (str(error),)))
        return

    def work() -> advice.AskedPlace:
        return advice.ask_place(rig, space, prior, vehicle, point, model)

    def deliver(found: advice.AskedPlace) -> None:
        note(name, Told(point, found.text, found))

    desk.ask(TOPIC, work, deliver, lambda error: note(name, Told(point, (str(error),))))


def note(scene_name: str, answer: Told) -> None:
    """Keep an answer, and have it shown."""
    _answers[scene_name] = answer
    changes.picture.tell()


def answer(scene: bpy.types.Scene) -> Told | None:
    """Return what was told last of a place, None when none was asked about."""
    return _answers.get(scene.name)


def dismiss(scene: bpy.types.Scene) -> None:
    """Forget the place."""
    desk.drop(TOPIC)
    if _answers.pop(scene.name, None) is not None:
        changes.picture.tell()


def ask_again() -> None:
    """Things have moved and rest: what was told may not hold any more."""
    scene = bpy.context.scene
    if scene.name in _answers:
        ask(scene, bpy.context.evaluated_depsgraph_get(), _answers[scene.name].point)


@persistent
def forget(*_: object) -> None:
    """Another file comes: its scenes may have the same names."""
    desk.drop(TOPIC)
    _answers.clear()


def register() -> None:
    """Start listening."""
    changes.rested.connect(ask_again)
    bpy.app.handlers.load_pre.append(forget)


def unregister() -> None:
    """Stop listening, and forget all places."""
    bpy.app.handlers.load_pre.remove(forget)
    changes.rested.disconnect(ask_again)
    forget()
