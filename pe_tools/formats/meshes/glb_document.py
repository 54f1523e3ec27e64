"""glTF's JSON document: accessors, buffers, and the tree of nodes with their transforms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError

Item = dict[str, Any]

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


@dataclass(frozen=True, slots=True)
class Document:
    """The JSON root and the binary chunk of one file."""

    source: str
    root: Item
    binary: memoryview

    def error(self, field: str, expected: str, found: str) -> InputError:
        """Return an `InputError` about this file."""
        return InputError(self.source, field, expected, found)

    def item(self, kind: str, index: Any) -> Item:
        """Return item `index` of the array `kind`; raise `InputError` if there is none."""
        items = self.root.get(kind, [])
        if type(index) is not int or not 0 <= index < len(items):
            raise self.error(kind, f"an index below {len(items)}", repr(index))
        item = items[index]
        if not isinstance(item, dict):
            raise self.error(f"{kind}[{index}]", "an object", type(item).__name__)
        return item

    def accessor(self, index: Any, kind: str) -> NDArray[Any]:
        """Return the accessor's values, (N, 1) for SCALAR or (N, 3) for VEC3; not copied.

        One that is sparse, has no data or another type, or reaches beyond its buffer view, raises
        `InputError`.
        """
        accessor = self.item("accessors", index)
        field = f"accessors[{index}]"
        if "sparse" in accessor or "bufferView" not in accessor:
            found = "a sparse one" if "sparse" in accessor else "no bufferView"
            raise self.error(field, "a plain accessor with a bufferView", found)
        if accessor.get("type") != kind or accessor.get("componentType") not in _COMPONENTS:
            found = f"{accessor.get('type')} of {accessor.get('componentType')}"
            raise self.error(field, f"{kind} of a known componentType", found)
        code, width = np.dtype(_COMPONENTS[accessor["componentType"]]), _WIDTHS[kind]
        view_index = accessor["bufferView"]
        view = self.item("bufferViews", view_index)
        data = self._view(f"bufferViews[{view_index}]", view)
        size = code.itemsize * width
        offset = self._whole(field, accessor, "byteOffset", 0)
        count = self._whole(field, accessor, "count")
        stride = self._whole(field, view, "byteStride", size)
        end = offset + stride * (count - 1) + size
        if stride < size or count < 1 or end > len(data):
            expected = f"elements of {size} bytes within the {len(data)} of the bufferView"
            found = f"{count} from {offset}, {stride} apart"
            raise self.error(field, expected, found)
        return np.ndarray((count, width), code, data, offset, (stride, code.itemsize))

    def numbers(self, index: Any, values: NDArray[Any]) -> NDArray[np.float64]:
        """Return values of an accessor as numbers: fractions, if the accessor is normalized."""
        if self.item("accessors", index).get("normalized") and values.dtype.kind in "iu":
            return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return values.astype(np.float64)

    def count(self, index: Any) -> int:
        """Return the number of elements that an accessor states."""
        return self._whole(f"accessors[{index}]", self.item("accessors", index), "count")

    def _view(self, field: str, view: Item) -> memoryview:
        if self._whole(field, view, "buffer") != 0 or "uri" in self.item("buffers", 0):
            raise self.error(field, "data in the file's own binary chunk", "another buffer")
        start = self._whole(field, view, "byteOffset", 0)
        length = self._whole(field, view, "byteLength")
        if start + length > len(self.binary):
            expected = f"bytes within the {len(self.binary)} of the binary chunk"
            raise self.error(field, expected, f"{length} from {start}")
        return self.binary[start : start + length]

    def _whole(self, field: str, item: Item, key: str, default: int | None = None) -> int:
        value = item.get(key, default)
        if type(value) is not int or value < 0:
            raise self.error(f"{field}.{key}", "a whole number from 0 up", repr(value))
        return value


MAX_NODES = 200_000
MAX_PLACED, MAX_PRIMITIVES = 20_000, 100_000
"""Nodes that hold a mesh, and primitives of all meshes: each takes a part of a millisecond."""


def placed_meshes(document: Document) -> Iterator[tuple[str, Any, NDArray[np.float64]]]:
    """Yield each mesh of the default scene, depth first in the file's order.

    Yields its name (of the node or of the mesh, or "node N"), its index, and the transform (4, 4)
    from its coordinates to the scene's [m], glTF axes.
    """
    nodes = document.root.get("nodes", [])
    held = sum(isinstance(node, dict) and "mesh" in node for node in nodes)
    primitives = sum(len(mesh["primitives"]) for mesh in document.root.get("meshes", []))
    hint = " with a mesh (join meshes in the program that wrote it)"
    for field, count, most, more in (
        ("nodes", len(nodes), MAX_NODES, ""),
        ("nodes", held, MAX_PLACED, hint),
        ("primitives", primitives, MAX_PRIMITIVES, ""),
    ):
        if count > most:
            raise document.error(field, f"at most {most:,}{more}", f"{count:,}")
    scenes, indices = document.root.get("scenes"), range(len(nodes))
    if scenes:
        roots = list(document.item("scenes", document.root.get("scene", 0)).get("nodes", []))
    else:  # all nodes count, beginning with those that have no parent
        children = {c for n in indices for c in document.item("nodes", n).get("children", [])}
        roots = [n for n in indices if n not in children]
    waiting = [(index, np.eye(4)) for index in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        index, above = waiting.pop()
        node = document.item("nodes", index)
        field = f"nodes[{index}]"
        if index in seen:
            raise document.error(field, "one parent to a node", "a second parent or a loop")
        seen.add(index)
        world = above @ _local(document, field, node)
        waiting += [(child, world) for child in reversed(node.get("children", []))]
        if "mesh" in node:
            mesh = document.item("meshes", node["mesh"])
            # These move vertices; ignoring them would give a wrong shape without a message.
            if "skin" in node:
                raise document.error(field, "a mesh without a skin", "a skin")
            weights: Any = node.get("weights", mesh.get("weights", []))
            if any(weights):
                raise document.error(field, "a mesh in its basic shape", "morph weights")
            names = node.get("name"), mesh.get("name")
            named = (name for name in names if isinstance(name, str) and name)
            yield next(named, f"node {index}"), node["mesh"], world


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
    """Rotation matrix (3, 3) of a quaternion (x, y, z, w), approximately of unit length."""
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
