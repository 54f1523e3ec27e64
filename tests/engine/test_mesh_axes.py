"""Axes of mesh files: asked for, said by the file, guessed by names and shape; and always told."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.scene.mesh import AXIS_NAMES, BodyShape
from pe_core.scene.vehicle_description import up_of
from tests.engine.mesh_files import glb_file, gltf, obj_bytes, read, stl_binary
from tests.engine.shapes import BOX_FACES

# A car in the ground frame: a body, a cabin nearer to its rear, a nose. No side is like another.
BOXES = {
    "body": ((-2.0, -0.9, 0.25), (2.0, 0.9, 0.8)),
    "cabin": ((-1.7, -0.75, 0.8), (0.6, 0.75, 1.5)),
    "hood": ((1.2, -0.8, 0.8), (1.9, 0.8, 0.9)),
    "tail": ((-2.0, -0.8, 0.8), (-1.8, 0.8, 0.9)),
    "wheels": ((-1.5, -0.9, 0.0), (1.5, 0.9, 0.5)),
}
TURNS = {  # of (forward, left, up): what a program's axes x, y, z are
    "ours": (lambda x, y, z: (x, y, z)),
    "Blender, Y up": (lambda x, y, z: (x, z, -y)),
    "Z forward, Y up": (lambda x, y, z: (y, z, x)),
    "-Y forward, Z up": (lambda x, y, z: (y, -x, z)),
}
CORNER = np.vstack([np.zeros(3), np.eye(3)])[[(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]]
"""The triangles of a cube's corner: none of its halves is like the other."""
PROFILES = {
    # Length and height of the corners of a side view from the front on [m].
    "pickup": [(0.0, 1.15), (1.3, 1.2), (2.2, 1.9), (3.5, 1.9), (3.55, 0.85), (5.6, 0.85)],
    "sedan": [(0.0, 0.75), (1.2, 0.9), (2.0, 1.4), (3.2, 1.42), (4.0, 1.05), (4.7, 1.0)],
    "hatchback": [(0.0, 0.8), (1.0, 0.95), (1.7, 1.45), (3.7, 1.45), (3.9, 0.9)],
    "rear engine": [(0.0, 0.65), (1.2, 0.85), (1.9, 1.3), (2.3, 1.3), (4.2, 1.0), (4.4, 0.9)],
}


