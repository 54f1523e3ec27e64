"""The verb ``fit``: a and b of the AP curve from a table, a snippet for a study, a plot."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from pe_core.app import DONE, Answer
from pe_core.errors import InputError
from pe_core.formats import read_ap_table
from pe_core.metric import SATURATION, CurveFit, fit_ap_curve, study_snippet
from pe_core.study import prepare_folder
from pe_core.text import dump_json, write_bytes

SNIPPET, PLOT = "ap.toml", "ap.png"


def add_fit(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``fit`` to the parser of ``pe``."""
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


def _fit(args: argparse.Namespace) -> Answer:
    fit = fit_ap_curve(read_ap_table(args.table), args.saturation)
    snippet = study_snippet(fit, args.kind)
    if args.output is not None:
        folder = prepare_folder(args.output)
        write_bytes(folder / SNIPPET, snippet.encode())
        matplotlib_figures().ap_curves(folder / PLOT, {Path(args.table).stem: fit_data(fit)})
    text = dump_json(fit_data(fit)) if args.json else f"{_fit_summary(fit)}\n\n{snippet}"
    return text, DONE


def fit_data(fit: CurveFit) -> dict[str, Any]:
    """Return a fit as plain JSON data."""
    return {
        "a": fit.curve.a,
        "b": fit.curve.b,
        "a_error": fit.a_error,
        "b_error": fit.b_error,
        "rms": fit.rms,
        "m": fit.table.m.tolist(),
        "ap": fit.table.ap.tolist(),
        "n": fit.table.n.tolist(),
        "left_out": list(fit.why),
    }


def _fit_summary(fit: CurveFit) -> str:
    taken, every = int(fit.used.sum()), len(fit.why)
    out = ", ".join(f"{count} {why}" for why, count in fit.left_out.items())
    left = f"; left out: {out}" if out else ""
    return (
        f"a  {fit.curve.a:.4f} +- {fit.a_error:.4f}\n"
        f"b  {fit.curve.b:.4f} +- {fit.b_error:.4f}\n"
        f"rms of AP  {fit.rms:.4f}\n"
        f"points  {taken} of {every}{left}"
    )


def matplotlib_figures() -> Any:
    """Return the module of figures, or raise `InputError` where matplotlib is missing."""
    try:
        from . import figures
    except ImportError:
        expected = 'matplotlib: pip install "perception-entropy[report]"'
        raise InputError("pe", "plots", expected, "no matplotlib") from None
    return figures
