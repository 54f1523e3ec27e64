"""Instances of a glTF mesh (EXT_mesh_gpu_instancing) as nodes, which any reader places."""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError

INSTANCING = "EXT_mesh_gpu_instancing"
PLACES = {"TRANSLATION": "translation", "ROTATION": "rotation", "SCALE": "scale"}
"""Attributes of the extension, and the key of a node that says the same."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
JSON_START = 20  # Bytes of a .glb in front of its JSON


def instance_count(root: dict[str, Any], node: dict[str, Any]) -> int:
    """How often a node's mesh is placed."""
    attributes = node.get("extensions", {}).get(INSTANCING, {}).get("attributes", {})
    counts = [int(root["accessors"][index]["count"]) for index in attributes.values()]
    return min(counts) if counts else 1


def with_instances_as_nodes(source: str, data: bytes, root: dict[str, Any]) -> bytes:
    """Return a .glb in which each instance of a mesh is a node below the node that has them; data
    without instances are returned unchanged. What is wrong with them raises `InputError`."""
    nodes = root.get("nodes", [])
    holders = [n for n in nodes if "mesh" in n and INSTANCING in n.get("extensions", {})]
    if not holders:
        return data
    size = int.from_bytes(data[12:16], "little")
    binary = data[JSON_START + size + 8 :]
    try:
        for node in holders:
            instances = _instances(root, binary, node)
            node.setdefault("children", []).extend(range(len(nodes), len(nodes) + len(instances)))
            nodes.extend(instances)
            del node["mesh"]
    except (ValueError, TypeError, LookupError, AttributeError, OverflowError) as error:
        raise InputError(source, "scene", "whole instances of a mesh", str(error)) from error
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    rest = data[JSON_START + size :]
    head = struct.pack("<4sII", b"glTF", 2, JSON_START + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest


def _instances(root: dict[str, Any], binary: bytes, node: dict[str, Any]) -> list[dict[str, Any]]:
    """A node for each instance of a node's mesh."""
    attributes = node["extensions"][INSTANCING]["attributes"]
    columns = {
        PLACES[name]: _values(root, binary, index).tolist()
        for name, index in attributes.items()
        if name in PLACES
    }
    made: list[dict[str, Any]] = []
    for row in range(instance_count(root, node)):
        instance = {"mesh": node["mesh"], **{key: rows[row] for key, rows in columns.items()}}
        if isinstance(node.get("name"), str):
            instance["name"] = f"{node['name']} instance {row + 1}"
        made.append(instance)
    return made


def _values(root: dict[str, Any], binary: bytes, index: int) -> NDArray[np.float64]:
    """The values (N, K) of an accessor, as numbers."""
    accessor = root["accessors"][index]
    view = root["bufferViews"][accessor["bufferView"]]
    code = np.dtype(COMPONENTS[accessor["componentType"]])
    width = WIDTHS[accessor["type"]]
    stride = int(view.get("byteStride", code.itemsize * width))
    start = int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
    shape = int(accessor["count"]), width
    values = np.ndarray(shape, code, binary, start, (stride, code.itemsize)).astype(float)
    if accessor.get("normalized"):
        values = np.maximum(values / np.iinfo(code).max, -1.0)
    if not np.isfinite(values).all():
        raise ValueError("a place that is not finite")
    return values
