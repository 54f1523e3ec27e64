"""The review page: one HTML file that shows a rig, its score and what its sensors see. It is the
same from Blender and from a command line. `sections` lists its parts, `document` puts them
together. Names are imported at first use: other verbs of `pe` start without the page."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .build import review_studies as review_studies
    from .build import write_front_page as write_front_page
    from .build import write_search_page as write_search_page
    from .document import PAGE as PAGE
    from .document import page_bytes as page_bytes
    from .document import write_page as write_page
    from .pictures.vehicle_picture import picture_file as picture_file
    from .pictures.vehicle_picture import vehicle_picture as vehicle_picture
    from .report_context import About as About
    from .report_context import ReportContext as ReportContext
    from .report_context import keyed_contexts as keyed_contexts
    from .verification import verification_page as verification_page

_MODULES = {
    **dict.fromkeys(("review_studies", "write_front_page", "write_search_page"), "build"),
    **dict.fromkeys(("PAGE", "page_bytes", "write_page"), "document"),
    **dict.fromkeys(("picture_file", "vehicle_picture"), "pictures.vehicle_picture"),
    **dict.fromkeys(("About", "ReportContext", "keyed_contexts"), "report_context"),
    "verification_page": "verification",
}
__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_MODULES[name]}", __name__), name)
