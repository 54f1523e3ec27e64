"""The still of what is reviewed, cast once however many sections show it."""

from __future__ import annotations

from ..markup import Markup
from ..reviewed import Reviewed
from .named_still import named_still
from .still import still


def still_of(one: Reviewed) -> bytes:
    """Return the picture of a rig on its vehicle, PNG."""
    return one.once("still", lambda: still(one.shown_vehicle[0], one.rig))


def named_still_of(one: Reviewed, alt: str) -> Markup:
    """Return that picture with its sensors numbered."""
    return named_still(one.shown_vehicle[0], one.rig, alt, still_of(one))
