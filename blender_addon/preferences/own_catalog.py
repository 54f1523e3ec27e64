"""Sensors of the user's own in the catalogue, from a file that the preferences name."""

from pathlib import Path

import bpy

from ..engine import catalog, pe

problem = ""  # Why the file was not loaded, in one line; empty where it was
_names: list[str] = []


def load(filepath: str) -> None:
    """Load a file's sensors into the catalogue, in place of those of the file before. TOML: a table
    for each sensor, by its name, as in the catalogue. Without a path: none."""
    global problem
    while _names:
        catalog.remove(_names.pop())
    problem = ""
    if not filepath:
        return
    try:
        _names[:] = catalog.add_file(Path(bpy.path.abspath(filepath)))
    except pe.InputError as error:
        problem = str(error)
