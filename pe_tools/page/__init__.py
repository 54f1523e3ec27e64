"""The review page: one HTML file that shows a rig, its score and what its sensors see.

It needs NumPy and the engine alone, so the page is the same from Blender and from a command line. A
section is a function from a `ReportContext` to a `Section`; `document` puts sections together.
Names are imported at first use: the other verbs of `pe` start without the page.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .cli import add_page, add_review_options

if TYPE_CHECKING:
    from .build import review_studies
    from .document import PAGE, page_bytes, write_page
    from .report_context import About, ReportContext, Section, keyed_contexts

_MODULES = {
    "review_studies": "build",
    "PAGE": "document",
    "page_bytes": "document",
    "write_page": "document",
    "About": "report_context",
    "ReportContext": "report_context",
    "Section": "report_context",
    "keyed_contexts": "report_context",
}

__all__ = [
    "PAGE",
    "About",
    "ReportContext",
    "Section",
    "add_page",
    "add_review_options",
    "keyed_contexts",
    "page_bytes",
    "review_studies",
    "write_page",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_MODULES[name]}", __name__), name)
