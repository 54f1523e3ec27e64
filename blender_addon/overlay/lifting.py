"""Draws what lies on the ground in front of it, whatever else lies there."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy
import gpu
from mathutils import Matrix

NEARER = 0.002
"""By what part of its distance from the eye a thing is drawn nearer."""
NEARER_M = 0.02
"""The same in a view without perspective, which has no eye [m]."""


@contextlib.contextmanager
def lifted(look: bpy.types.RegionView3D | None, wanted: bool) -> Iterator[None]:
    """Draw nearer to the eye within, at the same place in the picture."""
    if not wanted or look is None:
        yield
        return
    gpu.matrix.push()
    try:
        gpu.matrix.multiply_matrix(nearer(look.view_matrix, look.is_perspective))
        yield
    finally:
        gpu.matrix.pop()


def nearer(view_from_world: Matrix, perspective: bool) -> Matrix:
    """World to world: towards the eye, or towards the viewer where there is no eye."""
    world_from_view = view_from_world.inverted()
    if not perspective:
        return Matrix.Translation(world_from_view.col[2].to_3d() * NEARER_M)
    eye = world_from_view.translation
    return Matrix.Translation(eye) @ Matrix.Scale(1.0 - NEARER, 4) @ Matrix.Translation(-eye)
