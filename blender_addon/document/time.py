"""Time in a scene: frames, how tracks are confirmed, and stories, a row each."""

import json
import math
from collections.abc import Mapping, Sequence

from bpy.types import Object, PropertyGroup, Scene
from mathutils import Vector

from ..engine import motion, studies
from .study_table import read_row, store_row, value_at


def stories_of(settings: PropertyGroup) -> tuple[motion.Story, ...]:
    """Return the stories of a scene that are switched on. `InputError` when a value is wrong."""
    return tuple(story_of(row) for row in settings.stories if row.enabled)


def story_of(row: PropertyGroup) -> motion.Story:
    """Return the story of a row; `InputError` when a value is wrong."""
    return read_row(motion.Story, row, f"story {row.name!r}", name=row.name)


def write_stories(settings: PropertyGroup, stories: Sequence[motion.Story]) -> None:
    """Write stories to a scene, in place of its own."""
    settings.stories.clear()
    for story in stories:
        write_story(settings.stories.add(), story)


def write_story(row: PropertyGroup, story: motion.Story) -> None:
    """Write a story to a row; what its preset has, too, as it is changed there."""
    row.result = ""
    declared = studies.settings_of(motion.Story)
    store_row(row, story, name=story.name, **{name: getattr(story, name) for name in declared})


def frame_rate(scene: Scene) -> float:
    """Return how many frames of a scene a second has [Hz]."""
    return scene.render.fps / scene.render.fps_base


def body_place(obj: Object) -> tuple[float, float, float]:
    """Return x and y of the middle of a test body [m], and its heading [deg]."""
    matrix = obj.matrix_world
    x, y, _ = matrix @ (sum(map(Vector, obj.bound_box), Vector()) / 8.0)
    return x, y, math.degrees(matrix.to_euler().z)


def story_signatures(settings: PropertyGroup, scene: str) -> dict[str, str]:
    """Return by name what the result of each row depends on; `scene` is the scene's fingerprint."""
    rule = value_at(settings.table, ("time",))
    return {row.name: f"{scene} {rule} {row.table}" for row in settings.stories}


def store_driven(
    settings: PropertyGroup, driven: Sequence[motion.DriveBy], signatures: Mapping[str, str]
) -> None:
    """Store in the rows of stories when their tracks are confirmed; other rows have nothing.
    `signatures` are those of the scene that was driven."""
    found = {each.story.name: each.summary() for each in driven}
    for row in settings.stories:
        data = found.get(row.name)
        row.result = (
            json.dumps(data | {"signature": signatures[row.name]})
            if data and row.name in signatures
            else ""
        )


def clear_stale_stories(settings: PropertyGroup, scene: str) -> bool:
    """Clear the results of stories that are not of the scene any more; return if there was one."""
    now = story_signatures(settings, scene)
    stale = [
        row
        for row in settings.stories
        if row.result and json.loads(row.result)["signature"] != now[row.name]
    ]
    for row in stale:
        row.result = ""
    return bool(stale)
