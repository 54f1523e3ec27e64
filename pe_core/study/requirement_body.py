"""Test bodies from mesh files, `body = { mesh = "child.glb" }`, in a study's requirements."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..base.errors import InputError
from ..base.plugins import shipped
from ..base.table_reader import Table
from ..base.values import A_NAME, A_PATH
from ..scene.mesh import SCALE, MeshAxes
from ..scoring.requirements import Body, MeshShape, Requirement

AXES = ("up", "forward", "scale")


def read_mesh_body(own: Table, name: str, folder: Path) -> Body:
    """Return a body from its table, with a mesh file relative to a folder.

    `InputError` for a file that is no mesh, a body that is not closed, or one of no likely size.
    """
    file = own.text("mesh", rule=A_PATH)
    up, forward = own.text("up", None), own.text("forward", None)
    scale = own.number("scale", 1.0, rule=SCALE)
    low, class_name = own.number("low", 0.0), own.text("class", None, rule=A_NAME)
    own.finish()
    path = folder / file
    try:
        state = os.stat(path)
        stamp = state.st_mtime_ns, state.st_size
    except OSError:
        stamp = 0, 0  # the reader says what is wrong with it
    with own.naming():
        axes = MeshAxes(up, forward, scale, (0.0, 0.0, 0.0))
    try:
        shape = _shape(str(path), stamp, axes)
    except InputError as error:
        raise own.error("mesh", error.expected, f"{file}: {error.found}") from None
    return Body(name, shape.size, low, class_name=class_name, shape=replace(shape, file=file))


@lru_cache(maxsize=32)
def _shape(path: str, stamp: tuple[int, int], axes: MeshAxes) -> MeshShape:
    """Return the shape of a mesh file; `stamp` changes with the file."""
    mesh = shipped("reader.mesh")(path, axes)
    stated = (axes.up, axes.forward, axes.scale if axes.scale != 1.0 else None)
    keys = tuple((key, value) for key, value in zip(AXES, stated, strict=True) if value is not None)
    return MeshShape.of(path, mesh.triangles, keys)


def mesh_files(requirements: Sequence[Requirement]) -> list[tuple[str, str]]:
    """Return the name of each requirement that has a body from a mesh, and the mesh file."""
    return [
        (each.name, body.shape.file)
        for each in requirements
        for body in each.bodies
        if body.shape is not None
    ]


def mesh_table(body: Body) -> dict[str, Any]:
    """Return the keys of a body from a mesh; empty for another body."""
    return {} if body.shape is None else {"mesh": body.shape.file, **dict(body.shape.axes)}
