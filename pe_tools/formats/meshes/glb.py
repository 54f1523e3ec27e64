"""Binary glTF 2.0: the container, and the scene's triangles in its own axes."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, require_memory
from pe_core.geometry.poses import rotate
from pe_core.scene.mesh import Mesh

from .glb_document import Document, Item, placed_meshes
from .mesh import fan, gathered, make_mesh, require_room

Faceted = tuple[Floats, NDArray[Any]]
"""Points (N, 3) and the corners (F, 3) among them of triangles."""

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_NONE = np.zeros((0, 3, 3))
_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quant")

MAX_CHUNKS = 100
MAX_JSON_BYTES = 32 << 20
JSON_UNFOLDS = 30
"""Maximum size of the JSON scene, and memory of one of its bytes after reading (measured)."""


def read_glb(path: Path, data: bytes) -> Mesh:
    """Read the default scene of a binary glTF 2.0 file.

    glTF is right-handed with +Y up, +Z forward and -X right, in metres. The corners that are
    returned have these axes, too. The transforms of all nodes down to a mesh are applied. A
    transform that mirrors also reverses the triangles, so their outer sides stay outside. A
    part has the name of the node with the mesh, or of the mesh. Points and lines are ignored.
    Draco or meshopt compression, sparse accessors, skins, morph weights, and buffers in other files
    are refused.
    """
    source = str(path)
    text, binary = _chunks(source, data)
    try:
        document = Document(source, _parse(source, text), binary)
        # For an extension that is used but not required, the file has a fallback.
        for name in document.root.get("extensionsRequired", []):
            if not str(name).startswith(_HARMLESS):
                expected = "a file without compression or other geometry extensions"
                raise document.error("extensionsRequired", expected, str(name))
        return _scene(document)
    except InputError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError) as error:
        # Earlier checks report the usual errors; this one is for JSON with another structure.
        raise InputError(source, "JSON", "a well-formed glTF scene", error) from error


def _chunks(source: str, data: bytes) -> tuple[bytes, memoryview]:
    """The JSON chunk and the binary chunk (empty if there is none), which is not copied."""
    if data[:4] != b"glTF" or len(data) < 12:
        raise InputError(source, "header", "12 bytes beginning with 'glTF'", data[:12])
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise InputError(source, "version", "2", str(version))
    if length > len(data):
        raise InputError(source, "length", f"{length} bytes", f"{len(data)}")
    chunks: dict[bytes, memoryview] = {}
    offset, count = 12, 0
    while offset + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, offset)
        offset, count = offset + 8, count + 1
        if offset + size > length:
            found = f"{length - offset} left"
            raise InputError(source, f"chunk {kind!r}", f"{size} bytes", found)
        if count > MAX_CHUNKS:
            raise InputError(source, "chunks", f"at most {MAX_CHUNKS}", "more")
        chunks.setdefault(kind, memoryview(data)[offset : offset + size])
        offset += size
    if b"JSON" not in chunks:
        raise InputError(source, "chunk JSON", "one", "none")
    return bytes(chunks[b"JSON"]), chunks.get(b"BIN\0", memoryview(b""))


def _parse(source: str, text: bytes) -> Item:
    if len(text) > MAX_JSON_BYTES:
        expected = f"a scene of at most {MAX_JSON_BYTES:,} bytes"
        raise InputError(source, "JSON", expected, f"{len(text):,}")
    require_memory(source, "JSON", len(text) * JSON_UNFOLDS)
    try:
        root = json.loads(text.decode("utf-8"), parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise InputError(source, "JSON", "valid JSON in UTF-8", str(error)) from error
    if not isinstance(root, dict):
        raise InputError(source, "JSON", "an object", type(root).__name__)
    return root


def _no_number(word: str) -> None:
    raise ValueError(f"{word}, which JSON has no number for")


def _scene(document: Document) -> Mesh:
    """All placed meshes; the number of triangles is checked before any is created."""
    placed = list(placed_meshes(document))
    sizes = {index: _size(document, index) for index in dict.fromkeys(m for _, m, _ in placed)}
    require_room(document.source, sum(sizes[index] for _, index, _ in placed))
    # Each mesh is read once, even if several nodes use it.
    shapes = {index: _shape(document, index) for index in sizes}
    surfaces = [each for _, m, world in placed for each in _place(shapes[m], world)]
    triangles = surfaces[0] if len(surfaces) == 1 else np.concatenate([_NONE, *surfaces])
    counts = [sizes[index] for _, index, _ in placed]
    parts = np.repeat(np.arange(len(placed), dtype=np.int32), counts)
    return make_mesh(document.source, triangles, parts, [name for name, _, _ in placed])


def _size(document: Document, index: int) -> int:
    """Number of triangles of a mesh, from the counts of its accessors."""
    total = 0
    for primitive in document.item("meshes", index)["primitives"]:
        if _has_faces(primitive):
            count = document.count(_corner_list(primitive))
            total += count // 3 if _mode(primitive) == _TRIANGLES else max(count - 2, 0)
    return total


def _mode(primitive: Item) -> Any:
    return primitive.get("mode", _TRIANGLES)


def _has_faces(primitive: Item) -> bool:
    return _mode(primitive) in (_TRIANGLES, _STRIP, _FAN) and "POSITION" in primitive["attributes"]


def _corner_list(primitive: Item) -> Any:
    """Index of the accessor that lists a primitive's corners, one after the other."""
    indexed = "indices" in primitive
    return primitive["indices"] if indexed else primitive["attributes"]["POSITION"]


