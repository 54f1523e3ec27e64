"""Collada (.dae), read by pycollada."""

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import collada
import numpy as np

from pe_core.base.errors import InputError

from .mesh import FoundMesh, Piece, found, placed

UP = {"X_UP": "+x", "Y_UP": "+y", "Z_UP": "+z"}
PROLOGUE_BYTES = 1 << 16


def read_dae(path: Path, data: bytes) -> FoundMesh:
    """Read the scene of a Collada file with its up axis and unit; each node is a part. Skins,
    morphs, cameras and lights are ignored."""
    source = str(path)
    if b"<!DOCTYPE" in data[:PROLOGUE_BYTES] or b"<!ENTITY" in data[:PROLOGUE_BYTES]:
        raise InputError(source, "XML", "Collada without definitions", "<!DOCTYPE")
    try:
        unsupported = [collada.common.DaeUnsupportedError]
        document = collada.Collada(io.BytesIO(data), ignore=unsupported)
        nodes = [] if document.scene is None else document.scene.nodes
        pieces = [piece for node in nodes for piece in _pieces(node)]
        asset = document.assetInfo
        up = UP[asset.upaxis or "Y_UP"]
        metres = 1.0 if asset.unitmeter is None else float(asset.unitmeter)
    except Exception as error:  # errors of pycollada, of XML, and others that damaged files cause
        raise InputError(source, "file", "Collada", f"{type(error).__name__}: {error}") from error
    return found(source, pieces, metres, up)


def _pieces(root: Any) -> Iterator[Piece]:
    """Every geometry below a node, depth first, with the name of its node."""
    waiting = [(root, np.eye(4))]
    while waiting:
        node, above = waiting.pop()
        matrix = above @ np.asarray(getattr(node, "matrix", np.eye(4)), float)
        inner = getattr(node, "children", [])
        for child in inner:
            if isinstance(child, collada.scene.GeometryNode):
                geometry = child.geometry
                name = str(getattr(node, "name", None) or geometry.name or geometry.id)
                for triangles in map(_triangles, geometry.primitives):
                    yield Piece(name, placed(triangles, matrix))
        waiting += [(child, matrix) for child in reversed(inner) if hasattr(child, "children")]


def _triangles(primitive: Any) -> Any:
    """The triangles (F, 3, 3) of a primitive; polygons are cut into fans, lines have none."""
    if isinstance(primitive, collada.lineset.LineSet) or primitive.vertex is None:
        return np.zeros((0, 3, 3))
    is_triangles = isinstance(primitive, collada.triangleset.TriangleSet)
    shape = primitive if is_triangles else primitive.triangleset()
    return np.asarray(shape.vertex, float)[shape.vertex_index]
