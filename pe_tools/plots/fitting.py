"""The verb ``pe fit``: a and b of AP = a ln m + b from a table, a snippet for a study, a plot."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pe_core import catalog
from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_tools.formats import CurveFit, fit_ap_curve, m_by_range, study_snippet

from ..cli import DONE, Answer, tell
from ..formats import read_ap_table
from ..jobs import FileSet, prepare_folder
from .plotting import (
    BLUE,
    EXTRA,
    GREY,
    ORANGE,
    has_matplotlib,
    pyplot,
    remove_frame,
    save_plot,
    shortened,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SNIPPET, PLOT = "ap.toml", "ap.png"
"""The files that the verb writes."""
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
        folder = prepare_folder(args.output, (SNIPPET, PLOT))
        with FileSet(folder) as files:
            files.add(SNIPPET, snippet.encode())
            if has_matplotlib():
                files.add(PLOT, lambda path: draw_ap_curves(path, {table.stem: data}))
            else:
                tell(f"{PLOT} is left out: it needs matplotlib; {EXTRA}")
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


@styled
def draw_ap_curves(path: Path, fits: Mapping[str, Any]) -> None:
    """Draw AP against the measurement, a panel for each fit: points, curve, points left out. `fits`
    has the data of `fit_data` by the name of the panel."""
    plt = pyplot()
    size = (0.6 + 3.0 * len(fits), 3.4)
    layout: dict[str, Any] = {"sharey": True, "layout": "constrained", "squeeze": False}
    figure, grid = plt.subplots(1, len(fits), figsize=size, **layout)
    for axes, (name, fit) in zip(grid[0], fits.items(), strict=True):
        _draw_ap_curve(axes, fit)
        axes.set_title(shortened(name.replace("_", " ")), loc="left", parse_math=False)
    grid[0][0].set_ylabel("AP")
    marks = [
        plt.Line2D([], [], marker="o", color=BLUE, ls="none", label="taken"),
        plt.Line2D([], [], marker="o", color=GREY, mfc="none", ls="none", label="left out"),
    ]
    figure.legend(handles=marks, frameon=False, loc="outside upper right", ncols=2)
    save_plot(figure, path)


def _draw_ap_curve(axes: Axes, fit: Mapping[str, Any]) -> None:
    m, ap = np.array(fit["m"]), np.array(fit["ap"])
    used = np.array([not why for why in fit["left_out"]])
    x = np.geomspace(m[m > 0].min() / 1.5, m.max() * 1.5, 200)
    axes.plot(x, np.clip(fit["a"] * np.log(x) + fit["b"], 0.001, 0.999), color=ORANGE)
    axes.plot(m[used], ap[used], "o", color=BLUE)
    axes.plot(m[~used], ap[~used], "o", color=GREY, mfc="none")
    axes.set(xscale="log", ylim=(-0.03, 1.03), xlabel="measurement a voxel, m")
    label = f"a = {fit['a']:.3f} ± {fit['a_error']:.3f}\nb = {fit['b']:.3f} ± {fit['b_error']:.3f}"
    axes.text(0.97, 0.04, label, transform=axes.transAxes, va="bottom", ha="right")
    axes.grid(alpha=0.3)
    remove_frame(axes)
