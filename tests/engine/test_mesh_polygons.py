"""Polygons of mesh files: their triangles cover them once, whatever their shape; holes stay open.

The right area is the shoelace formula's: half the sum of the cross products of following corners.
"""

import json

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.errors import InputError
from pe_core.scene import vehicle_line
from pe_tools.formats.meshes.polygons import MAX_CONCAVE_CORNERS, joined_ring, triangulate
from tests.engine.mesh_files import (
    POINTS,
    glb_file,
    gltf,
    obj_bytes,
    ply_ascii,
    ply_binary,
    ply_header,
    read,
)
from tests.thorough import tries

TRIALS = tries(20, 300)
DART = np.array([(1.0, 2.0, 0.0), (0.0, 0.5, 0.0), (-1.0, 2.0, 0.0), (0.0, 0.0, 0.0)])
FACE = obj_bytes(POINTS, [(0, 1, 3, 2)])


def shoelace(ring):
    """The area of a flat ring (N, 3) in any plane."""
    spokes = ring - ring[0]
    return np.linalg.norm(np.cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0)) / 2.0


def area(triangles):
    edges = triangles[:, 1:] - triangles[:, :1]
    return np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum() / 2.0


def star(rng, corners):
    """A ring round the origin, no gap of which is half a turn, with corners near and far."""
    turns = (np.arange(corners) + rng.uniform(0.0, 0.9, corners)) * (2.0 * np.pi / corners)
    flat = np.stack([np.cos(turns), np.sin(turns)], axis=1) * rng.uniform(0.15, 1.0, (corners, 1))
    return np.column_stack([flat, np.zeros(corners)])


def with_corners_on_edges(ring):
    """The ring with a corner in the middle of each edge."""
    return np.stack([ring, (ring + np.roll(ring, -1, axis=0)) / 2.0], axis=1).reshape(-1, 3)


def arches(side=1.0):
    """A panel of 4 x 1.1 m with two half-octagons of 0.4 m radius cut out of its lower edge."""
    turn = np.radians(180.0 - 22.5 * np.arange(1, 8))
    arc = np.stack([0.4 * np.cos(turn), 0.4 * np.sin(turn)], axis=1)
    rear = arc - np.array([1.2, 0.0])
    front = arc + np.array([1.2, 0.0])
    low = [(-2.0, 0.0), (-1.6, 0.0), *rear, (-0.8, 0.0)]
    low += [(0.8, 0.0), *front, (1.6, 0.0), (2.0, 0.0)]
    flat = np.array([*low, (2.0, 1.1), (-2.0, 1.1)])
    return np.column_stack([flat[:, 0], np.full(len(flat), side), flat[:, 1]])


