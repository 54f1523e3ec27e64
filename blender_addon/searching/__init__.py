"""The search that runs, as the 3D view shows it: its curve, and the best placement so far."""

from . import drawing
from .curve import SearchCurve, curve_of
from .latest import SearchView, best, drop, view

__all__ = [
    "SearchCurve",
    "SearchView",
    "best",
    "curve_of",
    "drop",
    "note",
    "register",
    "unregister",
]

register, unregister = drawing.register, drawing.unregister


def note(scene: str, seen: SearchView) -> None:
    """Have a scene's views show this of its search."""
    view[scene] = seen
