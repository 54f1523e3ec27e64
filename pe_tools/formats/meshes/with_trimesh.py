"""STL and binary glTF, read by trimesh; what it would read wrongly is fixed or refused before."""

import io
import re
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.base.table_reader import parse_json
from pe_core.scene.mesh import Mesh

from .gltf_instances import INSTANCING, instance_count, with_instances_as_nodes
from .mesh import Piece, fit_names, joined, make_mesh, mesh_notes, placed, require_room
from .whole_numbers import refusing_unread_text

MAX_NODES = 200_000
MAX_PLACED = 20_000
MAX_JSON_BYTES = 32 << 20
"""Limits of a glTF scene: nodes, surfaces of all that have a mesh, and bytes of JSON."""
UNNAMED = re.compile(r"geometry(_\d+)?|GLTF(_\d+)?")  # Names that trimesh gives to what has none
NO_TRIANGLES = {"PointCloud": "set of points", "Path3D": "set of lines"}
WRONG_JSON = (ValueError, RecursionError, TypeError, LookupError, AttributeError, OverflowError)
HARMLESS = (
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_mesh_quant",
    INSTANCING,
)


def read_scene(path: Path, data: bytes) -> Mesh:
    """Read a file in its own axes, in metres; polygons are cut into triangles. Parts are the
    objects of an OBJ file (without any, its groups), the solids of an ASCII STL file, the nodes of
    glTF's default scene; else the file's stem. Transforms of nodes are applied; one that mirrors
    also reverses the triangles. Whatever trimesh raises becomes an `InputError`."""
    import trimesh

    source = str(path)
    kind = path.suffix[1:].lower()
    options: dict[str, Any] = {}
    if kind in _PREPARED:
        data, options = _PREPARED[kind](source, data)
    try:
        with refusing_unread_text():
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
    notes = mesh_notes(_skipped(scene), np.zeros(0), 0)
    return make_mesh(source, triangles, parts, names, notes=notes)


def _placements(graph: Any) -> Iterator[tuple[str, Floats, str]]:
    """Each node with a geometry, its transform (4, 4) to the scene, and the geometry's name. By
    trimesh's own look-up each node of a long chain would keep its way: gigabytes."""
    links = graph.transforms
    worlds = {graph.base_frame: np.eye(4)}
    for placed_node in graph.nodes_geometry:
        node = placed_node
        way = []
        while node not in worlds:
            way.append(node)
            node = links.parents[node]
        for below in reversed(way):
            local = links.edge_data[(node, below)].get("matrix", np.eye(4))
            worlds[below] = worlds[node] @ local
            node = below
        yield placed_node, worlds[placed_node], links.node_data[placed_node]["geometry"]


def _skipped(scene: Any) -> Counter[str]:
    """How much geometry of a scene is placed that is no triangles, by its noun."""
    kinds = (type(scene.geometry[name]).__name__ for _, _, name in _placements(scene.graph))
    return Counter(NO_TRIANGLES[kind] for kind in kinds if kind in NO_TRIANGLES)


def _pieces(source: str, scene: Any) -> Iterator[Piece]:
    """Every placed mesh of a scene; their triangles are counted before any is placed."""
    nodes = list(_placements(scene.graph))
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
        root = parse_json(source, data[20 : 20 + size])
        nodes, meshes, accessors = (root.get(k, []) for k in ("nodes", "meshes", "accessors"))
        primitives = [each for mesh in meshes for each in mesh["primitives"]]
        held = [node for node in nodes if "mesh" in node]
        surfaces = sum(
            len(meshes[node["mesh"]]["primitives"]) * instance_count(root, node) for node in held
        )
        checks = {
            f"at most {MAX_NODES:,} nodes": len(nodes) <= MAX_NODES,
            f"at most {MAX_PLACED:,} surfaces": max(surfaces, len(primitives)) <= MAX_PLACED,
            "one parent to a node, and no circle": _are_trees(nodes),
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
    except InputError as error:
        raise InputError(source, "JSON", error.expected, error.found) from error
    except WRONG_JSON as error:
        raise InputError(source, "JSON", "a well-formed glTF scene", error) from error
    for expected, holds in checks.items():
        if not holds:
            raise InputError(source, "scene", expected, "another")
    return with_instances_as_nodes(source, data, root), {}


def _are_trees(nodes: list[dict[str, Any]]) -> bool:
    """Whether each node of a glTF has one parent at most, and is below a node without one."""
    children = [node.get("children", []) for node in nodes]
    inner = {child for row in children for child in row}
    if len(inner) < sum(map(len, children)) or not inner <= set(range(len(nodes))):
        return False
    level = [number for number in range(len(nodes)) if number not in inner]
    reached = len(level)
    while level := [child for number in level for child in children[number]]:
        reached += len(level)
    return reached == len(nodes)


_PREPARED: dict[str, Callable[[str, bytes], tuple[bytes, dict[str, Any]]]] = {
    "stl": _stl,
    "glb": _glb,
}


def dump_obj(path: Path, mesh: Mesh) -> bytes:
    """Return OBJ text of a mesh: an object a part, coordinates to 1e-12 m."""
    if fit_names(mesh.part_names) != mesh.part_names:
        raise InputError(str(path), "part_names", "names that fit on one line", mesh.part_names)
    text: Any = _scene_of(mesh, mesh.triangles).export(
        file_type="obj", digits=12, header="metres, x forward, y left, z up"
    )
    return str(text).encode()


def dump_stl(_path: Path, mesh: Mesh) -> bytes:
    """Return a binary STL of a mesh: one solid, coordinates in single precision."""
    data: bytes = _scene_of(mesh, mesh.triangles).export(file_type="stl")
    return data


def dump_glb(_path: Path, mesh: Mesh) -> bytes:
    """Return a GLB of a mesh, which has +Y up and +Z forward: a node a part, single precision."""
    data: bytes = _scene_of(mesh, mesh.triangles[..., [1, 2, 0]]).export(file_type="glb")
    return data


def _scene_of(mesh: Mesh, triangles: Floats) -> Any:
    """Return a scene of trimesh with an object for each part of a mesh, at these corners."""
    import trimesh

    scene = trimesh.Scene()
    for part, name in enumerate(mesh.part_names):
        corners = triangles[mesh.parts == part].reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        each = trimesh.Trimesh(corners, faces, process=False)
        scene.add_geometry(each, node_name=name, geom_name=name)
    return scene
