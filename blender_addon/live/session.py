"""Live: while something moves a draft of the score follows, once it rests an exact one.

A wish is read inside Blender's own update, which costs a fraction of a millisecond, and scored
beside the window at once, while Blender draws; the newest wish is the only one that waits. What
was found is shown by the drawing that is under way, or by the next one.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import bpy
from bpy.app.handlers import persistent

from .. import body, bridge, changes, motion, worker
from ..engine import pe
from . import against, background, latest
from .asking import EvaluatorStore, ScoreWish, priors, read
from .reference import Baseline, Moves, ReadRig, rig_key

VEHICLE_MOVES = "The vehicle changes: measured again when it rests"


class Seen(NamedTuple):
    """How often things had moved, the vehicle's version, and what the prior depends on."""

    moves: int
    version: int
    prior: Hashable


MOVING = "TRANSFORM_OT_"
"""How the names of Blender's operators begin that move things."""

_evaluators = EvaluatorStore()
_moves = Moves()
_last: dict[str, tuple[pe.Rig, Hashable]] = {}
"""By the scene's name: the rig that was read last, and what tells its problem from others."""
_seen: dict[str, Seen] = {}
"""By the scene's name: what there was when it was read."""
_generation = 0
"""Rises when nothing that is under way may be shown any more."""


@persistent
def follow(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: ask for a draft where a sensor has moved."""
    if bpy.app.background or not scene.perception_entropy.live.on:
        return
    seen = _seen.get(scene.name)
    if seen is None or seen.moves == motion.count():
        return
    if seen.version != body.shared.version:
        if operator := _moving_operator():  # the vehicle is dragged; an undo is no move
            _moves.note(scene.name, operator, _last_read(scene.name), None)
        latest.note_request(scene.name)
        latest.set_note(scene.name, VEHICLE_MOVES)
        return
    ask(scene, depsgraph, draft=True)


def rest() -> None:
    """All rests: ask for the exact score of every scene that is shown."""
    if not _moving_operator():
        _moves.end()
    for scene in shown_scenes():
        depsgraph = bridge.view_layer_of(scene).depsgraph
        if depsgraph is not None:
            ask(scene, depsgraph, draft=False)


def ask(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, draft: bool) -> None:
    """Read a scene, and have it scored beside the window."""
    name = scene.name
    last, number = _last_read(name), latest.note_request(name)
    try:
        wish = read(scene, depsgraph, draft=draft)
    except pe.InputError as error:
        say(name, str(error))
        return
    if draft:
        _moves.note(name, _moving_operator(), last, wish.rig)
    seen, known = Seen(motion.count(), body.shared.version, wish.prior_key), _seen.get(name)
    if known is not None and known.prior != seen.prior:
        _moves.drop(name)  # entropies under two priors are no change
    _seen[name], _last[name] = seen, (wish.rig, wish.problem.key)
    reference = against.reference_of(scene, wish, _moves)
    job = partial(work, name, wish, number, reference, _generation)
    worker.hand.ask(name, job, lambda _: changes.reading.tell(), partial(failed, name))
    if not draft:
        background.ask(scene, wish, reference)


def work(
    name: str, wish: ScoreWish, number: int, reference: Baseline | None, generation: int
) -> None:
    """In the thread: score, and put what was found where the next drawing looks."""
    exact = not wish.draft
    if exact and reference is not None and reference.glance is None and reference.rig is not None:
        reference.glance, _ = _evaluators.glance(name, replace(wish, rig=reference.rig))
    glance, moved_m = _evaluators.glance(name, wish)
    if generation == _generation:
        of = wish.rig, moved_m, number, wish.problem.key
        reading = latest.Reading(glance, reference, exact, *of)
        latest.note_reading(name, reading)


def failed(name: str, error: Exception) -> None:
    """Say what was wrong; a mistake of ours is Blender's to tell as well."""
    say(name, str(error) if isinstance(error, pe.InputError) else f"Not scored: {error!r}")
    if not isinstance(error, (pe.InputError, MemoryError)):
        raise error


def say(name: str, line: str) -> None:
    """Show why there is no newer reading."""
    drop(name)
    latest.set_note(name, line)
    changes.reading.tell()


def drop(name: str) -> None:
    """Have nothing shown any more of what was asked of a scene."""
    global _generation
    _generation += 1
    worker.hand.drop(name)


def switched() -> None:
    """The switch was used: begin where it is on, forget where it is off."""
    for scene in bpy.data.scenes:
        if not scene.perception_entropy.live.on:
            drop(scene.name)
            latest.forget_reading(scene.name)
            background.drop(scene.name)
            _seen.pop(scene.name, None)
            _last.pop(scene.name, None)
            _moves.drop(scene.name)
    if not bpy.app.background:
        rest()
    changes.reading.tell()


def shown_scenes() -> list[bpy.types.Scene]:
    """Scenes that some window shows and that are live."""
    windows = (w for manager in bpy.data.window_managers for w in manager.windows)
    shown = {window.scene.name: window.scene for window in windows}
    return [scene for scene in shown.values() if scene.perception_entropy.live.on]


def look_at_settings() -> None:
    """What the 3D view shows may be set for another height or class: so are the figures."""
    if not bpy.app.background:
        for scene in shown_scenes():
            background.ask_again(scene)


@persistent
def forget(*_: object) -> None:
    """Before another file comes: nothing of this one is kept or delivered."""
    for name in tuple(_seen):
        drop(name)
    for each in (_moves, _seen, _last):
        each.clear()
    priors.clear()
    against.forget()
    background.forget()
    latest.forget()


def _last_read(name: str) -> ReadRig | None:
    """Return the rig that was read last, and its exact score where that is there already."""
    if name not in _last:
        return None
    (rig, problem), exact = _last[name], latest.exact(name)
    known = exact is not None and exact.problem == problem and rig_key(exact.rig) == rig_key(rig)
    return ReadRig(rig, exact.glance if known else None)


def _moving_operator() -> int:
    """Which operator moves things with the mouse, by a number of its own; 0 when there is none."""
    windows = (w for manager in bpy.data.window_managers for w in manager.windows)
    running = (each for window in windows for each in window.modal_operators)
    return next((o.as_pointer() for o in running if o.bl_idname.startswith(MOVING)), 0)


def register() -> None:
    """Start listening; what moves is noted before it is followed."""
    bpy.app.handlers.depsgraph_update_post.append(follow)
    bpy.app.handlers.load_pre.append(forget)
    changes.rested.connect(rest)
    changes.live.connect(switched)
    changes.picture.connect(look_at_settings)


def unregister() -> None:
    """Stop listening and forget everything; the thread has ended."""
    changes.picture.disconnect(look_at_settings)
    changes.live.disconnect(switched)
    changes.rested.disconnect(rest)
    bpy.app.handlers.load_pre.remove(forget)
    bpy.app.handlers.depsgraph_update_post.remove(follow)
    forget()
    _evaluators.clear()
