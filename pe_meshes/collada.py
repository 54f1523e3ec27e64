"""Collada (.dae), read by pycollada."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import collada
import numpy as np

from pe_core.errors import InputError
from pe_core.formats import FoundMesh

from .collada_checks import UP, check_document
from .pieces import Piece, cut, found, placed

PROLOGUE_BYTES = 1 << 16


def read_dae(path: Path, data: bytes) -> FoundMesh:
    """Read the scene of a Collada file: its up axis and unit are the file's, parts its nodes.

    Skins and morphs are passed over, as are cameras and lights.

    Raises
    ------
    InputError
        Not Collada, or something in it that pycollada does not take.
    """
    source = str(path)
    if b"<!DOCTYPE" in data[:PROLOGUE_BYTES] or b"<!ENTITY" in data[:PROLOGUE_BYTES]:
        raise InputError(source, "XML", "Collada without definitions", "<!DOCTYPE")
    try:
        document = collada.Collada(io.BytesIO(data), ignore=[collada.common.DaeUnsupportedError])
        check_document(source, document.xmlnode.getroot())
        nodes = [] if document.scene is None else document.scene.nodes
        pieces = [piece for node in nodes for piece in _pieces(node)]
        asset = document.assetInfo
        up = UP[asset.upaxis or "Y_UP"]
        metres = 1.0 if asset.unitmeter is None else float(asset.unitmeter)
    except InputError:
        raise
    except Exception as error:  # pycollada's own, XML's, and whatever odd files make of it
        raise InputError(source, "file", "Collada", f"{type(error).__name__}: {error}") from error
    return found(source, pieces, metres, up)


def _pieces(root: Any) -> Iterator[Piece]:
    """Every geometry below a node, depth first, by the name of the node that holds it."""
    waiting = [(root, np.eye(4))]
    while waiting:
        node, above = waiting.pop()
        matrix = above @ np.asarray(getattr(node, "matrix", np.eye(4)), float)
        for child in getattr(node, "children", []):
            if isinstance(child, collada.scene.GeometryNode):
                yield from _geometry(node, child.geometry, matrix)
        below = [each for each in getattr(node, "children", []) if hasattr(each, "children")]
        waiting += [(each, matrix) for each in reversed(below)]


def _geometry(node: Any, geometry: Any, matrix: Any) -> Iterator[Piece]:
    name = str(getattr(node, "name", None) or geometry.name or geometry.id)
    for primitive in geometry.primitives:
        if isinstance(primitive, collada.lineset.LineSet) or primitive.vertex is None:
            continue
        points, corners = np.asarray(primitive.vertex, float), primitive.vertex_index
        if isinstance(primitive, collada.triangleset.TriangleSet):
            counts = np.full(len(corners), 3)
        else:
            counts = primitive.vcounts
        flat = np.asarray(corners, np.int64).ravel()
        listed = int(np.asarray(counts, np.int64).sum())
        if listed != flat.size or np.any(np.asarray(counts) < 0):
            raise InputError(name, "geometry", f"the {listed} corners it counts", str(flat.size))
        if flat.size and not 0 <= int(flat.min()) <= int(flat.max()) < len(points):
            expected = f"vertex indices within the {len(points)} vertices"
            raise InputError(name, "geometry", expected, int(flat.max()))
        yield Piece(name, placed(cut(points, counts, flat), matrix))
