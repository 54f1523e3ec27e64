"""The live score: it follows every move of a sensor.

`state` holds what is known of each scene, `session` requests scores and says what they are compared
with, `background_figures` requests their key figures, `shown` is the one state of all that is drawn
of them, `readout_text` puts it into text, and `readout` draws that in a corner of the 3D view.
"""

<<<<<<< HEAD
import bpy

from ..engine import advice
from . import background_figures, readout, session
from .readout_text import BETTER, SAME, SENSE_ICONS, WORSE, change_text, is_not_shown
from .state import FinishedScore, ShownScore, live_state, shown_score


def latest_figures(scene: bpy.types.Scene) -> list[advice.KeyFigures]:
    """Return the key figures of the live score, or of the stored result; none before both."""
    found = background_figures.figures_of(scene)
    if not found and scene.perception_entropy.has_result:
        found = told_figures(scene, live=False)
    return found[-1:]


def told_figures(scene: bpy.types.Scene, *, live: bool) -> list[advice.KeyFigures]:
    """Return the key figures that the panel shows: of the live score, or of the stored result.
    Those before it come first: of a search's start, or of what *Live* is compared with."""
    if live:
        return background_figures.figures_of(scene)
    result = scene.perception_entropy.result
    of_kind = ("before", "after") if result.kind == "optimize" else ("after",)
    told = [result.figures[which] for which in of_kind if which in result.figures]
    return [advice.KeyFigures.from_dict(data) for data in told]
=======
from . import readout, session
from .readout_text import BETTER, SAME, SENSE_ICONS, WORSE, change_text
from .shown import (
    AT_REST,
    BEFORE_SEARCH,
    MOVING,
    OUT_OF_DATE,
    PENDING,
    STORED,
    ShownScore,
    for_drawing,
    shown_score,
)
from .state import FinishedScore, live_state
>>>>>>> main


def register() -> None:
    """Start drawing."""
    readout.register()


def unregister() -> None:
    """Stop drawing, and drop everything."""
    readout.unregister()
    session.unregister()
