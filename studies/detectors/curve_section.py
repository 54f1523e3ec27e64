"""The section on AP curves from scans: on the page, and as the file of the curves that ship."""

from __future__ import annotations

import datetime
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.base import decode_text, dumps, read_bytes, require_new, write_bytes
from pe_core.sensors.lidar import LIDAR

from ..wording import joined, table
from .scan_curves import A_BOUNDS

Json = dict[str, Any]

PLOT = "ap_curves.png"
SOURCE = "docs/validity/own: the study's detector at the odd placements of its fixed design"
HEAD = """\
# AP curves of LiDARs' objects for `[ap] model = "scans"`: AP = a ln m + b, m the number of beams.
# Written by `python -m studies.detectors --page-only --curves FILE`; do not edit it.

"""


def curve_section(found: Json) -> str:
    """Return the section as Markdown, from the results of `scan_curves`."""
    head = "## AP curves from scans"
    state = f"{found['done']} of {found['planned']} runs of the fixed design"
    classes = found["classes"]
    if not classes:
        return f"{head}\n\n{state}: too few for a fit."
    done = found["done"] == found["planned"]
    rows = [_row(name, row) for name, row in classes.items()]
    titles = ["class", "a (95 %)", "b (95 %)", "RMSE, odd", "RMSE, even", "even, mean of odd"]
    return f"""
{head}

{state}{"" if done else "; figures so far, and the curves are provisional"}. The plan: a and b of AP = a ln m + b are
fitted so that expected AP in traffic has the AP of the {found["fitted"]} placements with odd numbers (least squares, seeds
averaged: {found["seeds"]}); the error is judged on the {found["judged"]} with even numbers. {_answer(classes)}

{table(titles, rows)}

*RMSE of AP: with the shipped curves, then with these; for the even ones with its interval. The last column is
the error of a forecast without any score: the mean AP of the odd placements. Intervals are bootstraps over
placements and seeds, each with its own fit.*

![Expected AP against AP found, by class]({PLOT})

*Placements with even numbers. On the dashed line, expected AP is the AP found.*

a and b depend on each other: the placements of one rig have much the same numbers of beams. Expected AP is that of
all objects in the space of the scores, 80 m ahead and behind; the detector is asked for those in its own, smaller
region. So a curve holds for this detector, and a level for expected AP as this project computes it. These curves are
`[ap] model = "scans"` of a study ([objects](../../objects.md#curves-from-scans)).
"""


def _row(name: str, row: Json) -> list[str]:
    before, after = row["rmse"]["judged"]
    shipped, fitted = row["rmse"]["fitted"]
    return [
        name,
        *(f"{row[key]:.3f} ({_range(row[f'{key}_interval'])})" for key in ("a", "b")),
        f"{shipped:.3f}, {fitted:.3f}",
        f"{before:.3f}, **{after:.3f}** ({_range(row['rmse_interval'])})",
        f"{row['rmse']['judged_by_mean']:.3f}",
    ]


def _range(interval: list[float]) -> str:
    low, high = interval
    return f"{low:.3f} to {high:.3f}"


def _answer(classes: Mapping[str, Json]) -> str:
    """Return for which classes the curves are better than the shipped ones, and than none."""
    before = [
        n for n, row in classes.items() if row["rmse"]["judged"][1] < row["rmse"]["judged"][0]
    ]
    by_mean = [
        n for n, row in classes.items() if row["rmse"]["judged"][1] < row["rmse"]["judged_by_mean"]
    ]
    flat = [n for n, row in classes.items() if row["a_interval"][0] <= A_BOUNDS[0]]
    text = (
        f"There, their error is below that of the shipped curves for {_of(before, classes)}, and "
        f"below that of the mean AP of the odd placements for {_of(by_mean, classes)}."
    )
    if not flat:
        return text
    of_slope = f"The interval of a reaches the bound of the fit, {A_BOUNDS[0]:g}, for"
    return f"{text} {of_slope} {_of(flat, classes)}: there the curve says little more than whether a beam meets it."


def _of(names: list[str], classes: Mapping[str, Json]) -> str:
    return "all classes" if len(names) == len(classes) else joined([f"{n}s" for n in names])


def curves_text(found: Json, date: str) -> str:
    """Return the file of the curves: TOML.

    Parameters
    ----------
    found : dict
        The results of `scan_curves`, with classes.
    date : str
        Day of the fit, YYYY-MM-DD.
    """
    head = {
        "source": SOURCE,
        "date": date,
        "runs": found["done"],
        "planned": found["planned"],
        "complete": found["done"] == found["planned"],
    }
    curves = {n: {"a": row["a"], "b": row["b"]} for n, row in found["classes"].items()}
    return HEAD + dumps({**head, "curves": {LIDAR.name: curves}})


def write_curves(path: Path, found: Json) -> None:
    """Write the file of the curves; its date stays where nothing else has changed.

    Raises
    ------
    InputError
        When there are too few runs for a fit, or the file cannot be written.
    """
    if not found["classes"]:
        state = f"{found['done']} of {found['planned']}"
        raise InputError(path, "curves", "enough runs of the fixed design for a fit", state)
    if os.path.lexists(path):
        before = decode_text(read_bytes(path))
        if not before.startswith(HEAD):
            require_new(path, replace=False)
        if before == curves_text(found, date_of(before)):
            return
    write_bytes(path, curves_text(found, datetime.date.today().isoformat()).encode())


def date_of(text: str) -> str:
    """Return the date of a file of curves."""
    return str(tomllib.loads(text)["date"])