def _shape(document: Document, index: int) -> list[Faceted]:
    """The triangles of a mesh in its own frame."""
    primitives = document.item("meshes", index)["primitives"]
    return [_primitive(document, primitive) for primitive in primitives if _has_faces(primitive)]


def _primitive(document: Document, primitive: Item) -> Faceted:
    """The triangles of a primitive in its mesh's own frame."""
    mode, listed = _mode(primitive), _corner_list(primitive)
    positions = primitive["attributes"]["POSITION"]
    points = document.accessor(positions, "VEC3")
    order: NDArray[Any] = np.arange(len(points))
    if "indices" in primitive:
        order = document.accessor(listed, "SCALAR").ravel()
        if order.dtype.kind != "u" or int(order.max()) >= len(points):
            expected = f"whole numbers within the {len(points)} vertices"
            raise document.error(f"accessors[{listed}]", expected, f"up to {order.max()}")
    if mode == _TRIANGLES and len(order) % 3:
        raise document.error("primitive", "three corners to a triangle", f"{len(order)} corners")
    corners = _corners(mode, order)
    if corners.size < len(points):
        # Only the corners become doubles: many small primitives may share a long list of points.
        points = points[corners.ravel()]
        corners = np.arange(len(points)).reshape(-1, 3)
    return document.numbers(positions, points), corners


def _corners(mode: int, order: NDArray[Any]) -> NDArray[Any]:
    """Positions (F, 3) in the corner list of the corners of a primitive's triangles."""
    if mode == _TRIANGLES:
        return order.reshape(-1, 3)
    if mode == _FAN:
        return order[fan(np.array([len(order)]))[0]]
    first = np.arange(max(len(order) - 2, 0))
    # Every second triangle of a strip has the reverse order.
    odd = first % 2
    return order[np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)]


def _place(surfaces: list[Faceted], world: Floats) -> Iterator[Floats]:
    """Triangles (F, 3, 3) of surfaces with a node's transform applied."""
    linear = world[:3, :3]
    mirrors = np.linalg.det(linear) < 0
    for points, corners in surfaces:
        moved = rotate(linear, points) + world[:3, 3]
        yield gathered(moved, corners[:, ::-1] if mirrors else corners)
