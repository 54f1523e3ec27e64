"""What operators tell in the status bar: one line, whatever was typed."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..engine import pe

REFUSALS = (pe.InputError, MemoryError)
"""What ends an operator with a line: wrong input, and numbers too large for this machine."""
LONGEST = 400


def refuse(operator: bpy.types.Operator, error: Exception) -> set[str]:
    """Say what is wrong; the operator has changed nothing."""
    text = str(error)
    if isinstance(error, MemoryError):
        text = f"Not enough memory for this many voxels or candidates: {text}".rstrip(": ")
    tell(operator, "ERROR", text)
    return {"CANCELLED"}


def tell(operator: bpy.types.Operator, level: str, text: str) -> None:
    """Report one line; what would turn or break it is written out."""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[:LONGEST])
    operator.report({level}, shown)


def chosen_file(filepath: str) -> Path:
    """Return the file that was chosen.

    Raises
    ------
    InputError
        When none was.
    """
    path = Path(bpy.path.abspath(filepath))
    if not path.name:
        raise pe.InputError("export", "file", "the name of a file", repr(filepath))
    return path
