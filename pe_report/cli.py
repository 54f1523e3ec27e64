"""The verbs ``fit``, ``front`` and ``reproduce`` of the command ``pe``: their options alone.

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
SNIPPET, PLOT = "ap.toml", "ap.png"
MOST_WORKERS = 1024


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verbs to the parser of ``pe``."""
    _add_fit(verbs)
    _add_front(verbs)
    _add_reproduce(verbs)
    if _draw_front not in plots:
        plots.append(_draw_front)


def _add_fit(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    fit = verbs.add_parser("fit", help="find a and b of AP = a ln m + b in a table")
    fit.add_argument("table", metavar="TABLE", help="CSV with the columns m and ap, and perhaps n")
    fit.add_argument("--kind", choices=("lidar", "camera"), default="lidar", help="of the sensor")
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
    reproduce.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        help=f"folder for page, plots and results.json (default {FOLDER}, or {QUICK_FOLDER})",
    )
    reproduce.add_argument("--quick", action="store_true", help="check all orderings in a minute")
    instead = reproduce.add_mutually_exclusive_group()
    instead.add_argument(
        "--page-only",
        action="store_true",
        help="write page and plots of the results that are there",
    )
    instead.add_argument(
        "--check",
        action="store_true",
        help="compute again what needs no search, compare with the results that are there",
    )
    reproduce.add_argument("--json", action="store_true", help="print results.json on stdout")
    reproduce.add_argument(
        "--workers",
        type=count_up_to(MOST_WORKERS),
        metavar="N",
        help="processes (default, and at most: all)",
    )
    reproduce.set_defaults(function=_reproduce)


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
