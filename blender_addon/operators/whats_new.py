"""What is new: shown once after an update, from the changelog."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import Any

import bpy

from ..engine import pe
from ..language import shown
from ..library import mark_seen
from .declared import OperatorResult, operator

PLACES = [folder / "CHANGELOG.md" for folder in Path(__file__).resolve().parents[1:3]]
"""The changelog in the extension, or in a checkout of the project."""
WIDTH_PX, MAX_COLUMNS = 560, 84


def news() -> list[str]:
    """Return title and first sentence of each paragraph or item of the newest section."""
    changelog = next(filter(Path.is_file, PLACES)).read_text("utf-8")
    newest = re.split(r"^## .*\n", changelog, flags=re.MULTILINE)[1]
    without_links = re.sub(r"\s\([\s,]*\)", "", re.sub(r"\[[^]]*\]\([^)]*\)|`", "", newest))
    items = (" ".join(each.split()) for each in re.split(r"\n\n|^- ", without_links, flags=re.M))
    found = (re.match(r"(?:\*\*(.+?)\.?\*\* )?(.+?)\.(?= |$)", each) for each in items)
    return [": ".join(filter(None, match.groups())) for match in found if match]


def _show(self: Any, context: bpy.types.Context, _event: object) -> OperatorResult:
    mark_seen()
    return context.window_manager.invoke_popup(self, width=WIDTH_PX)


def _draw(self: Any, _context: bpy.types.Context) -> None:
    column = self.layout.column(align=True)
    column.label(text=f"{shown(self.bl_label)}: {pe.__version__}", translate=False)
    for sentence in news():
        for k, line in enumerate(textwrap.wrap(sentence, MAX_COLUMNS)):
            column.label(text=line, icon="BLANK1" if k else "DOT", translate=False)


@operator("What's New", options=frozenset(), invoke=_show, draw=_draw)
def whats_new(_context: bpy.types.Context) -> None:
    """Show what has changed in this version of the extension"""
    mark_seen()
