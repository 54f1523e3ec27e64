"""`pe drive-by`: stories of what moves round the vehicle, and when its tracks are confirmed."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes
from pe_core.base.table_reader import load_toml
from pe_core.base.values import choice
from pe_core.motion import DriveBy, SeenBody, Story, stories
from pe_core.scoring.sight import shown_end, shown_start
from pe_core.study import Node, Study, load_study, read

from ..wording import aligned
from .run_job import output_file, print_vehicle, save_text
from .terminal import DONE, NOT_MET, Answer

ALL = "all"
TOML = ".toml"


@dataclass(frozen=True)
class StoryFile:
    """A file of stories."""

    story: tuple[Story, ...]


def add_drive_by_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``drive-by`` to a parser."""
    about = "a story of the study, a shipped one, or a TOML file with [[story]]; all: each shipped"
    parser.add_argument("--story", action="append", default=[], metavar="NAME", help=about)
    parser.add_argument("--json", action="store_true", help="print JSON, with AP frame by frame")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the JSON to a file")
    parser.add_argument("--replace", action="store_true", help="replace a file that is there")


def add_list_option(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``drive-by`` for study files."""
    add_drive_by_options(parser)
    parser.add_argument("--list", action="store_true", help="list the shipped stories")


def drive_by(args: argparse.Namespace) -> Answer:
    """Drive the stories of a study file by its rig; the exit status says whether all are met."""
    if args.list:
        return "\n".join(aligned([[n, s.title, s.source] for n, s in stories().items()])), DONE
    if args.study is None:
        args.usage_error("expected STUDY, or --list")
    return drive_by_study(load_study(args.study), args)


def drive_by_study(study: Study, args: argparse.Namespace) -> Answer:
    """Drive stories by a study's rig: those that are named, else the study's own."""
    chosen = chosen_stories(study, args.story)
    output = output_file(args.output, args)
    print_vehicle(study)
    driven = [study.drive_by(story) for story in chosen]
    met = all(each.is_met for each in driven)
    text = dump_json({"met": met, "stories": [each.to_dict() for each in driven]})
    status = save_text(output, text) or (DONE if met else NOT_MET)
    return text if args.json else "\n".join(story_lines(driven)), status


def chosen_stories(study: Study, names: Sequence[str]) -> list[Story]:
    """Return stories by name or from files; without names the study's own."""
    known = {**stories(), **{story.name: story for story in study.stories}}
    chosen: dict[str, Story] = {} if names else {story.name: story for story in study.stories}
    for name in names:
        if name == ALL:
            chosen |= stories()
        elif name.endswith(TOML):
            tables = load_toml(name, "stories", decode_text(read_bytes(Path(name))))
            chosen |= {story.name: story for story in read(StoryFile, Node(tables, name)).story}
        else:
            chosen[name] = known[choice("drive-by", "--story", name, tuple(known))]
    if not chosen:
        expected = "[[story]] in the study, or --story NAME (--list lists them)"
        raise InputError("drive-by", "story", expected, "none")
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
    lost, stop = f"{shown_end(body.lost_s):.1f} s", f"{shown_end(driven.story.stop_m):.1f} m"
    return [met, driven.story.name, body.name, *texts, lost, margin, stop]
