"""The score that follows the hand.

`latest` is what is known now, `session` asks for it, `reference` and `against` say what it is
compared with, `shown` which score is shown, `background` works out the figures below it, `words`
and `figure_words` put it into words, `readout` draws those in the corner of the 3D view.
"""

from __future__ import annotations

import bpy

from . import against, background, figure_words, latest, readout, session
from .shown import ShownScore, shown_score

__all__ = ["ShownScore", "against", "latest", "live_lines", "register", "shown_score", "unregister"]


def live_lines(scene: bpy.types.Scene) -> list[str]:
    """Return the lines below a live score, for the panel: those of the read-out."""
    reading, score = latest.reading(scene.name), shown_score(scene)
    if reading is None or score is None:
        return []
    figures = background.figures_of(scene.name, reading, score.exact)
    anchor = background.anchor_of(scene.name)
    lines = [] if figures is None else [*figure_words.figure_lines(figures)]
    lines += [] if anchor is None else [figure_words.anchor_line(anchor, reading.glance)]
    return [line for line in lines if line]


def register() -> None:
    """Start following and drawing."""
    session.register()
    readout.register()


def unregister() -> None:
    """Stop both; the worker has ended before."""
    readout.unregister()
    session.unregister()
