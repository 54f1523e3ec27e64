"""Rigs go out in other formats and come back; what a format cannot hold is said; known files."""

import json
import math
from itertools import starmap
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.geometry.poses import rotation_matrix
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_tools.cli.exchange_verbs import FILE_NAMES
from pe_tools.cli.verbs import main
from pe_tools.exchange import RIG_FORMATS, format_of_file, rig_files
from pe_tools.exchange.frames import from_quaternion, quaternion
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

AXLE = pe.Reference(-1.31, 0.33)
PUCK = "Velodyne VLP-16 Puck"
TABLE = """\
# a comment; with a semicolon, and a comma
name,kind,model,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg
roof,lidar,Pandar64,-0.43,0,1.8,0,0,0
"front, left",camera,Camera 60 deg,1.5,0,1.2,0,5,0
"""
JOINT = '<joint name="{0}{1}" type="fixed"><parent link="{0}"/><child link="{1}"/></joint>'
LINKS = '<link name="a"/><link name="b"/><link name="c"/>'
CALL = "static_transform_publisher --x one --frame-id a --child-frame-id b"
LEFT_HANDED = "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 0 1 0 0 1 0 0 0 0 0 1 0\n"
ALL_SIX = "".join(f"    {key}: 0\n" for key in ("x", "y", "z", "roll", "pitch", "yaw"))
BAD_KITS = [
    ("base_link", "base_link: [1, 2]\n"),
    ("line 3", "base_link:\n    a:\n  b:\n"),
    ("base_link.a", "base_link:\n  a: &x 1\n"),
    ("line 3", "base_link:\n  a: 1\n  a: 2\n"),
    ("base_link.sensor_kit_base_link.y", "base_link:\n  sensor_kit_base_link:\n    x: 1\n"),
    ("base_link", f"base_link:\n  other:\n{ALL_SIX}"),
    ("base_link", "map:\n  x: 1\n"),
]
SUFFIXES = [
    ("PRIUS.URDF", None, "urdf"),
    ("objects.json", None, "carla"),
    ("scene.glb", None, "gltf"),
    ("prius.urdf", "urdf", "urdf"),
    ("rig.launch.xml", "ros", "ros"),
    ("front.json", "osi", "osi"),
    ("kit", "autoware", "autoware"),
    ("prius.v2", "csv", "csv"),
    ("rig.json", None, "driveworks"),
    ("rig.json", "carla", "carla"),
]
"""Output, the format that is asked for, and the one that is written."""
CURVE = pe.ApCurve(0.2, 0.1)
NEAR = pe.Camera("near", 640, 480, math.radians(70.0), min_range=0.3, max_range=40.0)
BEAMS = pe.Lidar("own", np.radians([-20, -10, 0]), 36, 80.0, min_range=0.5)
LOSSY = pe.Rig(
    [
        pe.Sensor("roof", BEAMS, pe.Pose((0.0, 0.0, 1.8)), fusion="top"),
        pe.Sensor("puck", pe.catalog.load("Velodyne VLP-16 Puck"), pe.Pose((1.0, 0.0, 1.0))),
        pe.Sensor("eye", NEAR, pe.Pose((1.5, 0.1, 1.3)), curve=CURVE),
    ]
)
RANGES = "minimum range of eye; maximum range of eye"
NOTHING_BUT_POSES = f"beams of roof, puck; {RANGES}; fusion group of roof; AP curve of eye"
EVERY_BEAM = (
    "minimum range of roof, eye; maximum range of eye; fusion group of roof; AP curve of eye"
)
LOST = {
    "csv": "beams of roof; AP curve of eye",
    "urdf": "AP curve of eye",
    "carla": EVERY_BEAM,
    "osi": EVERY_BEAM,
    "driveworks": f"beams of roof; {RANGES}; fusion group of roof; AP curve of eye",
    "kitti": f"beams of roof; {RANGES}; fusion group of roof; AP curve of eye",
    "usd": "AP curve of eye",
}
P0 = "718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0"
P2 = "718.856 0 607.1928 45.38225 0 718.856 185.2157 -0.1130887 0 0 1 0.003779761"
TR = (
    "0.0004276802 -0.9999672 -0.008084492 -0.0119846 -0.007210627 0.008081198 -0.9999413 "
    "-0.05403985 0.9999739 0.000485949 -0.007206934 -0.2921969"
)
"""Of odometry's sequence 00: the LiDAR to the rectified first camera."""
TO_FIRST = (
    "0.007533745 -0.9999714 -0.000616602 -0.004069766 0.01480249 0.0007280733 -0.9998902 "
    "-0.07631618 0.9998621 0.00752379 0.01480755 -0.2717806"
)


