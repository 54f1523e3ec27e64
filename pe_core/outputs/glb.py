"""Binary glTF 2.0 put together: meshes, materials, cameras and nodes.

glTF has y up and z to the right of one who looks along x: what comes in is in our axes (x forward,
y left, z up) and is turned on its way, as Blender's exporter does.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..version import __version__
from .colors import Rgb, linear

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Entries = list[dict[str, Any]]

FLOAT, UNSIGNED = 5126, 5125
ARRAY, ELEMENTS = 34962, 34963
LINES, TRIANGLES = 1, 4
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942


def y_up(points: Floats) -> Floats:
    """Turn (..., 3) vectors of ours to glTF's axes."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


class GlbScene:
    """A glTF scene as it grows; what is added is told by its number."""

    def __init__(self) -> None:
        self.nodes: Entries = []
        self.meshes: Entries = []
        self.materials: Entries = []
        self.cameras: Entries = []
        self.accessors: Entries = []
        self.views: Entries = []
        self.data = bytearray()

    def add_material(self, name: str, color: Rgb, alpha: float = 1.0, **more: Any) -> int:
        """Add a rough material that is seen from both sides."""
        look: dict[str, Any] = {"baseColorFactor": [*linear(color), alpha], "metallicFactor": 0.0}
        row = {"doubleSided": True, "alphaMode": "BLEND" if alpha < 1.0 else "OPAQUE"}
        look["roughnessFactor"] = 0.9
        self.materials.append({"name": name, "pbrMetallicRoughness": look, **row, **more})
        return len(self.materials) - 1

    def add_mesh(
        self, name: str, points: Floats, corners: Ints, material: int, mode: int = TRIANGLES
    ) -> int:
        """Add a mesh of (N, 3) points, ours [m], and (F, 3) triangles or (L, 2) lines."""
        places = y_up(points).astype("<f4")
        ends = {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
        position = self._accessor(places, FLOAT, "VEC3", ARRAY, len(places), ends)
        flat = corners.astype("<u4").ravel()
        index = self._accessor(flat, UNSIGNED, "SCALAR", ELEMENTS, len(flat), {})
        drawn = {"attributes": {"POSITION": position}, "indices": index, "mode": mode}
        self.meshes.append({"name": name, "primitives": [{**drawn, "material": material}]})
        return len(self.meshes) - 1

    def add_node(self, name: str, children: Sequence[int] = (), **more: Any) -> int:
        """Add a node; `more` are its further keys."""
        row: dict[str, Any] = {"name": name} | ({"children": list(children)} if children else {})
        self.nodes.append(row | more)
        return len(self.nodes) - 1

    def encoded(self, root: int) -> bytes:
        """Return the file whose scene is one node and what hangs on it."""
        document = {
            "asset": {"version": "2.0", "generator": f"perception-entropy {__version__}"},
            "scene": 0,
            "scenes": [{"name": "Scene", "nodes": [root]}],
            "buffers": [{"byteLength": len(self.data)}] if self.data else [],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "cameras": self.cameras,
            "accessors": self.accessors,
            "bufferViews": self.views,
        }
        text = json.dumps({key: value for key, value in document.items() if value != []}).encode()
        chunks = [_chunk(JSON_CHUNK, text, b" ")]
        chunks += [_chunk(BINARY_CHUNK, bytes(self.data), b"\0")] if self.data else []
        size = 12 + sum(map(len, chunks))
        return struct.pack("<III", MAGIC, 2, size) + b"".join(chunks)

    def _accessor(
        self,
        values: NDArray,
        number: int,
        shape: str,
        target: int,
        count: int,
        ends: dict[str, Any],
    ) -> int:
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.views.append({**view, "target": target})
        self.data += values.tobytes()  # of four bytes each: the next one is aligned
        row = {"bufferView": len(self.views) - 1, "componentType": number, "count": count}
        self.accessors.append({**row, "type": shape, **ends})
        return len(self.accessors) - 1


def _chunk(kind: int, data: bytes, padding: bytes) -> bytes:
    data += padding * (-len(data) % 4)
    return struct.pack("<II", len(data), kind) + data
