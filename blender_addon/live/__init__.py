"""The live score: it follows every move of a sensor.

`state` holds what is known of each scene, `session` requests scores and says what they are compared
with, `background_figures` requests the figures below them, `readout_text` puts all of it into text,
and `readout` draws that in a corner of the 3D view.
"""

from __future__ import annotations

import bpy

from ..engine import advice
from . import readout, session
from .readout_text import BETTER, SAME, SENSE_ICONS, WORSE, FigureRow, nats_text, rows_of_figures
from .state import FinishedScore, ShownScore, live_state, shown_figures, shown_score

__all__ = ["BETTER", "SAME", "SENSE_ICONS", "WORSE", "FinishedScore", "ShownScore", "built_lines"]
__all__ += ["figure_rows", "live_state", "nats_text", "register", "shown_score", "unregister"]


def built_lines(scene: bpy.types.Scene) -> list[str]:
    """Return what can be built, of the live score, or of the stored result."""
    if (now := shown_figures(scene)) is not None:
        return advice.built_lines([now])
    told = scene.perception_entropy.result.figures
    return advice.built_lines([advice.KeyFigures.from_dict(told["after"])]) if told else []


def figure_rows(scene: bpy.types.Scene, *, live: bool) -> list[FigureRow]:
    """Return rows of key figures for the panel: of the live score, or of the stored result."""
    if live:
        now = shown_figures(scene)
        return rows_of_figures([] if now is None else [now])
    result = scene.perception_entropy.result
    of_kind = ("before", "after") if result.kind == "optimize" else ("after",)
    told = [result.figures[which] for which in of_kind if result.figures]
    return rows_of_figures([advice.KeyFigures.from_dict(data) for data in told])


def register() -> None:
    """Start drawing."""
    readout.register()


def unregister() -> None:
    """Stop drawing, and drop everything."""
    readout.unregister()
    session.unregister()
