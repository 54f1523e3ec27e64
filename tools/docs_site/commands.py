"""The page of the command ``pe``: every verb with its arguments, from its parser."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from pe_tools.cli.verbs import parser

PATH = "reference/commands.md"
HEAD = """# The command `pe`

Every verb with its arguments, generated from the parser of the command (`pe VERB --help` prints
the same). Exit statuses and the files that a run writes: [results.md](../results.md). How to begin:
[command_line.md](../command_line.md).

"""


def page() -> str:
    """Return the whole page."""
    verbs = list(verbs_of(parser()))
    table = [f"| [`pe {name}`](#pe-{name}) | {_cell(about)} |\n" for name, about, _ in verbs]
    sections = [section(name, about, verb) for name, about, verb in verbs]
    return HEAD + "| verb | what it does |\n| --- | --- |\n" + "".join([*table, *sections])


def verbs_of(top: argparse.ArgumentParser) -> Iterator[tuple[str, str, argparse.ArgumentParser]]:
    """Yield name, meaning and parser of each verb."""
    (action,) = (a for a in top._actions if isinstance(a, argparse._SubParsersAction))
    about = {choice.dest: choice.help or "" for choice in action._choices_actions}
    for name, verb in action.choices.items():
        yield name, about.get(name, ""), verb


def section(name: str, about: str, verb: argparse.ArgumentParser) -> str:
    """Return the section of a verb: its usage, its arguments and options."""
    usage = " ".join(verb.format_usage().removeprefix("usage:").split())
    usage = re.sub(r"^.*?\bpe " + name, f"pe {name}", usage)
    rows = [row(action) for action in verb._actions if action.help != argparse.SUPPRESS]
    table = "| argument | meaning | default |\n| --- | --- | --- |\n" + "".join(rows)
    about = about[:1].upper() + about[1:]
    return f"\n## pe {name}\n\n{about}.\n\n```\n{usage}\n```\n\n{table}"


def row(action: argparse.Action) -> str:
    """Return the row of an argument or option."""
    value = f" {_metavar(action)}" if action.nargs != 0 and action.option_strings else ""
    names = action.option_strings or [_metavar(action)]
    shown = ", ".join(f"`{name}{value}`" for name in names)
    about = (action.help or "") % {**vars(action), "prog": "pe"}
    allowed = "" if action.choices is None or action.metavar is None else _choices(action, about)
    default = action.default
    unsaid = default is None or default is False or default == argparse.SUPPRESS or default == []
    return f"| {shown} | {_cell(about)}{allowed} | {'' if unsaid else f'`{default}`'} |\n"


def _choices(action: argparse.Action, about: str) -> str:
    names = [str(choice) for choice in action.choices or ()]
    return "" if all(name in about for name in names) else f" ({_cell(', '.join(names))})"


def _metavar(action: argparse.Action) -> str:
    if isinstance(action.metavar, tuple):
        return " ".join(action.metavar)
    if action.metavar is None and action.choices is not None:
        return "{" + ",".join(map(str, action.choices)) + "}"
    return action.metavar or action.dest.upper()


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