def corners(box):
    ends = np.array(box)
    return np.array(
        [(ends[i, 0], ends[j, 1], ends[k, 2]) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )


def car(turn, names=tuple(BOXES)):
    """Points (N, 3) of the boxes in a program's axes, and lists of faces by name."""
    points = np.concatenate([corners(BOXES[name]) for name in names])
    faces = {name: np.array(BOX_FACES) + 8 * k for k, name in enumerate(names)}
    return np.stack(TURNS[turn](*points.T), axis=1), faces


def obj(turn, named=True, head=b""):
    points, faces = car(turn)
    text = [head, obj_bytes(points, [])]
    for name, quads in faces.items():
        text.append(f"o {name if named else 'mesh'}".encode())
        text.append(obj_bytes([], quads))
    return b"\n".join(text)


def triangles_of(turn):
    points, faces = car(turn)
    return np.concatenate(
        [points[q[[0, a, a + 1]]][None] for quads in faces.values() for q in quads for a in (1, 2)]
    )


def is_upright(mesh):
    corners = mesh.triangles.reshape(-1, 3)
    low = corners.min(axis=0)
    high = corners.max(axis=0)
    np.testing.assert_allclose([low, high], [(-2.0, -0.9, 0.0), (2.0, 0.9, 1.5)], atol=1e-6)
    return True


def faces_ahead(mesh):
    """Whether the nose is ahead and left is left: the box of the nose is where it was."""
    hood = mesh.triangles[mesh.parts == mesh.part_names.index("hood")].reshape(-1, 3)
    np.testing.assert_allclose(hood.min(axis=0), BOXES["hood"][0], atol=1e-6)
    return True


@pytest.mark.parametrize("turn", TURNS)
def test_an_obj_with_names_is_turned_whatever_its_axes_are(tmp_path, turn):
    mesh = read(tmp_path, "car.obj", obj(turn))
    assert is_upright(mesh) and faces_ahead(mesh)
    assert "(part names)" in mesh.axes


@pytest.mark.parametrize("turn", TURNS)
def test_without_names_the_shape_says_up_and_along(tmp_path, turn):
    mesh = read(tmp_path, "car.obj", obj(turn, named=False))
    assert is_upright(mesh)
    up = "+y" if turn.endswith("Y up") else "+z"
    assert f"up is {up} (shape)" in mesh.axes
    top = mesh.triangles.reshape(-1, 3)[mesh.triangles.reshape(-1, 3)[:, 2] > 1.4]
    assert top[:, 0].mean() < 0.0, "the cabin is nearer to its rear: its hood tells so"
    stl = read(tmp_path, "car.stl", stl_binary(triangles=triangles_of(turn)))
    assert is_upright(stl) and stl.axes == mesh.axes


@pytest.mark.parametrize(
    ("comment", "told"),
    [
        (b"# metres, x forward, y left, z up", ""),
        (b"# X-Forward, Z-Up", ""),
        (b"# axes: -y forward, +z up", "faces -y (file), up is +z (file)"),
        (b"# z forward\n# y up", "faces +z (file), up is +y (file)"),
    ],
)
def test_comments_that_name_the_axes_are_believed(tmp_path, comment, told):
    """Against the names of parts, which would say otherwise."""
    assert read(tmp_path, "car.obj", obj("Blender, Y up", head=comment)).axes == told


def test_gltf_is_y_up_and_its_front_is_looked_for(tmp_path):
    """As the standard has it, and as Blender writes a car that faces its +X."""
    for turn, told in (("Z forward, Y up", "faces +z"), ("Blender, Y up", "faces +x (shape)")):
        points = np.stack(TURNS[turn](*(triangles_of("ours").reshape(-1, 3).T)), axis=1)
        root, _ = gltf(points=points, indices=None)
        data = points.astype("<f4").tobytes()
        mesh = read(tmp_path, "car.glb", glb_file(root, data))
        assert is_upright(mesh)
        assert mesh.axes.startswith(told) and mesh.axes.endswith("up is +y (format)")


@pytest.mark.parametrize("up", AXIS_NAMES)
@pytest.mark.parametrize("forward", AXIS_NAMES)
def test_a_study_s_axes_hold_against_any_guess(tmp_path, up, forward):
    """x of the result is the file's forward, z its up, y what is left of them: det is 1."""
    if up[1] == forward[1]:
        with pytest.raises(pe.InputError, match="across up"):
            pe.MeshAxes(up, forward)
        return
    mesh = read(tmp_path, "car.obj", obj("ours"), up=up, forward=forward)
    ours = read(tmp_path, "car.obj", obj("ours"), up="+z", forward="+x").triangles
    unit = {n: np.eye(3)["xyz".index(n[1])] * (1 if n[0] == "+" else -1) for n in (up, forward)}
    turn = np.stack([unit[forward], np.cross(unit[up], unit[forward]), unit[up]])
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_array_equal(mesh.triangles, ours @ turn.T)
    assert mesh.axes == f"faces {forward} (study), up is {up} (study)"


def test_scale_and_rotation_come_last(tmp_path):
    mesh = read(tmp_path, "box.stl", stl_binary(), scale=0.5, rotation_deg=(0, 0, 90))
    low, high = (f(mesh.triangles.reshape(-1, 3), axis=0) for f in (np.min, np.max))
    # The box of x -1 to 4, y -1 to 1.5: halved, then x becomes y and y becomes -x.
    np.testing.assert_allclose([low, high], [(-0.75, -0.5, 0.125), (0.5, 2.0, 1.0)], atol=1e-12)


def slab(low, high):
    return corners(np.array((low, high)))


@pytest.mark.parametrize(
    ("low", "mirrored", "up"),
    [
        ((5.0, 5.0, 5.0), 1, (2, "shape")),
        ((5.0, 5.0, 5.0), 2, (1, "shape")),
        ((5.0, -0.5, 0.0), None, (2, "shape")),  # the bottom at z = 0, the middle at y = 0
        ((-0.5, 0.0, -0.5), None, (1, "shape")),
        ((-0.5, 5.0, 0.0), None, None),
    ],
)
def test_up_is_across_the_mirror_or_where_the_bottom_is_on_the_ground(low, mirrored, up):
    halves = [CORNER]
    if mirrored is not None:
        halves.append(CORNER * np.where(np.arange(3) == mirrored, -1.0, 1.0))
    triangles = np.concatenate(halves) + low
    assert up_of(BodyShape(triangles, np.zeros(len(triangles), np.int32), ["body"])) == up


def outline_car(heights, width):
    """Boxes side by side along y, as high as they say; z is up, forward along y."""
    length = 4.0 / len(heights)
    boxes = [
        slab((-width / 2, -2.0 + k * length, 0.0), (width / 2, -2.0 + (k + 1) * length, height))
        for k, height in enumerate(heights)
    ]
    points = np.concatenate(boxes)
    quads = np.concatenate([np.array(BOX_FACES) + 8 * k for k in range(len(boxes))])
    return obj_bytes(points, quads)


@pytest.mark.parametrize(
    ("heights", "width", "told"),
    [
        ((1.4, 1.5, 1.5, 0.9), 1.8, "faces +y (shape)"),  # a hatchback: its hood is at +y
        ((0.9, 1.5, 1.5, 1.4), 1.8, "faces -y (shape)"),
        ((1.1, 1.5, 1.5, 0.9), 1.8, "faces -y (shape)"),  # too even to tell: Blender's front
        ((2.6, 2.6, 2.6, 1.2), 2.5, "faces -y (shape)"),  # a lorry may be low at its rear
    ],
)
def test_a_car_s_hood_tells_its_front_and_a_lorry_s_load_does_not(tmp_path, heights, width, told):
    mesh = read(tmp_path, "car.obj", outline_car(heights, width))
    assert told in mesh.axes


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("kind", PROFILES)
def test_a_pickup_s_bed_is_not_its_hood(kind, way, tmp_path):
    """Its bed is lower than its hood, but ends at an upright window; z is up, it faces +y or -y."""
    ends = [*PROFILES[kind], (PROFILES[kind][-1][0], 0.0), (0.0, 0.0)]
    middle = PROFILES[kind][-1][0] / 2.0
    side = [(way * (middle - x), z) for x, z in ends]
    points = [(half, y, z) for half in (-1.0, 1.0) for y, z in side]
    count = len(side)
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    for k in range(count):
        after = (k + 1) % count
        corners = (k, after, after + count, k + count)
        lines.append("f " + " ".join(str(corner + 1) for corner in corners))
    mesh = read(tmp_path, "car.obj", "\n".join(lines).encode())
    assert f"faces {'+' if way > 0 else '-'}y (shape)" in mesh.axes
