"""The options of the verbs ``pe fit`` and ``pe front``.

What a verb does is imported when it is called, so that the other verbs start without it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.sensors import KINDS
from pe_tools.formats import SATURATION

from ..cli import Answer, plots


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verbs to the parser of ``pe``."""
    _add_fit(verbs)
    front = verbs.add_parser("front", help="draw the Pareto front of price and entropy again")
    front.add_argument(
        "folder", metavar="DIR", help="folder that `pe optimize` wrote for a study with choices"
    )
    front.set_defaults(function=_front)
    if _draw_front not in plots:
        plots.append(_draw_front)


def _add_fit(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
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
    fit.add_argument("-o", "--output", metavar="DIR", help="folder for ap.toml and ap.png")
    fit.add_argument("--json", action="store_true", help="print JSON on stdout")
    fit.set_defaults(function=_fit)


def _fit(args: argparse.Namespace) -> Answer:
    from .fitting import fit

    return fit(args)


def _front(args: argparse.Namespace) -> Answer:
    from .plotting import front

    return front(args)


def _draw_front(data: Mapping[str, Any], folder: Path) -> None:
    """Write the plot beside the front of ``pe optimize``, where matplotlib is installed."""
    from .plotting import has_matplotlib, write_front_plot

    if has_matplotlib() and not data.get("objectives"):
        write_front_plot(data, folder)
