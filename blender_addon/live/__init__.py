"""The live score: it follows every move of a sensor.

`state` holds what is known of each scene, `session` requests scores and says what they are compared
with, `background_figures` requests their key figures, `shown` is the one state of all that is drawn
of them, `readout_text` puts it into text, and `readout` draws that in a corner of the 3D view.
"""

from . import readout, session
from .readout_text import BETTER, SAME, SENSE_ICONS, WORSE, change_text, is_not_shown
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


def register() -> None:
    """Start drawing."""
    readout.register()


def unregister() -> None:
    """Stop drawing, and drop everything."""
    readout.unregister()
    session.unregister()
