"""The review page: one HTML file that shows a rig, its score and what its sensors see. It is the
same from Blender and from a command line. `sections` lists its parts, `document` puts them
together. Names are imported at first use: other verbs of `pe` start without page and jinja2."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from pe_core.sensors import KINDS
from pe_tools.formats import SATURATION

if TYPE_CHECKING:
    from .build import review_studies as review_studies
    from .document import PAGE as PAGE
    from .document import page_bytes as page_bytes
    from .document import write_page as write_page
    from .pictures.vehicle_picture import picture_file as picture_file
    from .pictures.vehicle_picture import vehicle_picture as vehicle_picture
    from .report_context import About as About
    from .report_context import ReportContext as ReportContext
    from .report_context import keyed_contexts as keyed_contexts

_MODULES = {
    "review_studies": "build",
    **dict.fromkeys(("PAGE", "page_bytes", "write_page"), "document"),
    **dict.fromkeys(("picture_file", "vehicle_picture"), "pictures.vehicle_picture"),
    **dict.fromkeys(("About", "ReportContext", "keyed_contexts"), "report_context"),
}
__all__ = [*sorted(_MODULES), "add_page", "add_review_options"]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_MODULES[name]}", __name__), name)


def add_verbs(verbs: Any) -> None:
    """Add the verbs ``fit`` and ``review`` to ``pe``, and pages to the files of a search."""
    from .. import cli as app

    _add_fit(verbs)

    review = verbs.add_parser(
        "review", help="write an HTML page that shows a rig and what its sensors see"
    )
    review.add_argument("studies", nargs="+", metavar="STUDY", help="study file (TOML)")
    add_review_options(review)
    app.add_score_options(review)
    review.set_defaults(function=_later("review"))
    add_page()


def _add_fit(verbs: Any) -> None:
    fit = verbs.add_parser("fit", help="fit a and b of AP = a ln m + b to a table")
    fit.add_argument(
        "table", metavar="TABLE", help="CSV with the columns m (or range_m) and ap, optionally n"
    )
    about = "of the sensor (default lidar, or the kind of --model)"
    fit.add_argument("--kind", choices=tuple(KINDS), help=about)
    about = "the table has a column range_m in place of m; m is what this model measures there"
    fit.add_argument("--model", metavar="MODEL", help=about)
    about = "of the model above the ground (default: level with the object's middle)"
    fit.add_argument("--height", type=float, metavar="M", help=about)
    about = "m is counted on whole objects of this class, not divided by their voxels"
    fit.add_argument("--object", metavar="CLASS", help=about)
    fit.add_argument(
        "--saturation",
        type=float,
        default=SATURATION,
        metavar="AP",
        help=f"points whose AP differs by less than this from the largest one are saturated "
        f"(default {SATURATION})",
    )
    fit.add_argument("-o", "--output", metavar="DIR", help="folder for ap.toml")
    fit.add_argument("--json", action="store_true", help="print JSON on stdout")
    fit.set_defaults(function=_later("fit", "fitting"))


def add_review_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``review``, without the studies themselves."""
    parser.add_argument("-o", "--output", required=True, metavar="DIR", help="folder for the page")
    parser.add_argument("--replace", action="store_true", help="replace an existing page")
    about = "title of the page, in place of the studies' names"
    parser.add_argument("--title", default="", metavar="TEXT", help=about)
    parser.add_argument("--author", default="", metavar="TEXT", help="who made it")
    about = "date on the page, any text; 'today' is the day of the run (none without it)"
    parser.add_argument("--date", default="", metavar="TEXT", help=about)
    parser.add_argument("--revision", default="", metavar="TEXT", help="revision of the page")


def add_page() -> None:
    """Write a page beside the results of every search and of every front from now on."""
    from pe_core import study as studies

    from .. import cli as app
    from ..jobs import FRONT_PAGE

    if not any(studies.REVIEW_PAGE in artifact.names for artifact in app.pages):
        app.pages.append(app.More([studies.REVIEW_PAGE], _later("write_search_page")))
        app.front_pages.append(app.More([FRONT_PAGE], _later("write_front_page")))


def _later(name: str, module: str = "build") -> Callable[..., Any]:
    """Return a function of a module that is imported when it is called."""
    return lambda *given: getattr(import_module(f".{module}", __name__), name)(*given)
