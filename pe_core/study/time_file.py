"""The tables [time] and [[story]] of a study: frames, tracks, and stories of what moves."""

from collections.abc import Mapping, Sequence
from typing import Any

from ..base.setting import changed_settings, read_settings, settings_of
from ..base.table_reader import Table, dump_json, parse_json
from ..base.values import degrees_in_file
from ..metric.frames import Frames
from ..motion import Actor, Confirmation, Story, read_story, stories
from ..scoring.requirements.bodies import BODIES

BY_NAME = ("noises", "rates")


def read_time(table: Table) -> tuple[Frames, Confirmation]:
    """Return the frames of the entropy over frames, and how tracks are confirmed."""
    own = {key: table.table(key) for key in BY_NAME}
    mappings: Any = {key: {name: t.number(name) for name in t.names} for key, t in own.items()}
    frames, rule = read_settings(table, Frames), read_settings(table, Confirmation)
    table.finish()
    with table.naming():
        return Frames(**frames, **mappings), Confirmation(**rule)


def time_table(frames: Frames, confirmation: Confirmation) -> dict[str, Any]:
    """Return the table [time] without what has its default."""
    mappings = {key: dict(getattr(frames, key)) for key in BY_NAME if getattr(frames, key)}
    return changed_settings(frames) | changed_settings(confirmation) | mappings


def by_name_text(frames: Frames) -> str:
    """Return noises and rates by name as JSON text, as a scene keeps them; empty without any."""
    kept = {key: dict(own) for key in BY_NAME if (own := getattr(frames, key))}
    return dump_json(kept) if kept else ""


def by_name_of_text(text: str, source: str) -> dict[str, Any]:
    """Read the text of `by_name_text`, or raise `InputError`."""
    table = Table(parse_json(source, text, infinite=True) if text else {}, source)
    frames, _ = read_time(table)
    return {key: dict(getattr(frames, key)) for key in BY_NAME}


def read_stories(tables: Sequence[Table]) -> tuple[Story, ...]:
    """Return the stories of a study, of different names."""
    read: list[Story] = []
    for table in tables:
        name = table.text("name", table.text("preset", None))
        if name is None:
            raise table.error("name", "a name, or a preset", "none")
        if any(name == each.name for each in read):
            raise table.error("name", "another name than the stories before", name)
        read.append(read_story(table, name))
    return tuple(read)


def stories_of_rows(rows: Sequence[Mapping[str, Any]], source: str) -> tuple[Story, ...]:
    """Return stories from their tables, as a scene keeps them; `InputError` as `read_stories`."""
    return read_stories(Table({"story": list(rows)}, source).tables("story"))


def story_table(story: Story) -> dict[str, Any]:
    """Return the table of a story; of a shipped one its name alone, and what was changed."""
    shipped = stories().get(story.preset)
    if shipped is None:
        actors = [_actor_table(actor) for actor in story.actors]
        texts = {"title": story.title or None, "source": story.source or None}
        return {"name": story.name, **texts, **changed_settings(story), "body": actors}
    changed = [n for n in settings_of(Story) if getattr(story, n) != getattr(shipped, n)]
    name = {} if story.name == story.preset else {"name": story.name}
    values = {n: getattr(story, n) for n in changed}
    return {**name, "preset": story.preset, **values}


def _actor_table(actor: Actor) -> dict[str, Any]:
    body = actor.body
    own = {} if body.name in BODIES else {"size": list(body.size), "class": body.class_name}
    return {
        "name": actor.name,
        "body": body.name,
        **own,
        "path": [list(row) for row in actor.path],
        "watched": None if actor.watched else False,
        "heading_deg": degrees_in_file(actor.heading) if actor.heading else None,
    }
