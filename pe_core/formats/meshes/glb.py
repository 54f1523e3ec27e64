"""Binary glTF 2.0: the container, and the scene's triangles in the ground frame."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .glb_document import Document, Item
from .glb_nodes import placed_meshes
from .mesh import Mesh, fan, make_mesh

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quant")


def read_glb(path: Path, data: bytes) -> Mesh:
    """Read the default scene of a binary glTF 2.0 file.

    glTF is right-handed with +Y up, +Z forward and -X right, in metres. Corners are turned
    into the ground frame: x forward = +Z, y left = +X, z up = +Y. Each node's transforms are
    applied down the hierarchy; a mirroring one also reverses its triangles, so that their
    outer sides stay outside. Parts are the names of the nodes that hold a mesh, or else of
    the mesh. Points and lines are passed over.

    Raises
    ------
    InputError
        Not binary glTF 2.0, cut short, malformed or with an index out of range; something
        this reader has no notion of (Draco or meshopt compression, sparse accessors, skins,
        morph weights, buffers in other files); coordinates not finite, or no triangles.
    """
    source = str(path)
    text, binary = _chunks(source, data)
    try:
        document = Document(source, _parse(source, text), binary)
        _require_known(document)
        return _scene(document)
    except InputError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError) as error:
        # The checks on the way name the usual faults; this is for JSON of another shape.
        raise InputError(source, "JSON", "a well-formed glTF scene", repr(error)) from error


def _chunks(source: str, data: bytes) -> tuple[bytes, bytes]:
    """The JSON chunk and the binary one (empty if there is none)."""
    if data[:4] != b"glTF" or len(data) < 12:
        raise InputError(source, "header", "12 bytes beginning with 'glTF'", repr(data[:12]))
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise InputError(source, "version", "2", str(version))
    if length > len(data):
        raise InputError(source, "length", f"{length} bytes", f"{len(data)}")
    chunks: dict[bytes, bytes] = {}
    offset = 12
    while offset + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, offset)
        offset += 8
        if offset + size > length:
            found = f"{length - offset} left"
            raise InputError(source, f"chunk {kind!r}", f"{size} bytes", found)
        chunks.setdefault(kind, data[offset : offset + size])
        offset += size
    if b"JSON" not in chunks:
        raise InputError(source, "chunk JSON", "one", "none")
    return chunks[b"JSON"], chunks.get(b"BIN\0", b"")


def _parse(source: str, text: bytes) -> Item:
    try:
        root = json.loads(text.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(source, "JSON", "valid JSON in UTF-8", str(error)) from error
    if not isinstance(root, dict):
        raise InputError(source, "JSON", "an object", type(root).__name__)
    return root


def _require_known(document: Document) -> None:
    # Of extensions only used, not required, the file holds a plain fallback.
    for name in document.root.get("extensionsRequired", []):
        if not str(name).startswith(_HARMLESS):
            expected = "a file without compression or other geometry extensions"
            raise document.error("extensionsRequired", expected, str(name))


def _scene(document: Document) -> Mesh:
    triangles = [np.zeros((0, 3, 3))]
    parts = [np.zeros(0, dtype=np.int32)]
    names: list[str] = []
    for name, index, world in placed_meshes(document):
        for primitive in document.item("meshes", index)["primitives"]:
            placed = _place(_primitive(document, primitive), world)
            triangles.append(placed)
            parts.append(np.full(len(placed), len(names), dtype=np.int32))
        names.append(name)
    return make_mesh(document.source, np.concatenate(triangles), np.concatenate(parts), names)


def _primitive(document: Document, primitive: Item) -> NDArray[np.float64]:
    """Triangles (F, 3, 3) of a primitive in its mesh's own frame."""
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN) or "POSITION" not in primitive["attributes"]:
        return np.zeros((0, 3, 3))
    points = document.accessor(primitive["attributes"]["POSITION"], "VEC3").astype(np.float64)
    order: NDArray[Any] = np.arange(len(points))
    if "indices" in primitive:
        order = document.accessor(primitive["indices"], "SCALAR").ravel()
        if order.dtype.kind != "u" or (order >= len(points)).any():
            expected = f"whole numbers within the {len(points)} vertices"
            field = f"accessors[{primitive['indices']}]"
            raise document.error(field, expected, f"up to {order.max()}")
    if mode == _TRIANGLES and len(order) % 3:
        raise document.error("primitive", "three corners to a triangle", f"{len(order)} corners")
    return points[order[_corners(mode, len(order))]]


def _corners(mode: int, count: int) -> NDArray[np.int64]:
    """Which of a primitive's `count` corners make up its triangles (F, 3)."""
    if mode == _TRIANGLES:
        return np.arange(count).reshape(-1, 3)
    if mode == _FAN:
        return fan(np.array([count]))[0]
    first = np.arange(max(count - 2, 0))
    # Every other triangle of a strip runs the other way round.
    odd = first % 2
    return np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)


def _place(triangles: NDArray[np.float64], world: NDArray[np.float64]) -> NDArray[np.float64]:
    placed = triangles @ world[:3, :3].T + world[:3, 3]
    if np.linalg.det(world[:3, :3]) < 0:
        placed = placed[:, ::-1]
    return placed[..., [2, 0, 1]]  # (Z, X, Y) of glTF is (forward, left, up)
