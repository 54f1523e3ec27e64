"""Time in a scene: frames, how tracks are confirmed, and stories, a row each."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from bpy.types import PropertyGroup

from ..engine import motion, pe, studies
from .rig import scan_of, sensor_objects
from .scene_settings import values_of, write_values


def time_of(settings: PropertyGroup) -> dict[str, Any]:
    """Return the fields of a study in time that a scene holds, by name.

    `InputError` when a value or a row is wrong, or names repeat.
    """
    by_name = studies.by_name_of_text(settings.time_text, "scene")
    rows = [_table_of(row) for row in settings.stories if row.enabled]
    return {
        "frames": motion.Frames(**values_of(settings, motion.Frames), **by_name),
        "confirmation": motion.Confirmation(**values_of(settings, motion.Confirmation)),
        "stories": studies.stories_of_rows(rows, "scene"),
    }


def write_time(
    settings: PropertyGroup,
    frames: motion.Frames,
    confirmation: motion.Confirmation,
    stories: Sequence[motion.Story],
) -> None:
    """Write them to a scene, in place of its own."""
    write_values(settings, frames)
    write_values(settings, confirmation)
    settings.time_text = studies.by_name_text(frames)
    settings.stories.clear()
    for story in stories:
        write_story(settings.stories.add(), story)


def write_story(row: PropertyGroup, story: motion.Story) -> None:
    """Write a story to a row: its fields, and as JSON what these do not have."""
    row.name, row.result = story.name, ""
    write_values(row, story)
    row.table = json.dumps(studies.story_table(story))


def story_signatures(settings: PropertyGroup, scene: str) -> dict[str, str]:
    """Return by name what the result of each row depends on; `scene` is the scene's fingerprint."""
    scans = [scan_of(obj.perception_entropy) for obj in sensor_objects(settings.id_data)]
    rule = f"{values_of(settings, motion.Confirmation)!r} {settings.time_text} {scans!r}"
    return {
        row.name: f"{scene} {rule} {row.table} {values_of(row, motion.Story)!r}"
        for row in settings.stories
    }


def store_driven(
    settings: PropertyGroup, driven: Sequence[motion.DriveBy], signatures: Mapping[str, str]
) -> None:
    """Store in the rows of stories when their tracks are confirmed; other rows have nothing.

    `signatures` are those of the scene that was driven.
    """
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
