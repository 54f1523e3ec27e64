"""What would fix it: for a blind place, or a requirement that is not met; and taking it."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import FloatVectorProperty, IntProperty, StringProperty

from .. import document
from ..engine import jobs, pe
from ..queries import where_map
from .add_sensor import select_only
from .declared import INTERNAL, OperatorResult, Refused, operator
from .jobs import JobRow, Task, begin, of_study
from .where import put

NOTHING = "Nothing to fix: what is 0.5 m tall is seen there"
MET = "Nothing to fix: the requirement is met"
NONE_FOUND = "No move of one sensor, and no added one that was tried, is enough"


@operator(
    "What Would Fix It?",
    mode="Sensors are placed in Object Mode",
    unless=lambda context: (
        None if document.sensor_objects(context.scene) else "There are no sensors yet"
    ),
    options=INTERNAL,
    requirement=StringProperty(name="Requirement", description="Its name; empty: the location"),
    point=FloatVectorProperty(
        name="Location", description="x, y and z of a place on the ground", subtype="XYZ"
    ),
)
def suggest(
    _context: bpy.types.Context, requirement: str, point: tuple[float, ...]
) -> OperatorResult:
    """Find the smallest move of a sensor, and one more sensor, that would make it visible there"""
    return begin(SUGGESTIONS, of=requirement or tuple(point))


def _task(_scene: bpy.types.Scene, study: pe.Study, _taken: document.Fingerprint) -> Task:
    of = SUGGESTIONS.asked["of"]
    given: dict[str, Any] = {"names": (of,)} if isinstance(of, str) else {"spot": of[:2]}

    def finish(scene: bpy.types.Scene, found: dict[str, list[Any]]) -> str:
        every = tuple(each for own in found.values() for each in own)
        where_map.store_offers(scene.name, where_map.Repairs(of, every) if found else None)
        if not found:
            return MET if isinstance(of, str) else NOTHING
        return every[0].sentence if every else NONE_FOUND

    return Task(jobs.SuggestJob(study, **given), finish, "found")


SUGGESTIONS = JobRow(read=of_study(_task), unfinished="Stopped before anything was found")


@operator(
    "Take",
    mode="Sensors are placed in Object Mode",
    unless=lambda context: None if where_map.offers.get(context.scene.name) else "",
    number=IntProperty(name="Number", description="Which of the suggestions", min=0),
)
def take_suggestion(context: bpy.types.Context, number: int) -> str:
    """Do what is suggested: the sensor is moved there, or added"""
    scene = context.scene
    found = where_map.offers[scene.name].found
    if number >= len(found):
        raise Refused("There is no such suggestion")
    chosen = found[number]
    if chosen.added:
        put(context, chosen.rig[chosen.moved[0]])
    else:
        document.place_rig(scene, chosen.rig, chosen.start)
        select_only(context, scene.objects[chosen.moved[0]])
    where_map.store_offers(scene.name, None)
    return chosen.sentence
