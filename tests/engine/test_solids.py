"""Fields of view as solids: closed, as large as a formula says, and where the body leaves them."""

import json
import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.cli.verbs import main
from pe_tools.outputs import scene_files
from pe_tools.outputs.solid import (
    MountedView,
    _squares,
    blind_volume,
    free_solid,
    hidden_solid,
    joined,
    mounted_view,
    voxel_solid,
    whole_solid,
)

from .shapes import box, box_car, camera, lidar_on_roof, small_lidar
from .surfaces import is_watertight, read_stl, volume

RANGE = 20.0
STEP = math.radians(2.0)
POSE = ((0.3, -0.2, 1.9), (3.0, 10.0, 50.0))
FISHEYE = pe.Camera("fisheye", 1280, 960, lens=pe.KannalaBrandt(320, 320, 640, 480, fov=3.4))
DOME = pe.Lidar("dome", np.radians(np.linspace(0, 90, 16)), 180, 30.0)
SECTOR = small_lidar(horizontal_fov=(-1.0, 1.0))
ROSETTE = pe.Lidar.from_directions(
    "rosette", [(1, 0.3 * math.cos(a), 0.3 * math.sin(a)) for a in np.linspace(0, 6.28, 400)], 90
)
LINE = pe.Lidar("line", [0.0], 360, 30.0)
MODELS = {"fisheye": FISHEYE, "dome": DOME, "sector": SECTOR, "rosette": ROSETTE, "line": LINE}
MODELS |= {"ring": small_lidar(), "pinhole": camera(90.0).model}
MODELS |= {
    name: pe.catalog.load(name) for name in ("Continental ARS408-21", "Parking module 2.5 m")
}


def view_of(name, vehicle=None, step=STEP):
    sensor = pe.Sensor(name, MODELS[name], pe.Pose.from_degrees(*POSE))
    return mounted_view(sensor, vehicle, RANGE, step)


def corners(solid):
    """(F, 3, 3), in the single precision that files have."""
    return solid.points.astype(np.float32)[solid.faces]


@pytest.mark.parametrize("name", MODELS)
def test_solids_of_every_kind_of_view_are_closed_and_outwards(name):
    view = view_of(name, box_car())
    whole, free = whole_solid("whole", view), free_solid("free", view)
    hidden = hidden_solid("hidden", view)
    solids = [whole, free] + ([hidden] if hidden else [])
    assert all(is_watertight(corners(solid)) for solid in solids)
    assert all(solid.volume > 0.0 for solid in solids)
    parts = free.volume + (hidden.volume if hidden else 0.0)
    assert parts == pytest.approx(whole.volume, rel=1e-3)  # the hidden one is 1 mm thick at least


def pyramid_angle(wide, high):
    """Solid angle of a pinhole's picture [sr]."""
    return 4.0 * math.asin(math.sin(wide / 2.0) * math.sin(high / 2.0))


FULL = 2.0 * math.pi
LOW, HIGH = math.radians(-25.0), math.radians(15.0)
BY_HAND = {  # solid angles [sr]
    "pinhole": pyramid_angle(math.pi / 2.0, 2.0 * math.atan(1080 / 1920)),
    "ring": FULL * (math.sin(HIGH) - math.sin(LOW)),
    "sector": math.radians(2 * 56) * (math.sin(HIGH) - math.sin(LOW)),  # its outmost beams
    "dome": FULL,
    "rosette": FULL * (1.0 - math.cos(math.atan(0.3))),
}


@pytest.mark.parametrize(("name", "rel"), [(n, 0.03 if n == "rosette" else 1e-3) for n in BY_HAND])
def test_an_unobstructed_view_is_as_large_as_its_solid_angle_says(name, rel):
    solid = whole_solid("view", view_of(name, step=math.radians(1.0)))
    assert solid.volume == pytest.approx(BY_HAND[name] * RANGE**3 / 3.0, rel=rel)
    assert hidden_solid("hidden", view_of(name)) is None


def test_a_wall_takes_what_lies_behind_it():
    """A wall 5 m ahead, wider than the picture: what is free is a pyramid of that height."""
    wall = pe.Vehicle(box((5.0, -30.0, -30.0), (5.1, 30.0, 30.0)))
    eye = camera(90.0, position=(0, 0, 0))
    view = mounted_view(eye, wall, RANGE, math.radians(1.0))
    free = free_solid("free", view)
    assert free.volume == pytest.approx(10.0 * 10.0 * 1080 / 1920 * 5.0 / 3.0, rel=1e-3)
    assert hidden_solid("hidden", view).points[:, 0].min() == pytest.approx(5.0, abs=1e-6)


def test_cubes_that_touch_along_an_edge_are_joined_by_a_third():
    cubes = np.random.default_rng(7).random((9, 8, 7)) < 0.3
    filled = joined(cubes)
    solid = voxel_solid("cubes", filled, np.array([-1.0, 2.0, 0.0]), 0.5)
    assert is_watertight(corners(solid)) and (filled >= cubes).all()
    assert solid.volume == pytest.approx(filled.sum() * 0.125)
    assert voxel_solid("none", np.zeros((2, 2, 2), bool), np.zeros(3), 0.5) is None


