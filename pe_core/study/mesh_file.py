"""The keys of [vehicle] that define the axes of its mesh file."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..base.errors import InputError
from ..base.table_reader import Table
from ..base.values import ANY
from ..scene.mesh import MeshAxes

AXES_KEYS = ("scale", "rotation", "up", "forward")


class MeshFile(NamedTuple):
    """A vehicle's mesh file, its axes by the study, and the axes that were used, in words."""

    mesh: str | None = None
    axes: MeshAxes = MeshAxes()
    faces: str = ""


def read_axes(table: Table) -> MeshAxes:
    """Return the axes of the mesh file, from [vehicle]."""
    up, forward = table.text("up", None), table.text("forward", None)
    scale = table.number("scale", 1.0, rule=ANY)
    rotation = table.numbers("rotation", 3, None)
    try:
        return MeshAxes(up, forward, scale, rotation)  # type: ignore[arg-type]  # three of them
    except InputError as error:
        raise table.error(error.field, error.expected, error.found) from None


def axes_table(axes: MeshAxes) -> dict[str, Any]:
    """Return the keys of [vehicle] for the axes of the mesh file."""
    rotation = None if axes.rotation_deg is None else list(axes.rotation_deg)
    scale = None if axes.scale == 1.0 else axes.scale
    return {"scale": scale, "rotation": rotation, "up": axes.up, "forward": axes.forward}
