"""What is odd, and what a score means in words: looked into beside the window.

Warnings are looked for a while after things have come to rest, so that they are in nobody's way
who goes on moving. How far a rig sees is worked out after a score.
"""

from __future__ import annotations

import bpy

from . import body, bridge, changes, redraw, roster
from .engine import advice, pe
from .worker import desk

PATIENCE_S = 1.0
"""How long things have to rest until they are looked over."""
WARNINGS, WORDS = "warnings", "words"
"""Topics of the work."""


_behind = False
"""Whether things have moved since what is odd was told."""


def is_behind() -> bool:
    """Whether the warnings that are told are of before the last move."""
    return _behind


def look_soon() -> None:
    """Look for what is odd a while from now, if nothing moves until then."""
    _mark_behind(True)
    if not bpy.app.background and not bpy.app.timers.is_registered(look):
        bpy.app.timers.register(look, first_interval=PATIENCE_S)


def not_yet() -> None:
    """Something moves: wait on."""
    _mark_behind(True)
    if bpy.app.timers.is_registered(look):
        bpy.app.timers.unregister(look)


def look() -> None:
    """Look for what is odd in the scene that is open; tell it in its settings."""
    scene = bpy.context.scene
    if not bridge.sensor_objects(scene) and scene.perception_entropy.vehicle is None:
        _mark_behind(False)
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    own, name = bridge.scene_advice(scene), scene.name
    vehicle = body.shared.read(scene, depsgraph).vehicle
    sensors = bridge.possible_sensors(roster.sensors(scene), depsgraph)
    try:
        space = bridge.space_of(scene.perception_entropy)
    except pe.InputError:  # a score says so
        space = pe.PerceptionSpace()

    def work() -> tuple[str, tuple[pe.Advice, ...]]:
        line = "" if vehicle is None else advice.vehicle_line(vehicle)
        return line, advice.warnings(sensors, vehicle, space, pe.Prior.uniform())

    def deliver(found: tuple[str, tuple[pe.Advice, ...]]) -> None:
        if name in bpy.data.scenes:
            line, told = found
            settings = bpy.data.scenes[name].perception_entropy
            bridge.store_warnings(settings, (*own, *told))
            if settings.vehicle_line != line:
                settings.vehicle_line = line
            _mark_behind(_is_due())
            changes.picture.tell()

    desk.ask(WARNINGS, work, deliver, lambda _: None)


def _is_due() -> bool:
    """Whether they are to be looked for once more."""
    return not bpy.app.background and bpy.app.timers.is_registered(look)


def _mark_behind(behind: bool) -> None:
    """Note whether warnings are of before a move, and have panels say so."""
    global _behind
    if behind != _behind and not bpy.app.background:
        _behind = behind
        redraw.editors()


def look_round(scene: bpy.types.Scene, outcome: pe.Outcome, signature: str) -> None:
    """Tell in words, soon, how far the rig of a result sees; without a window nobody reads it."""
    if bpy.app.background:
        return
    study, score, name = outcome.study, outcome.after, scene.name

    def work() -> advice.Outlook:
        return advice.outlook(study.sight(), study.rig)

    def deliver(seen: advice.Outlook) -> None:
        scene = bpy.data.scenes.get(name)
        if scene is not None and scene.perception_entropy.result_signature == signature:
            bridge.store_words(scene, study, score, seen)
            changes.picture.tell()

    desk.ask(WORDS, work, deliver, lambda _: None)


def register() -> None:
    """Start listening."""
    changes.moved.connect(not_yet)
    changes.rested.connect(look_soon)


def unregister() -> None:
    """Stop listening, also to the look that may be due."""
    changes.rested.disconnect(look_soon)
    changes.moved.disconnect(not_yet)
    not_yet()
