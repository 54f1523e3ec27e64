"""The score that follows the hand.

`latest` is what is known now, `session` asks for it, `reference` and `against` say what it is
compared with, `shown` which score is shown, `words` puts it into words, `readout` draws those in
the corner of the 3D view.
"""

from __future__ import annotations

from . import against, latest, readout, session
from .shown import ShownScore, shown_score

__all__ = ["ShownScore", "against", "latest", "register", "shown_score", "unregister"]


def register() -> None:
    """Start following and drawing."""
    session.register()
    readout.register()


def unregister() -> None:
    """Stop both; the worker has ended before."""
    readout.unregister()
    session.unregister()
