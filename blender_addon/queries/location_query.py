"""The location that was queried last in each scene, and the answer: which sensors see it, and why.

It is kept here and not in a property: an answer is not part of the user's work. When the scene is
idle after a change, the location is queried again.
"""

from typing import NamedTuple

import bpy

from .. import document, signals
from ..caches import sensor_cache, vehicle_cache
from ..engine import advice, pe
from ..processes import engine_process

TOPIC = "place"
QueriedPoint = tuple[float, float, float]


class LocationAnswer(NamedTuple):
    """A point [m], and lines of text; `place` is None where there is no answer but an error."""

    point: QueriedPoint
    lines: tuple[str, ...]
    place: advice.AskedPlace | None = None


_answers: dict[str, LocationAnswer] = {}
"""By the scene's name."""


def query(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, point: QueriedPoint) -> None:
    """Query which sensors see a point; the answer is delivered when it is there."""
    name = scene.name
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    sensors = document.possible_sensors(sensor_cache.sensors(scene), depsgraph)
    settings = scene.perception_entropy
    try:
        scored = document.document_of(settings, *document.SCORED_PARTS)
        space = scored.space
        model = scored.perception
        prior = document.prior_from_scene(scene)
        rig = pe.Rig(sensors)
    except pe.InputError as error:
        store_answer(name, LocationAnswer(point, (str(error),)))
        return

    def deliver(place: advice.AskedPlace) -> None:
        store_answer(name, LocationAnswer(point, place.text, place))

    def fail(error: Exception) -> None:
        store_answer(name, LocationAnswer(point, (str(error),)))

    given = rig, space, prior, vehicle, point, model
    engine_process.ask(TOPIC, advice.ask_place, given, deliver, fail=fail)


def store_answer(scene_name: str, answer: LocationAnswer) -> None:
    """Store an answer, and have it shown."""
    _answers[scene_name] = answer
    signals.view_changed.emit()


def answer(scene: bpy.types.Scene) -> LocationAnswer | None:
    """Return the answer of the last query; None where there was none."""
    return _answers.get(scene.name)


def discard(scene: bpy.types.Scene) -> None:
    """Discard the query and its answer."""
    engine_process.drop(TOPIC)
    if _answers.pop(scene.name, None) is not None:
        signals.view_changed.emit()


def query_again() -> None:
    """Query the location again: the scene has changed, and is idle."""
    scene = bpy.context.scene
    if scene.name in _answers:
        query(scene, bpy.context.evaluated_depsgraph_get(), _answers[scene.name].point)


def clear(*_: object) -> None:
    """Discard all queries: another file is opened, whose scenes may have the same names."""
    engine_process.drop(TOPIC)
    _answers.clear()
