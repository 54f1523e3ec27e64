"""USD (.usd, .usda, .usdc, .usdz): read by usd-core."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdUtils

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, require_name

from .mesh import FoundMesh, Piece, found, mesh_notes, placed, require_room
from .polygons import Corners, triangulate
from .usd_solids import SOLIDS, TO_AXIS

HIDDEN_PURPOSES = ("guide", "proxy")
TIME = Usd.TimeCode.EarliestTime()
HOLE = "face that is a hole"
MAX_DEPTH = 8  # Instancers within prototypes of instancers, at most


def read_usd(path: Path, _data: bytes) -> FoundMesh:
    """Read the meshes and solids of a USD stage, with the stage's up axis and unit, and what point
    instancers place. A part has the name of the transform above its mesh, as Blender and others
    name objects, or the mesh's name. Invisible prims, guides and proxies are ignored; curves,
    points and other geometry are left out and counted. A subdivision surface is represented by its
    cage."""
    source = str(path)
    diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # while it exists, USD prints nothing
    try:
        stage = Usd.Stage.Open(source)
        if errors := stage.GetCompositionErrors():
            problem = " ".join(str(errors[0]).split())
            raise InputError(source, "composition", "layers that fit together", problem)
        reading = _StageReading(source)
        pieces = list(reading.pieces(stage.GetPseudoRoot(), np.eye(4), 0))
    except Tf.ErrorException as error:
        raise InputError(source, "file", "USD", " ".join(str(error).split())) from error
    finally:
        del diagnostics
    up = "+y" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else "+z"
    notes = mesh_notes(reading.skipped, np.array(reading.counts), reading.crossing)
    return found(source, pieces, UsdGeom.GetStageMetersPerUnit(stage), up, notes=notes)


@dataclass(slots=True)
class _StageReading:
    """The reading of a stage: what is left out of it, and the triangles so far."""

    source: str
    cache: Any = field(default_factory=lambda: UsdGeom.XformCache(TIME))
    skipped: Counter[str] = field(default_factory=Counter)
    counts: list[int] = field(default_factory=list)
    crossing: int = 0
    triangles: int = 0

    def pieces(self, root: Any, world: Floats, depth: int) -> Iterator[Piece]:
        """Every visible shape below a prim, and of it. `world` (4, 4) is from the root's own frame,
        and from the stage's for the stage's root."""
        prims = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies()))
        for prim in prims:
            if not (image := UsdGeom.Imageable(prim)) or _is_hidden(image):
                continue
            local, _ = self.cache.ComputeRelativeTransform(prim, root)
            matrix = world @ _columns(local)
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
                yield from self._instances(UsdGeom.PointInstancer(prim), matrix, depth)
                continue
            triangles = self._shape(prim)
            if len(triangles):
                self.triangles += len(triangles)
                require_room(self.source, self.triangles)
                yield Piece(_name(prim), placed(triangles, matrix))

    def _instances(self, instancer: Any, world: Floats, depth: int) -> Iterator[Piece]:
        """Every prototype of a point instancer, wherever it places one."""
        if depth >= MAX_DEPTH:
            path = str(instancer.GetPath())
            raise InputError(self.source, path, f"at most {MAX_DEPTH} instancers in a row", "more")
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        stage = instancer.GetPrim().GetStage()
        indices = np.array(instancer.GetProtoIndicesAttr().Get(TIME) or (), np.int64)
        if len(shown := instancer.ComputeMaskAtTime(TIME)):
            indices = indices[np.array(shown, np.bool_)]
        transforms = instancer.ComputeInstanceTransformsAtTime(TIME, TIME)
        within = not len(indices) or 0 <= int(indices.min()) <= int(indices.max()) < len(targets)
        if len(transforms) != len(indices) or not within:
            expected = f"a place for each index within its {len(targets)} prototypes"
            found = f"{len(indices)} indices"
            raise InputError(self.source, str(instancer.GetPath()), expected, found)
        for index, transform in zip(indices.tolist(), transforms, strict=True):
            prototype = stage.GetPrimAtPath(targets[index])
            yield from self.pieces(prototype, world @ _columns(transform), depth + 1)

    def _shape(self, prim: Any) -> Floats:
        """The triangles (F, 3, 3) of a prim in its own frame; none of what is left out."""
        kind = str(prim.GetTypeName())
        if prim.IsA(UsdGeom.Mesh):
            return self._mesh(prim, UsdGeom.Mesh(prim))
        if kind in SOLIDS:
            axis = prim.GetAttribute("axis").Get(TIME)
            if axis is not None:
                require_name(self.source, f"{prim.GetPath()}, axis", axis, TO_AXIS)
            solid: Callable[[Callable[[str], Any]], Floats] = SOLIDS[kind]
            return solid(lambda name: prim.GetAttribute(name).Get(TIME))
        if prim.IsA(UsdGeom.Gprim):
            self.skipped[kind] += 1
        return np.zeros((0, 3, 3))

    def _mesh(self, prim: Any, mesh: Any) -> Floats:
        points, corners, counts, holes = _polygons(self.source, prim, mesh)
        self.skipped[HOLE] += holes
        require_room(self.source, self.triangles + len(corners))
        cut = triangulate(self.source, points[corners], counts)
        self.crossing += cut.crossing
        self.counts += counts[counts < 3].tolist()
        is_left_handed = mesh.GetOrientationAttr().Get(TIME) == UsdGeom.Tokens.leftHanded
        return cut.triangles[:, ::-1] if is_left_handed else cut.triangles


def _polygons(source: str, prim: Any, mesh: Any) -> tuple[Floats, Corners, Corners, int]:
    """Points (P, 3) of a mesh, the corners of its faces in one list, how many each face has, and
    the number of further faces, which the mesh calls holes."""
    attributes = (
        mesh.GetPointsAttr(),
        mesh.GetFaceVertexCountsAttr(),
        mesh.GetFaceVertexIndicesAttr(),
        mesh.GetHoleIndicesAttr(),
    )
    points, counts, corners, holes = (np.array(each.Get(TIME) or ()) for each in attributes)
    points = points.astype(float).reshape(-1, 3)
    corners, counts, holes = (each.astype(np.int64) for each in (corners, counts, holes))
    within = not corners.size or 0 <= int(corners.min()) <= int(corners.max()) < len(points)
    counted = bool((counts >= 0).all()) and int(counts.sum()) == len(corners)
    if not (within and counted):
        expected = f"as many indices as it counts, within its {len(points)} points"
        raise InputError(source, str(prim.GetPath()), expected, f"{len(corners)}")
    is_hole = np.isin(np.arange(len(counts)), holes)
    return points, corners[~np.repeat(is_hole, counts)], counts[~is_hole], int(is_hole.sum())


def _is_hidden(image: Any) -> bool:
    if image.ComputePurpose() in HIDDEN_PURPOSES:
        return True
    return bool(image.ComputeVisibility(TIME) == UsdGeom.Tokens.invisible)


def _columns(matrix: Any) -> Floats:
    """A matrix for columns, as ours are; USD multiplies rows by its own."""
    return np.array(Gf.Matrix4d(matrix), float).T


def _name(prim: Any) -> str:
    """The name of the transform that holds this mesh alone, or else of the mesh."""
    parent = prim.GetParent()
    holds_it_alone = parent.GetTypeName() == "Xform" and len(parent.GetChildren()) == 1
    return str((parent if holds_it_alone else prim).GetName())
