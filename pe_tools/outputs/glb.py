"""Binary glTF writer: scene elements, the vehicle's body, and the wires of a field of view."""

import json
import struct
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats, Ints
from pe_core.scene import Reference, Vehicle
from pe_core.scoring.sight.ground_cells import chained
from pe_core.version import __version__

from ..graphics import Rgb
from .request import BODY, GLASS, linear
from .solid import MountedView, border

Entries = list[dict[str, Any]]

FLOAT = 5126
UNSIGNED = 5125
ARRAY = 34962
ELEMENTS = 34963
LINES = 1
TRIANGLES = 4
MAGIC = 0x46546C67
JSON_CHUNK = 0x4E4F534A
BINARY_CHUNK = 0x004E4942
EXTERIOR = "Grp_Exterior"
STATIC = "Grp_Exterior_Static"
DYNAMIC = "Grp_Exterior_Dynamic"
REAR_AXLE = "Grp_Rear_Axle_Center"
GLASS_ALPHA = 0.45
SPOKES = 8
"""Lines from the sensor to each border; a picture's begins at a corner, so four go to corners."""


def y_up(points: Floats) -> Floats:
    """Return vectors (..., 3) of the ground frame in glTF's axes, where y is up."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


class GlbScene:
    """Builder of a glTF scene; each method that adds an element returns its index."""

    def __init__(self) -> None:
        self.nodes: Entries = []
        self.meshes: Entries = []
        self.materials: Entries = []
        self.cameras: Entries = []
        self.accessors: Entries = []
        self.views: Entries = []
        self.data = bytearray()

    def add_material(self, name: str, color: Rgb, alpha: float = 1.0, **more: Any) -> int:
        """Add a rough, double-sided material."""
        surface = {"baseColorFactor": [*linear(color), alpha], "metallicFactor": 0.0}
        surface |= {"roughnessFactor": 0.9}
        row = {"doubleSided": True, "alphaMode": "BLEND" if alpha < 1.0 else "OPAQUE"}
        self.materials.append({"name": name, "pbrMetallicRoughness": surface, **row, **more})
        return len(self.materials) - 1

    def add_mesh(
        self, name: str, points: Floats, corners: Ints, material: int, mode: int = TRIANGLES
    ) -> int:
        """Add a mesh of (N, 3) points, ground frame [m], and (F, 3) triangles or (L, 2) lines."""
        positions = y_up(points).astype("<f4")
        bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
        size = {"componentType": FLOAT, "count": len(positions), "type": "VEC3"}
        position = self._accessor(positions, ARRAY, **size, **bounds)
        flat = corners.astype("<u4").ravel()
        size = {"componentType": UNSIGNED, "count": len(flat), "type": "SCALAR"}
        index = self._accessor(flat, ELEMENTS, **size)
        drawn = {"attributes": {"POSITION": position}, "indices": index, "mode": mode}
        self.meshes.append({"name": name, "primitives": [{**drawn, "material": material}]})
        return len(self.meshes) - 1

    def add_node(self, name: str, children: Sequence[int] = (), **more: Any) -> int:
        """Add a node; `more` are its further keys."""
        row: dict[str, Any] = {"name": name} | ({"children": list(children)} if children else {})
        self.nodes.append(row | more)
        return len(self.nodes) - 1

    def encoded(self, root: int) -> bytes:
        """Return the file's bytes; its scene is the node `root` with its descendants."""
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

    def _accessor(self, values: NDArray, target: int, **row: Any) -> int:
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.views.append({**view, "target": target})
        self.data += values.tobytes()  # of four bytes each: the next one is aligned
        self.accessors.append({"bufferView": len(self.views) - 1, **row})
        return len(self.accessors) - 1


def _chunk(kind: int, data: bytes, padding: bytes) -> bytes:
    data += padding * (-len(data) % 4)
    return struct.pack("<II", len(data), kind) + data


def add_vehicle(
    scene: GlbScene,
    vehicle: Vehicle | None,
    reference: Reference | None,
    taken: Collection[str] = (),
) -> list[int]:
    """Add the vehicle's parts and rear axle, if known; return the indices of their root nodes. A
    part whose name is in `taken` gets the suffix "(body)"."""
    groups = []
    if vehicle is not None:
        groups.append(scene.add_node(STATIC, _parts(scene, vehicle, taken)))
    if reference is not None:
        position = np.array([reference.rear_axle_x, 0.0, reference.rear_axle_z])
        axle = scene.add_node(REAR_AXLE, translation=y_up(position).tolist())
        groups.append(scene.add_node(DYNAMIC, [axle]))
    return [scene.add_node(EXTERIOR, groups)] if groups else []


def _parts(scene: GlbScene, vehicle: Vehicle, taken: Collection[str]) -> list[int]:
    materials = (scene.add_material("body", BODY), scene.add_material("glass", GLASS, GLASS_ALPHA))
    nodes = []
    for number, name in enumerate(vehicle.part_names):
        corners = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(corners):
            points, index = np.unique(corners, axis=0, return_inverse=True)
            material = materials[name in vehicle.glass]
            mesh = scene.add_mesh(name, points, index.reshape(-1, 3), material)
            nodes.append(scene.add_node(f"{name} (body)" if name in taken else name, mesh=mesh))
    return nodes


def view_wires(view: MountedView) -> list[Floats]:
    """Return lines (N, 3) in the ground frame [m]: closed borders, and spokes."""
    edges = border(view.faces)
    points = view.origin + view.directions * view.ends[:, None]
    lines = []
    for ring in chained(edges[:, 0], edges[:, 1]):
        lines.append(points[ring])
        start = ring.index(min(ring))
        around = np.array([*ring[start:-1], *ring[:start]])
        spoke_points = around[np.arange(SPOKES) * len(around) // SPOKES]
        lines += [np.stack([view.origin, point]) for point in points[spoke_points]]
    return lines
