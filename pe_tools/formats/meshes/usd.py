"""USD (.usd, .usda, .usdc, .usdz): layers checked and counted, then read by usd-core."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Ar, Sdf, Tf, Usd, UsdGeom, UsdUtils

from pe_core.base.errors import InputError
from pe_core.base.files import MESH_BYTES

from .mesh import FoundMesh, Piece, fan, found, placed

MAX_LAYERS = 1_000
MAX_PRIMS = 200_000
"""Maximum prims of a stage; repeated instances count each time."""
MAX_DEPTH = 1_000
"""Maximum nesting of brackets in a text layer."""
PACKAGE, TEXT_MAGIC = ".usdz", b"#usda"
CHUNK_BYTES = 1 << 24
STEPS = np.zeros(256, np.int8)
for _open, _close in ("()", "[]", "{}"):
    STEPS[ord(_open)], STEPS[ord(_close)] = 1, -1


class _UsdLayers:
    """Opened layers, and the number of prims below each of their prims.

    None may be missing, no regular file, not USD or too deeply nested; references may not form a
    circle, nor layers and prims be more than the limits: else `InputError`.
    """

    def __init__(self, source: str) -> None:
        self._source = source
        self._layers: dict[str, Any] = {}
        self._counts: dict[tuple[str, Any], int] = {}

    def prims_below(self, name: str, path: Any, above: tuple[tuple[str, Any], ...]) -> int:
        """Number of prims of a prim of a layer, with all references."""
        key = (name, path)
        if key in above:
            raise InputError(self._source, "references", "no cycle", f"a cycle with {name}")
        if key not in self._counts:
            if len(above) > MAX_DEPTH:
                raise InputError(self._source, "references", f"at most {MAX_DEPTH} deep", "more")
            self._counts[key] = self._count(name, path, (*above, key))
        return self._counts[key]

    def _count(self, name: str, path: Any, above: tuple[tuple[str, Any], ...]) -> int:
        layer = self._layer(name)
        if path == Sdf.Path.absoluteRootPath:
            specs = list(layer.rootPrims)
            total = sum(
                self.prims_below(str(layer.ComputeAbsolutePath(sublayer)), path, above)
                for sublayer in layer.subLayerPaths
            )
        else:
            spec = layer.GetPrimAtPath(path)
            specs, total = ([] if spec is None else [spec]), 0
        while specs:
            spec = specs.pop()
            total += 1
            for to, inner in self._referred(name, layer, spec):
                total += self.prims_below(to, inner, above)
            specs += list(spec.nameChildren)
            for variants in spec.variantSets.values():
                specs += [variant.primSpec for variant in variants.variants.values()]
            if total > MAX_PRIMS:
                found = "more, counted with all references"
                raise InputError(self._source, "prims", f"at most {MAX_PRIMS:,}", found)
        return total

    def _referred(self, name: str, layer: Any, spec: Any) -> Iterator[tuple[str, Any]]:
        """Yield the layer and prim of every reference and payload of a prim."""
        for references in (spec.referenceList, spec.payloadList):
            for reference in references.GetAddedOrExplicitItems():
                layer_name = (
                    str(layer.ComputeAbsolutePath(reference.assetPath))
                    if reference.assetPath
                    else name
                )
                inner = reference.primPath
                if inner.isEmpty:
                    default = self._layer(layer_name).defaultPrim
                    inner = Sdf.Path(f"/{default}") if default else Sdf.Path.absoluteRootPath
                yield layer_name, inner

    def _layer(self, name: str) -> Any:
        if name not in self._layers:
            if len(self._layers) >= MAX_LAYERS:
                raise InputError(self._source, "layers", f"at most {MAX_LAYERS:,}", "more")
            package = Ar.SplitPackageRelativePathOuter(name)[0] if "[" in name else name
            _check_file(self._source, Path(package))
            try:
                layer = Sdf.Layer.FindOrOpen(name)
            except Tf.ErrorException as error:
                lines = [line.strip() for line in str(error).splitlines() if line.strip()]
                raise InputError(name, "file", "USD", [*lines, "an error"][0]) from error
            if layer is None:
                raise InputError(name, "file", "USD", "another file")
            self._layers[name] = layer
        return self._layers[name]


def _check_file(source: str, path: Path) -> None:
    """Raise `InputError` unless a layer's file exists, is regular and not too deeply nested."""
    if not path.exists():
        raise InputError(source, "references", "existing files", f"no file at {path}")
    if not path.is_file():
        raise InputError(path, "file", "a regular file", "something else")
    if path.stat().st_size > MESH_BYTES:
        raise InputError(path, "size", f"at most {MESH_BYTES:,} bytes", f"{path.stat().st_size:,}")
    if path.suffix.lower() == PACKAGE and not zipfile.is_zipfile(path):
        raise InputError(path, "file", "a whole package (.usdz)", "one that is cut short")
    with path.open("rb") as file:
        if file.read(len(TEXT_MAGIC)) != TEXT_MAGIC:
            return
        depth = 0
        while chunk := file.read(CHUNK_BYTES):
            depths = depth + np.cumsum(STEPS[np.frombuffer(chunk, np.uint8)], dtype=np.int64)
            if int(depths.max()) > MAX_DEPTH:
                raise InputError(path, "brackets", f"at most {MAX_DEPTH:,} deep", "more")
            depth = int(depths[-1])


HIDDEN_PURPOSES = ("guide", "proxy")


def read_usd(path: Path, _data: bytes) -> FoundMesh:
    """Read the meshes of a USD stage, with the stage's up axis and unit.

    A part has the name of the transform above its mesh, as Blender and others name objects, or
    the mesh's name. Invisible prims, guides and proxies are ignored. A subdivision surface is
    represented by its cage.
    """
    source = str(path)
    diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # while it exists, USD prints nothing
    try:
        _UsdLayers(source).prims_below(source, Sdf.Path.absoluteRootPath, ())
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
