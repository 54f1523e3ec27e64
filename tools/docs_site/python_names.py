"""Pages of the Python names that ``pe_core`` and ``pe_tools`` show, by the room of each."""

from __future__ import annotations

import functools
import re
import types
from collections.abc import Iterator
from pathlib import Path

import pe_core as pe
import pe_tools as pt

FOLDER = "reference/python"
EXAMPLES = Path(__file__).with_name("names_by_example.txt")
ROOMS = {
    "pe_core.study": ("study", "Studies", "Everything that a run needs, and its file."),
    "pe_core.scene": (
        "scene",
        "Rig and vehicle",
        "Sensors with their poses, vehicle, space, objects.",
    ),
    "pe_core.geometry": ("scene", "Rig and vehicle", ""),
    "pe_core.sensors": ("sensors", "Sensors", "Models of sensors, and the definition of m."),
    "pe_core.catalog": ("catalog", "Catalogue", "Presets of sensors, and known rigs."),
    "pe_core.prior": ("prior", "Prior", "Where objects are expected."),
    "pe_core.metric": ("scoring", "Scores", "Evaluators, scores, AP curves and requirements."),
    "pe_core.scoring": ("scoring", "Scores", ""),
    "pe_core.search": ("search", "Search", "Searches, mounts, constraints and choices of sensors."),
    "pe_core.base": ("study", "Studies", ""),
    "pe_tools": ("tools", "Files, jobs, words", "What stands around the engine."),
}
"""The page of each room, by the longest beginning of a module's name."""


def pages() -> dict[str, str]:
    """Return the text of each page, by its path in the site."""
    texts = {}
    heads = {}
    for name, target in public_names():
        room = max((r for r in ROOMS if target.startswith(r)), key=len)
        page, title, about = ROOMS[room]
        heads.setdefault(page, [title, ""])[1] = heads.get(page, ["", ""])[1] or about
        texts.setdefault(page, []).append((name, entry(name, target)))
    made = {}
    for page, (title, about) in heads.items():
        entries = "".join(text for _, text in sorted(texts[page]))
        made[f"{FOLDER}/{page}.md"] = f"# {title}\n\n{about}\n\n{entries}"
    return {f"{FOLDER}/index.md": index(heads, texts), **made}


def public_names() -> Iterator[tuple[str, str]]:
    """Yield the name of each public class, function and module, and where it is defined."""
    for short, package in (("pe", pe), ("pt", pt)):
        for name in package.__all__:
            value = getattr(package, name)
            if isinstance(value, types.ModuleType):
                yield f"{short}.{name}", value.__name__
            elif callable(value):
                yield f"{short}.{name}", f"{value.__module__}.{value.__qualname__}"


def entry(name: str, target: str) -> str:
    """Return a name's part of its page: as mkdocstrings takes it, and its example."""
    head = f"::: {target}\n    options:\n      heading: {name}\n      toc_label: {name}\n\n"
    return f"{head}{examples().get(name, '')}\n"


@functools.cache
def examples() -> dict[str, str]:
    """Return the example of each name, a block of a session."""
    text = EXAMPLES.read_text("utf-8")
    return dict(re.findall(r"^### (\S+)\n\n(```pycon\n.*?```\n)", text, re.M | re.S))


def index(heads: dict[str, list[str]], texts: dict[str, list[tuple[str, str]]]) -> str:
    """Return the first page: all names by page."""
    rows = []
    for page, (title, about) in heads.items():
        names = ", ".join(f"`{name}`" for name, _ in sorted(texts[page]))
        rows.append(f"## [{title}]({page}.md)\n\n{about}\n\n{names}\n\n")
    return (
        "# Python names\n\nWhat `import pe_core as pe` and `import pe_tools as pt` show, generated"
        " from the docstrings. These names stay; what lies deeper may change with any"
        " version. How to begin: [python.md](../../python.md).\n\n" + "".join(rows)
    )
