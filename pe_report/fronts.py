"""The verb ``front``, and the plot that `pe optimize` leaves beside a front."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.app import DONE, Answer
from pe_core.study import FRONT_JSON, FRONT_PLOT, FileSet
from pe_core.text import decode_text, read_bytes

from .drawing import front_figure

NEEDED = ("name", "on_front", "price", "entropy")


def front(args: argparse.Namespace) -> Answer:
    """Run the verb: draw the front of a folder again."""
    folder = Path(args.folder)
    write_plot(read_front(folder / FRONT_JSON), folder)
    return str(folder / FRONT_PLOT), DONE


def write_plot(data: Mapping[str, Any], folder: Path) -> None:
    """Write the plot of a front to its folder.

    Raises
    ------
    InputError
        Where matplotlib is missing, or the file there is not ours.
    """
    draw = front_figure().draw_front
    with FileSet(folder) as files:
        files.add(FRONT_PLOT, lambda path: draw(path, data))


def read_front(path: Path) -> dict[str, Any]:
    """Return what is drawn of a front.json, or raise `InputError`."""
    try:
        data = json.loads(decode_text(read_bytes(path)))
        rows = [{key: row[key] for key in NEEDED} for row in data["designs"]]
        if not any(row["on_front"] for row in rows):
            raise ValueError
        for row in rows:
            row |= {"price": float(row["price"]), "entropy": float(row["entropy"])}
            row["name"] = str(row["name"])
        return {"currency": str(data["currency"]), "designs": rows}
    except (KeyError, RecursionError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, "file", "the front that `pe optimize` wrote", "another") from None