CHANGES = {
    "as it is": lambda ring, _: ring,
    "reversed": lambda ring, _: ring[::-1],
    "corners twice": lambda ring, _: np.repeat(ring, 2, axis=0),
    "corners on edges": lambda ring, _: with_corners_on_edges(ring),
    "tilted": lambda ring, turn: ring @ turn + np.array([3.0, -70.0, 0.5]),
    "single precision": lambda ring, turn: (ring @ turn).astype(np.float32).astype(float),
    "thin": lambda ring, _: ring * (1.0, 1e-9, 1.0),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("corners", [4, 5, 6, 9, 22, 60])
def test_triangles_of_any_ring_cover_it_once(change, corners):
    """There are two triangles fewer than corners."""
    rng = np.random.default_rng(corners)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rings = [CHANGES[change](star(rng, corners), turn) for _ in range(TRIALS)]
    counts = np.array([len(ring) for ring in rings])
    found = triangulate("car", np.concatenate(rings), counts)
    assert found.crossing == 0
    for number, ring in enumerate(rings):
        triangles = found.triangles[found.polygons == number]
        assert len(triangles) == len(ring) - 2
        assert area(triangles) == pytest.approx(shoelace(ring), rel=1e-6, abs=1e-15)


def test_convex_polygons_are_fans_and_keep_their_order():
    turns = np.arange(6) * np.pi / 3.0
    ring = np.stack([np.cos(turns), np.sin(turns), np.zeros(6)], axis=1)
    found = triangulate("car", np.concatenate([ring, ring[:3]]), np.array([6, 3]))
    fan = ring[[(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]]
    assert found.triangles[:4].tolist() == fan.tolist()
    assert found.polygons.tolist() == [0, 0, 0, 0, 1]


def test_too_many_corners_of_a_concave_ring_are_refused():
    ring = star(np.random.default_rng(1), MAX_CONCAVE_CORNERS + 1)
    with pytest.raises(InputError, match="concave polygons"):
        triangulate("car", ring, np.array([len(ring)]))


@pytest.mark.parametrize("seed", range(TRIALS))
def test_holes_stay_open_in_any_plane(seed):
    """Squares and stars in a field of 10 x 10 m, wound either way."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] if seed % 2 else np.eye(3)
    field = np.array([(0, 0, 0), (10, 0, 0), (10, 10, 0), (5, 6, 0), (0, 10, 0)], float)
    places = [(x, y, 0.0) for x in (1.5, 3.5, 6.5, 8.5) for y in (1.5, 3.5)]
    rings = [
        field,
        *(star(rng, 7) * 0.9 + np.array(p) for p in rng.permutation(places)[: seed % 8 + 1]),
    ]
    rings = [ring[::-1] if rng.random() < 0.5 else ring for ring in rings]
    turned = [ring @ turn for ring in rings]
    whole = np.concatenate(turned)[joined_ring(turned)]
    found = triangulate("car", whole, np.array([len(whole)]))
    expected = shoelace(rings[0]) - sum(shoelace(ring) for ring in rings[1:])
    assert area(found.triangles) == pytest.approx(expected, rel=1e-9)
    assert found.crossing == 0


RINGS = {"arches": arches(), "dart": DART}


@pytest.mark.parametrize("name", RINGS)
@pytest.mark.parametrize(
    ("suffix", "written"),
    [
        ("obj", lambda ring, face: obj_bytes(ring, [face])),
        ("ply", lambda ring, face: ply_ascii(ring, [face, face[:3]])),
        ("ply", lambda ring, face: ply_binary("<", ring, [face, face[:3]])),
        ("ply", lambda ring, face: ply_binary(">", ring, [face])),
    ],
)
def test_concave_faces_have_the_shoelace_area_in_each_format(tmp_path, name, suffix, written):
    """Two wheel arches in a panel: 3.91 m2 for the 6.04 of a fan."""
    ring = RINGS[name]
    face = list(range(len(ring)))
    mesh = read(tmp_path, f"a.{suffix}", written(ring, face), up="+z", forward="+x")
    more = shoelace(ring[:3]) if len(mesh.triangles) > len(ring) - 2 else 0.0
    assert area(mesh.triangles) == pytest.approx(shoelace(ring) + more, rel=1e-6)
    assert mesh.notes == ()


def strips(points):
    """A PLY with an edge and a list of strips besides its face."""
    head = ply_header("ascii", len(points), 1).replace(
        "end_header",
        "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header",
    )
    rows = "\n".join(" ".join(map(str, point)) for point in points)
    return f"{head}{rows}\n3 0 1 2\n0 1\n4 0 1 2 3\n".encode()


def lines_and_points():
    root, binary = gltf()
    primitives = root["meshes"][0]["primitives"]
    primitives += [{"attributes": {"POSITION": 0}, "mode": mode} for mode in (0, 1)]
    return glb_file(root, binary)


LEFT_OUT = [
    ("a.obj", FACE + b"\nl 1 2\nl 2 3\np 1\nf 1 2\n", ("2 lines", "1 point", "1 face of fewer")),
    ("a.ply", strips(POINTS), ("1 edge", "1 set of triangle strips")),
    ("a.glb", lines_and_points(), ("1 set of points", "1 set of lines")),
]


@pytest.mark.parametrize(("name", "data", "words"), LEFT_OUT)
def test_geometry_that_is_left_out_is_counted_in_one_line(tmp_path, name, data, words):
    """In the notes of the mesh, and in the line about the vehicle of a study."""
    mesh = read(tmp_path, name, data)
    assert len(mesh.notes) == 1 and all(word in mesh.notes[0] for word in words)
    vehicle = pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
    assert vehicle_line(vehicle, mesh.axes, mesh.notes).endswith(mesh.notes[0])
    assert mesh.notes[0].isprintable()
    if name == "a.obj":
        text = f'[vehicle]\nmesh = "{name}"\n[[sensor]]\nname = "roof"\nmodel = "Pandar64"\n'
        (tmp_path / "study.toml").write_text(f"{text}position = [0, 0, 2]\n")
        assert mesh.notes[0] in pe.load_study(tmp_path / "study.toml").vehicle_line


def test_instances_of_a_glb_are_placed(tmp_path):
    """Two boxes of the instancing extension, the second turned upside down and of double size."""
    root, binary = gltf()
    places = np.array([(0, 0, 0), (10, 0, 0)], "<f4").tobytes()
    turns = np.array([(0, 0, 0, 1), (1, 0, 0, 0)], "<f4").tobytes()
    sizes = np.array([(1, 1, 1), (2, 2, 2)], "<f4").tobytes()
    binary += b"\0" * (-len(binary) % 4)
    attributes = {}
    for name, width, data in (
        ("TRANSLATION", 3, places),
        ("ROTATION", 4, turns),
        ("SCALE", 3, sizes),
    ):
        attributes[name] = len(root["accessors"])
        view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)}
        root["bufferViews"].append(view)
        root["accessors"].append(
            {
                "bufferView": len(root["bufferViews"]) - 1,
                "componentType": 5126,
                "type": f"VEC{width}",
                "count": 2,
            }
        )
        binary += data
    root["buffers"][0]["byteLength"] = len(binary)
    root["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    root["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    mesh = read(tmp_path, "a.glb", glb_file(root, binary), up="+y", forward="+z")
    one = read(tmp_path, "b.glb", glb_file(*gltf()), up="+y", forward="+z").triangles
    second = one * (-2.0, 2.0, -2.0) + (0.0, 10.0, 0.0)  # half a turn round glTF's X, our y
    assert len(mesh.triangles) == 2 * len(one)
    expected = np.concatenate([one, second])
    for end in (np.min, np.max):
        np.testing.assert_allclose(
            end(mesh.triangles.reshape(2, -1, 3), axis=1), end(expected.reshape(2, -1, 3), axis=1)
        )
    assert area(mesh.triangles) == pytest.approx(5.0 * area(one))
    assert json.dumps(mesh.part_names).count("instance") == 2
