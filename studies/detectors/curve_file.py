"""The file of the curves of `[ap] model = "scans"`, as the fit to the runs has them."""

from __future__ import annotations

import datetime
import os
import tomllib
from pathlib import Path

from pe_core import InputError
from pe_core.base import decode_text, dumps, read_bytes, require_new, write_bytes
from pe_core.sensors.lidar import LIDAR

from ..results_file import Json

SOURCE = "docs/validity/own: the study's detector at the odd placements of its fixed design"
HEAD = """\
# AP curves of LiDARs' objects for `[ap] model = "scans"`: AP = a ln m + b, m the number of beams.
# Written by `python -m studies.detectors --page-only --curves FILE`; do not edit it.

"""


def curves_text(found: Json, date: str) -> str:
    """Return the file, TOML, from the results of `scan_curves` and the day of the fit."""
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
    """Write the file; its date stays where nothing else has changed.

    Too few runs for a fit, or another file at the path, are an `InputError`.
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
