"""The glTF node hierarchy: which mesh stands where, under which name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .glb_document import Document, Item

MOST_NODES = 200_000
MAX_PLACED, MAX_PRIMITIVES = 20_000, 100_000
"""Nodes that hold a mesh, and primitives of all meshes: each takes a part of a millisecond."""


def placed_meshes(document: Document) -> Iterator[tuple[str, Any, NDArray[np.float64]]]:
    """Each mesh of the default scene, depth first in the file's order.

    Yields
    ------
    name : str
        The node's name, or else the mesh's, or else "node N".
    mesh : int
        Index of the mesh, not checked yet.
    world : (4, 4) float64
        From the mesh's coordinates to the scene's [m], glTF axes.
    """
    count = len(document.root.get("nodes", []))
    if count > MOST_NODES:
        raise document.error("nodes", f"at most {MOST_NODES:,}", f"{count:,}")
    _require_few_pieces(document)
    waiting = [(index, np.eye(4)) for index in reversed(_roots(document))]
    seen: set[int] = set()
    while waiting:
        index, above = waiting.pop()
        node = document.item("nodes", index)
        field = f"nodes[{index}]"
        if index in seen:
            raise document.error(field, "one parent to a node", "a second one or a loop")
        seen.add(index)
        world = above @ _local(document, field, node)
        waiting += [(child, world) for child in reversed(node.get("children", []))]
        if "mesh" in node:
            mesh = document.item("meshes", node["mesh"])
            _require_rigid(document, field, node, mesh)
            yield _name(node, mesh, f"node {index}"), node["mesh"], world


def _require_few_pieces(document: Document) -> None:
    """Count nodes with a mesh, and primitives, before any is placed."""
    nodes = document.root.get("nodes", [])
    placed = sum(isinstance(node, dict) and "mesh" in node for node in nodes)
    if placed > MAX_PLACED:
        expected = f"at most {MAX_PLACED:,} with a mesh (join meshes in the program that wrote it)"
        raise document.error("nodes", expected, f"{placed:,}")
    primitives = sum(len(mesh["primitives"]) for mesh in document.root.get("meshes", []))
    if primitives > MAX_PRIMITIVES:
        raise document.error("primitives", f"at most {MAX_PRIMITIVES:,}", f"{primitives:,}")


def _roots(document: Document) -> list[Any]:
    if document.root.get("scenes"):
        return list(document.item("scenes", document.root.get("scene", 0)).get("nodes", []))
    # Without scenes everything counts, from the nodes that are nobody's children.
    nodes = range(len(document.root.get("nodes", [])))
    children = {c for n in nodes for c in document.item("nodes", n).get("children", [])}
    return [n for n in nodes if n not in children]


def _require_rigid(document: Document, field: str, node: Item, mesh: Item) -> None:
    # These move vertices; leaving them out would read a wrong shape without a word.
    if "skin" in node:
        raise document.error(field, "a mesh without a skin", "a skin")
    weights: Any = node.get("weights", mesh.get("weights", []))
    if any(weights):
        raise document.error(field, "a mesh in its basic shape", "morph weights")


def _name(node: Item, mesh: Item, default: str) -> str:
    names = (node.get("name"), mesh.get("name"))
    return next((name for name in names if isinstance(name, str) and name), default)


def _local(document: Document, field: str, node: Item) -> NDArray[np.float64]:
    """The node's own transform (4, 4): its matrix, or translation x rotation x scale."""
    if "matrix" in node:
        columns = _numbers(document, field, node, "matrix", np.eye(4).ravel())
        return columns.reshape(4, 4).T
    local = np.eye(4)
    local[:3, 3] = _numbers(document, field, node, "translation", np.zeros(3))
    rotation = _numbers(document, field, node, "rotation", np.array([0.0, 0.0, 0.0, 1.0]))
    if not rotation.any():
        raise document.error(f"{field}.rotation", "a unit quaternion", "zeros")
    scale = _numbers(document, field, node, "scale", np.ones(3))
    local[:3, :3] = _rotation(rotation) * scale
    return local


def _rotation(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) of a quaternion (x, y, z, w), which need not be quite unit."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _numbers(
    document: Document, field: str, node: Item, key: str, default: NDArray[np.float64]
) -> NDArray[np.float64]:
    given = node.get(key, default)
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        values = np.array(np.nan)
    if values.shape != default.shape or not np.isfinite(values).all():
        raise document.error(f"{field}.{key}", f"{default.size} finite numbers", repr(given))
    return values
