"""Collada (.dae), read by pycollada."""

import io
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import collada
import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError

from ..xml_text import parse_xml
from .mesh import FoundMesh, Piece, found, mesh_notes, placed, require_room
from .polygons import Corners, joined_ring, triangle_count, triangulate
from .whole_numbers import refusing_unread_text

UP = {"X_UP": "+x", "Y_UP": "+y", "Z_UP": "+z"}
PACKED = b"PK\3\4"
"""Beginning of an archive: pycollada would unpack one without a limit."""
LOOKS = {"images", "effects", "materials", "animations", "animation_clips", "cameras", "lights"}
LOOKS |= {"controllers", "physics_models", "physics_materials", "physics_scenes", "force_fields"}
NOT_READ = {f"library_{name}" for name in LOOKS}
NOT_READ |= {"bind_material", "instance_camera", "instance_light", "extra"}
"""Elements that say nothing of the shape; an image among them may be missing."""
SKIPPED = {"lines": "set of lines", "linestrips": "set of lines", "spline": "curve"}
SKIPPED |= {"instance_controller": "skinned or morphed mesh", "convex_mesh": "convex hull"}
SKIPPED |= {"brep": "solid with curved faces"}
"""Elements with geometry that is not read, and what it is."""


def read_dae(path: Path, data: bytes) -> FoundMesh:
    """Read the scene of a Collada file with its up axis and unit; each node is a part. Polygons may
    have holes. Skins, morphs and lines are left out and counted."""
    source = str(path)
    if data.startswith(PACKED):
        raise InputError(source, "file", "Collada", "an archive: unpack it first")
    root = parse_xml(source, data)
    skipped = _pruned(root)
    try:
        with refusing_unread_text():
            document = collada.Collada(io.BytesIO(ElementTree.tostring(root)))
        nodes = [] if document.scene is None else document.scene.nodes
        pieces = []
        crossing = 0
        few: list[Corners] = []
        for name, matrix, primitive in _primitives(nodes):
            corners, counts = _rings(source, primitive)
            require_room(source, triangle_count(counts))
            cut = triangulate(source, corners, counts)
            pieces.append(Piece(name, placed(cut.triangles, matrix)))
            crossing += cut.crossing
            few.append(counts[counts < 3])
        asset = document.assetInfo
        up = UP[asset.upaxis or "Y_UP"]
        metres = 1.0 if asset.unitmeter is None else float(asset.unitmeter)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # errors of pycollada, and others that damaged files cause
        raise InputError(source, "file", "Collada", f"{type(error).__name__}: {error}") from error
    notes = mesh_notes(skipped, np.concatenate([np.zeros(0, np.int64), *few]), crossing)
    return found(source, pieces, metres, up, notes=notes)


def _tag(element: ElementTree.Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _pruned(root: ElementTree.Element) -> Counter[str]:
    """Remove what is not read; return how much of it is geometry, by its noun."""
    skipped: Counter[str] = Counter()
    waiting = [root]
    while waiting:
        element = waiting.pop()
        for child in list(element):
            tag = _tag(child)
            if tag in SKIPPED:
                skipped[SKIPPED[tag]] += 1
            if tag in SKIPPED or tag in NOT_READ:
                element.remove(child)
            else:
                waiting.append(child)
    return skipped


def _primitives(roots: Sequence[Any]) -> Iterator[tuple[str, Floats, Any]]:
    """Every primitive below some nodes, depth first, with its node's name and transform (4, 4)."""
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    while waiting:
        node, above = waiting.pop()
        matrix = above @ np.asarray(getattr(node, "matrix", np.eye(4)), float)
        inner = getattr(node, "children", [])
        for child in inner:
            if isinstance(child, collada.scene.GeometryNode):
                geometry = child.geometry
                name = str(getattr(node, "name", None) or geometry.name or geometry.id)
                for primitive in geometry.primitives:
                    yield name, matrix, primitive
        waiting += [(child, matrix) for child in reversed(inner) if hasattr(child, "children")]


def _rings(source: str, primitive: Any) -> tuple[Floats, Corners]:
    """The corners (C, 3) of all polygons of a primitive in one list, and how many each has."""
    rings = [_with_holes(source, primitive, element) for element in _holed(primitive)]
    corners = [np.zeros((0, 3)), *rings]
    counts = [len(ring) for ring in rings]
    if primitive.vertex is not None:
        points = np.asarray(primitive.vertex, float)
        corners.insert(0, _checked(source, points, np.ravel(primitive.vertex_index)))
        is_triangles = isinstance(primitive, collada.triangleset.TriangleSet)
        sizes = [3] * len(primitive) if is_triangles else primitive.vcounts.tolist()
        counts = [*sizes, *counts]
    return np.concatenate(corners), np.array(counts, np.int64)


def _checked(source: str, points: Floats, indices: Corners) -> Floats:
    """The points that indices name."""
    if len(indices) and not 0 <= int(indices.min()) <= int(indices.max()) < len(points):
        expected = f"indices within {len(points)} vertices"
        raise InputError(source, "faces", expected, f"{indices.min()} to {indices.max()}")
    return points[indices]


def _holed(primitive: Any) -> list[ElementTree.Element]:
    """The polygons with holes of a primitive, which pycollada leaves out."""
    return [element for element in primitive.xmlnode if _tag(element) == "ph"]


def _with_holes(source: str, primitive: Any, polygon: ElementTree.Element) -> Floats:
    """The corners (N, 3) of a polygon and its holes as one ring."""
    offset, _, _, _, vertices = primitive.sources["VERTEX"][0]
    every = 1 + max(each[0] for inputs in primitive.sources.values() for each in inputs)
    points = np.asarray(vertices.data, float)
    lists = [child.text or "" for child in polygon]
    indices = [np.array(text.split(), np.int64)[offset::every] for text in lists]
    rings = [_checked(source, points, each) for each in indices if len(each) >= 3]
    if not rings:
        return np.zeros((0, 3))
    corners: Floats = np.concatenate(rings)[joined_ring(rings)]
    return corners