def test_what_is_hidden_in_two_places_that_touch_in_a_point_is_one_closed_solid():
    """5 by 5 rays ahead, two of them stopped: the triangles round these share the middle ray."""
    grid = np.arange(25).reshape(5, 5)
    a, b, c, d = (w.ravel() for w in (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    y, z = np.meshgrid(np.linspace(-0.2, 0.2, 5), np.linspace(-0.2, 0.2, 5), indexing="ij")
    ways = np.stack([np.ones(25), y.ravel(), z.ravel()], axis=1)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    ends = np.full(25, 10.0)
    ends[[grid[1, 1], grid[3, 3]]] = 5.0
    hidden = hidden_solid("hidden", MountedView(np.zeros(3), ways, faces, 10.0, ends))
    assert is_watertight(corners(hidden)) and hidden.volume > 0.0


def test_where_nothing_is_seen_all_is_blind_but_the_vehicle():
    """10 m round a block of 4 by 2 by 1 m, and 2.5 m high: 24 * 22 * 2.5 - 8 m3."""
    block = pe.Vehicle(box((-2.0, -1.0, 0.0), (2.0, 1.0, 1.0)))
    away = pe.Rig([lidar_on_roof(small_lidar(max_range=1.0), (500.0, 0.0, 2.0))])
    assert blind_volume("blind", away, block).volume == pytest.approx(1312.0)


def test_a_gap_of_one_cube_is_no_blind_volume():
    """Seen from above, layer by layer: a square of two by two, with a strip on either side."""
    layer = np.array([[0, 0, 1, 0, 0], [1, 1, 1, 1, 0], [0, 1, 1, 0, 1]], bool)
    kept = np.array([[0, 0, 0, 0, 0], [0, 1, 1, 0, 0], [0, 1, 1, 0, 0]], bool)
    flags = np.stack([layer, ~layer & False, layer], axis=2)
    assert (_squares(flags) == np.stack([kept, kept & False, kept], axis=2)).all()


def a_study(*sensors, vehicle=None):
    space = pe.PerceptionSpace((-16, 16), (-16, 16), (0, 3), 0.5)
    return pe.Study(pe.Rig(sensors), vehicle, space, reference=pe.Reference(-1.3, 0.3))


@pytest.fixture(scope="module")
def files():
    """Solids of a car with a LiDAR and a camera whose names are alike as files."""
    rig = lidar_on_roof(small_lidar(), name="roof/top"), camera(name="Roof top")
    return scene_files(a_study(*rig, vehicle=box_car()), "solids", RANGE)


def test_every_file_is_one_closed_solid_with_normals_outwards(files):
    stl = {name: data for name, data in files[0].items() if name.endswith(".stl")}
    kinds = ("field", "free", "hidden")
    assert {f"roof_top_{kind}.stl" for kind in kinds} | {"blind_volume.stl"} <= set(stl)
    assert "Roof_top_2_field.stl" in stl
    for data in stl.values():
        normals, triangles = read_stl(data)
        assert is_watertight(triangles) and volume(triangles) > 0.0
        across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        assert ((across * normals).sum(axis=1) >= 0.0).all()


def test_the_blind_volume_is_where_nothing_is_measured(files):
    """Corner by corner: none is in the body's column above its top, none farther than asked."""
    _, triangles = read_stl(files[0]["blind_volume.stl"])
    points = triangles.reshape(-1, 3)
    assert np.abs(points / 0.25 - np.rint(points / 0.25)).max() < 1e-5
    assert points.min(axis=0) == pytest.approx([-12.5, -11.0, 0.0])
    assert points[:, 2].max() <= 2.5
    car = box_car()
    seen = pe.measure(lidar_on_roof(small_lidar()), [[5.125, 0.125, 0.625]], 0.25, car)
    assert seen[0] > 0


def test_what_there_is_to_know_is_reported_in_lines():
    own = scene_files(a_study(camera(name="a b")), "solids")[1]
    assert own == [
        "a b: called a_b in names of files",
        "a b: has no range of its own; its solids end at 80 m (--range)",
        "no vehicle: nothing is occluded, and there is no blind volume near it",
    ]


def test_the_glb_names_and_colours_every_solid(files):
    data = files[0]["solids.glb"]
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    named = {node["name"] for node in document["nodes"]}
    assert {"Grp_Root", "roof_top_free", "roof_top_hidden", "blind_volume", "body"} <= named
    materials = {m["name"]: m for m in document["materials"]}
    assert materials["roof_top_free"]["alphaMode"] == "BLEND"
    assert len(data) == int.from_bytes(data[8:12], "little")


@pytest.mark.parametrize("range_m", [0.0, -3.0, math.nan, math.inf])
def test_a_range_that_is_none_is_refused_in_a_line(range_m):
    with pytest.raises(pe.InputError, match=r"export: range: expected a .*length above 0 m"):
        scene_files(a_study(camera()), "solids", range_m)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--to", "solids", "--range", "0"], "export: range: expected a length above 0 m"),
        (["--to", "solids", "-o", "taken"], "taken: folder: expected a path that can be written"),
        (["--to", "gltf", "-o", "taken/scene.glb"], "expected a path that can be written"),
        (["--to", "gltf", "-o", "taken.glb"], "taken.glb: file: expected a new file"),
        (
            ["--to", "csv", "-o", "rig.csv", "--range", "5"],
            "--range: option: expected one of solids",
        ),
    ],
)
def test_what_cannot_be_written_is_reported(options, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pe.save_study(a_study(camera()), "study.toml")
    for name in ("taken", "taken.glb"):
        (tmp_path / name).write_text("mine")
    assert main(["export", "study.toml", "-o", "out", *options]) == 1
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1
    assert (tmp_path / "taken").read_text() == "mine" and not (tmp_path / "out").exists()
