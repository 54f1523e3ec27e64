"""The review that goes round a company: one HTML file that holds all a reader may ask of a rig.

It needs NumPy and the engine alone, so that it is the same page from Blender and from a command
line. A section is a function of what is reviewed; `page` puts sections together. Names are loaded
when one is asked for: the other verbs of `pe` start without it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .cli import add_page, add_review_options

if TYPE_CHECKING:
    from .about import About
    from .making import review_studies
    from .page import PAGE, page_bytes, write_page
    from .reviewed import Reviewed, reviewed_together
    from .section import Section

_PLACES = {
    "About": "about",
    "review_studies": "making",
    "PAGE": "page",
    "page_bytes": "page",
    "write_page": "page",
    "Reviewed": "reviewed",
    "reviewed_together": "reviewed",
    "Section": "section",
}

__all__ = [
    "PAGE",
    "About",
    "Reviewed",
    "Section",
    "add_page",
    "add_review_options",
    "page_bytes",
    "review_studies",
    "reviewed_together",
    "write_page",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_PLACES[name]}", __name__), name)
