"""The options of the verbs ``pe fit``, ``pe front`` and ``pe reproduce``.

What a verb does is imported when it is called, so that the other verbs start without it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core.sensors import KINDS
from pe_tools.formats import SATURATION

from ..cli import Answer, count_up_to, plots

FOLDER, QUICK_FOLDER = "docs/reproduction", "reproduction-quick"
MAX_WORKERS = 1024


def add_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verbs to the parser of ``pe``."""
    _add_fit(verbs)
    _add_front(verbs)
    _add_reproduce(verbs)
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


def _add_front(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    front = verbs.add_parser("front", help="draw the Pareto front of price and entropy again")
    front.add_argument(
        "folder", metavar="DIR", help="folder that `pe optimize` wrote for a study with choices"
    )
    front.set_defaults(function=_front)


def _add_reproduce(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    reproduce = verbs.add_parser("reproduce", help="run the paper's experiments and report on them")
    alternatives = add_page_options(
        reproduce, FOLDER, QUICK_FOLDER, "check all orderings in a minute"
    )
    alternatives.add_argument(
        "--check",
        action="store_true",
        help="compute again what needs no search, and compare it with the folder's results",
    )
    reproduce.set_defaults(function=_reproduce)


def add_page_options(
    parser: argparse.ArgumentParser, folder: str, quick_folder: str, quick: str
) -> argparse._MutuallyExclusiveGroup:
    """Add the options of a verb that writes a page, and of what it can do instead of a full run.

    Parameters
    ----------
    parser : ArgumentParser
        The parser of the verb.
    folder, quick_folder : str
        Default folders of a full and of a quick run.
    quick : str
        What a quick run does, for the help.

    Returns
    -------
    argparse group
        The options that exclude each other, for further ones.
    """
    about = f"folder for page, plots and results.json (default {folder}, or {quick_folder})"
    parser.add_argument("-o", "--output", metavar="DIR", help=about)
    parser.set_defaults(default_output=folder, default_quick_output=quick_folder)
    parser.add_argument("--quick", action="store_true", help=quick)
    alternatives = parser.add_mutually_exclusive_group()
    about = "write page and plots from the results that the folder has"
    alternatives.add_argument("--page-only", action="store_true", help=about)
    parser.add_argument("--json", action="store_true", help="print results.json on stdout")
    about = "number of processes (default and maximum: one per processor)"
    parser.add_argument("--workers", type=count_up_to(MAX_WORKERS), metavar="N", help=about)
    return alternatives


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


def _reproduce(args: argparse.Namespace) -> Answer:
    from .reproduce import reproduce

    return reproduce(args, output_folder(args))


def output_folder(args: argparse.Namespace) -> Path:
    """Return the folder that was named, or the default one."""
    return Path(args.output or (args.default_quick_output if args.quick else args.default_output))
