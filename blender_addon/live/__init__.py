"""The live score: it follows every move of a sensor.

`state` holds what is known of each scene, `session` requests scores and says what they are compared
with, `background_figures` requests the figures below them, `readout_text` puts all of it into text,
and `readout` draws that in a corner of the 3D view.
"""

from __future__ import annotations

import bpy

from ..engine import advice
from . import background_figures, readout, sense_icons, session
from .readout_text import (
    BETTER,
    SAME,
    WORSE,
    FigureRow,
    ReadoutLine,
    nats_text,
    rows_of_figures,
    sense_of,
    text_of,
)
from .sense_icons import sense_icon
from .state import FinishedScore, ShownScore, live_state, shown_figures, shown_score

__all__ = ["BETTER", "SAME", "WORSE", "FinishedScore", "ShownScore", "figure_rows", "live_lines"]
__all__ += ["live_state", "nats_text", "register", "sense_icon", "sense_of", "shown_score"]
__all__ += ["text_of", "unregister"]


def figure_rows(scene: bpy.types.Scene, *, live: bool) -> list[FigureRow]:
    """Return rows of key figures for the panel: of the live score, or of the stored result."""
    if live:
        now = shown_figures(scene)
        return rows_of_figures([] if now is None else [now])
    settings = scene.perception_entropy
    of_kind = ("before", "after") if settings.result_kind == "optimize" else ("after",)
    told = [settings.result_figures[which] for which in of_kind if settings.result_figures]
    return rows_of_figures([advice.KeyFigures.from_dict(data) for data in told])


def live_lines(scene: bpy.types.Scene) -> list[ReadoutLine]:
    """Return the lines below a live score, for the panel: those of the read-out."""
    score, shown = live_state(scene.name).score, shown_score(scene)
    if score is None or shown is None:
        return []
    return [line for line, _ in background_figures.lines_below(scene.name, score, shown.exact)]


def register() -> None:
    """Start drawing, and make the icons."""
    readout.register()
    sense_icons.register()


def unregister() -> None:
    """Stop drawing, and drop everything."""
    sense_icons.unregister()
    readout.unregister()
    session.unregister()
