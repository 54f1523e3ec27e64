"""Collada (.dae), checked, then read by pycollada."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import collada
import numpy as np

from pe_core.base.errors import InputError, shown

from .mesh import FoundMesh, Piece, fan, found, placed

UP = {"X_UP": "+x", "Y_UP": "+y", "Z_UP": "+z"}
MAX_NODES = 200_000
"""Maximum nodes of a scene; repeated instances count each time."""


NO_INDEX = re.compile(r"[^\d\s]\S{0,20}|\d{10,30}")
"""What is no index. The library would cut it: 2.5 to 2, 4294967297 to 1."""


def check_document(source: str, root: Any) -> None:
    """Check up axis, unit, accessors and nodes of a document's XML root, or raise `InputError`."""
    for up in _each(root, "up_axis"):
        if (up.text or "").strip() not in UP:
            raise InputError(source, "up_axis", f"one of {', '.join(UP)}", shown(up.text))
    for unit in _each(root, "unit"):
        metres = unit.get("meter", "1")
        if _number(metres) is None:
            raise InputError(source, "unit", "its length in metres", shown(metres))
    for geometry in _each(root, "geometry"):
        _check_accessors(source, geometry)
    for name in ("p", "v", "vcount"):
        for element in _each(root, name):
            if wrong := NO_INDEX.search(element.text or ""):
                raise InputError(source, name, "whole numbers of up to 9 digits", shown(wrong[0]))
    _check_nodes(source, root)


def _check_accessors(source: str, root: Any) -> None:
    sizes = {
        array.get("id"): len((array.text or "").split()) for array in _each(root, "float_array")
    }
    for accessor in _each(root, "accessor"):
        size = sizes.get((accessor.get("source") or "").removeprefix("#"))
        width = len(list(_each(accessor, "param")))
        if size is None or not width:  # of names, or one that pycollada refuses
            continue
        stride, count, offset = (
            _number(accessor.get(key, default))
            for key, default in (("stride", "1"), ("count", "0"), ("offset", "0"))
        )
        if stride != width or offset != 0:
            expected = f"a stride of its {width} params and no offset"
            found = f"{accessor.get('stride')}, {accessor.get('offset', '0')}"
            raise InputError(source, "accessor", expected, found)
        if count is None or count * stride > size:
            expected = f"elements within the {size} numbers of its array"
            raise InputError(source, "accessor", expected, f"{accessor.get('count')} of {width}")


def _check_nodes(source: str, root: Any) -> None:
    """Count the nodes of all scenes, including repeated instances."""
    named = {node.get("id"): node for node in _each(root, "node") if node.get("id")}
    counts: dict[Any, int] = {}
    waiting = [(node, False) for scene in _each(root, "visual_scene") for node in _nodes(scene)]
    open_nodes: set[Any] = set()
    while waiting:
        node, is_left = waiting.pop()
        urls = (each.get("url") or "" for each in node if _tag(each) == "instance_node")
        instanced = (named.get(url.removeprefix("#")) for url in urls)
        inner = [*_nodes(node), *(target for target in instanced if target is not None)]
        if is_left:
            open_nodes.discard(node)
            counts[node] = 1 + sum(counts.get(child, 0) for child in inner)
            if counts[node] > MAX_NODES:
                found = "more, counted with all instances"
                raise InputError(source, "nodes", f"at most {MAX_NODES:,}", found)
        elif node in open_nodes:
            raise InputError(source, "nodes", "no cycle", f"a cycle with {node.get('id')!r}")
        elif node not in counts:
            open_nodes.add(node)
            waiting.append((node, True))
            waiting += [(child, False) for child in inner if child not in counts]


def _nodes(element: Any) -> list[Any]:
    return [child for child in element if _tag(child) == "node"]


def _each(root: Any, name: str) -> Iterator[Any]:
    return (element for element in root.iter() if _tag(element) == name)


def _tag(element: Any) -> str:
    """An element's name without its namespace; empty for a comment."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


PROLOGUE_BYTES = 1 << 16


def read_dae(path: Path, data: bytes) -> FoundMesh:
    """Read the scene of a Collada file with its up axis and unit; each node is a part.

    Skins, morphs, cameras and lights are ignored.
    """
    source = str(path)
    if b"<!DOCTYPE" in data[:PROLOGUE_BYTES] or b"<!ENTITY" in data[:PROLOGUE_BYTES]:
        raise InputError(source, "XML", "Collada without definitions", "<!DOCTYPE")
    try:
        with warnings.catch_warnings():  # of indices that `check_document` refuses
            warnings.filterwarnings("ignore", "string or file could not be read")
            unsupported = [collada.common.DaeUnsupportedError]
            document = collada.Collada(io.BytesIO(data), ignore=unsupported)
        check_document(source, document.xmlnode.getroot())
        nodes = [] if document.scene is None else document.scene.nodes
        pieces = [piece for node in nodes for piece in _pieces(node)]
        asset = document.assetInfo
        up = UP[asset.upaxis or "Y_UP"]
        metres = 1.0 if asset.unitmeter is None else float(asset.unitmeter)
    except InputError:
        raise
    except Exception as error:  # errors of pycollada, of XML, and others that damaged files cause
        raise InputError(source, "file", "Collada", f"{type(error).__name__}: {error}") from error
    return found(source, pieces, metres, up)


def _pieces(root: Any) -> Iterator[Piece]:
    """Every geometry below a node, depth first, with the name of its node."""
    waiting = [(root, np.eye(4))]
    while waiting:
        node, above = waiting.pop()
        matrix = above @ np.asarray(getattr(node, "matrix", np.eye(4)), float)
        for child in getattr(node, "children", []):
            if isinstance(child, collada.scene.GeometryNode):
                yield from _geometry(node, child.geometry, matrix)
        inner = [child for child in getattr(node, "children", []) if hasattr(child, "children")]
        waiting += [(child, matrix) for child in reversed(inner)]


def _geometry(node: Any, geometry: Any, matrix: Any) -> Iterator[Piece]:
    name = str(getattr(node, "name", None) or geometry.name or geometry.id)
    for primitive in geometry.primitives:
        if isinstance(primitive, collada.lineset.LineSet) or primitive.vertex is None:
            continue
        points, corners = np.asarray(primitive.vertex, float), primitive.vertex_index
        is_triangles = isinstance(primitive, collada.triangleset.TriangleSet)
        counts = np.full(len(corners), 3) if is_triangles else np.array(primitive.vcounts, np.int64)
        flat = np.asarray(corners, np.int64).ravel()
        listed = int(counts.sum())
        if listed != flat.size or np.any(counts < 0):
            raise InputError(name, "geometry", f"the {listed} corners it counts", str(flat.size))
        if flat.size and not 0 <= int(flat.min()) <= int(flat.max()) < len(points):
            expected = f"vertex indices within the {len(points)} vertices"
            raise InputError(name, "geometry", expected, int(flat.max()))
        yield Piece(name, placed(points[flat[fan(counts)[0]]], matrix))
