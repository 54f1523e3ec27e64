"""OBJ, STL, PLY and binary glTF, read by trimesh; what it would read wrongly is refused before."""

import io
import json
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.errors import InputError, require_memory
from pe_core.base.files import decode_text
from pe_core.scene.mesh import Mesh

from .mesh import Piece, fit_names, joined, make_mesh, placed, require_room

UNFOLDS = 20  # Memory of a byte of a file while it is read, at most (measured)
MAX_NODES, MAX_PLACED, MAX_JSON_BYTES = 200_000, 20_000, 32 << 20
"""Limits of a glTF scene: nodes, surfaces of all that have a mesh, and bytes of JSON."""
UNNAMED = re.compile(r"geometry(_\d+)?|GLTF(_\d+)?")  # Names that trimesh gives to what has none
BACKWARDS = re.compile(r"^f (?:.* )?[-0].*", re.MULTILINE)
"""A face of an OBJ file with an index that counts backwards, or is 0: trimesh takes another."""
HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quant")


def read_scene(path: Path, data: bytes) -> Mesh:
    """Read a file in its own axes, in metres; polygons are cut into triangles. Parts are the
    objects of an OBJ file (without any, its groups), the solids of an ASCII STL file, the nodes of
    glTF's default scene; else the file's stem. Transforms of nodes are applied; one that mirrors
    also reverses the triangles. Whatever trimesh raises becomes an `InputError`."""
    import trimesh

    source, kind = str(path), path.suffix[1:].lower()
    require_memory(source, "file", len(data) * UNFOLDS)
    options: dict[str, Any] = {}
    if kind in _PREPARED:
        data, options = _PREPARED[kind](source, data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # NumPy's, of text that is no number
            scene = trimesh.load_scene(
                io.BytesIO(data), file_type=kind, process=False, skip_materials=True, **options
            )
        pieces = list(_pieces(source, scene))
    except (InputError, MemoryError):
        raise
    except Exception as error:  # whatever damaged files cause
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise InputError(source, "file", f"a whole {path.suffix.lower()} file", reason) from error
    if kind in ("obj", "glb"):
        pieces.reverse()  # trimesh takes them from the file's end
    triangles, parts = joined(pieces)
    names = [path.stem if UNNAMED.fullmatch(name) else name for name, _ in pieces]
    return make_mesh(source, triangles, parts, names)


def _pieces(source: str, scene: Any) -> Iterator[Piece]:
    """Every placed mesh of a scene; their triangles are counted before any is placed."""
    nodes = [(node, *scene.graph[node]) for node in scene.graph.nodes_geometry]
    faces = {
        name: getattr(mesh, "faces", np.zeros((0, 3), int)) for name, mesh in scene.geometry.items()
    }
    require_room(source, sum(len(faces[name]) for _, _, name in nodes))
    for node, matrix, name in nodes:
        if len(faces[name]):  # points and lines have none
            corners = faces[name]
            if corners.min() < 0:
                raise InputError(source, "faces", "vertex indices from 0 up", corners.min())
            # Each primitive of a glTF mesh is a node of its own, with a random name.
            of_mesh = scene.geometry[name].metadata.get("from_gltf_primitive")
            part = scene.graph.transforms.parents[node] if of_mesh else node
            yield Piece(part, placed(scene.geometry[name].vertices[corners], matrix))


def _obj(source: str, data: bytes) -> tuple[bytes, dict[str, Any]]:
    """OBJ without what trimesh stumbles over: comments, tabs, blanks before a statement."""
    if b"\0" in data:
        raise InputError(source, "file", "OBJ text", "binary data")
    text = decode_text(data).replace("\r\n", "\n").replace("\r", "\n")
    text = re.sub(r"^[ \t]*#.*", "", text, flags=re.MULTILINE)
    text = text.replace("\\\n", " ")
    if "#" in text or "\t" in text or "\n " in text:
        text = re.sub(r"^[ \t]*([vf])[ \t]+([^#\n]*).*", r"\1 \2", text, flags=re.MULTILINE)
        text = re.sub(r"^[ \t]*([og])[ \t]+", r"\1 ", text, flags=re.MULTILINE)
    if wrong := BACKWARDS.search(text):
        raise InputError(source, "faces", "vertex indices from 1 up", wrong[0][:60])
    has_objects = re.search(r"^o ", text, re.MULTILINE) is not None
    split = "split_objects" if has_objects else "split_groups"
    return text.encode(), {split: True, "group_material": False}


def _stl(source: str, data: bytes) -> tuple[bytes, dict[str, Any]]:
    """Refuse text whose last solid has no end: trimesh would leave it out."""
    is_text = data[:512].lstrip()[:5].lower() == b"solid" and b"\0" not in data
    if is_text and not data.rstrip().rpartition(b"\n")[2].strip().lower().startswith(b"endsolid"):
        raise InputError(source, "file", "endsolid in the last line", "another line")
    return data, {}


def _glb(source: str, data: bytes) -> tuple[bytes, dict[str, Any]]:
    """Refuse scenes that trimesh reads as another shape, and those without end."""
    size = int.from_bytes(data[12:16], "little")
    if size > MAX_JSON_BYTES:
        raise InputError(source, "JSON", f"at most {MAX_JSON_BYTES:,} bytes", f"{size:,}")
    try:
        root = json.loads(data[20 : 20 + size])
        nodes, meshes, accessors = (root.get(k, []) for k in ("nodes", "meshes", "accessors"))
        children = [child for node in nodes for child in node.get("children", [])]
        primitives = [each for mesh in meshes for each in mesh["primitives"]]
        surfaces = sum(len(meshes[n["mesh"]]["primitives"]) for n in nodes if "mesh" in n)
        checks = {
            f"at most {MAX_NODES:,} nodes": len(nodes) <= MAX_NODES,
            f"at most {MAX_PLACED:,} surfaces": max(surfaces, len(primitives)) <= MAX_PLACED,
            "one parent to a node": len(set(children)) == len(children),
            "meshes without skins": not any("skin" in node for node in nodes),
            "meshes in their basic shape": not any(
                any(e.get("weights", ())) for e in [*nodes, *meshes]
            ),
            "no fans of triangles": all(each.get("mode", 4) != 6 for each in primitives),
            "no compressed geometry": all(
                str(name).startswith(HARMLESS) for name in root.get("extensionsRequired", [])
            ),
            "accessors with a bufferView, neither sparse nor normalized": all(
                "sparse" not in each and "bufferView" in each for each in accessors
            )
            and not any(
                accessors[each["attributes"]["POSITION"]].get("normalized") for each in primitives
            ),
        }
    except (ValueError, RecursionError, TypeError, LookupError, AttributeError) as error:
        raise InputError(source, "JSON", "a well-formed glTF scene", error) from error
    for expected, holds in checks.items():
        if not holds:
            raise InputError(source, "scene", expected, "another")
    return data, {}


_PREPARED: dict[str, Callable[[str, bytes], tuple[bytes, dict[str, Any]]]] = {
    "obj": _obj,
    "stl": _stl,
    "glb": _glb,
}


def dump_obj(path: Path, mesh: Mesh) -> bytes:
    """Return OBJ text of a mesh: an object a part, coordinates to 1e-12 m."""
    import trimesh

    if fit_names(mesh.part_names) != mesh.part_names:
        raise InputError(str(path), "part_names", "names that fit on one line", mesh.part_names)
    scene = trimesh.Scene()
    for part, name in enumerate(mesh.part_names):
        corners = mesh.triangles[mesh.parts == part].reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        each = trimesh.Trimesh(corners, faces, process=False)
        scene.add_geometry(each, node_name=name, geom_name=name)
    text: Any = scene.export(  # type: ignore[no-untyped-call]
        file_type="obj", digits=12, header="metres, x forward, y left, z up"
    )
    return str(text).encode()
