"""Time in a scene: frames, how tracks are confirmed, and stories, a row each."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from bpy.types import Object, PropertyGroup, Scene
from mathutils import Vector

from ..engine import motion, pe, studies, text
from .scene_settings import values_of, write_values

BY_NAME = ("noises", "rates")


def time_of(settings: PropertyGroup) -> dict[str, Any]:
    """Return the fields of a study in time that a scene holds, by name. `InputError` when a value
    or a row is wrong, or names repeat."""
    by_name = by_name_of(settings)
    rows = [_table_of(row) for row in settings.stories if row.enabled]
    return {
        "frames": motion.Frames(**values_of(settings, motion.Frames), **by_name),
        "confirmation": confirmation_of(settings),
        "stories": tuple(_read_story(row) for row in rows),
    }


def confirmation_of(settings: PropertyGroup) -> motion.Confirmation:
    """Return how tracks are confirmed."""
    return motion.Confirmation(**values_of(settings, motion.Confirmation))


def story_of(row: PropertyGroup) -> motion.Story:
    """Return the story of a row; `InputError` when a value is wrong."""
    return _read_story(_table_of(row))


def _read_story(table: Mapping[str, Any]) -> motion.Story:
    return studies.read(motion.Story, studies.Node(table, "scene", "story"))


def by_name_of(settings: PropertyGroup) -> dict[str, Any]:
    """Return noises by class and rates by kind of sensor; `InputError` where the text is wrong."""
    kept = text.parse_json("scene", settings.time_text, infinite=True) if settings.time_text else {}
    frames = studies.read(motion.Frames, studies.Node(kept, "scene", "time"))
    return {key: dict(getattr(frames, key)) for key in BY_NAME}


def write_time(
    settings: PropertyGroup,
    frames: motion.Frames,
    confirmation: motion.Confirmation,
    stories: Sequence[motion.Story],
) -> None:
    """Write them to a scene, in place of its own."""
    write_values(settings, frames)
    write_values(settings, confirmation)
    by_name = {key: dict(own) for key in BY_NAME if (own := getattr(frames, key))}
    settings.time_text = text.dump_json(by_name) if by_name else ""
    settings.stories.clear()
    for story in stories:
        write_story(settings.stories.add(), story)


def write_story(row: PropertyGroup, story: motion.Story) -> None:
    """Write a story to a row: its fields, and as JSON what these do not have."""
    row.name = story.name
    row.result = ""
    write_values(row, story)
    row.table = json.dumps(studies.write(story))


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
    rule = f"{values_of(settings, motion.Confirmation)!r} {settings.time_text}"
    return {
        row.name: f"{scene} {rule} {row.table} {values_of(row, motion.Story)!r}"
        for row in settings.stories
    }


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


def _table_of(row: PropertyGroup) -> dict[str, Any]:
    try:
        table = json.loads(row.table or "{}")
    except ValueError:
        raise pe.InputError("scene", f"story {row.name!r}", "its table", "other text") from None
    return {**table, **values_of(row, motion.Story), "name": row.name}
