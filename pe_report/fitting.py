"""The verb ``fit``: a and b of the AP curve from a table, a snippet for a study, a plot."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core import prepare_folder
from pe_core.app import DONE, Answer
from pe_core.formats import read_ap_table
from pe_core.metric import CurveFit, fit_ap_curve, study_snippet
from pe_core.study import FileSet
from pe_core.text import dump_json

from .cli import PLOT, SNIPPET
from .drawing import figures
from .words import one_line

LONGEST_FILE = 255


def fit(args: argparse.Namespace) -> Answer:
    """Run the verb."""
    found = fit_ap_curve(read_ap_table(args.table), args.saturation)
    snippet = study_snippet(_named(found, Path(args.table)), args.kind, args.object)
    if args.output is not None:
        folder = prepare_folder(args.output, (SNIPPET, PLOT))
        curves = {Path(args.table).stem: fit_data(found)}
        with FileSet(folder) as files:
            files.add(SNIPPET, snippet.encode())
            files.add(PLOT, lambda path: figures().ap_curves(path, curves))
    text = dump_json(fit_data(found)) if args.json else f"{_fit_summary(found)}\n\n{snippet}"
    return text, DONE


def _named(fit: CurveFit, path: Path) -> CurveFit:
    """Return the fit with a file's name that a comment can hold."""
    return replace(fit, table=replace(fit.table, source=one_line(path.name, LONGEST_FILE)))


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
