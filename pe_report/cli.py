"""The verbs ``fit``, ``front``, ``reproduce``, ``validate`` of ``pe``: their options alone.

What they do is imported when they are called, so that the other verbs start without it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.app import Answer, count_up_to, plots
from pe_core.metric import SATURATION

FOLDER, QUICK_FOLDER = "docs/reproduction", "reproduction-quick"
VALIDITY_FOLDER, QUICK_VALIDITY_FOLDER = "docs/validity", "validity-quick"
SNIPPET, PLOT = "ap.toml", "ap.png"
MOST_WORKERS = 1024


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verbs to the parser of ``pe``."""
    _add_fit(verbs)
    _add_front(verbs)
    _add_reproduce(verbs)
    _add_validate(verbs)
    if _draw_front not in plots:
        plots.append(_draw_front)


def _add_fit(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    fit = verbs.add_parser("fit", help="find a and b of AP = a ln m + b in a table")
    fit.add_argument("table", metavar="TABLE", help="CSV with the columns m and ap, and perhaps n")
    fit.add_argument("--kind", choices=("lidar", "camera"), default="lidar", help="of the sensor")
    about = "m is counted on whole objects of this class, not divided by their voxels"
    fit.add_argument("--object", metavar="CLASS", help=about)
    fit.add_argument(
        "--saturation",
        type=float,
        default=SATURATION,
        metavar="AP",
        help=f"points this near to the largest AP are saturated (default {SATURATION})",
    )
    fit.add_argument("-o", "--output", metavar="DIR", help=f"folder for {SNIPPET} and {PLOT}")
    fit.add_argument("--json", action="store_true", help="print JSON on stdout")
    fit.set_defaults(function=_fit)


def _add_front(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    front = verbs.add_parser("front", help="draw the front of price against entropy again")
    front.add_argument(
        "folder", metavar="DIR", help="folder of `pe optimize`, of a study's choices"
    )
    front.set_defaults(function=_front)


def _add_reproduce(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    reproduce = verbs.add_parser("reproduce", help="run the paper's experiments and report on them")
    instead = _add_page_options(reproduce, FOLDER, QUICK_FOLDER, "check all orderings in a minute")
    instead.add_argument(
        "--check",
        action="store_true",
        help="compute again what needs no search, compare with the results that are there",
    )
    reproduce.set_defaults(function=_reproduce)


def _add_validate(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    about = "hold the scores against published results of detectors"
    validate = verbs.add_parser("validate", help=about)
    quick = "on few voxels and objects, in a minute"
    _add_page_options(validate, VALIDITY_FOLDER, QUICK_VALIDITY_FOLDER, quick)
    validate.set_defaults(function=_validate)


def _add_page_options(
    parser: argparse.ArgumentParser, folder: str, quick_folder: str, quick: str
) -> argparse._MutuallyExclusiveGroup:
    """Add what verbs share that write a page; return the group of what they do instead."""
    about = f"folder for page, plots and results.json (default {folder}, or {quick_folder})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.add_argument("--quick", action="store_true", help=quick)
    instead = parser.add_mutually_exclusive_group()
    about = "write page and plots of the results that are there"
    instead.add_argument("--page-only", action="store_true", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    about = "processes (default, and at most: all)"
    parser.add_argument("--workers", type=count_up_to(MOST_WORKERS), metavar="N", help=about)
    return instead


def _fit(args: argparse.Namespace) -> Answer:
    from .fitting import fit

    return fit(args)


def _front(args: argparse.Namespace) -> Answer:
    from .fronts import front

    return front(args)


def _draw_front(data: Mapping[str, Any], folder: Path) -> None:
    from .drawing import has_matplotlib
    from .fronts import write_plot

    if has_matplotlib():
        write_plot(data, folder)


def _reproduce(args: argparse.Namespace) -> Answer:
    from .reproduce import reproduce

    return reproduce(args)


def _validate(args: argparse.Namespace) -> Answer:
    from .validity.validate import validate

    return validate(args)