def sensor(name, model, position, rotation=(0, 0, 0)):
    return pe.Sensor(name, pe.catalog.load(model), pe.Pose.from_degrees(position, rotation))


MIXED = pe.Rig(
    [
        sensor("roof", "Pandar64", (-0.43, 0, 1.8), (0.5, -1.25, 12)),
        sensor("side left", PUCK, (1.2, 0.9, 0.8), (1, 40.7, 90.1)),
        sensor("front cam", "Front 120 deg 8 MP", (1.5, 0.1, 1.3), (0.3, 2.5, -0.4)),
        sensor("rear cam", "KITTI cam2", (-2.2, -0.1, 1.0), (0, 10, 180)),
        sensor("up cam", "KITTI cam2", (0, 0, 2.0), (20, -90, 0)),
    ]
)


def test_uneven_channels_and_their_azimuths_are_told():
    for name, told in (("carla", ["roof"]), ("urdf", ["roof"]), ("ros", [])):
        _, lines = rig_files(MIXED, name, AXLE)
        assert [s.split(":")[0] for s in lines if "spaces channels evenly" in s] == told


def spawned(kind, name, **more):
    """A row of objects.json."""
    spawn = dict.fromkeys(("x", "y", "roll", "pitch", "yaw"), 0.0) | {"z": 2.0}
    return {"type": f"sensor.{kind}", "id": name, "spawn_point": spawn, **more}


def test_carla_s_ground_truth_and_spectator_are_no_sensors(tmp_path):
    """What shows the simulated world without error, or the vehicle to a person, sees nothing."""
    picture = {"image_size_x": 800, "image_size_y": 600, "fov": 90.0}
    beams = {"channels": 4, "upper_fov": 2.0, "lower_fov": -20.0, "range": 50.0}
    beams |= {"points_per_second": 14400, "rotation_frequency": 10}
    truths = ("depth", "semantic_segmentation", "instance_segmentation", "optical_flow", "normals")
    rows = [
        spawned("camera.rgb", "front", **picture),
        spawned("lidar.ray_cast", "top", **beams),
        *(spawned(f"camera.{kind}", kind, **picture) for kind in truths),
        spawned("lidar.ray_cast_semantic", "semantic", **beams),
        spawned("camera.rgb", "rgb_view", **picture),
        spawned("camera.rgb", "Spectator", **picture),
        spawned("camera.dvs", "events", **picture),
    ]
    objects = [{"type": "vehicle.a.b", "id": "ego_vehicle", "sensors": rows}]
    (tmp_path / "objects.json").write_text(json.dumps({"objects": objects}))
    found = pt.import_rig(tmp_path)
    assert [(s.name, s.kind) for s in found.rig] == [("front", "camera"), ("top", "lidar")]
    (line,) = (line for line in found.lines if line.startswith("left out"))
    assert f"6 ground truth sensors ({', '.join(truths)}, semantic)" in line
    assert (
        "2 spectator sensors (rgb_view, Spectator)" in line
        and "1 camera.dvs sensor (events)" in line
    )


def saved_by_a_spreadsheet(separator):
    """A table with a separator, a comment in quotes and a row without cells at its end."""
    comment, *rows = TABLE.replace('"front, left"', "front left").splitlines()
    rows = [row.replace(",", separator) for row in rows]
    return "\n".join([f'"{comment}"{separator * 8}', *rows, separator * 8, ""])


def test_a_table_is_read_as_spreadsheets_save_it(tmp_path):
    path = tmp_path / "rig.csv"
    by_hand = [
        ("roof", "Pandar64", (-0.43, 0, 1.8), (0, 0, 0)),
        ("front left", "Camera 60 deg", (1.5, 0, 1.2), (0, 5, 0)),
    ]
    texts = [saved_by_a_spreadsheet(separator) for separator in ";\t,"]
    texts += [f"sep={text[-2]}\n{text}" for text in texts]
    for text in texts:
        for encoding in ("utf-8", "utf-8-sig", "utf-16"):
            path.write_bytes(text.replace("\n", "\r\n").encode(encoding))
            found = [
                (s.name, s.model.name, s.pose.position, s.pose.rotation_deg)
                for s in pt.import_rig(path).rig
            ]
            assert found == by_hand, (text[:12], encoding)
    path.write_text(TABLE)
    assert [s.name for s in pt.import_rig(path).rig] == ["roof", "front, left"]


