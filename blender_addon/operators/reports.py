"""What operators share: what they are given, what they return, and their reports.

A report is one line in the status bar, whatever the input was.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import bpy

from .. import language, preferences
from ..engine import pe, text

USER_ERRORS = (pe.InputError, MemoryError)
"""Errors that end an operator with one line: wrong input, and too little memory."""
MAX_LETTERS = 400
OperatorResult = set[Literal["RUNNING_MODAL", "CANCELLED", "FINISHED", "PASS_THROUGH", "INTERFACE"]]
"""What ``execute``, ``invoke`` and ``modal`` return."""

# Blender registers the subclasses of Operator alone. What several operators have in common is a
# plain class for Blender, and an Operator for the checker of types.
if TYPE_CHECKING:
    OperatorMixin: TypeAlias = bpy.types.Operator
else:
    OperatorMixin = object


def report_error(operator: bpy.types.Operator, error: Exception) -> OperatorResult:
    """Report an error; the operator has changed nothing."""
    text = str(error)
    if isinstance(error, MemoryError):
        text = f"Not enough memory for this many voxels or candidates: {text}".rstrip(": ")
    report(operator, "ERROR", text)
    return {"CANCELLED"}


def report(
    operator: bpy.types.Operator, level: Literal["INFO", "WARNING", "ERROR"], text: str
) -> None:
    """Report one line in the interface's language.

    Characters that would break or reverse the line are escaped.
    """
    text = language.shown(text[:MAX_LETTERS])
    printable = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
    operator.report({level}, printable)


def chosen_sensor(context: bpy.types.Context, name: str) -> bpy.types.Object:
    """Return the sensor of that name; the active one when the name is empty.

    Raises
    ------
    InputError
        When there is no such sensor.
    """
    obj = context.scene.objects.get(name) if name else context.active_object
    if obj is None or not obj.perception_entropy.is_sensor:
        raise pe.InputError("scene", "active object", "a sensor", obj.name if obj else "none")
    return obj


def begin_in_results_folder(operator: Any) -> None:
    """Have the file dialog of an export begin in the folder of results of the preferences."""
    named = f"{Path(bpy.data.filepath).stem or 'untitled'}{operator.filename_ext}"
    operator.filepath = preferences.in_results_folder(operator.filepath, named)


def chosen_file(filepath: str) -> Path:
    """Return the chosen file.

    Raises
    ------
    InputError
        When no file was chosen, or its name cannot be one.
    """
    path = text.named_path("export", "file", bpy.path.abspath(filepath))
    if not path.name:
        raise pe.InputError("export", "file", "the name of a file", repr(filepath))
    return path
