"""USD (.usd, .usda, .usdc, .usdz): read by usd-core."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdUtils

from pe_core.base.errors import InputError

from .mesh import FoundMesh, Piece, fan, found, placed

HIDDEN_PURPOSES = ("guide", "proxy")


def read_usd(path: Path, _data: bytes) -> FoundMesh:
    """Read the meshes of a USD stage, with the stage's up axis and unit. A part has the name of the
    transform above its mesh, as Blender and others name objects, or the mesh's name. Invisible
    prims, guides and proxies are ignored. A subdivision surface is represented by its cage."""
    source = str(path)
    diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # while it exists, USD prints nothing
    try:
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
        if not mesh or mesh.ComputePurpose() in HIDDEN_PURPOSES:
            continue
        if mesh.ComputeVisibility(Usd.TimeCode.EarliestTime()) == UsdGeom.Tokens.invisible:
            continue
        # USD multiplies rows by matrices, we columns.
        matrix = np.array(cache.GetLocalToWorldTransform(prim), float).T
        triangles = _triangles(source, prim, mesh)
        if len(triangles):
            yield Piece(_name(prim), placed(triangles, matrix))


def _triangles(source: str, prim: Any, mesh: Any) -> Any:
    time = Usd.TimeCode.EarliestTime()
    attributes = (
        mesh.GetPointsAttr(),
        mesh.GetFaceVertexCountsAttr(),
        mesh.GetFaceVertexIndicesAttr(),
    )
    points, counts, corners = (np.array(attribute.Get(time) or ()) for attribute in attributes)
    points = points.astype(float).reshape(-1, 3)
    corners, counts = corners.astype(np.int64), counts.astype(np.int64)
    within = not corners.size or 0 <= int(corners.min()) <= int(corners.max()) < len(points)
    counted = bool((counts >= 0).all()) and int(counts.sum()) == len(corners)
    if not (within and counted):
        expected = f"as many indices as it counts, within its {len(points)} points"
        raise InputError(source, str(prim.GetPath()), expected, f"{len(corners)}")
    triangles = points[corners[fan(counts)[0]]]
    is_left_handed = mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return triangles[:, ::-1] if is_left_handed else triangles


def _name(prim: Any) -> str:
    """The name of the transform that holds this mesh alone, or else of the mesh."""
    parent = prim.GetParent()
    holds_it_alone = parent.GetTypeName() == "Xform" and len(parent.GetChildren()) == 1
    return str((parent if holds_it_alone else prim).GetName())
