"""What the sensors see of the test bodies of each scene: asked again while one of them moves.

As with `location_query`, answers are kept here and not in a property.
"""

import contextlib

import bpy
from mathutils import Vector

from .. import document
from ..caches import sensor_cache, vehicle_cache
from ..choices import NO_BODY
from ..engine import advice, graphics, pe, requirements
from ..processes import analysis_calls, engine_process
from ..view import viewport

TOPIC = f"{engine_process.OVERLAY}test bodies"
"""As a layer of the view: what has been found is taken before the view is drawn."""
PLACE_DIGITS = 5
HEADING_DIGITS = 4
SEEN = graphics.with_alpha(graphics.VIEWPORT.words, 1.0)
UNSEEN = graphics.with_alpha(graphics.VIEWPORT.occluded, 1.0)

_seen: dict[str, dict[str, advice.BodySight]] = {}
"""By the scene's and the object's name."""


def standing(scene: bpy.types.Scene) -> dict[str, advice.StandingBody]:
    """Return the visible test bodies of a scene by the name of their object."""
    found = {}
    for obj in scene.objects:
        kind = obj.perception_entropy.body
        if kind in requirements.BODIES and obj.visible_get():
            x, y, heading = document.body_place(obj)
            place = round(x, PLACE_DIGITS), round(y, PLACE_DIGITS)
            with contextlib.suppress(pe.InputError):  # out of this world
                heading = round(heading, HEADING_DIGITS)
                found[obj.name] = advice.StandingBody(kind, place, heading)
    return found


def query(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Ask what the sensors see of the bodies; the answer is delivered when it is there."""
    name = scene.name
    bodies = standing(scene)
    sensors = document.possible_sensors(sensor_cache.sensors(scene), depsgraph) if bodies else []
    if not sensors:
        engine_process.drop(TOPIC)
        _seen.pop(name, None)
        return
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle

    def deliver(found: tuple[advice.BodySight, ...]) -> None:
        _seen[name] = dict(zip(bodies, found, strict=True))
        viewport.redraw_editors()

    def fail(_error: Exception) -> None:  # a score says what is wrong
        _seen.pop(name, None)

    with contextlib.suppress(pe.InputError):
        model = document.document_of(scene.perception_entropy, *document.SCORED_PARTS).perception
        given = pe.Rig(sensors), vehicle, tuple(bodies.values()), model
        engine_process.ask(
            TOPIC,
            analysis_calls.bodies_seen,
            given,
            deliver,
            fail=fail,
            lane=engine_process.FOLLOWS_MOUSE,
        )


def seen(scene: bpy.types.Scene) -> dict[str, advice.BodySight]:
    """Return what the sensors see of the bodies that are still there, by the object's name."""
    found = _seen.get(scene.name, {})
    return {name: each for name, each in found.items() if name in scene.objects}


def labels(scene: bpy.types.Scene, active: bpy.types.Object | None) -> list[graphics.Tag]:
    """Return a label for each visible body: a line, of the active one all sensors."""
    found = []
    for name, body in seen(scene).items():
        obj = scene.objects[name]
        if not obj.visible_get():
            continue
        lines = [f"{each.name}: {each.text}" for each in body.seeing] if obj == active else []
        text = "\n".join([f"{name}: {body.summary}", *lines])
        x, y, _ = document.body_place(obj)
        top = max((obj.matrix_world @ corner).z for corner in map(Vector, obj.bound_box))
        color = SEEN if body.seeing else UNSEEN
        found.append(graphics.Tag(text, (x, y, top), color, strong=obj == active))
    return found


def note_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: ask again where a test body moved."""
    for update in depsgraph.updates:
        obj = update.id.original
        if isinstance(obj, bpy.types.Object) and obj.perception_entropy.body != NO_BODY:
            schedule()
            return


def schedule(*_: object) -> None:
    """Ask again as soon as a timer's turn comes; several calls become one question."""
    if not bpy.app.background and not bpy.app.timers.is_registered(_query_now):
        bpy.app.timers.register(_query_now, first_interval=0.0)


def _query_now() -> None:
    query(bpy.context.scene, bpy.context.evaluated_depsgraph_get())


def clear(*_: object) -> None:
    """Drop all answers, and what is due: another file is opened, or the add-on disabled."""
    if bpy.app.timers.is_registered(_query_now):
        bpy.app.timers.unregister(_query_now)
    engine_process.drop(TOPIC)
    _seen.clear()