def test_sensors_of_one_name_are_renamed_in_one_line_each(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(TABLE.replace('"front, left"', "roof").replace("# a comment", "# roof"))
    found = pt.import_rig(path)
    assert [s.name for s in found.rig] == ["roof", "roof_2"]
    assert [line for line in found.lines if line.startswith("roof_2: ")] != []


def test_quaternions_of_all_rotations_come_back():
    rng = np.random.default_rng(5)
    for rpy in [*rng.uniform(-math.pi, math.pi, (200, 3)), (math.pi, 0, 0), (0, 0, math.pi)]:
        rotation = rotation_matrix(*rpy)
        again = from_quaternion("test", "q", quaternion(rotation))
        assert np.abs(again - rotation).max() < 1e-12 and quaternion(rotation)[0] >= 0.0
        longer = from_quaternion("test", "q", [1.3 * q for q in quaternion(rotation)])
        assert np.abs(longer - rotation).max() < 1e-12


def test_the_rear_axle_is_guessed_from_wheels_alone():
    parts = [((-2.3, -1, 0.2), (2.4, 1, 1.5)), ((1.2, 0.7, 0), (1.8, 0.9, 0.6))]
    parts.append(((-1.6, 0.7, 0), (-1.0, 0.9, 0.6)))
    meshes = list(starmap(shapes.box, parts))
    numbers = np.repeat(np.arange(3), [len(mesh) for mesh in meshes])
    for names, known in (
        (("body", "wheel_front_left", "wheel_rear_left"), True),
        (("body", "Tire.FL", "Tire.RL"), True),
        (("body", "steering_wheel", "wheel_arch"), False),
    ):
        found = pe.guessed_reference(pe.Vehicle(np.concatenate(meshes), numbers, names))
        assert found == (
            pe.Reference(
                rear_axle_x=-1.3,
                rear_axle_z=0.3,
                wheelbase=2.8,
                front_overhang=0.9,
                rear_overhang=1.0,
            )
            if known
            else None
        )
    assert pe.guessed_reference(None) is None


def test_without_the_rear_axle_its_formats_are_refused(tmp_path):
    formats = [name for name, row in RIG_FORMATS.items() if row.origin.startswith("rear")]
    assert len(formats) > 3
    for name in formats:
        with pytest.raises(pe.InputError, match="rear axle's place, which is the origin"):
            pt.export_rig(MIXED, name, tmp_path / "new")
    assert not (tmp_path / "new").exists()


def robot(*joints):
    return "rig.urdf", f"<robot>{LINKS}{''.join(JOINT.format(*each) for each in joints)}</robot>"


BAD = [
    ("link", robot("ab")),
    ("link c", robot("bc", "cb")),
    ("link c", robot("ac", "bc")),
    ("joint 'az', child", robot("az")),
    ("file", ("rig.urdf", "<html/>")),
    ("model", ("rig.sdf", "<sdf/>")),
    ("y_m", ("rig.csv", "name,x_m\na,1\n")),
    ("row 1, z_m", ("rig.csv", "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\na,1,2,x,0,0,0\n")),
    ("row 1", ("rig.csv", "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\na,1,8,2,0,5,0,0,0\n")),
    ("row 1, z_m", ("rig.csv", "name;x_m;y_m;z_m;roll_deg;pitch_deg;yaw_deg\na;1;2;1,8;0;0;0\n")),
    ("objects", ("objects.json", '{"objects": []}')),
    ("file", ("objects.json", '{"objects": [')),
    ("rig.sensors", ("rig.json", '{"rig": {"sensors": [{"name": "can"}]}}')),
    ("file", ("rig.launch.xml", "<launch/>")),
    ("transform 1, x", ("rig.launch.xml", CALL)),
    ("Tr_velo_to_cam", ("calib.txt", "P0: 1 2 3\nR0_rect: 1 0 0 0 1 0 0 0 1\n")),
    ("Tr_velo_to_cam", ("calib.txt", LEFT_HANDED)),
    ("format", ("something.bin", "")),
]


def test_bad_files_are_refused_by_what_is_wrong_in_them(tmp_path):
    kit = "sensors_calibration.yaml"
    (tmp_path / "sensor_kit_calibration.yaml").write_text("sensor_kit_base_link:\n")

    def imported(given):
        (tmp_path / given[0]).write_text(given[1])
        pt.import_rig(tmp_path / given[0], reference=AXLE)

    assert wrongly_refused(imported, BAD, tmp_path) == []
    assert wrongly_refused(lambda text: imported((kit, text)), BAD_KITS, tmp_path / kit) == []


def test_the_command_writes_and_reads(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pe.save_study(pe.Study(MIXED, reference=AXLE), Path("study.toml"))
    assert main(["export", "study.toml", "--to", "autoware", "-o", "kit"]) == 0
    said = capsys.readouterr()
    assert "sensor_kit_calibration.yaml" in said.out and "Pandar64" in said.err
    assert main(["import", "kit", "-o", "back.toml"]) == 1, "where the rear axle is was not said"
    command = ["import", "kit", "-o", "back.toml", "--rear-axle", "-1.31", "0.33"]
    assert main([*command, "--model", f"side_left={PUCK}"]) == 0
    told = capsys.readouterr().err
    assert "side_left: 37.7 mm from its frame up to the centre of its scan" in told
    assert "no model" not in told, "comments have them"
    back = pe.load_study("back.toml")
    assert back.samples == FIRST_SAMPLES
    assert back.reference == AXLE and len(back.rig) == len(MIXED)
    assert main(command) == 1, "a study is there"
    assert "an existing file" in capsys.readouterr().err


NO_FORMAT = [("rig", "ros"), ("prius.urdf", "csv"), ("plan.svg", "gltf"), ("front.json", None)]
NO_FORMAT += [("prius.step", None), ("prius", None)]


def test_the_suffix_of_a_file_decides_its_format():
    found = [format_of_file(Path(output), FILE_NAMES, chosen) for output, chosen, _ in SUFFIXES]
    assert found == [written for _, _, written in SUFFIXES]

    def refused(given):
        format_of_file(Path(given[0]), FILE_NAMES, given[1])

    assert wrongly_refused(refused, [("format", given) for given in NO_FORMAT]) == []


def test_what_a_format_cannot_hold_is_one_line():
    pytest.importorskip("pyarrow", reason="of the extra argoverse")
    for name, row in RIG_FORMATS.items():
        rig = pe.Rig([s for s in LOSSY if s.name != "puck"]) if name == "kitti" else LOSSY
        _, lines = rig_files(rig, name, AXLE)
        told = [each for each in lines if each.startswith("left out of ")]
        assert told == [f"left out of {row.title}: {LOST.get(name, NOTHING_BUT_POSES)}"]


R = "0.9999239 0.00983776 -0.007445048 -0.009869795 0.9999421 -0.004278459 0.007402527 "
R += "0.004351614 0.9999631"
LAYOUTS = {
    "calib.txt": f"P0: {P0}\nP2: {P2}\nTr: {TR}\n",
    "000007.txt": f"P0: {P0}\nP2: {P2}\nR0_rect: {R}\nTr_velo_to_cam: {TO_FIRST}\n\n",
    "0007.txt": f"P0: {P0}\nP2: {P2}\nR_rect {R}\nTr_velo_cam {TO_FIRST}\nTr_imu_velo {TR}\n",
}
"""As the benchmarks of odometry, objects and tracking have them."""


@pytest.mark.parametrize("name", LAYOUTS)
def test_kitti_s_layouts_are_read(name, tmp_path):
    """Camera 0 by hand: where the transform takes the LiDAR's origin to, seen from the camera."""
    (tmp_path / name).write_text(LAYOUTS[name])
    found = pt.import_rig(tmp_path / name).rig
    assert [each.name for each in found] == ["velodyne", "camera_0", "camera_2"]
    to_first = np.array((TR if name == "calib.txt" else TO_FIRST).split(), dtype=float)
    turn = to_first.reshape(3, 4)[:, :3]
    camera = -turn.T @ to_first.reshape(3, 4)[:, 3]
    assert found["camera_0"].pose.position == pytest.approx(tuple(camera), abs=1e-6)
    axis = found["camera_0"].pose.ground_from_sensor[:, 0]
    rectified = np.eye(3) if name == "calib.txt" else np.array(R.split(), float).reshape(3, 3)
    assert axis == pytest.approx((rectified @ turn)[2], abs=1e-6)
    assert found["camera_2"].pose.position[1] == pytest.approx(camera[1] + 0.06, abs=0.01)


def nuimages(folder, distortion):
    """A table with the camera behind; what is read of it."""
    sensor = {"token": "s", "channel": "CAM_BACK", "modality": "camera"}
    row = {
        "token": "c",
        "sensor_token": "s",
        "translation": [0.0, 0.0, 1.5],
        "rotation": [0.5, -0.5, 0.5, -0.5],
        "camera_intrinsic": [[800.0, 0, 800.0], [0, 800.0, 450.0], [0, 0, 1]],
        "camera_distortion": distortion,
    }
    (folder / "sensor.json").write_text(json.dumps([sensor]))
    (folder / "calibrated_sensor.json").write_text(json.dumps([row]))
    return pt.import_rig(folder, None, pe.Reference(-1.4, 0.3))


def test_the_skew_of_a_matrix_is_told_and_another_form_is_refused(tmp_path):
    """KITTI's camera with a skew: P = K [I | -t] gives the same t, computed by NumPy."""
    (tmp_path / "calib.txt").write_text(LAYOUTS["calib.txt"].replace("718.856 0 ", "718.856 2 "))
    found = pt.import_rig(tmp_path / "calib.txt")
    assert found.lines[0].startswith("camera_0, camera_2: ") and "skew, 2 px" in found.lines[0]
    p = np.array(P2.split(), float).reshape(3, 4)
    p[0, 1] = 2.0
    place = np.linalg.solve(p[:, :3], -p[:, 3])
    to_first = np.array(TR.split(), dtype=float).reshape(3, 4)
    in_lidar = to_first[:, :3].T @ (place - to_first[:, 3])
    assert found.rig["camera_2"].pose.position == pytest.approx(tuple(in_lidar), abs=1e-5)
    nuimages(tmp_path, [])
    path = tmp_path / "calibrated_sensor.json"
    rows = json.loads(path.read_text())
    for place, value, error in (((0, 1), 1.5, False), ((1, 0), 1.5, True), ((2, 2), 2.0, True)):
        matrix = [[800.0, 0, 800.0], [0, 800.0, 450.0], [0, 0, 1]]
        matrix[place[0]][place[1]] = value
        path.write_text(json.dumps([rows[0] | {"camera_intrinsic": matrix}]))
        if error:
            with pytest.raises(pe.InputError, match="camera_intrinsic"):
                pt.import_rig(tmp_path, reference=AXLE)
        else:
            lines = pt.import_rig(tmp_path, reference=AXLE).lines
            assert any("skew, 1.5 px" in line for line in lines)


def test_of_six_numbers_of_nuimages_the_last_is_left_out_and_a_seventh_is_too_many(tmp_path):
    for sixth in (0.00048, 0.0):
        found = nuimages(tmp_path, [-0.23, 0.061, 4e-4, -3e-4, -0.0085, sixth])
        lens = found.rig["CAM_BACK"].model.projection
        assert (lens.k1, lens.k2, lens.k3, lens.k4) == (-0.23, 0.061, -0.0085, 0.0)
        assert (lens.p1, lens.p2) == (4e-4, -3e-4)
        assert any("its sixth coefficient" in line for line in found.lines) == (sixth != 0.0)
    with pytest.raises(pe.InputError, match="4 to 6 numbers"):
        nuimages(tmp_path, [0.1] * 7)


def test_a_name_that_begins_as_a_comment_comes_back_from_a_table(tmp_path):
    rig = pe.Rig([sensor("#1", PUCK, (0, 0, 2)), sensor("=2", PUCK, (1, 0, 2))])
    pt.export_rig(rig, "csv", tmp_path / "rig.csv")
    assert [s.name for s in pt.import_rig(tmp_path / "rig.csv").rig] == ["#1", "=2"]
