"""The keys of [vehicle] that say how the axes of its mesh file are to be taken."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..errors import InputError
from ..formats.meshes import MeshAxes
from ..text.tables import Table
from ..text.values import ANY

AXES_KEYS = ("scale", "rotation", "up", "forward")


class MeshFile(NamedTuple):
    """A vehicle's file, how it is to be taken, and how its axes were taken, in words."""

    mesh: str | None = None
    axes: MeshAxes = MeshAxes()
    faces: str = ""


def read_axes(table: Table) -> MeshAxes:
    """Read what a study says of its mesh's axes."""
    up, forward = table.text("up", None), table.text("forward", None)
    scale = table.number("scale", 1.0, rule=ANY)
    rotation = table.numbers("rotation", 3, None)
    try:
        return MeshAxes(up, forward, scale, rotation)  # type: ignore[arg-type]  # three of them
    except InputError as error:
        raise table.error(error.field, error.expected, error.found) from None


def axes_table(axes: MeshAxes) -> dict[str, Any]:
    """Return the keys of a study that says something of its mesh's axes."""
    rotation = None if axes.rotation_deg is None else list(axes.rotation_deg)
    scale = None if axes.scale == 1.0 else axes.scale
    return {"scale": scale, "rotation": rotation, "up": axes.up, "forward": axes.forward}
