"""USD (.usd, .usda, .usdc, .usdz), read by usd-core."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdUtils

from pe_core.errors import InputError
from pe_core.formats import FoundMesh

from .pieces import Piece, cut, found, placed
from .usd_layers import check_layers

HIDDEN_PURPOSES = ("guide", "proxy")


def read_usd(path: Path, _data: bytes) -> FoundMesh:
    """Read the meshes of a USD stage as it opens: up axis and unit are the stage's.

    A part is called by the transform that holds its mesh, as Blender and others name objects, or
    else by the mesh. What is invisible, a guide or a proxy is passed over; of a subdivision surface
    the cage is taken.

    Raises
    ------
    InputError
        Not USD, a layer that is missing or not USD, more prims than `MAX_PRIMS`, or a mesh with
        indices out of range.
    """
    source = str(path)
    diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # while it is there, USD prints nothing
    try:
        check_layers(path)
        stage = Usd.Stage.Open(source)
        if errors := stage.GetCompositionErrors():
            problem = " ".join(str(errors[0]).split())
            raise InputError(source, "composition", "layers that fit together", problem)
        pieces = list(_pieces(source, stage))
    except Tf.ErrorException as error:
        raise InputError(source, "file", "USD", " ".join(str(error).split())) from error
    finally:
        del diagnostics
    up = "+y" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else "+z"
    return found(source, pieces, UsdGeom.GetStageMetersPerUnit(stage), up)


def _pieces(source: str, stage: Any) -> Iterator[Piece]:
    cache = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        mesh = UsdGeom.Mesh(prim)
        if not mesh or _is_hidden(mesh):
            continue
        # USD multiplies rows by matrices, we columns.
        matrix = np.array(cache.GetLocalToWorldTransform(prim), float).T
        triangles = _triangles(source, prim, mesh)
        if len(triangles):
            yield Piece(_name(prim), placed(triangles, matrix))


def _is_hidden(mesh: Any) -> bool:
    if mesh.ComputeVisibility(Usd.TimeCode.EarliestTime()) == UsdGeom.Tokens.invisible:
        return True
    return mesh.ComputePurpose() in HIDDEN_PURPOSES


def _triangles(source: str, prim: Any, mesh: Any) -> Any:
    time = Usd.TimeCode.EarliestTime()
    attributes = (
        mesh.GetPointsAttr(),
        mesh.GetFaceVertexCountsAttr(),
        mesh.GetFaceVertexIndicesAttr(),
    )
    points, counts, corners = (np.array(each.Get(time) or ()) for each in attributes)
    points = points.astype(float).reshape(-1, 3)
    corners, counts = corners.astype(np.int64), counts.astype(np.int64)
    within = not corners.size or 0 <= int(corners.min()) <= int(corners.max()) < len(points)
    counted = bool((counts >= 0).all()) and int(counts.sum()) == len(corners)
    if not (within and counted):
        expected = f"as many indices as it counts, within its {len(points)} points"
        raise InputError(source, str(prim.GetPath()), expected, f"{len(corners)}")
    triangles = cut(points, counts, corners)
    is_left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return triangles[:, ::-1] if is_left_handed else triangles


def _name(prim: Any) -> str:
    """The name of the transform that holds this mesh alone, or else of the mesh."""
    parent = prim.GetParent()
    holds_it_alone = parent.GetTypeName() == "Xform" and len(parent.GetChildren()) == 1
    return str((parent if holds_it_alone else prim).GetName())
