"""The verb ``pe fit``: a and b of AP = a ln m + b from a table, and a snippet for a study."""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from pe_core import catalog
from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_tools.formats import CurveFit, fit_ap_curve, m_by_range, study_snippet

from ..cli import DONE, Answer
from ..formats import read_ap_table
from ..jobs import FileSet, prepare_folder

SNIPPET = "ap.toml"  # The file that the verb writes
MAX_FILE_NAME = 255


def fit(args: argparse.Namespace) -> Answer:
    """Run the verb."""
    table, kind, m_at_ranges = Path(args.table), args.kind or "lidar", None
    if args.model is not None:
        model = catalog.load(args.model)
        kind = model.kind
        if args.kind not in (None, kind):
            raise InputError("fit", "kind", f"{kind}, the kind of {args.model}", args.kind)
        m_at_ranges = partial(m_by_range, model, class_name=args.object, height=args.height)
    curve_fit = fit_ap_curve(read_ap_table(args.table, m_at_ranges), args.saturation)
    # A comment of the snippet names the file, in characters that a comment can hold.
    named = replace(curve_fit.table, source=shortened(table.name, MAX_FILE_NAME))
    snippet = study_snippet(replace(curve_fit, table=named), kind, args.object)
    data = fit_data(curve_fit)
    if args.output is not None:
        folder = prepare_folder(args.output, (SNIPPET,))
        with FileSet(folder) as files:
            files.add(SNIPPET, snippet.encode())
    text = dump_json(data) if args.json else f"{_summary(curve_fit)}\n\n{snippet}"
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


def _summary(fit: CurveFit) -> str:
    used, total = int(fit.used.sum()), len(fit.why)
    reasons = ", ".join(f"{count} {why}" for why, count in fit.left_out.items())
    left_out = f"; left out: {reasons}" if reasons else ""
    return (
        f"a  {fit.curve.a:.4f} +- {fit.a_error:.4f}\n"
        f"b  {fit.curve.b:.4f} +- {fit.b_error:.4f}\n"
        f"rms of AP  {fit.rms:.4f}\n"
        f"points  {used} of {total}{left_out}"
    )


def shortened(name: str, max_length: int) -> str:
    """Return a name from a file as one printable line, cut where it is longer than that."""
    line = "".join(c if c.isprintable() else "?" for c in name)
    return line if len(line) <= max_length else f"{line[: max_length - 3]}..."
