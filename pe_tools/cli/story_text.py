"""Stories of what moves round the vehicle: those that are named, and when tracks are confirmed."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes
from pe_core.base.table_reader import load_toml
from pe_core.base.values import choice
from pe_core.motion import DriveBy, SeenBody, Story, stories
from pe_core.scoring.sight import shown_end, shown_start
from pe_core.study import Node, Study, read

from ..wording import aligned

ALL = "all"
TOML = ".toml"


@dataclass(frozen=True)
class StoryFile:
    """A file of stories."""

    story: tuple[Story, ...]


def story_names(text: str | None) -> list[str]:
    """Return the names of the option ``--stories``: none where it is left out, or has none."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def chosen_stories(study: Study, names: Sequence[str]) -> list[Story]:
    """Return stories by name or from files; without names the study's own. `InputError` for none,
    and for a name that no story has."""
    known = {**stories(), **{story.name: story for story in study.stories}}
    chosen: dict[str, Story] = {} if names else {story.name: story for story in study.stories}
    for name in names:
        if name == ALL:
            chosen |= stories()
        elif name.endswith(TOML):
            tables = load_toml(name, "stories", decode_text(read_bytes(Path(name))))
            chosen |= {story.name: story for story in read(StoryFile, Node(tables, name)).story}
        else:
            chosen[name] = known[choice("check", "--stories", name, tuple(known))]
    if not chosen:
        expected = "[[story]] in the study, or --stories NAME (--list lists them)"
        raise InputError("check", "stories", expected, "none")
    return list(chosen.values())


def story_lines(driven: Sequence[DriveBy]) -> list[str]:
    """Return stories as a table: a row for each watched body."""
    bodies = [body for each in driven for body in each.bodies]
    chances = sorted({chance for body in bodies for chance in body.moments})
    head = ["", "story", "body", *(f"confirmed {c:.0%}" for c in chances), "lost", "margin"]
    head += ["stops in"]
    rows = [[*_row(each, body, chances)] for each in driven for body in each.bodies]
    met = sum(each.is_met for each in driven)
    return [*aligned([head, *rows]), f"{met} of {len(driven)} stories confirmed in time"]


def _row(driven: DriveBy, body: SeenBody, chances: Sequence[float]) -> list[str]:
    texts = [
        "never" if m is None else f"{shown_end(m.time_s):+.1f} s, {shown_start(m.distance_m):.1f} m"
        for m in map(body.moments.get, chances)
    ]
    margin = "-" if body.margin_s is None else f"{body.shown_margin_s:+.1f} s"
    met = "met" if body.is_met else "NOT MET"
    lost = f"{shown_end(body.lost_s):.1f} s"
    stop = f"{shown_end(driven.story.stop_m):.1f} m"
    return [met, driven.story.name, body.name, *texts, lost, margin, stop]
